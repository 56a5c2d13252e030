/* Normal and colour of a patch as bytes: mip levels, dilated past what is occupied. */
#include "bake/patch_maps.hpp"
#include "bake/srgb.hpp"

#include "asset/asset.h"

#include <algorithm>

namespace gtx::baking {

struct Level {
    int w, h;
    std::vector<Shade> shades;
    std::vector<uint8_t> occupied;
};

/* A sum of shades that gives their mean. */
struct Mean {
    Shade sum;
    int count = 0;

    void add(const Shade &s)
    {
        sum.normal += s.normal;
        for (int k = 0; k < 4; ++k)
            sum.color[k] += s.color[k];
        ++count;
    }
    /* `or_else` gives the normal when the sum of normals vanishes. */
    Shade shade(const Shade &or_else) const
    {
        Shade mean = sum;
        float size = length(mean.normal);
        mean.normal = size > 1e-6f ? mean.normal / size : or_else.normal;
        for (float &c : mean.color)
            c /= float(count);
        return mean;
    }
};

/* The next level: means of the occupied texels of each square. */
static Level halve(const Level &fine)
{
    Level coarse{fine.w / 2, fine.h / 2, {}, {}};
    coarse.shades.resize(size_t(coarse.w) * coarse.h);
    coarse.occupied.resize(coarse.shades.size(), 0);
    for (int j = 0; j < coarse.h; ++j) {
        for (int i = 0; i < coarse.w; ++i) {
            Mean mean;
            const Shade *last = nullptr;
            for (int k = 0; k < 4; ++k) {
                size_t at = size_t(2 * j + k / 2) * fine.w + 2 * i + k % 2;
                if (fine.occupied[at])
                    mean.add(*(last = &fine.shades[at]));
            }
            size_t to = size_t(j) * coarse.w + i;
            coarse.occupied[to] = last != nullptr;
            if (last)
                coarse.shades[to] = mean.shade(*last);
        }
    }
    return coarse;
}

/* Fills empty texels ring by ring with the mean of the neighbours that the ring before had. */
static void dilate(Level &level, unsigned rings)
{
    std::vector<size_t> ring;
    for (unsigned r = 0; r < rings; ++r) {
        ring.clear();
        for (int j = 0; j < level.h; ++j) {
            for (int i = 0; i < level.w; ++i) {
                size_t at = size_t(j) * level.w + i;
                if (level.occupied[at])
                    continue;
                Mean mean;
                const Shade *last = nullptr;
                for (int y = std::max(j - 1, 0); y <= std::min(j + 1, level.h - 1); ++y)
                    for (int x = std::max(i - 1, 0); x <= std::min(i + 1, level.w - 1); ++x)
                        if (level.occupied[size_t(y) * level.w + x])
                            mean.add(*(last = &level.shades[size_t(y) * level.w + x]));
                if (!last)
                    continue;
                level.shades[at] = mean.shade(*last);
                ring.push_back(at);
            }
        }
        if (ring.empty())
            return;
        for (size_t at : ring)
            level.occupied[at] = 1;
    }
}

static std::vector<uint8_t> encode_normals(const Level &level, const gtx_patch &record)
{
    float rows[3][3];
    gtx_normal_frame(&record, rows);
    std::vector<uint8_t> bytes(2 * level.shades.size(), 128);
    for (size_t i = 0; i < level.shades.size(); ++i) {
        if (!level.occupied[i])
            continue;
        const Vec3f &n = level.shades[i].normal;
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

static std::vector<uint8_t> encode_colors(const Level &level)
{
    std::vector<uint8_t> bytes(4 * level.shades.size(), 0);
    for (size_t i = 0; i < level.shades.size(); ++i) {
        if (!level.occupied[i])
            continue;
        const float *c = level.shades[i].color;
        for (int k = 0; k < 3; ++k)
            bytes[4 * i + k] = linear_to_srgb(c[k]);
        bytes[4 * i + 3] = uint8_t(std::clamp(c[3], 0.f, 1.f) * 255 + 0.5f);
    }
    return bytes;
}

void build_mips(std::vector<Shade> shades, std::vector<uint8_t> occupied, unsigned mips,
                bool color, PatchMaps &patch)
{
    const gtx_patch &record = patch.record;
    Level level{record.rect[2], record.rect[3], std::move(shades), std::move(occupied)};
    for (unsigned k = 0; k < mips; ++k) {
        Level filled = level;
        dilate(filled, std::max(1u, unsigned(record.dilation) >> k));
        patch.normal.push_back(encode_normals(filled, record));
        if (color)
            patch.color.push_back(encode_colors(filled));
        if (k + 1 < mips)
            level = halve(level);
    }
}

} // namespace gtx::baking
