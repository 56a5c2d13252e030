/* Writes a sculpture to cook: a closed surface of as many triangles as wanted, with normals and
 * vertex colours, as a Draco-compressed GLB. The hall and the cave are seen from inside.
 *
 *     sculpt [--shape shell|hall|cave] [--triangles N] OUT.glb
 *
 * For `-` it writes nothing but triangles to stdout, nine little-endian floats each, as many as
 * wanted without holding them: for `gtx world plan -`; and of a height grid a terrain, with relief
 * between its nodes.
 */
#include "terrain.hpp"

#include "base/output.h"

#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

using Attribute = draco::GeometryAttribute;

/* Returns the id by which glTF refers to the attribute. */
template <class T>
static uint32_t add_attribute(draco::Mesh &mesh, Attribute::Type type, draco::DataType data,
                              const std::vector<Vec> &values)
{
    constexpr bool integral = std::is_integral<T>();
    Attribute attribute;
    attribute.Init(type, nullptr, 3, data, integral, 3 * sizeof(T), 0);
    int id = mesh.AddAttribute(attribute, true, uint32_t(values.size()));
    for (uint32_t i = 0; i < values.size(); ++i) {
        T value[3];
        for (int k = 0; k < 3; ++k)
            value[k] = T(integral ? values[i][k] * 255 + 0.5 : values[i][k]);
        mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i), value);
    }
    return mesh.attribute(id)->unique_id();
}

static std::string word(size_t n) /* little-endian, whatever the machine */
{
    return {char(n), char(n >> 8), char(n >> 16), char(n >> 24)};
}

static std::string chunk(const char *type, std::string bytes, char padding)
{
    bytes.resize((bytes.size() + 3) / 4 * 4, padding);
    return word(bytes.size()) + std::string(type, 4) + bytes;
}

/* The whole file: header, JSON chunk, binary chunk with the mesh. Empty if Draco fails. */
static std::string make_glb(const Model &model)
{
    draco::Mesh mesh;
    mesh.set_num_points(uint32_t(model.positions.size()));
    for (const auto &t : model.triangles)
        mesh.AddFace({draco::PointIndex(t[0]), draco::PointIndex(t[1]), draco::PointIndex(t[2])});
    using draco::DT_FLOAT32, draco::DT_UINT8;
    uint32_t ids[] = {
        add_attribute<float>(mesh, Attribute::POSITION, DT_FLOAT32, model.positions),
        add_attribute<float>(mesh, Attribute::NORMAL, DT_FLOAT32, model.normals),
        add_attribute<uint8_t>(mesh, Attribute::COLOR, DT_UINT8, model.colors)};
    draco::Encoder encoder;
    /* one bit more whenever a larger count halves the spacing of vertices */
    int more = std::max(0, int(std::log2(model.triangles.size() / 8e5) / 2 + 0.5));
    encoder.SetAttributeQuantization(Attribute::POSITION, 14 + more);
    encoder.SetAttributeQuantization(Attribute::NORMAL, 10);
    draco::EncoderBuffer buffer;
    if (!encoder.EncodeMeshToBuffer(mesh, &buffer).ok())
        return "";

    Vec low = model.positions[0], high = low;
    for (const Vec &p : model.positions)
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    size_t size = buffer.size(), count = model.positions.size();
    char json[2048];
    std::snprintf(json, sizeof json, R"({"asset":{"version":"2.0","generator":"geotex sculpt"},
"extensionsUsed":["KHR_draco_mesh_compression"],"extensionsRequired":["KHR_draco_mesh_compression"],
"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"materials":[{"pbrMetallicRoughness":{"metallicFactor":0,"roughnessFactor":0.6}}],
"buffers":[{"byteLength":%zu}],"bufferViews":[{"buffer":0,"byteLength":%zu}],
"accessors":[{"componentType":5125,"count":%zu,"type":"SCALAR"},
{"componentType":5126,"count":%zu,"type":"VEC3","min":[%.9g,%.9g,%.9g],"max":[%.9g,%.9g,%.9g]},
{"componentType":5126,"count":%zu,"type":"VEC3"},
{"componentType":5121,"count":%zu,"type":"VEC3","normalized":true}],
"meshes":[{"primitives":[{"attributes":{"POSITION":1,"NORMAL":2,"COLOR_0":3},"indices":0,
"material":0,"extensions":{"KHR_draco_mesh_compression":{"bufferView":0,
"attributes":{"POSITION":%u,"NORMAL":%u,"COLOR_0":%u}}}}]}]})",
                  size, size, 3 * model.triangles.size(), count, low[0], low[1], low[2], high[0],
                  high[1], high[2], count, count, ids[0], ids[1], ids[2]);
    std::string chunks = chunk("JSON", json, ' ') + chunk("BIN\0", {buffer.data(), size}, '\0');
    return "glTF" + word(2) + word(12 + chunks.size()) + chunks;
}

static int write_terrain(const char *path, double wanted)
{
    gtx_height_grid grid = {};
    gtx_error error;
    if (gtx_height_grid_read(path, nullptr, &grid, &error) ||
        gtx_height_grid_to_metres(&grid, grid.origin[1] + grid.spacing[1] * grid.ny / 2, &error)) {
        std::fprintf(stderr, "sculpt: error: %s\n", error.message);
    } else if (grid.nx < 2 || grid.ny < 2) {
        std::fprintf(stderr, "sculpt: error: %s: a single row of nodes\n", path);
    } else {
        Terrain(grid).stream(wanted, write_triangle);
        gtx_height_grid_free(&grid);
        return std::fflush(stdout) ? 2 : 0;
    }
    gtx_height_grid_free(&grid);
    return 2;
}

int main(int argc, char **argv)
{
    double wanted = 800000;
    std::string shape = "shell";
    const char *grid = nullptr;
    int at = 1;
    for (; at + 2 < argc; at += 2)
        if (!std::strcmp(argv[at], "--triangles"))
            wanted = std::atof(argv[at + 1]);
        else if (!std::strcmp(argv[at], "--shape"))
            shape = argv[at + 1];
        else if (!std::strcmp(argv[at], "--terrain"))
            grid = argv[at + 1];
        else
            break;
    bool known = shape == "shell" || shape == "hall" || shape == "cave";
    const bool streams = at + 1 == argc && !std::strcmp(argv[at], "-");
    const bool writes = at + 1 == argc && argv[at][0] != '-' && wanted <= 2e7 && !grid;
    if (!known || !(streams || writes) || !(wanted >= 1000 && wanted <= 1e10)) {
        std::fprintf(stderr, "usage: sculpt [--shape shell|hall|cave] "
                             "[--triangles 1000..20000000] OUT.glb\n"
                             "       sculpt [--shape shell|hall|cave | --terrain GRID] "
                             "[--triangles N] - | gtx world plan - -o DIR\n");
        return 1;
    }
    if (grid)
        return write_terrain(grid, wanted);
    if (streams)
        return write_stream(shape, wanted);
    Model model = shape == "hall"   ? in_rock(make_rings(wanted, 1, hall_at))
                  : shape == "cave" ? in_rock(make_rings(wanted, 8, cave_at))
                                    : make_rings(wanted, 14, shell_at);
    std::string glb = make_glb(model), path = argv[argc - 1];
    if (glb.empty() || gtx_write_file(path.c_str(), glb.data(), glb.size(), nullptr)) {
        std::fprintf(stderr, "%s: cannot be written\n", path.c_str());
        return 2;
    }
    std::printf("%s: %zu triangles, %zu bytes\n", path.c_str(), model.triangles.size(), glb.size());
    return 0;
}
