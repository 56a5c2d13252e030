/* Assets drawn by Vulkan, without a window. */
#pragma once

#include "cli/view/scene.hpp"

#include <geotex/frame.h>

namespace gtx {

/* A device, models on it, and a picture of some size. Everything throws Error: GL, MEMORY, LIMIT;
 * the constructor UNSUPPORTED, where the command was built without Vulkan. */
class VulkanDrawer {
public:
    VulkanDrawer();
    VulkanDrawer(const VulkanDrawer &) = delete;
    ~VulkanDrawer();

    std::string device() const;
    /* Uploads a model; they are counted from 0. */
    void add(const gtx_asset *asset);
    /* What is drawn into from now on. */
    void resize(uint32_t width, uint32_t height);
    /* Clears, draws, and waits for it. The view is as for OpenGL, with clip z in -1..1; instances
     * are of the models `of` says. */
    void draw(gtx_view view, const Vector<gtx_instance> &instances, const Vector<size_t> &of,
              const float background[4]);
    /* RGBA, and depth as the window has it; rows from the top. */
    void read(Vector<uint8_t> &color, Vector<float> &depth);

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

} // namespace gtx
