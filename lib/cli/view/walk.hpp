/* Walking on what `gtx view` shows, and flying around it. */
#pragma once

#include "cli/view/scene.hpp"
#include "host/walk.h"

namespace gtx {

enum class Motion { ORBIT, WALK, FLY };

class SceneRenderer;

/* The surfaces of a scene's assets and of what is there of its worlds, for rays, in the coordinates
 * it is drawn in: centred. */
class Ground {
public:
    /* Throws Error: MEMORY, LIMIT. */
    Ground(const Scene &scene, SceneRenderer &renderer);
    Ground(const Ground &) = delete;
    ~Ground();

    /* How far a ray of unit direction goes; infinite: it meets nothing. */
    float distance(const float origin[3], const float direction[3]) const;

private:
    void release();
    Vector<gtx_caster *> casters_;
    gtx_scene *scene_ = nullptr;
    SceneRenderer &renderer_;
};

class Walk {
public:
    /* Forgets the ground, and orbits. */
    void forget();
    /* From orbiting to walking, on what is in the middle of the picture; then to flying; and back.
     * Throws Error: MEMORY, LIMIT. */
    void change(gtx_camera &camera, const Scene &scene, SceneRenderer &renderer);
    /* Moves for some time: to the right, up and forward, -1..1 each. Walking, up is what the eye's
     * height gains. */
    void move(gtx_camera &camera, const float toward[3], bool fast, double seconds);
    /* Faster or slower, by steps of the wheel. */
    void hasten(float steps);

    Motion motion() const { return motion_; }

private:
    void begin_walk(gtx_camera &camera);

    Motion motion_ = Motion::ORBIT;
    std::unique_ptr<Ground> ground_;
    float orbit_ = 0;         /* distance to come back to */
    float height_ = 0, speed_ = 0; /* of the eye over the ground; world units a second */
};

} // namespace gtx
