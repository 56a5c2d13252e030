/* EXT_meshopt_compression: buffer views unpacked, every size checked before the decoder sees it. */
#include "mesh/import/gltf.hpp"

#include <meshoptimizer.h>

namespace gtx {

namespace {
/* A packed view. The decoder bears any bytes, but asserts what glTF promises of the sizes. */
struct Packed {
    std::string where;
    std::string_view bytes;
    size_t stride = 0, count = 0;
    std::string filter;

    const unsigned char *data() const
    {
        return reinterpret_cast<const unsigned char *>(bytes.data());
    }
    void require(bool holds, const char *what) const
    {
        if (!holds)
            fail(GTX_ERROR_INPUT, "%s: %s", where.c_str(), what);
    }
};

struct Mode {
    const char *name;
    /* What a packed byte unpacks to at most, so that no more is asked for than the bytes can be. */
    size_t most_bytes;
    int (*decode)(void *to, size_t count, size_t stride, const unsigned char *from, size_t size);
    bool (*suits)(size_t count, size_t stride);
};
} // namespace

static bool are_vertices(size_t, size_t stride)
{
    return stride > 0 && stride <= 256 && stride % 4 == 0;
}

static bool are_indices(size_t, size_t stride)
{
    return stride == 2 || stride == 4;
}

static bool are_triangles(size_t count, size_t stride)
{
    return are_indices(count, stride) && count % 3 == 0;
}

/* A vertex block spends two bits on 16 equal bytes, a triangle or an index one byte. */
static const Mode modes[] = {
    {"ATTRIBUTES", 64, meshopt_decodeVertexBuffer, are_vertices},
    {"TRIANGLES", 12, meshopt_decodeIndexBuffer, are_triangles},
    {"INDICES", 4, meshopt_decodeIndexSequence, are_indices},
};

static const struct Filter {
    const char *name;
    void (*apply)(void *data, size_t count, size_t stride);
    size_t strides[2]; /* that it takes; 0: any */
} filters[] = {
    {"OCTAHEDRAL", meshopt_decodeFilterOct, {4, 8}},
    {"QUATERNION", meshopt_decodeFilterQuat, {8, 8}},
    {"EXPONENTIAL", meshopt_decodeFilterExp, {0, 0}},
};

template <class T, size_t N>
static const T *find_named(const T (&table)[N], const std::string &name)
{
    for (const T &item : table)
        if (name == item.name)
            return &item;
    return nullptr;
}

static void apply_filter(const Packed &packed, Bytes &out)
{
    if (packed.filter.empty() || packed.filter == "NONE")
        return;
    const Filter *filter = find_named(filters, packed.filter);
    packed.require(filter, "its meshopt filter is unknown");
    packed.require(filter->strides[0] == 0 || packed.stride == filter->strides[0] ||
                       packed.stride == filter->strides[1],
                   "its meshopt filter does not suit its stride");
    filter->apply(out.data(), packed.count, packed.stride);
}

static Bytes unpack(const Packed &packed, const Mode &mode)
{
    packed.require(mode.suits(packed.count, packed.stride),
                   "its meshopt stride or count does not suit its mode");
    packed.require(packed.count <= packed.bytes.size() * mode.most_bytes / packed.stride,
                   "its meshopt data is too short for its count");
    Bytes out(packed.count * packed.stride, 0);
    if (!out.empty())
        packed.require(mode.decode(out.data(), packed.count, packed.stride, packed.data(),
                                   packed.bytes.size()) == 0,
                       "its meshopt data is damaged");
    if (mode.decode == meshopt_decodeVertexBuffer)
        apply_filter(packed, out);
    return out;
}

void unpack_gltf_views(GltfDocument &doc, Task &task)
{
    for (size_t i = 0; i < doc.model.bufferViews.size(); ++i) {
        const tinygltf::BufferView &view = doc.model.bufferViews[i];
        auto found = view.extensions.find("EXT_meshopt_compression");
        if (found == view.extensions.end())
            continue;
        const tinygltf::Value &extension = found->second;
        auto number = [&](const char *name) {
            return extension.Has(name) ? size_t(extension.Get(name).GetNumberAsInt()) : 0;
        };
        auto text = [&](const char *name) {
            return extension.Has(name) ? extension.Get(name).Get<std::string>() : std::string();
        };
        Packed packed = {"buffer view " + std::to_string(i), {}, number("byteStride"),
                         number("count"), text("filter")};
        const Mode *mode = find_named(modes, text("mode"));
        packed.require(mode, "its meshopt mode is unknown");
        packed.require(number("buffer") < doc.buffers.size(), "its meshopt buffer is not there");
        std::string_view buffer = doc.buffers[number("buffer")].view();
        packed.require(number("byteOffset") <= buffer.size() &&
                           number("byteLength") <= buffer.size() - number("byteOffset"),
                       "its meshopt data lies outside its buffer");
        packed.bytes = buffer.substr(number("byteOffset"), number("byteLength"));
        packed.require(packed.count * packed.stride == view.byteLength &&
                           (!view.byteStride || view.byteStride == packed.stride),
                       "its meshopt count and stride are not those of the view");
        doc.views.resize(doc.model.bufferViews.size());
        doc.views[i] = unpack(packed, *mode);
        task.advance(0.15);
    }
}

} // namespace gtx
