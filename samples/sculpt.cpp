/* A sculpture to cook: a spined, ribbed sea shell grown by formula, written as a Draco-compressed
 * GLB. Its one lesson: what a high-resolution model needs to come in, and how to write one.
 *
 *     sculpt [--triangles N] OUT.glb
 */
#include <draco/compression/encode.h>
#include <draco/mesh/mesh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

using Vec = std::array<float, 3>;
constexpr double PI = 3.14159265358979323846;

static double mix(double a, double b, double t) { return a + (b - a) * t; }
static double smooth(double t) { t = std::min(1., std::max(0., t)); return t * t * (3 - 2 * t); }
static Vec mix(const Vec &a, const Vec &b, double t)
{
    return {float(mix(a[0], b[0], t)), float(mix(a[1], b[1], t)), float(mix(a[2], b[2], t))};
}

/* Value noise in -1..1: hashed lattice points, smoothly interpolated. */
static double noise(double x, double y, double z)
{
    double cell[] = {std::floor(x), std::floor(y), std::floor(z)};
    double t[] = {smooth(x - cell[0]), smooth(y - cell[1]), smooth(z - cell[2])}, sum = 0;
    for (int i = 0; i < 8; ++i) {
        uint32_t h = 0x9e3779b9u;
        double weight = 1;
        for (int k = 0; k < 3; ++k) {
            int bit = i >> k & 1;
            h = (h ^ uint32_t(int32_t(cell[k]) + bit)) * 0x85ebca6bu;
            h ^= h >> 15;
            weight *= bit ? t[k] : 1 - t[k];
        }
        sum += weight * (h * 0xc2b2ae35u >> 8) / 8388607.5;
    }
    return sum - 1;
}

/* A bump around zero, as one turn repeats it. */
static double peak(double v) { return std::pow(std::max(0., std::cos(v)), 40); }

/* The shell is a tube around a logarithmic spiral: turned by `angle` (0 at the mouth, negative
 * towards the apex), everything is `growth` times as large. The first 80 % of `s` run outside from
 * the apex to the lip, the rest goes round the lip and back inside: one sheet, closed at two poles.
 * `v` runs around the tube. */
static Vec shell(double s, double v, Vec &color)
{
    const double per_turn = 2.25, rate = std::log(per_turn) / (2 * PI), turns = 4.2;
    const double wall = 0.13, lip = 0.8, inside = 0.83;
    double angle = 0, radius = 1, relief = 0, rib = 0, lean = 0;
    if (s < lip) {
        double first = std::pow(per_turn, -turns / 2);
        angle = 2 * std::log(mix(first, 1, s / lip)) / rate;
    } else if (s >= inside) {
        angle = -1.9 * (s - inside) / (1 - inside);
    }
    double flare = (0.28 + 0.06 * std::cos(8 * v - 3)) * std::exp(angle / 0.3);
    double x = std::cos(v), y = std::sin(v);
    double grain = noise(angle * 9, x * 4, y * 4), fine = noise(angle * 40, x * 16, y * 16);
    if (s < lip) {
        double at = angle * 10 / (2 * PI) + 0.06 * grain, from_rib = at - std::round(at);
        double spine = peak(v - 0.5) + 0.4 * peak(v + 0.35) + 0.25 * peak(v + 1.1);
        rib = std::exp(-from_rib * from_rib / 0.01);
        double crest = 0.09 + 0.02 * std::sin(9 * v + at) + 0.7 * spine;
        double thread = 1 - std::fabs(std::sin(21 * v + 0.5 * grain));
        double line = std::sin(angle * 90 + 2.5 * grain);
        double ease = 1 - std::exp(angle / 0.05);
        relief = ease * (crest * rib + (1 - rib) * (0.03 * thread * thread + 0.006 * line) +
                         0.006 * fine + 0.012 * grain);
        lean = ease * crest * rib * (0.25 + 0.5 * crest * rib);
        double cap = std::min(1., s / lip / 0.006);
        radius = (1 + flare + relief) * std::sqrt(1 - (1 - cap) * (1 - cap));
    } else if (s < inside) {
        double turn = PI * (s - lip) / (inside - lip);
        radius = 1 + flare - wall / 2 * (1 - std::cos(turn));
        lean = wall / 2 * std::sin(turn);
    } else {
        double left = std::min(1., (1 - s) / (1 - inside) / 0.25);
        radius = (1 + flare - wall) * std::sqrt(1 - (1 - left) * (1 - left));
    }
    const Vec ivory = {.94f, .87f, .76f}, clay = {.78f, .47f, .30f}, umber = {.33f, .17f, .11f},
              rose = {.90f, .60f, .48f};
    double band = smooth(0.5 + 0.9 * std::sin(3 * v + 0.6) + 0.5 * grain);
    Vec ground = mix(umber, mix(clay, ivory, 0.75 * band), smooth(0.3 + 30 * relief));
    color = s < lip ? mix(mix(ground, ivory, rib), clay, 0.8 * smooth(3 * (relief - 0.25)))
                    : mix(rose, ivory, std::exp(angle / 0.15));

    const double tube = 0.5, height = 1.5;
    double growth = std::pow(per_turn, angle / (2 * PI));
    angle += tube * lean / 0.85;
    double out = growth * (0.85 + tube * radius * x);
    return {float(out * std::cos(angle)), float(growth * (tube * radius * y * 1.1 - height)),
            float(out * std::sin(angle))};
}

