/* Material libraries of OBJ models. Internal to lib/mesh. */
#pragma once

#include "mesh/import/images.hpp"

#include <string_view>

namespace gtx {

/* What `usemtl` may name. */
struct MtlMaterial {
    std::string name;
    Material look; /* Texture::image is an index of MtlLibrary::images */
};

struct MtlLibrary {
    Vector<MtlMaterial> materials;
    Vector<EncodedImage> images;
    Vector<std::string> image_names;
    Vector<std::string> ignored;      /* statements, in the order found */
};

/* Adds the materials of a library beside the model; of two of one name the first stays. Colours are
 * linear, images sRGB. A library or statement that cannot be read is a warning, never an error. */
void read_mtl(const ModelFile &file, const std::string &name, MtlLibrary &library, Task &task);

} // namespace gtx
