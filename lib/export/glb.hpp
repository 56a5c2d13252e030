/* Writing GLB: arrays and images in one buffer, and the JSON that says what they are. */
#pragma once

#include "cook/report.hpp"

#include <string_view>

namespace gtx {

/* Numbers of glTF 2.0. */
enum GltfType : unsigned {
    GLTF_SHORT = 5122,
    GLTF_USHORT = 5123,
    GLTF_UINT = 5125,
    GLTF_FLOAT = 5126
};
enum GltfTarget : unsigned { GLTF_NO_TARGET = 0, GLTF_VERTICES = 34962, GLTF_INDICES = 34963 };

class GlbBuffer {
public:
    /* With `meshopt` views of vertices and of indices, of 32 bits, are compressed
     * (EXT_meshopt_compression). */
    explicit GlbBuffer(bool meshopt = false) : meshopt_(meshopt) {}

    /* The number of a new buffer view that starts at a multiple of `alignment`. */
    unsigned add_view(std::string_view bytes, GltfTarget target, size_t stride = 0,
                      size_t alignment = 4);

    static constexpr unsigned NO_VIEW = 0xffffffffu;
    struct Accessor {
        unsigned view;               /* or NO_VIEW: a Draco stream has the values */
        size_t offset;               /* in the view */
        GltfType type;
        size_t count;
        const char *shape;           /* "VEC3", ... */
        bool bounded = false;        /* of positions: */
        Vec3f low = {}, high = {};
        bool normalized = false;     /* whole numbers that stand for -1 or 0 to 1 */
    };
    unsigned add_accessor(const Accessor &accessor);
    size_t size() const { return bytes_.size(); }

    /* The members accessors, bufferViews and buffers of the root. */
    void describe(Json &out) const;
    /* The file. Throws Error(LIMIT) beyond 4 GiB; gives back the buffer's memory. */
    Bytes file(const Json &json);

private:
    struct View {
        size_t offset, length, stride;
        GltfTarget target;
        size_t unpacked = 0, count = 0; /* bytes and items of one that is compressed */
    };
    void pack(View &view, std::string_view bytes);
    void describe_views(Json &out) const;
    void describe_buffers(Json &out) const;
    bool meshopt_;
    Bytes bytes_;
    Vector<View> views_;
    Vector<Accessor> accessors_;
};

} // namespace gtx