struct Grid {
    std::vector<Vec> positions, normals, colors;
    std::vector<std::array<uint32_t, 3>> triangles;
};

/* Rings of vertices between two poles; vertices are shared, so nothing needs welding. */
static Grid tessellate(uint32_t rings, uint32_t columns)
{
    Grid grid;
    auto add = [&](double s, double v) {
        Vec color;
        grid.positions.push_back(shell(s, v, color));
        for (float &c : color) /* glTF colours are linear */
            c = float(std::pow(c, 2.2));
        grid.colors.push_back(color);
    };
    add(0, 0);
    for (uint32_t r = 0; r < rings; ++r)
        for (uint32_t c = 0; c < columns; ++c)
            add((r + 1.) / (rings + 1.), 2 * PI * c / columns);
    add(1, 0);
    uint32_t last = uint32_t(grid.positions.size() - 1);
    for (uint32_t r = 0; r <= rings; ++r)
        for (uint32_t c = 0; c < columns; ++c) {
            uint32_t next = (c + 1) % columns, above = 1 + r * columns, below = above - columns;
            if (r > 0)
                grid.triangles.push_back({below + c, below + next, r < rings ? above + c : last});
            if (r < rings)
                grid.triangles.push_back({above + c, r > 0 ? below + next : 0, above + next});
        }
    grid.normals.assign(grid.positions.size(), Vec{0, 0, 0});
    for (const auto &t : grid.triangles) {
        const Vec &p = grid.positions[t[0]], &q = grid.positions[t[1]], &r = grid.positions[t[2]];
        for (int k = 0; k < 3; ++k) {
            int i = (k + 1) % 3, j = (k + 2) % 3;
            float n = (q[i] - p[i]) * (r[j] - p[j]) - (q[j] - p[j]) * (r[i] - p[i]);
            for (uint32_t v : t)
                grid.normals[v][k] += n;
        }
    }
    for (Vec &n : grid.normals) {
        float length = std::hypot(n[0], n[1], n[2]);
        for (float &x : n)
            x = length > 0 ? x / length : 0;
    }
    return grid;
}

/* One value of T a vertex and component; returns the id that glTF refers to. */
template <class T>
static uint32_t add_attribute(draco::Mesh &mesh, draco::GeometryAttribute::Type type,
                              draco::DataType data_type, const std::vector<Vec> &values, float scale)
{
    draco::GeometryAttribute attribute;
    attribute.Init(type, nullptr, 3, data_type, scale != 1, 3 * sizeof(T), 0);
    int id = mesh.AddAttribute(attribute, true, uint32_t(values.size()));
    for (uint32_t i = 0; i < values.size(); ++i) {
        T value[3];
        for (int k = 0; k < 3; ++k)
            value[k] = T(values[i][k] * scale + (scale != 1 ? 0.5f : 0));
        mesh.attribute(id)->SetAttributeValue(draco::AttributeValueIndex(i), value);
    }
    return mesh.attribute(id)->unique_id();
}

