/* Models of any size as a stream of triangles, read in pieces: for what does not fit in memory. */
#pragma once

#include "mesh/mesh.hpp"

#include <functional>
#include <memory>

namespace gtx {

/* How a corner looks into textures; a triangle's corners have one material. */
struct CornerLook {
    static constexpr uint32_t NO_MATERIAL = 0xffffffffu;
    float uv[2][2] = {{0, 0}, {0, 0}};
    float tangent[4] = {0, 0, 0, 0};
    uint32_t material = NO_MATERIAL;
    static constexpr unsigned BYTES = 36;
};

/* A corner of a triangle that shares nothing with others. */
struct Corner {
    Vec3d position;
    Vec3f normal;
    Rgba8 color;
    CornerLook look = {};
};
using Corners3 = std::array<Corner, 3>;
using TriangleSink = std::function<void(const Corners3 &)>;
/* Images, and materials that name those that came since the last materials. */
using LookSink = std::function<void(const Appearance &)>;

/* What the corners of a stream have. */
struct CornerTraits {
    bool doubles = false;        /* positions that floats cannot hold */
    bool normals = false, colors = false;
    bool textured = false;

    unsigned bytes() const
    {
        return (doubles ? 24 : 12) + (normals ? 12 : 0) + (colors ? 4 : 0) +
               (textured ? CornerLook::BYTES : 0);
    }
    void add(const CornerTraits &o)
    {
        doubles |= o.doubles;
        normals |= o.normals;
        colors |= o.colors;
        textured |= o.textured;
    }
};

class TriangleStream {
public:
    virtual ~TriangleStream() = default;
    virtual CornerTraits traits() const = 0;
    /* Gives every triangle to `sink`, in the order of the file, again at each call. Positions may
     * be anything, even NaN. Throws Error: READ, INPUT, LIMIT, MEMORY, CANCELLED. */
    virtual void read(const TriangleSink &sink) = 0;
    /* Is called by read() before its triangles, where these are textured. */
    LookSink on_look;
};

/* A model file: binary PLY, binary STL, and GLB whose accessors are plain are read in pieces, of
 * which at most 64 MiB are in memory, and an image; any other model is imported whole,
 * within the task's limits. Of materials without textures the vertex colours are kept. The stream
 * keeps `task`. Throws Error: as import_model. */
std::unique_ptr<TriangleStream> open_triangles(const std::string &path, Task &task);

/* Nothing but triangles: nine little-endian floats each.
 * Throws Error: READ; INPUT where the file ends inside a triangle. */
std::unique_ptr<TriangleStream> open_raw_triangles(const std::string &path, Task &task);

} // namespace gtx
