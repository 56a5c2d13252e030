/* Maps of one patch of an asset made anew from those that they follow from, which were edited. */
#pragma once

#include "asset/asset.h"
#include "mesh/memory.hpp"

namespace gtx {

/* Bytes a texel of the maps, by gtx_map; heights of 16 bits have 2. */
constexpr uint32_t MAP_TEXEL[] = {1, 1, 2, 4, 4, 3};
constexpr int MAP_COUNT = 6;

/* The maps of an asset: `levels` are images of all pages one after another, null where it has no
 * such map. `bits` are those of heights. */
struct PageMaps {
    uint8_t *levels[MAP_COUNT][GTX_MAX_MIPS] = {};
    uint32_t width, height, mip_count, bits;

    /* Whether a patch lies inside its page. */
    bool hold(const gtx_patch &p) const
    {
        return p.rect[0] + p.rect[2] <= width && p.rect[1] + p.rect[3] <= height;
    }
};

/* A patch's texels at a level. */
class PatchTexels {
public:
    const uint32_t w, h;

    PatchTexels(const PageMaps &maps, const gtx_patch &patch, uint32_t level = 0)
        : w(patch.rect[2] >> level), h(patch.rect[3] >> level), maps_(maps), patch_(patch),
          level_(level)
    {
    }
    uint32_t size(int map) const
    {
        return map == GTX_MAP_HEIGHT ? maps_.bits / 8 : MAP_TEXEL[map];
    }
    uint8_t *at(int map, uint32_t x, uint32_t y) const
    {
        const size_t row = size_t(patch_.page) * (maps_.height >> level_) +
                           (patch_.rect[1] >> level_) + y;
        const size_t texel = row * (maps_.width >> level_) + (patch_.rect[0] >> level_) + x;
        return maps_.levels[map][level_] + texel * size(map);
    }
    /* Of a height, at level 0; 0 where there is none. */
    uint32_t code(uint32_t x, uint32_t y) const
    {
        const uint8_t *p = at(GTX_MAP_HEIGHT, x, y);
        return maps_.bits == 16 ? gtx_load_own_u16(p) : p[0];
    }
    Vector<uint8_t> occupied() const;

private:
    const PageMaps &maps_;
    const gtx_patch &patch_;
    uint32_t level_;
};

/* All levels of the maps whose bits 1 << gtx_map are set, of normals, colours, materials and
 * emission, from the texels of level 0 that have a height (format/gtx.md, 4.7 and 4.8). Level 0
 * stays where there is one, but normals can be those of the heights. */
void repaint_levels(const PageMaps &maps, const gtx_patch &patch, unsigned which,
                    bool normals_of_heights);

/* The outline becomes that of the cells of heights. */
void repaint_trim(const PageMaps &maps, const gtx_patch &patch);

} // namespace gtx
