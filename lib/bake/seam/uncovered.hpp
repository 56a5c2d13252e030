/* Finds the triangles of the source that no height field shows, and the cells that would show them
 * if their trim were relaxed. */
#pragma once

#include "bake/field/patch.hpp"

namespace gtx::baking {

/* A triangle that is not shown whole, of which chart, and how many square texels of it are not. */
struct Uncovered {
    uint32_t triangle, chart;
    double area;
};

/* A cell of a patch that would show something if its trim were lower by so many codes. */
struct RelaxedTrim {
    size_t patch, cell;
    int by;
};

/* Triangles in ascending order, and the cells that show what would be among them but for their
 * trim. */
struct Gaps {
    Vector<Uncovered> uncovered;
    Vector<RelaxedTrim> relaxed;
};
Gaps find_gaps(const Job &job, const Partition &partition, const Vector<PatchMaps> &patches,
               Task &task);

} // namespace gtx::baking
