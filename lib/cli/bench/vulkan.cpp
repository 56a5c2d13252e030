/* What of `gtx bench` Vulkan draws. */
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

/* Where any method asks for it. */
void BenchScene::open_vulkan(const gtx_asset *asset)
{
    const Vector<BenchMethod> &m = options_.methods;
    if (std::none_of(m.begin(), m.end(), [](BenchMethod k) { return without_vulkan(k) != k; }))
        return;
    vulkan_ = std::make_unique<VulkanDrawer>();
    vulkan_->add(asset);
    setup.device = vulkan_->device();
}

void BenchScene::draw_by_vulkan(BenchMethod method, gtx_view view,
                                const Vector<gtx_instance> &placed)
{
    const float nothing[4] = {};
    vulkan_->resize(view.viewport_width, view.viewport_height);
    if (method == BenchMethod::CAST_FRAGMENT_VULKAN)
        view.viewport_width = 0;
    vulkan_->draw(view, placed, Vector<size_t>(placed.size()), nothing);
}

} // namespace gtx