/* The whole file: header, JSON chunk, binary chunk with the compressed mesh. */
static std::string make_glb(const Grid &grid)
{
    draco::Mesh mesh;
    mesh.set_num_points(uint32_t(grid.positions.size()));
    mesh.SetNumFaces(grid.triangles.size());
    for (uint32_t t = 0; t < grid.triangles.size(); ++t) {
        const auto &v = grid.triangles[t];
        mesh.SetFace(draco::FaceIndex(t), {draco::PointIndex(v[0]), draco::PointIndex(v[1]),
                                           draco::PointIndex(v[2])});
    }
    using Attribute = draco::GeometryAttribute;
    uint32_t position = add_attribute<float>(mesh, Attribute::POSITION, draco::DT_FLOAT32,
                                             grid.positions, 1);
    uint32_t normal = add_attribute<float>(mesh, Attribute::NORMAL, draco::DT_FLOAT32,
                                           grid.normals, 1);
    uint32_t color = add_attribute<uint8_t>(mesh, Attribute::COLOR, draco::DT_UINT8, grid.colors, 255);

    draco::Encoder encoder;
    encoder.SetAttributeQuantization(Attribute::POSITION, 14);
    encoder.SetAttributeQuantization(Attribute::NORMAL, 10);
    encoder.SetSpeedOptions(5, 5);
    draco::EncoderBuffer buffer;
    if (!encoder.EncodeMeshToBuffer(mesh, &buffer).ok())
        return "";

    Vec low = grid.positions[0], high = low;
    for (const Vec &p : grid.positions)
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    char json[2048];
    std::snprintf(json, sizeof json, R"({"asset":{"version":"2.0","generator":"geotex sculpt"},
"extensionsUsed":["KHR_draco_mesh_compression"],"extensionsRequired":["KHR_draco_mesh_compression"],
"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"name":"shell"}],
"materials":[{"pbrMetallicRoughness":{"metallicFactor":0,"roughnessFactor":0.6}}],
"buffers":[{"byteLength":%zu}],"bufferViews":[{"buffer":0,"byteLength":%zu}],
"accessors":[
{"componentType":5125,"count":%zu,"type":"SCALAR"},
{"componentType":5126,"count":%zu,"type":"VEC3","min":[%.9g,%.9g,%.9g],"max":[%.9g,%.9g,%.9g]},
{"componentType":5126,"count":%zu,"type":"VEC3"},
{"componentType":5121,"count":%zu,"type":"VEC3","normalized":true}],
"meshes":[{"primitives":[{"attributes":{"POSITION":1,"NORMAL":2,"COLOR_0":3},"indices":0,"material":0,
"extensions":{"KHR_draco_mesh_compression":{"bufferView":0,
"attributes":{"POSITION":%u,"NORMAL":%u,"COLOR_0":%u}}}}]}]})",
                  buffer.size(), buffer.size(), 3 * grid.triangles.size(), grid.positions.size(),
                  low[0], low[1], low[2], high[0], high[1], high[2], grid.positions.size(),
                  grid.positions.size(), position, normal, color);

    auto word = [](size_t n) { /* little-endian, whatever the machine */
        return std::string{char(n), char(n >> 8), char(n >> 16), char(n >> 24)};
    };
    auto chunk = [&](const char *type, std::string bytes, char padding) {
        bytes.resize((bytes.size() + 3) / 4 * 4, padding);
        return word(bytes.size()) + std::string(type, 4) + bytes;
    };
    std::string chunks = chunk("JSON", json, ' ') +
                         chunk("BIN\0", std::string(buffer.data(), buffer.size()), '\0');
    return "glTF" + word(2) + word(12 + chunks.size()) + chunks;
}

int main(int argc, char **argv)
{
    double wanted = 800000;
    if (argc == 4 && !std::strcmp(argv[1], "--triangles"))
        wanted = std::atof(argv[2]);
    if ((argc != 2 && argc != 4) || !(wanted >= 1000 && wanted <= 2e7)) {
        std::fprintf(stderr, "usage: sculpt [--triangles 1000..20000000] OUT.glb\n");
        return 1;
    }
    uint32_t columns = uint32_t(std::sqrt(wanted / 14)), rings = uint32_t(wanted / 2 / columns);
    Grid grid = tessellate(rings, columns);
    std::string glb = make_glb(grid), path = argv[argc - 1], temporary = path + ".tmp";

    std::FILE *file = std::fopen(temporary.c_str(), "wb");
    bool written = file && !glb.empty() && std::fwrite(glb.data(), 1, glb.size(), file) == glb.size();
    written = file && !std::fclose(file) && written;
    if (!written || std::rename(temporary.c_str(), path.c_str())) {
        std::remove(temporary.c_str());
        std::fprintf(stderr, "%s: cannot be written\n", path.c_str());
        return 2;
    }
    std::printf("%s: %zu triangles, %zu bytes\n", path.c_str(), grid.triangles.size(), glb.size());
    return 0;
}
