/* The triangles and images of a GLB that is read in pieces. */
#include "mesh/stream/glb.hpp"

#include "mesh/material/srgb.hpp"

#include <algorithm>
#include <filesystem>

namespace gtx {

EncodedImage GlbStream::encoded(const Picture &picture)
{
    if (!picture.size) {
        const ModelFile file = {path_, {}, nullptr};
        return gltf_image(images_, picture.image, file, task_);
    }
    EncodedImage out;
    out.name = "image " + std::to_string(picture.image.number);
    out.glossiness = picture.image.glossiness;
    out.bytes.resize(size_t(picture.size));
    file_.read(picture.first, &out.bytes[0], out.bytes.size());
    return out;
}

void GlbStream::give_look()
{
    Appearance look = look_;
    stream_images(pictures_.size(), [&](size_t i) { return encoded(pictures_[i]); },
                  [&](Image image) {
                      Appearance one;
                      one.images.push_back(std::move(image));
                      on_look(one);
                  }, look, task_);
    on_look(look);
}

void GlbStream::values(const Values &from, uint64_t item, double *out)
{
    uint8_t bytes[16];
    const unsigned size = gltf_component_size(from.type);
    file_.read(from.first + item * from.stride, bytes, size * from.components);
    for (unsigned k = 0; k < from.components; ++k)
        out[k] = gltf_component(bytes + k * size, from.type) / from.full;
}

Corner GlbStream::corner(const Part &part, uint64_t vertex)
{
    Corner out;
    double v[4];
    values(part.position, vertex, v);
    out.position = part.turn.transform.point({v[0], v[1], v[2]});
    if (part.normal.components) {
        values(part.normal, vertex, v);
        out.normal = part.turn.normal(Vec3f(float(v[0]), float(v[1]), float(v[2])));
    }
    double light[4] = {1, 1, 1, 1};
    if (part.color.components)
        values(part.color, vertex, light);
    if (traits_.colors)
        out.color = {linear_to_srgb(float(light[0] * part.factor[0])),
                     linear_to_srgb(float(light[1] * part.factor[1])),
                     linear_to_srgb(float(light[2] * part.factor[2])),
                     to_byte(light[3] * part.factor[3])};
    if (!traits_.textured)
        return out;
    out.look.material = part.material;
    for (int k = 0; k < 2; ++k)
        if (part.uv[k].components) {
            values(part.uv[k], vertex, v);
            std::copy_n(v, 2, out.look.uv[k]);
        }
    if (part.tangent.components) {
        values(part.tangent, vertex, v);
        const std::array<float, 4> t = {float(v[0]), float(v[1]), float(v[2]), float(v[3])};
        std::copy_n(part.turn.tangent(t).data(), 4, out.look.tangent);
    }
    return out;
}

void GlbStream::read_part(const Part &part, const TriangleSink &sink)
{
    for (uint64_t t = 0; t < part.triangles(); ++t) {
        uint64_t vertex[3] = {3 * t, 3 * t + 1, 3 * t + 2};
        for (uint64_t &v : vertex) {
            double index = 0;
            if (part.indexed) {
                values(part.index, v, &index);
                v = index >= 0 ? uint64_t(index) : UINT64_MAX;
            }
            if (v >= part.position.count)
                fail(GTX_ERROR_INPUT, "triangle %llu: vertex %llu of %llu", (unsigned long long)t,
                     (unsigned long long)v, (unsigned long long)part.position.count);
        }
        if (part.turn.mirrors)
            std::swap(vertex[1], vertex[2]);
        sink({corner(part, vertex[0]), corner(part, vertex[1]), corner(part, vertex[2])});
        if (t % 0x8000 == 0)
            task_.advance(double(t) / double(part.triangles()));
    }
}

std::unique_ptr<TriangleStream> open_glb_stream(const std::string &path, Task &task)
{
    std::ifstream file(path, std::ios::binary);
    char magic[4] = {};
    file.read(magic, sizeof magic);
    if (std::string_view(magic, sizeof magic) != "glTF")
        return nullptr;
    const size_t before = task.warnings.size();
    auto stream = std::make_unique<GlbStream>(path, task);
    if (stream->suits())
        return stream;
    task.warnings.resize(before); /* the importer says them again */
    return nullptr;
}

} // namespace gtx
