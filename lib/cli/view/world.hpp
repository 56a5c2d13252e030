/* A world in a picture: its tiles are read by a thread while frames are drawn. */
#pragma once

#include "cli/view/lod_rays.hpp"
#include "host/worker.h"
#include "mesh/memory.hpp"
#include "mesh/vec.hpp"

#include <geotex/render.h>
#include <geotex/stream.h>

#include <string>

namespace gtx {

/* A folder that `gtx world` made, in a scene. */
struct PlacedWorld {
    std::string folder, index;       /* the bytes of tiles.gtw */
    gtx_stream_info info = {};
};

/* The folder of the world that a path is: the folder itself, its tileset.json, or its index. Empty
 * where it is none. */
std::string world_at(const std::string &path);
/* Throws Error: READ, and those of an index. */
PlacedWorld open_world(const std::string &path);

/* Needs the renderer's context in all that it does. */
class WorldStream {
public:
    /* `centre`: what the view's matrices take for 0, 0, 0. Throws Error: MEMORY, LIMIT. */
    WorldStream(const PlacedWorld &world, gtx_renderer *renderer, const Vec3d &centre,
                float max_error);
    WorldStream(const WorldStream &) = delete;
    ~WorldStream();

    /* One frame of a view: asks, takes what has come, uploads, and adds what is to be drawn. Throws
     * Error: GL, MEMORY. */
    void frame(const gtx_view &view, Vector<gtx_instance> &instances);
    /* Frame after frame until all that the view wants is there. Throws Error too where a tile
     * cannot be read. */
    void settle(const gtx_view &view, Vector<gtx_instance> &instances);

    /* How far a ray of unit direction goes over what was drawn last; infinite: it meets nothing. */
    float distance(const float origin[3], const float direction[3]);
    /* A line about what is there. */
    std::string status() const;
    /* The error of the tile that was given up last; OK: none. */
    const gtx_error &failure() const { return failure_; }
    /* Whether all that the last view wants is there, or there is no room for it. */
    bool is_settled() const { return frame_.pending <= frame_.without_room; }

private:
    struct Tile;
    static void load(void *item, void *user);
    static void release(void *payload, void *user);
    static void drop(void *item);
    static void report(const gtx_stream_report *report, void *user);
    void take_answers(bool wait);
    void upload();

    const std::string folder_;
    const uint32_t tiles_;
    gtx_renderer *renderer_;
    Vec3d centre_;
    gtx_stream *stream_ = nullptr;
    gtx_worker *worker_ = nullptr;
    gtx_stream_frame frame_ = {};
    gtx_scene *ground_ = nullptr;    /* of the last frame; made when it is asked for */
    Vector<gtx_scene_instance> places_;
    struct Coarse {
        const LodRays *rays;
        float place[3];
    };
    Vector<Coarse> coarse_;          /* of the last frame: beginnings of tiles */
    gtx_error failure_ = {};
    bool settles_ = false;           /* failures are thrown, not told */
};

} // namespace gtx
