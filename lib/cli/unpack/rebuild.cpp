/* Making maps of edited patches anew from what was painted. */
#include "cli/unpack/rebuild.hpp"

#include "asset/fill.h"
#include "asset/patch.h"
#include "base/hash.h"
#include "mesh/material/srgb.hpp"

#include <algorithm>
#include <cmath>

namespace gtx {

namespace {

enum { HEIGHT, TRIM, NORMAL, COLOR, MATERIAL, EMISSION };

bool fits(const MapLevels &maps, const gtx_patch &p)
{
    return p.rect[0] + p.rect[2] <= maps.width && p.rect[1] + p.rect[3] <= maps.height;
}

uint32_t texel_size(const MapLevels &maps, int map)
{
    return map == HEIGHT ? maps.bits / 8 : UNPACKED_MAPS[map].texel_size;
}

/* A patch's texels on its page: those of a level of a map, and what is known of them. */
class Rectangle {
public:
    Rectangle(const MapLevels &maps, const gtx_patch &patch, uint32_t level = 0)
        : maps_(maps), patch_(patch), level_(level), w(patch.rect[2] >> level),
          h(patch.rect[3] >> level)
    {
    }
    uint8_t *at(int map, uint32_t x, uint32_t y) const
    {
        const size_t row = size_t(patch_.page) * (maps_.height >> level_) +
                           (patch_.rect[1] >> level_) + y;
        const size_t texel = row * (maps_.width >> level_) + (patch_.rect[0] >> level_) + x;
        return const_cast<uint8_t *>(maps_.levels[map][level_]) + texel * texel_size(maps_, map);
    }
    uint32_t code(uint32_t x, uint32_t y) const
    {
        const uint8_t *p = at(HEIGHT, x, y);
        return maps_.bits == 16 ? p[0] | uint32_t(p[1]) << 8 : p[0];
    }
    Vector<uint8_t> occupied() const
    {
        Vector<uint8_t> out(size_t(w) * h);
        for (size_t t = 0; t < out.size(); ++t)
            out[t] = code(uint32_t(t % w), uint32_t(t / w)) != 0;
        return out;
    }

private:
    const MapLevels &maps_;
    const gtx_patch &patch_;
    uint32_t level_;

public:
    const uint32_t w, h;
};

Vector<uint8_t> halve(const Vector<uint8_t> &fine, uint32_t w, uint32_t h)
{
    Vector<uint8_t> out(size_t(w / 2) * (h / 2));
    for (uint32_t y = 0; y < h / 2; ++y)
        for (uint32_t x = 0; x < w / 2; ++x)
            for (uint32_t k = 0; k < 4; ++k)
                out[size_t(y) * (w / 2) + x] |= fine[size_t(2 * y + k / 2) * w + 2 * x + k % 2];
    return out;
}

/* The normal of the surface through a texel's point and its neighbours with a height. */
void write_normal(const MapLevels &maps, const gtx_patch &p, const Rectangle &r, uint32_t x,
                  uint32_t y, uint8_t out[2])
{
    double from[2][3], to[2][3];
    for (uint32_t a = 0; a < 2; ++a) {
        const uint32_t dx = a == 0, dy = a == 1, most = a ? r.h : r.w, i = a ? y : x;
        const bool before = i > 0 && r.code(x - dx, y - dy);
        const bool after = i + 1 < most && r.code(x + dx, y + dy);
        const uint32_t x0 = x - dx * before, y0 = y - dy * before;
        const uint32_t x1 = x + dx * after, y1 = y + dy * after;
        gtx_texel_point(&p, x0, y0, gtx_code_height(r.code(x0, y0), maps.bits), from[a]);
        gtx_texel_point(&p, x1, y1, gtx_code_height(r.code(x1, y1), maps.bits), to[a]);
        if (!before && !after) /* as flat as its frame */
            gtx_texel_point(&p, x + dx, y + dy, gtx_code_height(r.code(x, y), maps.bits), to[a]);
    }
    double u[2][3], n[3], size = 0;
    for (int a = 0; a < 2; ++a)
        for (int k = 0; k < 3; ++k)
            u[a][k] = to[a][k] - from[a][k];
    for (int k = 0; k < 3; ++k) {
        n[k] = u[0][(k + 1) % 3] * u[1][(k + 2) % 3] - u[0][(k + 2) % 3] * u[1][(k + 1) % 3];
        size += n[k] * n[k];
    }
    float rows[3][3], m[3];
    gtx_normal_frame(&p, rows);
    for (int j = 0; j < 3; ++j)
        m[j] = size > 0 ? float((rows[j][0] * n[0] + rows[j][1] * n[1] + rows[j][2] * n[2]) /
                                std::sqrt(size))
                        : float(j == 2);
    if (m[2] < 0) /* x and y of the texels are left-handed about z */
        for (float &part : m)
            part = -part;
    gtx_encode_normal(m, out);
}

/* Texels without a height, by rule, and the coarser levels. */
void rebuild_normal_levels(const MapLevels &maps, const gtx_patch &p, bool from_heights)
{
    const Rectangle base(maps, p);
    Vector<uint8_t> occupied = base.occupied(), codes(2 * occupied.size(), GTX_FAR_NORMAL);
    for (size_t t = 0; t < occupied.size(); ++t) {
        const uint32_t x = uint32_t(t % base.w), y = uint32_t(t / base.w);
        if (occupied[t] && from_heights)
            write_normal(maps, p, base, x, y, &codes[2 * t]);
        else if (occupied[t])
            std::copy_n(base.at(NORMAL, x, y), 2, &codes[2 * t]);
    }
    for (uint32_t k = 0; k < maps.mip_count; ++k) {
        const Rectangle r(maps, p, k);
        Vector<uint8_t> filled = codes, ring = occupied;
        const gtx_fill area = {filled.data(), ring.data(), r.w, r.w, r.h};
        gtx_fill_normals(&area, gtx_fill_rings(&p, k));
        for (uint32_t y = 0; y < r.h; ++y)
            std::copy_n(&filled[2 * size_t(y) * r.w], 2 * r.w, r.at(NORMAL, 0, y));
        const Vector<uint8_t> coarse = halve(occupied, r.w, r.h);
        Vector<uint8_t> next(2 * coarse.size(), GTX_FAR_NORMAL);
        for (size_t t = 0; t < coarse.size(); ++t) {
            gtx_normal_sum sum = {};
            for (uint32_t i = 0; coarse[t] && i < 4; ++i) {
                const size_t at = (2 * (t / (r.w / 2)) + i / 2) * r.w + 2 * (t % (r.w / 2)) + i % 2;
                gtx_normal_add_if(&sum, &codes[2 * at], occupied[at]);
            }
            if (coarse[t])
                gtx_normal_mean(&sum, &next[2 * t]);
        }
        codes = std::move(next);
        occupied = coarse;
    }
}

/* Light, or what a byte says as it is. */
bool is_light(int map, uint32_t channel)
{
    return map == EMISSION || (map == COLOR && channel < 3);
}

/* The mean of the given neighbours, channel by channel. */
struct Mean {
    float sum[4] = {};
    int count = 0;

