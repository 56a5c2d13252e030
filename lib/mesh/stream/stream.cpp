/* Which stream reads a model, blocks of files, and what has to be imported whole. */
#include "mesh/material/srgb.hpp"
#include "mesh/stream/paged.hpp"

#include "base/bytes.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

namespace gtx {

/* ---- blocks ---- */

PagedFile::PagedFile(const std::string &path, Task &task) : slots_(SLOTS)
{
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error))
        fail(GTX_ERROR_READ, "cannot read the file: %s",
             error ? error.message().c_str() : "it is no regular file");
    size_ = std::filesystem::file_size(path, error);
    file_.open(path, std::ios::binary);
    if (error || !file_)
        fail(GTX_ERROR_READ, "cannot read the file: %s", std::strerror(errno));
    task.limits.read(path, size_);
}

const PagedFile::Slot &PagedFile::load(uint64_t block)
{
    Slot &slot = slots_[block % SLOTS];
    if (slot.block == block)
        return slot;
    cancel_point();
    slot.block = NONE;
    slot.size = size_t(std::min(BLOCK, size_ - block * BLOCK));
    slot.bytes.resize(BLOCK);
    file_.clear();
    file_.seekg(std::streamoff(block * BLOCK));
    if (!file_.read(&slot.bytes[0], std::streamsize(slot.size)))
        fail(GTX_ERROR_READ, "the file cannot be read at byte %llu",
             (unsigned long long)(block * BLOCK));
    slot.block = block;
    return slot;
}

void PagedFile::read_across(uint64_t at, char *to, size_t count)
{
    if (at > size_ || count > size_ - at)
        fail(GTX_ERROR_INPUT, "the file ends at byte %llu, before what it promises",
             (unsigned long long)size_);
    while (count) {
        const Slot &slot = load(at / BLOCK);
        const size_t in = size_t(at % BLOCK), part = std::min(count, slot.size - in);
        std::memcpy(to, slot.bytes.data() + in, part);
        to += part;
        at += part;
        count -= part;
    }
}

namespace {

/* ---- a list of triangles ---- */

class RawStream : public TriangleStream {
public:
    RawStream(const std::string &path, Task &task) : file_(path, task)
    {
        if (file_.size() % TRIANGLE)
            fail(GTX_ERROR_INPUT, "%llu bytes are no whole number of triangles of 36 bytes",
                 (unsigned long long)file_.size());
    }
    CornerTraits traits() const override { return {}; }
    void read(const TriangleSink &sink) override
    {
        uint8_t bytes[TRIANGLE];
        Corners3 out;
        for (uint64_t at = 0; at < file_.size(); at += TRIANGLE) {
            file_.read(at, bytes, TRIANGLE);
            for (unsigned i = 0; i < 9; ++i)
                out[i / 3].position[int(i % 3)] = double(gtx_load_f32(bytes + 4 * i));
            sink(out);
        }
    }

private:
    static constexpr size_t TRIANGLE = 36;
    PagedFile file_;
};

/* ---- what is imported whole ---- */

bool tints(const Material &m)
{
    return m.color[0] != 1 || m.color[1] != 1 || m.color[2] != 1;
}

Rgba8 tinted(const Rgba8 &color, const Material &m)
{
    return {linear_to_srgb(srgb_to_linear(color.r) * m.color[0]),
            linear_to_srgb(srgb_to_linear(color.g) * m.color[1]),
            linear_to_srgb(srgb_to_linear(color.b) * m.color[2]), color.a};
}

/* Of the corner of a mesh. */
CornerLook look_of(const Appearance &from, size_t triangle, size_t corner)
{
    CornerLook out;
    if (!from.material.empty())
        out.material = from.material[triangle];
    for (size_t set = 0; set < 2; ++set)
        if (!from.uv[set].empty())
            std::copy_n(from.uv[set][corner].data(), 2, out.uv[set]);
    if (!from.tangents.empty())
        std::copy_n(from.tangents[corner].data(), 4, out.tangent);
    return out;
}

class WholeModel : public TriangleStream {
public:
    WholeModel(const std::string &path, Task &task) : path_(path), task_(task)
    {
        const Mesh mesh = import_mesh(path_, task_);
        const auto &materials = mesh.appearance.materials;
        const bool textured = !mesh.appearance.images.empty();
        tinted_ = !textured && std::any_of(materials.begin(), materials.end(), tints);
        traits_ = {true, !mesh.normals.empty(), tinted_ || !mesh.colors.empty(), textured};
    }
    CornerTraits traits() const override { return traits_; }
    void read(const TriangleSink &sink) override
    {
        const size_t before = task_.warnings.size(); /* they were heard */
        const Mesh mesh = import_mesh(path_, task_);
        task_.warnings.resize(before);
        const Appearance &look = mesh.appearance;
        Corners3 out;
        if (traits_.textured && on_look)
            on_look(look);
        for (size_t t = 0; t < mesh.triangle_count(); ++t) {
            for (size_t k = 0; k < 3; ++k) {
                const size_t corner = 3 * t + k;
                out[k].position = mesh.position(t, int(k));
                if (traits_.normals)
                    out[k].normal = mesh.normals[corner];
                out[k].color = mesh.colors.empty() ? Rgba8() : mesh.colors[corner];
                if (tinted_)
                    out[k].color = tinted(out[k].color, look.materials[look.material[t]]);
                if (traits_.textured)
                    out[k].look = look_of(look, t, corner);
            }
            sink(out);
        }
    }

private:
    const std::string path_;
    Task &task_;
    CornerTraits traits_;
    bool tinted_ = false;
};

} // namespace

std::unique_ptr<TriangleStream> open_triangles(const std::string &path, Task &task)
{
    std::unique_ptr<TriangleStream> stream;
    for (auto open : {open_ply_stream, open_stl_stream, open_glb_stream})
        if (!stream)
            stream = open(path, task);
    return stream ? std::move(stream) : std::make_unique<WholeModel>(path, task);
}

std::unique_ptr<TriangleStream> open_raw_triangles(const std::string &path, Task &task)
{
    return std::make_unique<RawStream>(path, task);
}

} // namespace gtx
