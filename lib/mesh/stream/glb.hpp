/* GLB in pieces, where its accessors are plain: arrays in the file's own binary chunk. Images lie
 * there or in files beside it, and are decoded one after another. Internal to lib/mesh. */
#pragma once

#include "mesh/import/gltf.hpp"
#include "mesh/stream/paged.hpp"

namespace gtx {

/* An accessor whose values lie in the file, checked to lie inside the chunk. */
struct Values {
    uint64_t first = 0, count = 0, stride = 0;
    unsigned components = 0;     /* 0: there is none */
    int type = 0;
    double full = 1;
};

/* A primitive in one of the places where its mesh stands. */
struct Part {
    Values position, normal, color, index, uv[2], tangent;
    bool indexed = false;
    uint32_t material = CornerLook::NO_MATERIAL;
    float factor[4] = {1, 1, 1, 1};
    Turn turn{Affine()};

    uint64_t triangles() const { return (indexed ? index.count : position.count) / 3; }
};

/* An image of a texture: bytes of the file, or none where it is a file of its own. */
struct Picture {
    GltfImage image;
    uint64_t first = 0, size = 0;
};

class GlbStream : public TriangleStream {
public:
    GlbStream(const std::string &path, Task &task) : path_(path), file_(path, task), task_(task) {}
    /* Whether all of it can be read in pieces. */
    bool suits();
    CornerTraits traits() const override { return traits_; }
    void read(const TriangleSink &sink) override
    {
        if (traits_.textured && on_look)
            give_look();
        for (const Part &part : parts_)
            read_part(part, sink);
    }

private:
    bool find_chunks(Bytes &json);
    bool find_values(const tinygltf::Model &model, int accessor, Values &out);
    bool find_look(const GltfDocument &doc, const tinygltf::Primitive &from, Part &out);
    bool find_part(const GltfDocument &doc, const tinygltf::Primitive &from, Part &out);
    bool find_parts(const GltfDocument &doc);
    bool find_pictures(const GltfDocument &doc);
    EncodedImage encoded(const Picture &picture);
    void give_look();
    void values(const Values &from, uint64_t item, double *out);
    Corner corner(const Part &part, uint64_t vertex);
    void read_part(const Part &part, const TriangleSink &sink);

    const std::string path_;
    PagedFile file_;
    Task &task_;
    GltfDocument images_;        /* of which only the names of images are left */
    Vector<Picture> pictures_;
    Appearance look_;            /* materials, whose textures are numbers of pictures */
    uint64_t binary_ = 0, binary_size_ = 0;
    CornerTraits traits_;
    Vector<Part> parts_;
};

} // namespace gtx
