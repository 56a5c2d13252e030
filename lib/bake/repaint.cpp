/* Maps of edited patches: levels as baking makes them, normals and outlines of the heights. */
#include "bake/repaint.hpp"
#include "base/exact.h"

#include "bake/field/shade.hpp"

#include "asset/fill.h"
#include "asset/patch.h"
#include "mesh/material/srgb.hpp"

#include <algorithm>
#include <cmath>

namespace gtx {

using namespace baking;

Vector<uint8_t> PatchTexels::occupied() const
{
    Vector<uint8_t> out(size_t(w) * h);
    for (size_t t = 0; t < out.size(); ++t)
        out[t] = code(uint32_t(t % w), uint32_t(t / w)) != 0;
    return out;
}

namespace {

/* Of the surface through a texel's point and those of its neighbours that have a height. */
Vec3f normal_of_heights(const PageMaps &maps, const gtx_patch &p, const PatchTexels &r, uint32_t x,
                        uint32_t y, const float axis[3])
{
    Vec3d along[2];
    for (uint32_t a = 0; a < 2; ++a) {
        const uint32_t dx = a == 0, dy = a == 1, most = a ? r.h : r.w, i = a ? y : x;
        const bool before = i > 0 && r.code(x - dx, y - dy);
        const bool after = i + 1 < most && r.code(x + dx, y + dy);
        const uint32_t x0 = x - dx * before, y0 = y - dy * before;
        uint32_t x1 = x + dx * after, y1 = y + dy * after, code = r.code(x1, y1);
        if (!before && !after) { /* as flat as its frame */
            x1 += dx;
            y1 += dy;
        }
        double from[3], to[3];
        gtx_texel_point(&p, x0, y0, gtx_code_height(r.code(x0, y0), maps.bits), from);
        gtx_texel_point(&p, x1, y1, gtx_code_height(code, maps.bits), to);
        along[a] = Vec3d(to[0] - from[0], to[1] - from[1], to[2] - from[2]);
    }
    const Vec3d n = cross(along[0], along[1]), up(axis[0], axis[1], axis[2]);
    const double size = length(n);
    if (!(size > 0))
        return Vec3f(axis[0], axis[1], axis[2]);
    const double turned = dot(n, up) < 0 ? -size : size; /* x and y may be left-handed about z */
    return Vec3f(float(n.x / turned), float(n.y / turned), float(n.z / turned));
}

AppearanceNeeds needs_of(unsigned which)
{
    AppearanceNeeds needs;
    needs.color = which >> GTX_MAP_COLOR & 1;
    needs.material = which >> GTX_MAP_MATERIAL & 1;
    needs.emission = which >> GTX_MAP_EMISSION & 1;
    needs.emission_scale = 1; /* its bytes are in that scale already */
    return needs;
}

/* Light, or what a byte says as it is. */
bool is_light(int map, uint32_t channel)
{
    return map == GTX_MAP_EMISSION || (map == GTX_MAP_COLOR && channel < 3);
}

float *read_values(const PatchTexels &r, int map, uint32_t x, uint32_t y, float *out)
{
    const uint8_t *bytes = r.at(map, x, y);
    for (uint32_t k = 0; k < MAP_TEXEL[map]; ++k)
        *out++ = is_light(map, k) ? srgb_to_linear(bytes[k]) : float(bytes[k]) / 255;
    return out;
}

Shades shades_of(const PageMaps &maps, const gtx_patch &p, unsigned which, bool normals_of_heights)
{
    int channels = 0;
    for (int map = GTX_MAP_COLOR; map <= GTX_MAP_EMISSION; ++map)
        channels += which >> map & 1 ? int(MAP_TEXEL[map]) : 0;
    const PatchTexels r(maps, p);
    Shades shades(int(r.w), int(r.h), channels);
    shades.occupied = r.occupied();
    float rows[3][3];
    gtx_normal_frame(&p, rows);
    for (size_t t = 0; t < shades.occupied.size(); ++t) {
        if (!shades.occupied[t])
            continue;
        const uint32_t x = uint32_t(t % r.w), y = uint32_t(t / r.w);
        float *values = shades.values.data() + t * size_t(channels);
        for (int map = GTX_MAP_COLOR; map <= GTX_MAP_EMISSION; ++map)
            values = which >> map & 1 ? read_values(r, map, x, y, values) : values;
        if (normals_of_heights) {
            shades.normal[t] = normal_of_heights(maps, p, r, x, y, rows[2]);
            continue;
        }
        float n[3];
        gtx_decode_normal(r.at(GTX_MAP_NORMAL, x, y), n);
        for (int k = 0; k < 3; ++k)
            shades.normal[t][k] = n[0] * rows[0][k] + n[1] * rows[1][k] + n[2] * rows[2][k];
    }
    return shades;
}

/* Texels from (x, y) to the nearest cell that is there, or is not. */
double distance_to(const Vector<uint8_t> &cells, const PatchTexels &r, uint32_t x, uint32_t y,
                   bool there)
{
    constexpr int REACH = 9; /* past what a code can say */
    const int w = int(r.w) - 1, h = int(r.h) - 1;
    double best = REACH;
    for (int j = int(y) - REACH; j < int(y) + REACH; ++j)
        for (int i = int(x) - REACH; i < int(x) + REACH; ++i) {
            const bool is = i >= 0 && j >= 0 && i < w && j < h && cells[size_t(j) * w + i];
            if (is != there)
                continue;
            const double dx = std::max({0, i - int(x), int(x) - i - 1});
            const double dy = std::max({0, j - int(y), int(y) - j - 1});
            best = std::min(best, length(dx, dy));
        }
    return best;
}

} // namespace

void repaint_levels(const PageMaps &maps, const gtx_patch &patch, unsigned which,
                    bool normals_of_heights)
{
    PatchMaps made;
    made.record = patch;
    build_mips(shades_of(maps, patch, which, normals_of_heights), maps.mip_count, needs_of(which),
               made);
    const Levels *levels[] = {nullptr, nullptr, &made.normal, &made.color, &made.material,
                              &made.emission};
    for (int map = GTX_MAP_NORMAL; map <= GTX_MAP_EMISSION; ++map)
        for (uint32_t k = 0; k < maps.mip_count && which >> map & 1; ++k) {
            const PatchTexels r(maps, patch, k);
            const size_t row = size_t(r.w) * MAP_TEXEL[map];
            for (uint32_t y = 0; y < r.h; ++y)
                std::copy_n((*levels[map])[k].data() + y * row, row, r.at(map, 0, y));
        }
}

void repaint_trim(const PageMaps &maps, const gtx_patch &patch)
{
    const PatchTexels r(maps, patch);
    if (r.w < 2 || r.h < 2)
        return;
    Vector<uint8_t> occupied = r.occupied(), cells(size_t(r.w - 1) * (r.h - 1));
    for (size_t c = 0; c < cells.size(); ++c) {
        const size_t t = c / (r.w - 1) * r.w + c % (r.w - 1);
        cells[c] = occupied[t] & occupied[t + 1] & occupied[t + r.w] & occupied[t + r.w + 1];
    }
    Vector<uint8_t> codes(occupied.size(), GTX_FAR_TRIM);
    for (size_t t = 0; t < occupied.size(); ++t) {
        const uint32_t x = uint32_t(t % r.w), y = uint32_t(t / r.w);
        if (occupied[t])
            codes[t] = gtx_nearest_trim(float(distance_to(cells, r, x, y, true) -
                                              distance_to(cells, r, x, y, false)));
    }
    const gtx_fill area = {codes.data(), occupied.data(), r.w, r.w, r.h};
    gtx_fill_trim(&area);
    for (uint32_t y = 0; y < r.h; ++y)
        std::copy_n(&codes[size_t(y) * r.w], r.w, r.at(GTX_MAP_TRIM, 0, y));
}

} // namespace gtx
