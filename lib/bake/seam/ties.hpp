/* Points of outlines, each tied to the height field of a neighbour that it should lie on. */
#pragma once

#include "bake/budget.hpp"
#include "bake/height_field.hpp"

namespace gtx::baking {

/* One side of a tie. */
struct End {
    const HeightField *field = nullptr;
    CellPoint place = {};
    double lever = 0;            /* how far the gap opens as it rises */
};
/* A point where a height field ends, and the place of another that it should lie on. */
struct Tie {
    End end[2];
    double gap = 0, slack = 0;   /* along the normal of the other */
    bool moves = true;           /* what is around its ends, in this pass */

    bool is_open() const { return std::abs(gap) > slack; }
};

/* What ties go by. */
struct TieLimits {
    double apart;                /* object units between two height fields that are tied */
    double slack;                /* codes */
};

/* Points along the outline of a height field, tied to nothing yet. */
Vector<Tie> sample_outline(const HeightField &own);

/* Looks that finding the ends of all of them takes, about. */
double looks_of(const Vector<const HeightField *> &others, const TieLimits &limits,
                const Vector<Tie> &ties);

/* Ties what is tied to nothing, or to what it does not lie on; measures the others that moved.
 * Returns those that are open. A budget is of looks at other height fields. */
Vector<const Tie *> update_ties(const Vector<const HeightField *> &others,
                                const TieLimits &limits, Budget budget, Vector<Tie> &ties);

} // namespace gtx::baking
