/* Models in pieces: a stream gives the triangles, corner by corner, and the looks that importing
 * the whole gives. */
#include "fuzz/fuzz.hpp"

#include "mesh/stream/paged.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace fuzz {

static bool expected(gtx_result result)
{
    return result == GTX_ERROR_INPUT || result == GTX_ERROR_EMPTY || result == GTX_ERROR_LIMIT ||
           result == GTX_ERROR_UNSUPPORTED || result == GTX_ERROR_READ ||
           result == GTX_ERROR_MEMORY;
}

/* What a stream gave. */
struct Pieces {
    gtx::CornerTraits traits;
    gtx::Vector<gtx::Corners3> triangles;
    gtx::Vector<gtx::Material> materials;
    size_t images = 0;
};

static void take_look(const gtx::Appearance &look, Pieces &to)
{
    for (const gtx::Image &image : look.images) {
        REQUIRE(!image.levels.empty(), "an image without levels");
        for (const gtx::Image::Level &level : image.levels)
            REQUIRE(level.width && level.height &&
                        level.texels.size() == size_t(level.width) * level.height,
                    "an image of %u x %u has %zu texels", level.width, level.height,
                    level.texels.size());
    }
    to.images += look.images.size();
    to.materials.insert(to.materials.end(), look.materials.begin(), look.materials.end());
}

static void check_looks(const Pieces &p)
{
    for (const gtx::Material &m : p.materials)
        for (gtx::Texture gtx::Material::*map : gtx::MATERIAL_TEXTURES)
            REQUIRE(!(m.*map).used() || ((m.*map).image < p.images && (m.*map).set < 2),
                    "image %u of %zu", (m.*map).image, p.images);
    for (const gtx::Corners3 &triangle : p.triangles)
        for (const gtx::Corner &c : triangle)
            REQUIRE(!p.traits.textured || c.look.material < p.materials.size(),
                    "material %u of %zu", c.look.material, p.materials.size());
}

/* Null where the bytes are to be imported whole. */
static bool read_pieces(const std::string &path, gtx::Task &task, Pieces &out)
{
    std::unique_ptr<gtx::TriangleStream> stream;
    for (auto open : {gtx::open_ply_stream, gtx::open_stl_stream, gtx::open_glb_stream})
        if (!stream)
            stream = open(path, task);
    if (!stream)
        return false;
    out.traits = stream->traits();
    stream->on_look = [&](const gtx::Appearance &look) { take_look(look, out); };
    stream->read([&](const gtx::Corners3 &c) {
        REQUIRE(out.triangles.size() < (1 << 20), "more triangles than the limits let pass");
        out.triangles.push_back(c);
    });
    check_looks(out);
    return true;
}

static bool same(double a, double b)
{
    return a == b || (std::isnan(a) && std::isnan(b));
}

static void compare(const Pieces &p, const gtx::Mesh &mesh)
{
    const gtx::Appearance &look = mesh.appearance;
    REQUIRE(p.triangles.size() == mesh.triangles.size(), "%zu triangles for %zu",
            p.triangles.size(), mesh.triangles.size());
    for (size_t c = 0; c < 3 * p.triangles.size(); ++c) {
        const gtx::Corner &corner = p.triangles[c / 3][c % 3];
        const gtx::Vec3d at = mesh.position(c / 3, int(c % 3));
        for (int k = 0; k < 3; ++k) {
            REQUIRE(same(corner.position[k], at[k]), "corner %zu lies elsewhere", c);
            REQUIRE(mesh.normals.empty() ||
                        same(double(corner.normal[k]), double(mesh.normals[c][k])),
                    "corner %zu has another normal", c);
        }
        for (size_t i = 0; i < 4 && p.traits.textured; ++i)
            REQUIRE(look.uv[i / 2].empty() || same(double(corner.look.uv[i / 2][i % 2]),
                                                   double(look.uv[i / 2][c][i % 2])),
                    "corner %zu looks elsewhere", c);
    }
    /* Read in pieces, an image may end in the chunk's padding, beyond the buffer. */
    REQUIRE(!p.traits.textured || look.images.size() <= p.images, "%zu images for %zu", p.images,
            look.images.size());
}

void run_pieces(const uint8_t *data, size_t size)
{
    static const char *const names[] = {"p.ply", "p.glb", "p.stl"};
    const std::string head(reinterpret_cast<const char *>(data), std::min<size_t>(size, 4));
    const char *const name = names[head == "glTF" ? 1 : head.compare(0, 3, "ply") ? 2 : 0];
    gtx::Task task(1, nullptr, nullptr, {}, {}, small_limits());
    Pieces pieces;
    bool whole = false;
    write_scratch(name, data, size);
    try {
        if (!read_pieces(scratch(name), task, pieces))
            return;
        whole = true;
        const gtx::Mesh mesh = gtx::import_mesh(scratch(name), task);
        compare(pieces, mesh);
    } catch (const gtx::Error &e) {
        REQUIRE(expected(e.result) && e.message.size() > 8, "%s: %d %s",
                whole ? "whole" : "in pieces", e.result, e.message.c_str());
    }
}

} // namespace fuzz
