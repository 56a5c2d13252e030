/* An asset as seen in a view, row by row. */
#pragma once

#include "measure/view.hpp"

#include <geotex/geotex.h>

#include <memory>

namespace gtx {

/* Nearest crossing of a pixel's ray, seen from either side. */
enum class Crossing : uint8_t {
    none,
    shown,                       /* the height field is seen: from above, or of a two-sided patch */
    leak                         /* from below, with no height field seen right behind it */
};

/* An asset at one level of detail, or where `max_error` (object units) is given each patch at its
 * coarsest within it, to be looked at. Const and reentrant. */
class AssetView {
public:
    /* The caster takes its memory where the asset did. Throws Error: MEMORY. */
    AssetView(const gtx_asset *asset, uint32_t level, double max_error = 0);

    /* Casts row j of the view; both vectors get view.size entries. A hit is what is shown: hit.t is
     * the depth, infinity where there is none. */
    void cast_row(const View &view, uint32_t j, Vector<gtx_hit> &hits,
                  Vector<Crossing> &crossings) const;

    /* The length of one step of the patch's height codes. */
    double height_step(uint32_t patch) const;
    /* Normal and colour at a hit. */
    Fragment fragment(const gtx_hit &hit) const;

private:
    struct Destroy {
        void operator()(gtx_caster *caster) const { gtx_caster_destroy(caster); }
    };
    gtx_info info_;
    const gtx_patch *patches_;
    const uint8_t *color_;       /* level 0, or null */
    std::unique_ptr<gtx_caster, Destroy> caster_;
};

} // namespace gtx
