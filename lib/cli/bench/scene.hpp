/* What `gtx bench` draws: an asset and the mesh it was cooked from, a method at a time. */
#pragma once

#include "cli/bench/bench.hpp"
#include "cli/bench/floor.hpp"
#include "cli/bench/parts.hpp"
#include "cli/bench/path.hpp"
#include "cli/view/vulkan.hpp"
#include "host/framebuffer.h"
#include "host/offscreen.h"

#include <geotex/render.h>

namespace gtx {

constexpr int BENCH_TURNS = 4; /* azimuths */

inline bool is_mesh(BenchMethod method)
{
    return method <= BenchMethod::MESH_LOD;
}
bool is_depth_pass(BenchMethod method);

/* How the methods of the library are asked for. */
struct Technique {
    gtx_method method;
    gtx_pass pass;
};
Technique technique_of(BenchMethod method);

/* What is drawn: `instances` on a wall of squares, each turned by `turn` of
 * BENCH_TURNS parts of a circle. */
struct Shot {
    uint32_t width, height, instances;
    int turn;
};

/* A framebuffer for a while, bound from the constructor on. */
struct Target {
    const gtx_host_gl &gl;
    gtx_framebuffer framebuffer;
    Target(const gtx_host_gl &functions, uint32_t width, uint32_t height);
    Target(const Target &) = delete;
    ~Target() { gtx_framebuffer_destroy(&gl, &framebuffer); }
};

/* A context that lives as long as its scene. */
struct BenchContext {
    gtx_offscreen *offscreen = nullptr;
    BenchContext();
    BenchContext(const BenchContext &) = delete;
    ~BenchContext() { gtx_offscreen_destroy(offscreen); }
};

/* Everything throws Error: GL, SHADER, MEMORY, LIMIT. */
class BenchScene {
public:
    BenchScene(const std::string &asset_path, const Mesh &mesh, const BenchOptions &options);
    BenchScene(const BenchScene &) = delete;
    ~BenchScene();

    /* Draws into the bound framebuffer and waits for it. */
    void draw(BenchMethod method, const Shot &shot);
    /* The same into `target`, read back. */
    Picture picture(BenchMethod method, const Shot &shot, const Target &target);
    /* The same of one instance where it is, from a viewpoint of a path. */
    gtx_view view_of(const ViewPath &path, size_t which, uint32_t width, uint32_t height) const;
    void draw(BenchMethod method, const gtx_view &view);
    Picture picture(BenchMethod method, const gtx_view &view, const Target &target);
    /* What the pictures of a view should be. */
    Truth truth(const gtx_view &view, const Target &target);
    Truth truth(const Shot &shot, const Target &target);
    /* Before FLOOR is drawn: what it covers. */
    void set_floor(const Picture &covered, const gtx_view &view);
    /* Fragments shaded and kept by all azimuths together; zeros: the driver cannot tell. */
    void count(BenchMethod method, Shot shot, uint64_t &rays, uint64_t &hits);
    /* Triangles of what a method draws; 0: no mesh. */
    uint32_t triangles(BenchMethod method) const;

    BenchSetup setup;
    gtx_host_gl gl = {};
    gtx_info info = {};
    MeshLevels levels;    /* of an orbit */
    PartLevels parts;     /* of a path */
    size_t level = 0;     /* that MESH_LOD draws */
    double max_error = 0; /* pixels, of what is no mesh */

private:
    template <class What> Truth truth_of(const What &what, const Target &target);
    void load_asset(const std::string &path);
    void load_mesh(const Mesh &mesh);
    gtx_view view_of(const Shot &shot, Vector<gtx_instance> &placed) const;
    void draw(BenchMethod method, gtx_view view, const Vector<gtx_instance> &placed);
    void draw_mesh(BenchMethod method, const gtx_view &view,
                   const Vector<gtx_instance> &placed);
    void shade_own(gtx_view &view);
    void open_vulkan(const gtx_asset *asset);
    void draw_by_vulkan(BenchMethod method, gtx_view view, const Vector<gtx_instance> &placed);
    Picture read(BenchMethod method, const gtx_view &view, const Target &target);

    const BenchOptions &options_;
    BenchContext context_;
    gtx_polygon_program program_ = {};
    gtx_renderer *renderer_ = nullptr;
    gtx_model *model_ = nullptr;
    gtx_shading *own_ = nullptr;         /* once it is asked for */
    float centre_[3] = {}, radius_ = 0;
    Vector<gtx_polygons> polygons_;      /* of the levels */
    std::unique_ptr<PartDrawer> part_drawer_;
    std::unique_ptr<Floor> floor_;
    std::unique_ptr<VulkanDrawer> vulkan_;
    bool counts_ = false;                /* the driver counts shaded fragments */
    double shift_[2] = {};               /* of the window, in pixels */
};

/* Of a clock that never goes back. */
double milliseconds();

} // namespace gtx
