/* The materials of a glTF document and the images behind them. Internal to lib/mesh. */
#pragma once

#include "mesh/import/images.hpp"

#include <nlohmann/json_fwd.hpp>
#include <set>

namespace gtx {

struct GltfMaterial {
    /* Texture::image is an index of GltfMaterials::images, Texture::set one of `sets`. */
    Material look;
    Vector<int> sets;      /* the n of TEXCOORD_n, two at most */
    bool two_sided = false;
    std::set<Warning> warnings; /* what will not be seen of it */
};

/* Where an image is; of one read in two ways there are two. */
struct GltfImage {
    int number; /* in the document */
    float glossiness = -1; /* as in EncodedImage */
    bool operator==(const GltfImage &o) const
    {
        return number == o.number && glossiness == o.glossiness;
    }
};

struct GltfMaterials {
    Vector<GltfMaterial> materials;
    Vector<GltfImage> images;
};

/* Reads materials, textures and samplers of a checked document. Throws Error: INPUT. */
GltfMaterials read_gltf_materials(const nlohmann::json &root);

} // namespace gtx
