/* What is seen at a patch's texels as bytes: mip levels, dilated past what is occupied. */
#include "bake/field/shade.hpp"

#include "asset/asset.h"
#include "asset/fill.h"
#include "mesh/material/srgb.hpp"

#include <algorithm>

namespace gtx::baking {

/* A sum of shades that gives their mean. */
struct Mean {
    Vec3f normal, last;
    float values[MAX_CHANNELS] = {};
    int count = 0;

    void add(const Shades &from, size_t at)
    {
        last = from.normal[at];
        normal += last;
        for (int k = 0; k < from.channels; ++k)
            values[k] += from.values[at * from.channels + k];
        ++count;
    }
    void store(Shades &to, size_t at) const
    {
        float size = length(normal);
        to.normal[at] = size > 1e-6f ? normal / size : last;
        for (int k = 0; k < to.channels; ++k)
            to.values[at * to.channels + k] = values[k] / float(count);
    }
};

/* The next level: means of the occupied texels of each square. */
static Shades halve(const Shades &fine)
{
    Shades coarse(fine.w / 2, fine.h / 2, fine.channels);
    for (int j = 0; j < coarse.h; ++j) {
        for (int i = 0; i < coarse.w; ++i) {
            Mean mean;
            for (int k = 0; k < 4; ++k) {
                size_t at = size_t(2 * j + k / 2) * fine.w + 2 * i + k % 2;
                if (fine.occupied[at])
                    mean.add(fine, at);
            }
            size_t to = size_t(j) * coarse.w + i;
            coarse.occupied[to] = mean.count > 0;
            if (mean.count)
                mean.store(coarse, to);
        }
    }
    return coarse;
}

void dilate(Shades &shades, unsigned rings)
{
    Vector<size_t> ring;
    for (unsigned r = 0; r < rings; ++r) {
        ring.clear();
        for (int j = 0; j < shades.h; ++j) {
            for (int i = 0; i < shades.w; ++i) {
                size_t at = size_t(j) * shades.w + i;
                if (shades.occupied[at])
                    continue;
                Mean mean;
                for (int y = std::max(j - 1, 0); y <= std::min(j + 1, shades.h - 1); ++y)
                    for (int x = std::max(i - 1, 0); x <= std::min(i + 1, shades.w - 1); ++x)
                        if (shades.occupied[size_t(y) * shades.w + x])
                            mean.add(shades, size_t(y) * shades.w + x);
                if (!mean.count)
                    continue;
                mean.store(shades, at);
                ring.push_back(at);
            }
        }
        if (ring.empty())
            return;
        for (size_t at : ring)
            shades.occupied[at] = 1;
    }
}

static Vector<uint8_t> encode_normals(const Shades &shades, const gtx_patch &record)
{
    float rows[3][3];
    gtx_normal_frame(&record, rows);
    Vector<uint8_t> bytes(2 * shades.normal.size(), GTX_FAR_NORMAL);
    for (size_t i = 0; i < shades.normal.size(); ++i) {
        if (!shades.occupied[i])
            continue;
        const Vec3f &n = shades.normal[i];
        Vec3f m;
        for (int k = 0; k < 3; ++k)
            m[k] = rows[k][0] * n.x + rows[k][1] * n.y + rows[k][2] * n.z;
        m.z = std::max(m.z, 0.f);
        if (length(m) < 1e-6f) /* straight away from the viewer */
            m = {0, 0, 1};
        m = normalize(m);
        gtx_encode_normal(&m.x, &bytes[2 * i]);
    }
    return bytes;
}

/* The next level of normals, by the rule that readers know. */
static Vector<uint8_t> halve_normals(const Vector<uint8_t> &fine, const Shades &shades)
{
    int w = shades.w / 2, h = shades.h / 2;
    Vector<uint8_t> coarse(2 * size_t(w) * h);
    for (int j = 0; j < h; ++j) {
        for (int i = 0; i < w; ++i) {
            gtx_normal_sum sum = {};
            for (int k = 0; k < 4; ++k) {
                size_t at = size_t(2 * j + k / 2) * shades.w + 2 * i + k % 2;
                if (shades.occupied[at])
                    gtx_normal_add(&sum, &fine[2 * at]);
            }
            gtx_normal_mean(&sum, &coarse[2 * (size_t(j) * w + i)]);
        }
    }
    return coarse;
}

static Vector<uint8_t> fill_normals(Vector<uint8_t> codes, const Shades &shades,
                                    unsigned rings)
{
    Vector<uint8_t> ring = shades.occupied;
    gtx_fill area = {codes.data(), ring.data(), size_t(shades.w), uint32_t(shades.w),
                     uint32_t(shades.h)};
    gtx_fill_normals(&area, rings);
    return codes;
}

static uint8_t unorm(float value)
{
    return uint8_t(std::min(std::max(0.f, value), 1.f) * 255 + 0.5f); /* NaN is 0 */
}

/* `count` channels from `first` on, as bytes that code(channel, value) gives. */
template <class Code>
static Vector<uint8_t> encode(const Shades &shades, int first, int count, Code code)
{
    Vector<uint8_t> bytes(count * shades.normal.size(), 0);
    for (size_t i = 0; i < shades.normal.size(); ++i)
        for (int k = 0; shades.occupied[i] && k < count; ++k)
            bytes[count * i + k] = code(k, shades.values[i * shades.channels + first + k]);
    return bytes;
}

static void encode_level(const Shades &shades, const AppearanceNeeds &needs, PatchMaps &patch)
{
    int first = 0;
    if (needs.color) {
        patch.color.push_back(encode(shades, first, COLOR_CHANNELS, [](int k, float value) {
            return k < 3 ? linear_to_srgb(value) : unorm(value);
        }));
        first += COLOR_CHANNELS;
    }
    if (needs.material) {
        patch.material.push_back(encode(shades, first, MATERIAL_CHANNELS,
                                        [](int, float value) { return unorm(value); }));
        first += MATERIAL_CHANNELS;
    }
    if (needs.emission)
        patch.emission.push_back(encode(shades, first, EMISSION_CHANNELS, [&](int, float value) {
            return linear_to_srgb(value / needs.emission_scale);
        }));
}

void build_mips(Shades shades, unsigned mips, const AppearanceNeeds &needs, PatchMaps &patch)
{
    Vector<uint8_t> normals = encode_normals(shades, patch.record);
    for (unsigned k = 0; k < mips; ++k) {
        unsigned rings = gtx_fill_rings(&patch.record, k);
        patch.normal.push_back(fill_normals(normals, shades, rings));
        Shades filled = shades;
        if (shades.channels)
            dilate(filled, rings);
        encode_level(filled, needs, patch);
        if (k + 1 < mips) {
            normals = halve_normals(normals, shades);
            shades = halve(shades);
        }
    }
}

} // namespace gtx::baking