    void add(const float *values, uint32_t channels)
    {
        for (uint32_t k = 0; k < channels; ++k)
            sum[k] += values[k];
        ++count;
    }
    void store(float *values, uint32_t channels) const
    {
        for (uint32_t k = 0; k < channels; ++k)
            values[k] = sum[k] / float(count);
    }
};

void dilate(Vector<float> &values, Vector<uint8_t> known, uint32_t channels, uint32_t w, uint32_t h,
            uint32_t rings)
{
    for (uint32_t n = 0; n < rings; ++n) {
        const Vector<uint8_t> before = known;
        for (uint32_t y = 0; y < h; ++y)
            for (uint32_t x = 0; x < w; ++x) {
                const size_t t = size_t(y) * w + x;
                Mean mean;
                for (uint32_t j = y - (y > 0); !before[t] && j <= std::min(y + 1, h - 1); ++j)
                    for (uint32_t i = x - (x > 0); i <= std::min(x + 1, w - 1); ++i)
                        if (before[size_t(j) * w + i])
                            mean.add(&values[(size_t(j) * w + i) * channels], channels);
                if (!mean.count)
                    continue;
                mean.store(&values[t * channels], channels);
                known[t] = 1;
            }
        if (known == before)
            return;
    }
}

void rebuild_levels(const MapLevels &maps, const gtx_patch &p, int map)
{
    const uint32_t channels = texel_size(maps, map);
    const Rectangle base(maps, p);
    Vector<uint8_t> occupied = base.occupied();
    Vector<float> values(occupied.size() * channels);
    for (size_t t = 0; t < occupied.size(); ++t)
        for (uint32_t k = 0; k < channels; ++k) {
            const uint8_t byte = base.at(map, uint32_t(t % base.w), uint32_t(t / base.w))[k];
            values[t * channels + k] = is_light(map, k) ? srgb_to_linear(byte) : float(byte);
        }
    for (uint32_t level = 0; level < maps.mip_count; ++level) {
        const Rectangle r(maps, p, level);
        Vector<float> filled = values;
        for (size_t t = 0; t < occupied.size(); ++t)
            for (uint32_t k = 0; k < channels && !occupied[t]; ++k)
                filled[t * channels + k] = 0;
        dilate(filled, occupied, channels, r.w, r.h, gtx_fill_rings(&p, level));
        for (size_t t = 0; t < occupied.size(); ++t)
            for (uint32_t k = 0; k < channels; ++k)
                r.at(map, uint32_t(t % r.w), uint32_t(t / r.w))[k] =
                    is_light(map, k) ? linear_to_srgb(filled[t * channels + k])
                                     : uint8_t(filled[t * channels + k] + 0.5f);
        const Vector<uint8_t> coarse = halve(occupied, r.w, r.h);
        Vector<float> next(coarse.size() * channels);
        for (size_t t = 0; t < coarse.size(); ++t) {
            Mean mean;
            for (uint32_t i = 0; i < 4 && coarse[t]; ++i) {
                const size_t at = (2 * (t / (r.w / 2)) + i / 2) * r.w + 2 * (t % (r.w / 2)) + i % 2;
                if (occupied[at])
                    mean.add(&values[at * channels], channels);
            }
            if (mean.count)
                mean.store(&next[t * channels], channels);
        }
        values = std::move(next);
        occupied = coarse;
    }
}

/* Texels from (x, y) to the nearest cell that is there, or is not. */
double distance_to(const Vector<uint8_t> &cells, const Rectangle &r, uint32_t x, uint32_t y,
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
            best = std::min(best, std::hypot(dx, dy));
        }
    return best;
}

void rebuild_trim(const MapLevels &maps, const gtx_patch &p)
{
    const Rectangle r(maps, p);
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
        std::copy_n(&codes[size_t(y) * r.w], r.w, r.at(TRIM, 0, y));
}

} // namespace

