/* Assets as seen in a view, row by row. */
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

/* What is shown, and which of the assets shows it. */
struct ViewHit : gtx_hit {
    uint32_t asset = 0;
};

/* Assets at one level of detail, or where `max_error` (object units) is given each patch at its
 * coarsest within it, to be looked at together: each at its anchor, the nearest is shown. Const and
 * reentrant. */
class AssetView {
public:
    /* Casters take their memory where the assets did. Throws Error: MEMORY. */
    AssetView(const Vector<const gtx_asset *> &assets, uint32_t level, double max_error = 0);
    AssetView(const gtx_asset *asset, uint32_t level, double max_error = 0)
        : AssetView(Vector<const gtx_asset *>{asset}, level, max_error)
    {
    }

    /* Casts row j of the view; both vectors get view.size entries. A hit is what is shown: hit.t is
     * the depth, infinity where there is none. */
    void cast_row(const View &view, uint32_t j, Vector<ViewHit> &hits,
                  Vector<Crossing> &crossings) const;

    /* The length of one step of the height codes of the patch that was hit. */
    double height_step(const ViewHit &hit) const;
    /* The longer side of a texel of the finest level of that patch. */
    double texel(const ViewHit &hit) const;
    /* Normal and colour at a hit, as the view shows them. */
    Fragment fragment(const ViewHit &hit, const View &view) const;

private:
    struct Destroy {
        void operator()(gtx_caster *caster) const { gtx_caster_destroy(caster); }
    };
    struct Part {
        gtx_info info;
        const gtx_patch *patches;
        const uint8_t *color;        /* level 0, or null */
        Vec3d low, high;             /* around all patches, anchor included */
        std::unique_ptr<gtx_caster, Destroy> caster;
    };
    void cast_nearest(const View &view, uint32_t j, const Vector<uint32_t> &pixels, uint32_t flags,
                      Vector<ViewHit> &hits) const;
    const gtx_patch &patch_of(const ViewHit &hit) const
    {
        return parts_[hit.asset].patches[hit.patch];
    }
    Vector<Part> parts_;
};

} // namespace gtx
