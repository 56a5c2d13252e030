/* A scene on the GPU, drawn as `gtx render` and `gtx view` show it. */
#pragma once

#include "cli/view/debug_views.hpp"
#include "cli/view/scene.hpp"
#include "host/polygons.h"

#include <geotex/render.h>

namespace gtx {

/* Needs its context current from the constructor to the destructor. Everything throws Error: GL,
 * SHADER, MEMORY, LIMIT. */
class SceneRenderer {
public:
    explicit SceneRenderer(gtx_host_load load);
    SceneRenderer(const SceneRenderer &) = delete;
    ~SceneRenderer();

    /* Shows another scene, which must outlive its show. `models` are of the scene's assets, in
     * order and uploaded, and are taken over; none: they are made here. */
    void show(const Scene &scene, Vector<gtx_model *> models = {});

    /* Clears the bound framebuffer and draws into it. Depth test on, func LESS, afterwards. */
    void draw(const gtx_view &view, DebugView debug = DebugView::NONE);
    /* The boxes of all patches as lines, on top of what was drawn, in its depth. */
    void draw_boxes(const gtx_view &view);

    /* Worlds: draws wait until all that is wanted is there, and throw Error where it cannot be. */
    void settle_worlds() { settles = true; }
    bool is_settled() const;
    /* A line for each; and how far a ray of unit direction goes over what was drawn of them. */
    std::string world_status() const;
    float distance_to_worlds(const float origin[3], const float direction[3]);

    /* Bytes on the GPU of what is drawn without a debug view. */
    uint64_t gpu_bytes() const;

    gtx_host_gl gl = {};
    gtx_polygon_program program = {}; /* for text and lines */
    float background[4] = {0.92f, 0.93f, 0.95f, 1};
    gtx_renderer *renderer = nullptr;

private:
    struct MeshOnGpu {
        gtx_polygons polygons;
        GLuint emissions;
        bool has_materials;
    };
    /* What one debug view draws; made when it is first asked for. */
    struct Uploaded {
        bool ready = false;
        Vector<gtx_model *> models;
        Vector<MeshOnGpu> meshes;
        uint64_t polygon_bytes = 0;
    };
    gtx_model *make_model(const gtx_asset *asset);
    Uploaded &uploaded(DebugView debug);
    gtx_polygon_program mesh_program = {};
    void clear();

    const Scene *scene = nullptr;
    Uploaded views[DEBUG_VIEW_COUNT];
    Vector<gtx_instance> places;      /* without their models */
    Vector<gtx_polygons> boxes;
    void add_worlds(const gtx_view &view, Vector<gtx_instance> &instances);
    Vector<std::unique_ptr<WorldStream>> streams; /* made by the first draw */
    bool settles = false;
};

/* The transform of an asset's own coordinates, with the scene's centre at the origin; no model. */
gtx_instance place_in_scene(const PlacedAsset &placed, const Vec3d &centre);

/* A key light over the camera's left shoulder. */
void light_from_camera(gtx_view &view);

} // namespace gtx
