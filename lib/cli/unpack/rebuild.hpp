/* Maps of an unpacked asset that others follow from: which were edited, and those made anew. */
#pragma once

#include "cli/unpack/unpacked.hpp"

#include "bake/repaint.hpp"

namespace gtx {

enum { REBUILD_MIPS = 1, REBUILD_NORMALS = 2, REBUILD_TRIM = 4 };

/* Of each map in turn, as UNPACKED_MAPS has them, a patch's texels of level 0, then those of all
 * coarser levels. */
using PatchHashes = std::array<uint64_t, 12>;

PatchHashes hash_patch(const PageMaps &maps, const gtx_patch &patch);

/* In patches that were edited since they were unpacked, or in all where that is not known:
 *   - mips: coarser levels of normals, colours, materials and emission, and what dilation gives,
 *     from the texels of level 0 that have a height (format/gtx.md, 4.7 and 4.8);
 *   - normals: of the heights, all levels, where heights were edited;
 *   - trim: the outline is where cells of the heights end, where heights were edited.
 * Warns of edited maps that others, neither edited nor rebuilt, do not agree with. Patches that lie
 * outside their page are passed over. */
void rebuild(Unpacked &unpacked, unsigned what);

} // namespace gtx
