/* The runs of `gtx bench` that draw with Vulkan. */
#include "cli/bench/scene.hpp"

#include <algorithm>

namespace gtx {

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
