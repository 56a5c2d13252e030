/* What of an unpacked asset was edited, and what is made anew of it. */
#include "cli/unpack/rebuild.hpp"

#include "base/hash.h"

#include <algorithm>

namespace gtx {

PatchHashes hash_patch(const PageMaps &maps, const gtx_patch &patch)
{
    PatchHashes out = {};
    for (int map = 0; map < MAP_COUNT; ++map)
        for (uint32_t part = 0; part < 2; ++part) {
            gtx_hash hash;
            gtx_hash_begin(&hash);
            const uint32_t end = part && UNPACKED_MAPS[map].has_levels ? maps.mip_count : 1;
            for (uint32_t k = part; k < end && maps.levels[map][k] && maps.hold(patch); ++k) {
                const PatchTexels r(maps, patch, k);
                for (uint32_t y = 0; y < r.h; ++y)
                    gtx_hash_add(&hash, r.at(map, 0, y), size_t(r.w) * r.size(map));
            }
            out[2 * size_t(map) + part] = gtx_hash_end(&hash);
        }
    return out;
}

void rebuild(Unpacked &unpacked, unsigned what)
{
    const gtx_asset_desc &d = unpacked.desc;
    PageMaps maps;
    maps.width = d.page_width;
    maps.height = d.page_height;
    maps.mip_count = d.mip_count;
    maps.bits = d.height_bits;
    for (int map = 0; map < MAP_COUNT; ++map)
        for (size_t k = 0; k < unpacked.levels[map].size(); ++k)
            maps.levels[map][k] = unpacked.levels[map][k].data();
    size_t old_levels = 0, old_normals = 0, old_trims = 0;
    for (size_t i = 0; i < unpacked.patches.size(); ++i) {
        const gtx_patch &p = unpacked.patches[i];
        const bool known = i < unpacked.hashes.size();
        if (p.page >= d.page_count || !maps.hold(p))
            continue; /* gtx_create will say so */
        const PatchHashes now = hash_patch(maps, p), was = known ? unpacked.hashes[i] : now;
        auto edited = [&](int m) { return !known || now[2 * size_t(m)] != was[2 * size_t(m)]; };
        auto stale = [&](int map) { /* level 0 is new, the others are not */
            return known && d.mip_count > 1 && edited(map) &&
                   now[2 * size_t(map) + 1] == was[2 * size_t(map) + 1];
        };
        const bool heights = edited(GTX_MAP_HEIGHT), normals = heights && (what & REBUILD_NORMALS);
        unpacked.has_old_normals |= heights || edited(GTX_MAP_NORMAL);
        old_normals += known && heights && !normals && !edited(GTX_MAP_NORMAL);
        if (heights && (what & REBUILD_TRIM))
            repaint_trim(maps, p);
        const PatchTexels r(maps, p);
        const Vector<uint8_t> occupied = r.occupied();
        const auto coded = std::count(occupied.begin(), occupied.end(), 1);
        old_trims += known && heights && !(what & REBUILD_TRIM) && !edited(GTX_MAP_TRIM) &&
                     double(coded) > double(p.coverage) * double(occupied.size()) + 0.5;
        unsigned anew = 0;
        for (int map = GTX_MAP_NORMAL; map < MAP_COUNT; ++map) {
            const bool mips = (what & REBUILD_MIPS) && (heights || edited(map));
            if (maps.levels[map][0] && (mips || (map == GTX_MAP_NORMAL && normals)))
                anew |= 1u << map;
            else
                old_levels += maps.levels[map][0] && stale(map);
        }
        if (anew)
            repaint_levels(maps, p, anew, normals);
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
