/* Walks by rays: one where the eye looks, to begin with, and one straight down for each step. */
#include "cli/view/walk.hpp"

#include "cli/view/scene_renderer.hpp"

#include <algorithm>
#include <cmath>

namespace gtx {

/* In radii of what is shown: a landscape is walked across in half a minute. */
constexpr float EYE_HEIGHT = 0.012f, SPEED = 0.06f;
constexpr float FAST = 5;                   /* times, with Shift */
constexpr float STEP = 0.5f; /* eye heights above the eye that still are the ground */
constexpr float MIN_HEIGHT = 0.2f, MAX_HEIGHT = 20; /* times EYE_HEIGHT */

Ground::Ground(const Scene &scene, SceneRenderer &renderer) : renderer_(renderer)
{
    Vector<gtx_scene_instance> instances;
    gtx_caster_desc desc = {};
    gtx_error error;
    desc.limits = cli_limits;
    try {
        for (const PlacedAsset &placed : scene.assets) {
            gtx_caster *caster;
            require_ok(gtx_caster_create(placed.asset.get(), &desc, &caster, &error), error);
            casters_.push_back(caster);
            const gtx_instance at = place_in_scene(placed, scene.centre);
            instances.emplace_back();
            instances.back().caster = caster;
            std::copy(at.transform, at.transform + 16, instances.back().transform);
        }
        require_ok(gtx_scene_create(instances.data(), uint32_t(instances.size()), nullptr, &scene_,
                                    &error), error);
    } catch (...) {
        release();
        throw;
    }
}

Ground::~Ground()
{
    release();
}

void Ground::release()
{
    gtx_scene_destroy(scene_);
    for (gtx_caster *caster : casters_)
        gtx_caster_destroy(caster);
}

float Ground::distance(const float origin[3], const float direction[3]) const
{
    gtx_ray ray = {};
    gtx_hit hit;
    std::copy(origin, origin + 3, ray.origin);
    std::copy(direction, direction + 3, ray.direction);
    const gtx_result result = gtx_scene_raycast(scene_, &ray, &hit, nullptr, 1, 0);
    return std::min(result == GTX_OK ? hit.t : INFINITY,
                    renderer_.distance_to_worlds(origin, direction));
}

void Walk::forget()
{
    motion_ = Motion::ORBIT;
    ground_.reset();
}

/* Stands on what is in the middle of the picture, or before it if it is a wall; over nothing the
 * eye stays where it is. */
void Walk::begin_walk(gtx_camera &camera)
{
    float right[3], up[3], back[3], eye[3];
    orbit_ = camera.distance;
    height_ = EYE_HEIGHT * camera.radius;
    speed_ = SPEED * camera.radius;
    gtx_camera_axes(&camera, right, up, back);
    gtx_walk_eye(&camera, eye);
    const float ahead[3] = {-back[0], -back[1], -back[2]};
    const float far = ground_->distance(eye, ahead);
    gtx_walk_begin(&camera);
    if (std::isfinite(far))
        for (int k = 0; k < 3; ++k)
            camera.pan[k] += ahead[k] * (far - height_) + (k == 1 ? height_ : 0);
    camera.elevation = 0;
}

void Walk::change(gtx_camera &camera, const Scene &scene, SceneRenderer &renderer)
{
    if (motion_ == Motion::ORBIT) {
        if (!ground_)
            ground_ = std::make_unique<Ground>(scene, renderer);
        begin_walk(camera);
        motion_ = Motion::WALK;
    } else if (motion_ == Motion::WALK) {
        motion_ = Motion::FLY;
    } else {
        gtx_walk_end(&camera, orbit_);
        motion_ = Motion::ORBIT;
    }
}

void Walk::move(gtx_camera &camera, const float toward[3], bool fast, double seconds)
{
    if (motion_ == Motion::ORBIT)
        return;
    const bool walks = motion_ == Motion::WALK;
    const float length = speed_ * (fast ? FAST : 1) * float(seconds);
    const float steps[3] = {toward[0] * length, walks ? 0 : toward[1] * length,
                            toward[2] * length};
    gtx_walk_move(&camera, steps, walks);
    if (!walks)
        return;
    const float usual = EYE_HEIGHT * camera.radius;
    height_ *= std::exp(toward[1] * float(seconds));
    height_ = std::min(std::max(height_, MIN_HEIGHT * usual), MAX_HEIGHT * usual);
    const float down[3] = {0, -1, 0};
    float eye[3];
    gtx_walk_eye(&camera, eye);
    eye[1] += STEP * height_;
    const float deep = ground_->distance(eye, down);
    if (std::isfinite(deep))
        gtx_walk_stand(&camera, eye[1] - deep, height_, float(seconds));
}

void Walk::hasten(float steps)
{
    speed_ *= std::pow(1.2f, steps);
}

} // namespace gtx
