/* A Vulkan device, the models on it and a picture. */
#include "cli/view/vulkan.hpp"

#include <cstring>

#ifdef GTX_VULKAN

#include "host/jobs.h"
#include "host/vulkan.h"

#include <geotex/vulkan.h>

namespace gtx {

struct VulkanDrawer::Parts {
    gtx_host_vulkan host = {};
    gtx_vk *vk = nullptr;
    gtx_picture picture = {};
    Vector<gtx_model *> models;
    Vector<gtx_vk_model *> uploaded;

    Parts()
    {
        gtx_error error;
        require_ok(gtx_host_vulkan_create(false, &host, &error), error);
    }
    Parts(const Parts &) = delete;
    ~Parts()
    {
        for (gtx_vk_model *model : uploaded)
            gtx_vk_model_destroy(vk, model);
        for (gtx_model *model : models)
            gtx_model_free(model);
        gtx_picture_destroy(&host, &picture);
        gtx_vk_destroy(vk);
        gtx_host_vulkan_destroy(&host);
    }
};

VulkanDrawer::VulkanDrawer() : parts_(std::make_unique<Parts>())
{
    gtx_error error;
    gtx_vk_desc desc = {};
    desc.load = parts_->host.load;
    desc.instance = parts_->host.instance;
    desc.physical_device = parts_->host.physical;
    desc.device = parts_->host.device;
    desc.frames = 1;
    require_ok(gtx_vk_create(&desc, &parts_->vk, &error), error);
}

VulkanDrawer::~VulkanDrawer() = default;

std::string VulkanDrawer::device() const
{
    return parts_->host.name;
}

void VulkanDrawer::add(const gtx_asset *asset)
{
    gtx_error error;
    const gtx_jobs jobs = gtx_host_jobs(0);
    gtx_model_desc desc = {};
    desc.jobs = &jobs;
    desc.borrow = 1;
    desc.first_provokes = 1;
    desc.limits = cli_limits;
    gtx_model *model;
    require_ok(gtx_model_prepare(asset, &desc, &model, &error), error);
    parts_->models.push_back(model);
    gtx_vk_model *uploaded;
    require_ok(gtx_host_vulkan_begin(&parts_->host, &error), error);
    require_ok(gtx_vk_upload(parts_->vk, parts_->host.commands, model, &uploaded, &error), error);
    parts_->uploaded.push_back(uploaded);
    require_ok(gtx_host_vulkan_run(&parts_->host, &error), error);
    gtx_vk_uploaded(parts_->vk, uploaded);
}

void VulkanDrawer::resize(uint32_t width, uint32_t height)
{
    gtx_error error;
    gtx_picture_desc desc = {};
    if (parts_->picture.desc.width == width && parts_->picture.desc.height == height)
        return;
    desc.width = width;
    desc.height = height;
    desc.color_count = 1;
    desc.colors[0] = VK_FORMAT_R8G8B8A8_UNORM;
    desc.pixel_size = 4;
    gtx_picture_destroy(&parts_->host, &parts_->picture);
    require_ok(gtx_picture_create(&parts_->host, &desc, &parts_->picture, &error), error);
}

void VulkanDrawer::draw(gtx_view view, const Vector<gtx_instance> &instances,
                        const Vector<size_t> &of, const float background[4])
{
    gtx_error error;
    Parts &p = *parts_;
    Vector<gtx_vk_instance> placed(instances.size());
    for (size_t i = 0; i < placed.size(); ++i)
        placed[i] = {p.uploaded[of[i]], instances[i]};
    for (int k = 0; k < 16; k += 4)
        view.projection[k + 2] = 0.5f * (view.projection[k + 2] + view.projection[k + 3]);
    view.flags |= GTX_VIEW_DEPTH_ZERO_TO_ONE;
    gtx_vk_target target = {};
    target.render_pass = p.picture.pass;
    target.color_count = 1;
    target.depth_format = VK_FORMAT_D32_SFLOAT;
    target.y_up = 1;
    gtx_picture_clear clear = {};
    std::memcpy(clear.color, background, sizeof clear.color);
    clear.depth = 1;
    require_ok(gtx_host_vulkan_begin(&p.host, &error), error);
    gtx_vk_next_frame(p.vk);
    gtx_picture_begin(&p.host, &p.picture, true, true, &clear);
    const gtx_result result = gtx_vk_draw(p.vk, p.host.commands, &target, &view, placed.data(),
                                          uint32_t(placed.size()), &error);
    gtx_picture_end(&p.host, &p.picture, true);
    require_ok(result, error);
    require_ok(gtx_host_vulkan_run(&p.host, &error), error);
}

void VulkanDrawer::read(Vector<uint8_t> &color, Vector<float> &depth)
{
    gtx_error error;
    Parts &p = *parts_;
    require_ok(gtx_host_vulkan_begin(&p.host, &error), error);
    gtx_picture_read(&p.host, &p.picture);
    require_ok(gtx_host_vulkan_run(&p.host, &error), error);
    const size_t pixels = size_t(p.picture.desc.width) * p.picture.desc.height;
    color.resize(4 * pixels);
    depth.resize(pixels);
    std::memcpy(color.data(), gtx_picture_bytes(&p.picture, 0), color.size());
    std::memcpy(depth.data(), gtx_picture_bytes(&p.picture, GTX_PICTURE_DEPTH), 4 * pixels);
}

} // namespace gtx

#else

namespace gtx {

struct VulkanDrawer::Parts {};

VulkanDrawer::VulkanDrawer()
{
    throw Error(GTX_ERROR_UNSUPPORTED, "this gtx was built without Vulkan");
}
VulkanDrawer::~VulkanDrawer() = default;
std::string VulkanDrawer::device() const
{
    return "";
}
void VulkanDrawer::add(const gtx_asset *) {}
void VulkanDrawer::resize(uint32_t, uint32_t) {}
void VulkanDrawer::draw(gtx_view, const Vector<gtx_instance> &, const Vector<size_t> &,
                        const float[4])
{
}
void VulkanDrawer::read(Vector<uint8_t> &, Vector<float> &) {}

} // namespace gtx

#endif
