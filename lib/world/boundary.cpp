/* Whether a surface is closed, decided while its triangles stream by. */
#include "world/plan.hpp"

#include <cstring>

namespace gtx {

static uint64_t mixed(uint64_t x)
{
    x = (x ^ x >> 32) * 0x9fb21c651e98df25u;
    x = (x ^ x >> 29) * 0xd6e8feb86659fd93u;
    return x ^ x >> 32;
}

static uint64_t hash_of(const Vec3d &position)
{
    uint64_t hash = 0;
    for (int k = 0; k < 3; ++k) {
        const double x = position[k] + 0.; /* -0 is 0 */
        uint64_t bits;
        std::memcpy(&bits, &x, sizeof bits);
        hash = mixed(hash ^ bits);
    }
    return hash;
}

void Boundary::add(const Corners3 &corners)
{
    constexpr uint64_t ODD = 0x9e3779b97f4a7c15u;
    uint64_t at[3];
    if (!any_)
        origin_ = corners[0].position;
    any_ = true;
    for (size_t k = 0; k < 3; ++k)
        at[k] = hash_of(corners[k].position);
    for (size_t k = 0; k < 3; ++k) {
        const uint64_t a = at[k], b = at[(k + 1) % 3];
        sum_ += mixed(a * ODD + b) - mixed(b * ODD + a);
    }
    volume_ += dot(corners[0].position - origin_,
                   cross(corners[1].position - origin_, corners[2].position - origin_));
}

} // namespace gtx
