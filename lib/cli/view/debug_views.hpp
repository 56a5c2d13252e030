/* Debug views: copies of what is drawn, coloured by patch or by normal. */
#pragma once

#include "cli/view/polygons.hpp"
#include "cli/view/scene.hpp"

namespace gtx {

enum class DebugView { NONE, PATCHES, NORMALS };
constexpr size_t DEBUG_VIEW_COUNT = 3;

/* A copy without materials: every patch in a colour of its own, or unlit in the colour of its
 * normals (x, y and z of object space as red, green and blue). Throws Error: MEMORY. */
AssetPointer recolor(const gtx_asset *asset, DebugView view);

/* The same of polygons, which have no patches: those stay as they are. */
void recolor(Polygons &polygons, DebugView view);

/* Of a patch in the view of patches. */
std::array<uint8_t, 3> patch_color(uint32_t index);

/* Pairs of ends: the edges of the patches' boxes, in the asset's own coordinates. */
Polygons patch_boxes(const gtx_asset *asset);

} // namespace gtx
