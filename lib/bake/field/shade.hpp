/* What a patch looks like at its texels, and the maps of that with all their levels. */
#pragma once

#include "bake/field/chart_field.hpp"

namespace gtx::baking {

/* Floats of each kind: light and alpha; occlusion, roughness, metallic and lit; light. */
constexpr int COLOR_CHANNELS = 4, MATERIAL_CHANNELS = 4, EMISSION_CHANNELS = 3,
              MAX_CHANNELS = COLOR_CHANNELS + MATERIAL_CHANNELS + EMISSION_CHANNELS;

/* What is seen at each texel of a level, before it is stored. */
struct Shades {
    int w, h, channels;
    Vector<Vec3f> normal;                     /* object space, unit */
    Vector<float> values;                     /* `channels` a texel: those that follow, if needed */
    Vector<uint8_t> occupied;                 /* has a shade */

    Shades(int w, int h, int channels)
        : w(w), h(h), channels(channels), normal(size_t(w) * h), values(normal.size() * channels),
          occupied(normal.size(), 0)
    {
    }
};

/* The part of a working grid that becomes the rectangle: its first texel may lie outside. */
struct Crop {
    int x = 0, y = 0, w = 0, h = 0;
};

/* The shades of the texels with a code. */
Shades shade_texels(const Job &job, const ChartField &field, const Crop &crop,
                    const Vector<uint16_t> &height);

/* Gives texels beside walls the mean normal of what their cells show. */
void shade_walls(const PatchMaps &maps, unsigned height_bits, Shades &shades);

/* Fills empty texels ring by ring with the mean of the neighbours that the ring before had. */
void dilate(Shades &shades, unsigned rings);

/* Encodes shades as all levels of the maps that are needed, dilated. `patch` gives the axes and
 * dilation. */
void build_mips(Shades shades, unsigned mips, const AppearanceNeeds &needs, PatchMaps &patch);

} // namespace gtx::baking
