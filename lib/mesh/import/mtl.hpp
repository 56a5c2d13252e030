/* Material libraries of OBJ models. Internal to lib/mesh. */
#pragma once

#include "mesh/import/images.hpp"

#include <map>

namespace gtx {

/* Names, numbered in the order found. */
class Names {
public:
    /* Whether it is new, with its number. */
    std::pair<uint32_t, bool> add(const std::string &name)
    {
        auto [at, fresh] = numbers_.emplace(name, uint32_t(numbers_.size()));
        return {at->second, fresh};
    }
    /* `none` where nothing has the name. */
    uint32_t find(const std::string &name, uint32_t none) const
    {
        auto at = numbers_.find(name);
        return at == numbers_.end() ? none : at->second;
    }
    size_t size() const { return numbers_.size(); }

    /* Pairs of a name and its number. */
    auto begin() const { return numbers_.begin(); }
    auto end() const { return numbers_.end(); }

private:
    std::map<std::string, uint32_t, std::less<std::string>,
             CountingAllocator<std::pair<const std::string, uint32_t>>> numbers_;
};

struct MtlLibrary {
    Names names;                      /* of the materials, as `usemtl` has them */
    Vector<Material> materials;       /* Texture::image is an index of `images` */
    Names image_names;
    Vector<EncodedImage> images;
    Vector<std::string> ignored;      /* statements, in the order found */
};

/* Adds the materials of a library beside the model; of two of one name the first stays. Colours are
 * linear, images sRGB. A library or statement that cannot be read is a warning, never an error. */
void read_mtl(const ModelFile &file, const std::string &name, MtlLibrary &library, Task &task);

} // namespace gtx
