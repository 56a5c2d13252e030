/* The names of `gtx bench`'s methods, and which belong together. */
#include "cli/bench/scene.hpp"

#include <algorithm>

namespace gtx {

/* Methods that Vulkan draws, too, in the order of those that draw so. */
static constexpr BenchMethod drawn_by_both[] = {
    BenchMethod::PAPER, BenchMethod::CAST, BenchMethod::LOD, BenchMethod::AUTO,
    BenchMethod::CAST_FRAGMENT, BenchMethod::GRID};
static constexpr uint32_t FIRST_OF_VULKAN = uint32_t(BenchMethod::PAPER_VULKAN);

BenchMethod without_vulkan(BenchMethod method)
{
    const uint32_t number = uint32_t(method);
    return number < FIRST_OF_VULKAN ? method : drawn_by_both[number - FIRST_OF_VULKAN];
}

BenchMethod with_vulkan(BenchMethod method)
{
    const BenchMethod *end = std::end(drawn_by_both);
    const BenchMethod *found = std::find(std::begin(drawn_by_both), end, method);
    return found == end ? BenchMethod::MESH
                        : BenchMethod(FIRST_OF_VULKAN + uint32_t(found - drawn_by_both));
}

Technique technique_of(BenchMethod method)
{
    switch (without_vulkan(method)) {
    case BenchMethod::PAPER: return {GTX_METHOD_PAPER, GTX_PASS_FORWARD};
    case BenchMethod::CAST:
    case BenchMethod::CAST_OWN:
    case BenchMethod::CAST_FRAGMENT: return {GTX_METHOD_CAST, GTX_PASS_FORWARD};
    case BenchMethod::GRID_OWN:
    case BenchMethod::GRID: return {GTX_METHOD_GRID, GTX_PASS_FORWARD};
    case BenchMethod::GRID_DEPTH: return {GTX_METHOD_GRID, GTX_PASS_DEPTH};
    case BenchMethod::LOD_OWN:
    case BenchMethod::LOD: return {GTX_METHOD_LOD, GTX_PASS_FORWARD};
    case BenchMethod::CAST_DEPTH: return {GTX_METHOD_CAST, GTX_PASS_DEPTH};
    case BenchMethod::AUTO_DEPTH: return {GTX_METHOD_AUTO, GTX_PASS_DEPTH};
    default: return {GTX_METHOD_AUTO, GTX_PASS_FORWARD};
    }
}

bool is_depth_pass(BenchMethod method)
{
    return technique_of(method).pass == GTX_PASS_DEPTH;
}

} // namespace gtx
