/* The models of one call: read once, identified by a hash, and imported as one mesh. */
#pragma once

#include "mesh/mesh.hpp"

#include <geotex/cook.h>

#include <functional>

namespace gtx {

/* A model file, or the bytes of one. */
struct ModelInput {
    const char *path;
    const void *data = nullptr; /* null: the file is read */
    size_t size = 0;
    std::function<Mesh()> make = nullptr; /* or what makes a mesh, of this hash */
    uint64_t hash = 0;
};

struct Models {
    Vector<ModelFile> files;
    Mesh made;                  /* where it was given as such */
    Mesh grids;                 /* height grids, which no `z_up` turns */
    /* Every file behind them that is there: the models, then what they refer to. */
    Vector<std::string> sources;
    /* Of the content of all of them, not of their paths. */
    uint64_t hash = 0;
    /* Whether importing read nothing else; known after it. */
    bool foreseen = true;
};

inline std::string text_of(const char *text) { return text ? text : ""; }

/* `more` holds further files. */
Models read_models(const ModelInput &first, const char *const *more, uint32_t more_count,
                   const TextureFiles &textures, Task &task);

/* What values of height grids, and where they lie, are taken for. */
struct GridSense {
    bool local_metres = false;   /* degrees become metres, true at the first one's middle */
    bool depths = false;         /* values are depths, positive downwards */
};

/* The same, and height grids among them: each a surface through its nodes. */
Models read_sources(const char *first, const char *const *more, uint32_t more_count,
                    const TextureFiles &textures, const GridSense &sense, Task &task);

/* One after another into one mesh; gives back the files' memory. With `z_up` the models' +Z becomes
 * +Y, and their +Y -Z. */
Mesh import_models(Models &models, bool z_up, Task &task);

/* What a mesh counts as where limits go by the bytes that were read: of texels of images, as many
 * as a compressed image takes. */
size_t bytes_of(const Mesh &mesh);

/* As gtx_cook_memory, of a mesh as importers make one: `make` is called once, and the cook counts
 * its memory. `hash` stands for its content; `file` gets the bytes of the asset. */
gtx_result cook_made_mesh(const std::function<Mesh()> &make, uint64_t hash,
                          const gtx_cook_desc &desc, gtx_asset **out, std::string *file,
                          gtx_report *report, gtx_error *error);

} // namespace gtx
