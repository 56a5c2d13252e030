/* The steps of baking that close the surface along the seams between patches: what no patch shows
 * is given to one, and height fields that meet are made to touch or cross. */
#pragma once

#include "bake/field/patch.hpp"

namespace gtx::baking {

/* Relaxes the trim of patches, those of `partition` in their order, that hide what no other shows;
 * returns charts of the surface that none of them has. */
Vector<Chart> cover_uncovered(const Job &job, const Partition &partition,
                              Vector<PatchMaps> &patches, Task &task);

/* Moves heights around outlines until height fields that meet lie on each other; all patches have
 * codes. They are to be measured again then. */
void stitch(unsigned height_bits, Vector<PatchMaps> &patches, Task &task);

/* Raises texels beyond straight cuts until the height fields on both sides cross; likewise.
 * `charts` is that of each patch. */
void close_cuts(const Partition &partition, const Vector<uint32_t> &charts,
                const Vec3d &anchor, unsigned height_bits, Vector<PatchMaps> &patches,
                Task &task);

/* Ends height fields sooner beyond convex edges of the source at which they meet those of the next
 * face: what they show there stands in the air. */
void end_at_creases(unsigned height_bits, Vector<PatchMaps> &patches, Task &task);

/* Takes back what is shown beyond outlines where the source is nowhere near. */
void take_back_fins(const Job &job, Vector<PatchMaps> &patches, Task &task);

} // namespace gtx::baking