PatchHashes hash_patch(const MapLevels &maps, const gtx_patch &patch)
{
    PatchHashes out = {};
    for (int map = 0; map < 6; ++map)
        for (uint32_t part = 0; part < 2; ++part) {
            gtx_hash hash;
            gtx_hash_begin(&hash);
            const uint32_t end = part && UNPACKED_MAPS[map].has_levels ? maps.mip_count : 1;
            for (uint32_t k = part; k < end && maps.levels[map][k] && fits(maps, patch); ++k) {
                const Rectangle r(maps, patch, k);
                for (uint32_t y = 0; y < r.h; ++y)
                    gtx_hash_add(&hash, r.at(map, 0, y), size_t(r.w) * texel_size(maps, map));
            }
            out[2 * size_t(map) + part] = gtx_hash_end(&hash);
        }
    return out;
}

void rebuild(Unpacked &unpacked, unsigned what)
{
    const gtx_asset_desc &d = unpacked.desc;
    MapLevels maps;
    maps.width = d.page_width;
    maps.height = d.page_height;
    maps.mip_count = d.mip_count;
    maps.bits = d.height_bits;
    for (int map = 0; map < 6; ++map)
        for (size_t k = 0; k < unpacked.pointers[map].size(); ++k)
            maps.levels[map][k] = unpacked.pointers[map][k];
    size_t old_levels = 0, old_normals = 0, old_trims = 0;
    for (size_t i = 0; i < unpacked.patches.size(); ++i) {
        const gtx_patch &p = unpacked.patches[i];
        const bool known = i < unpacked.hashes.size();
        if (p.page >= d.page_count || !fits(maps, p))
            continue; /* gtx_create will say so */
        const PatchHashes now = hash_patch(maps, p), was = known ? unpacked.hashes[i] : now;
        auto edited = [&](int m) { return !known || now[2 * size_t(m)] != was[2 * size_t(m)]; };
        auto stale = [&](int map) { /* level 0 is new, the others are not */
            return known && d.mip_count > 1 && edited(map) &&
                   now[2 * size_t(map) + 1] == was[2 * size_t(map) + 1];
        };
        const bool heights = edited(HEIGHT), normals = heights && (what & REBUILD_NORMALS);
        old_normals += known && heights && !normals && !edited(NORMAL);
        if (heights && (what & REBUILD_TRIM))
            rebuild_trim(maps, p);
        const Rectangle r(maps, p);
        const Vector<uint8_t> occupied = r.occupied();
        const auto coded = std::count(occupied.begin(), occupied.end(), 1);
        old_trims += known && heights && !(what & REBUILD_TRIM) && !edited(TRIM) &&
                     double(coded) > double(p.coverage) * double(occupied.size()) + 0.5;
        for (int map = NORMAL; map <= EMISSION; ++map) {
            const bool mips = (what & REBUILD_MIPS) && (heights || edited(map));
            if (!maps.levels[map][0])
                continue;
            if (map == NORMAL && (mips || normals))
                rebuild_normal_levels(maps, p, normals);
            else if (mips)
                rebuild_levels(maps, p, map);
            else
                old_levels += stale(map);
        }
    }
    auto warn = [&](size_t count, const std::string &sentence) {
        if (count)
            unpacked.warnings.push_back({GTX_WARNING_MAPS_DISAGREE,
                                         "in " + std::to_string(count) + " patches " + sentence});
    };
    warn(old_levels, "maps were edited at level 0 alone: from afar the old ones show (--rebuild "
                     "mips)");
    warn(old_normals, "heights were edited and normals were not (--rebuild normals)");
    warn(old_trims, "there are heights beyond the outline, which do not show (--rebuild trim)");
}

} // namespace gtx
