/* Assets as solids: insides and volumes of what anyone may have made, and what it combines to. */
#include "fuzz/fuzz.hpp"

#include <geotex/solid.h>

#include <cmath>

namespace fuzz {

/* The errors that solid.h lists. */
static void listed(const char *call, const gtx_error &error)
{
    REQUIRE(error.result == GTX_ERROR_INPUT || error.result == GTX_ERROR_EMPTY ||
                error.result == GTX_ERROR_LIMIT || error.result == GTX_ERROR_MEMORY,
            "%s: %d, rule %u: %s", call, error.result, error.rule, error.message);
}

static void ask(const gtx_asset *asset, Random &random)
{
    Counted memory;
    const gtx_allocator hooks = memory.hooks();
    gtx_solid_desc desc = {};
    desc.allocator = &hooks;
    desc.limits.work = 1 << 22;
    desc.max_openness = 1;
    gtx_solid *solid = nullptr;
    gtx_error error = {};
    if (gtx_solid_create(asset, &desc, &solid, &error))
        return listed("solid", error);
    gtx_solid_facts facts;
    gtx_solid_measure(solid, &facts);
    REQUIRE(facts.openness >= 0 && facts.openness <= 1, "an openness of %g", facts.openness);
    REQUIRE(!std::isnan(facts.volume) && facts.area >= 0, "a volume of %g in an area of %g",
            facts.volume, facts.area);
    float points[8][3], numbers[8];
    for (auto &p : points)
        for (float &x : p)
            x = random.number();
    REQUIRE(!gtx_solid_winding(solid, points, numbers, 8), "winding numbers are refused");
    gtx_solid_destroy(solid);
}

/* With itself: all of its surface coincides. */
void combine_asset(const gtx_asset *asset, uint64_t how)
{
    Random random(how);
    ask(asset, random);
    Counted memory;
    const gtx_allocator hooks = memory.hooks();
    gtx_combine_desc desc = {};
    desc.op = gtx_combine_op(random.below(3));
    desc.allocator = &hooks;
    desc.limits.work = 1 << 22;
    desc.max_openness = 1;
    gtx_asset *out = nullptr;
    gtx_error error = {};
    if (gtx_combine(asset, asset, &desc, &out, nullptr, &error))
        listed("combine", error);
    else
        round_trip(out, true, "what was combined");
    gtx_close(out);
}

} // namespace fuzz
