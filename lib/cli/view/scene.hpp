/* What `gtx render` draws: assets, polygon models and worlds, in one coordinate system. */
#pragma once

#include <geotex/geotex.h>

#include "cli/cli.h"
#include "cli/view/world.hpp"
#include "mesh/mesh.hpp"

#include <array>
#include <functional>
#include <memory>
#include <string>

namespace gtx {

struct AssetCloser {
    void operator()(gtx_asset *asset) const { gtx_close(asset); }
};
using AssetPointer = std::unique_ptr<gtx_asset, AssetCloser>;

/* Opens an asset, with the help of all processors. Throws Error. */
AssetPointer open_asset(const std::string &path);

/* A column-major affine transform in double. */
using Transform = std::array<double, 16>;
constexpr Transform identity_transform = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

struct PlacedAsset {
    AssetPointer asset;
    Transform transform; /* of the asset's object space, before its anchor is taken off */
    std::string model = {};   /* that it was cooked from just now; may be empty */
};

struct Scene {
    Vector<PlacedAsset> assets;
    Vector<Mesh> meshes;      /* cleaned */
    Vector<PlacedWorld> worlds;
    Vector<std::string> sources;  /* every file that it was made of */
    Vec3d centre;             /* bounding sphere of everything */
    double radius = 0;
};

/* Makes an asset of a height grid as gtx horizons does by default: degrees as metres of its middle,
 * and where no place is told heights that are no spikes. Throws Error. */
using WarnFn = std::function<void(gtx_warning, const char *)>;
AssetPointer asset_of_grid(const std::string &path, gtx_progress_fn progress, void *user,
                           const WarnFn &warn);

/* Adds a .gtx asset, a polygon model, a height grid, a world's folder, or a glTF scene whose nodes
 * place assets through `"extras": {"geotex": "FILE.gtx"}` (paths relative to it). Throws Error. */
void add_file(Scene &scene, const std::string &path, Task &task);

/* Whether a file is to be opened as an asset: its name or first bytes. Throws Error: READ. */
bool is_asset(const std::string &path);

/* Throws Error(ARGUMENT) where a file that the scene was made of is an output. */
void refuse_sources(const Scene &scene, const output_file *outputs);

/* Sets centre and radius once everything is in. */
void measure_bounds(Scene &scene);

} // namespace gtx
