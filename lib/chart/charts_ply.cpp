/* The partition as a coloured PLY (paper, Figure 5). */
#include "chart/frame.hpp"

#include "base/output.h"

#include <algorithm>
#include <cstring>

namespace gtx {

namespace {

/* Hues a golden ratio apart, clear of green, which marks inverted triangles. */
Rgba8 chart_color(uint32_t chart)
{
    double turn = std::fmod(chart * 0.6180339887, 1.) * 0.7;
    double hue = 6 * (turn < 0.2 ? turn : turn + 0.3), light = 1 - 0.2 * (chart % 3);
    double pale = 0.5 * (chart % 2);
    auto channel = [=](double at) {
        double away = std::abs(std::fmod(hue - at + 9, 6.) - 3);
        double pure = std::clamp(2 - away, 0., 1.);
        return uint8_t(255 * light * (pale + (1 - pale) * pure));
    };
    return {channel(0), channel(2), channel(4), 255};
}

/* Triangles that face away from the median normal of their initial chart. */
Vector<bool> initially_inverted(const Mesh &mesh, const Partition &partition)
{
    Vector<Vector<uint32_t>> charts(partition.report.initial_charts);
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t)
        charts[partition.initial_chart[t]].push_back(t);
    Vector<bool> out(mesh.triangle_count());
    for (const Vector<uint32_t> &chart : charts) {
        Vec3d z = median_axis(mesh, chart);
        for (uint32_t t : chart)
            out[t] = dot(mesh.area_vector(t), z) <= 0;
    }
    return out;
}

/* Numbers are in the machine's byte order, which the header names. */
bool little_endian()
{
    uint16_t one = 1;
    uint8_t first;
    std::memcpy(&first, &one, 1);
    return first == 1;
}

std::string header(const Mesh &mesh)
{
    return std::string("ply\nformat binary_") + (little_endian() ? "little" : "big") +
           "_endian 1.0\nelement vertex " + std::to_string(mesh.positions.size()) +
           "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
           std::to_string(mesh.triangle_count()) +
           "\nproperty list uchar int vertex_indices\nproperty uchar red\n"
           "property uchar green\nproperty uchar blue\nproperty int chart\nend_header\n";
}

} // namespace

void write_charts_ply(const std::string &path, const Mesh &mesh, const Partition &partition)
{
    Vector<bool> inverted = initially_inverted(mesh, partition);
    const std::string head = header(mesh);
    Vector<char> file(head.begin(), head.end());
    file.reserve(head.size() + sizeof(Vec3d) * mesh.positions.size() + 20 * mesh.triangle_count());
    auto put = [&](const void *data, size_t size) {
        const char *bytes = static_cast<const char *>(data);
        file.insert(file.end(), bytes, bytes + size);
    };
    for (const Vec3d &p : mesh.positions)
        put(&p, sizeof p);
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
        uint32_t chart = partition.initial_chart[t];
        Rgba8 c = inverted[t] ? Rgba8{0, 255, 0, 255} : chart_color(chart);
        uint8_t corners = 3, rgb[3] = {c.r, c.g, c.b};
        put(&corners, 1);
        put(mesh.triangles[t].data(), 12);
        put(rgb, 3);
        put(&chart, 4);
    }
    gtx_error error;
    require_ok(gtx_write_file(path.c_str(), file.data(), file.size(), &error), error);
}

} // namespace gtx
