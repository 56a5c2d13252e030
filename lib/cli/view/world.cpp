/* Streaming for `gtx render` and `gtx view`: a stream, a thread, and payloads that are models. */
#include "cli/view/world.hpp"

#include "base/error.h"
#include "cli/cli.h"
#include "mesh/task.hpp"
#include "stream/index.h"

#include <sys/stat.h>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>

namespace gtx {

/* Rays of walking feet: four cells of the height fields at once are fine enough. */
constexpr uint32_t GROUND_LEVEL = 2;

std::string world_at(const std::string &path)
{
    const size_t slash = path.rfind('/') + 1; /* 0 where there is none */
    const std::string name = path.substr(slash);
    const bool is_file = name == "tileset.json" || name == GTX_INDEX_FILE;
    const std::string folder = !is_file ? path : slash ? path.substr(0, slash) : ".";
    struct stat about;
    const bool there = !stat((folder + "/" GTX_INDEX_FILE).c_str(), &about);
    return there && S_ISREG(about.st_mode) ? folder : std::string();
}

static bool read_whole(const std::string &path, std::string &out)
{
    std::ifstream file(path, std::ios::binary);
    out.assign(std::istreambuf_iterator<char>(file), {});
    return file && !file.bad();
}

/* Of a file the bytes behind those that are there, until these are so many; fewer where it ends. */
static bool read_more(const std::string &path, uint64_t size, std::string &out)
{
    const size_t before = out.size();
    std::ifstream file(path, std::ios::binary);
    if (!file || before > size || !file.seekg(std::streamoff(before)))
        return false;
    out.resize(size_t(size));
    file.read(&out[before], std::streamsize(size - before));
    out.resize(before + size_t(file.gcount()));
    return !file.bad();
}

PlacedWorld open_world(const std::string &path)
{
    PlacedWorld world;
    gtx_stream_desc desc = {};
    gtx_stream *stream = nullptr;
    gtx_error error;
    world.folder = path;
    errno = 0;
    if (!read_whole(path + "/" GTX_INDEX_FILE, world.index))
        throw Error(GTX_ERROR_READ, std::strerror(errno));
    desc.index = world.index.data();
    desc.index_size = world.index.size();
    require_ok(gtx_stream_create(&desc, &stream, &error), error);
    gtx_stream_get_info(stream, &world.info);
    gtx_stream_destroy(stream);
    return world;
}

/* The payload. Its memory is counted. */
struct WorldStream::Tile {
    gtx_stream_request request = {};
    WorldStream *of = nullptr;
    gtx_asset *asset = nullptr;
    gtx_model *model = nullptr;
    gtx_caster *caster = nullptr;    /* of a whole tile: beginnings have no heights */
    LodRays rays;                    /* of a beginning */
    float transform[16] = {};
    uint64_t bytes = 0;
    std::string file;                /* of a beginning, for its rest */
    gtx_error error = {};

    Tile(const gtx_stream_request &wanted, WorldStream *stream) : request(wanted), of(stream)
    {
        if (wanted.beginning)
            file = static_cast<const Tile *>(wanted.beginning)->file;
    }
    bool whole() const { return request.bytes == request.file_bytes; }
    uint64_t size() const { return bytes + file.capacity() + rays.bytes(); }
    ~Tile()
    {
        gtx_model_destroy(of->renderer_, model);
        gtx_caster_destroy(caster);
        gtx_close(asset);
    }
    static void *take(size_t size, void *user)
    {
        void *memory = std::malloc(size);
        static_cast<Tile *>(user)->bytes += memory ? size : 0;
        return memory;
    }
    static void give(void *memory, size_t size, void *user)
    {
        static_cast<Tile *>(user)->bytes -= size;
        std::free(memory);
    }
    void open();
    void prepare();
};

void WorldStream::Tile::open()
{
    const gtx_allocator hooks = {take, give, this};
    gtx_open_desc desc = {};
    errno = 0;
    if (!read_more(of->folder_ + "/" + request.uri, request.bytes, file))
        throw Error(GTX_ERROR_READ, std::strerror(errno));
    desc.allocator = &hooks;
    gtx_stream_open(&request, file.data(), file.size(), &desc, &asset, nullptr, &error);
    if (whole())
        std::string().swap(file);
}

void WorldStream::Tile::prepare()
{
    const gtx_allocator hooks = {take, give, this};
    gtx_model_desc desc = {};
    gtx_caster_desc solid = {};
    gtx_info info;
    desc.allocator = solid.allocator = &hooks;
    desc.limits = solid.limits = cli_limits;
    desc.borrow = 1;
    solid.level = GROUND_LEVEL;
    if (gtx_model_prepare(asset, &desc, &model, &error) ||
        (whole() && gtx_caster_create(asset, &solid, &caster, &error)))
        return;
    if (!whole())
        rays = LodRays(asset);
    gtx_get_info(asset, &info);
    for (int k = 0; k < 3; ++k) {
        transform[5 * k] = 1;
        transform[12 + k] = float(info.anchor[k] - of->centre_[k]);
    }
    transform[15] = 1;
}

/* On the worker's thread. */
void WorldStream::load(void *item, void *)
{
    auto *tile = static_cast<Tile *>(item);
    try {
        tile->open();
        if (!tile->error.result)
            tile->prepare();
    } catch (...) {
        tile->error = caught_error();
    }
}

void WorldStream::release(void *payload, void *)
{
    delete static_cast<Tile *>(payload);
}

void WorldStream::drop(void *item)
{
    release(item, nullptr);
}

void WorldStream::report(const gtx_stream_report *report, void *user)
{
    auto *self = static_cast<WorldStream *>(user);
    if (report->tries_left)
        return;
    gtx_fail(&self->failure_, report->error->result, "%s: %s", report->uri,
             report->error->message);
    if (!self->settles_)
        report_error((self->folder_ + "/" + report->uri).c_str(), report->error);
}

WorldStream::WorldStream(const PlacedWorld &world, gtx_renderer *renderer, const Vec3d &centre,
                         float max_error)
    : folder_(world.folder), tiles_(world.info.tiles), renderer_(renderer), centre_(centre)
{
    gtx_stream_desc desc = {};
    gtx_error error;
    desc.index = world.index.data();
    desc.index_size = world.index.size();
    desc.max_error = max_error;
    desc.cpu_bytes = cli_limits.memory;
    desc.release = release;
    desc.report = report;
    desc.user = this;
    require_ok(gtx_stream_create(&desc, &stream_, &error), error);
    if (gtx_worker_create(load, this, &worker_, &error)) {
        gtx_stream_destroy(stream_);
        throw Error(error);
    }
}

WorldStream::~WorldStream()
{
    gtx_scene_destroy(ground_);
    gtx_worker_destroy(worker_, drop);
    gtx_stream_destroy(stream_);
}

void WorldStream::take_answers(bool wait)
{
    while (auto *tile = static_cast<Tile *>(gtx_worker_pop(worker_, wait))) {
        if (tile->error.result) {
            gtx_stream_fail(stream_, tile->request.id, &tile->error);
            delete tile;
            continue;
        }
        const gtx_model_size size = gtx_model_gpu_size(tile->model);
        gtx_stream_deliver(stream_, tile->request.id, tile, tile->size(),
                           size.geometry + size.color);
    }
}

void WorldStream::upload()
{
    for (uint32_t i = 0; i < frame_.upload_count; ++i) {
        const gtx_stream_upload &part = frame_.uploads[i];
        auto *tile = static_cast<Tile *>(part.payload);
        uint32_t done = 0;
        gtx_error error;
        require_ok(gtx_model_upload(renderer_, tile->model, part.bytes, &done, &error), error);
        if (!done)
            continue;
        gtx_close(tile->asset);
        tile->asset = nullptr;
        gtx_stream_ready(stream_, part.tile, tile->size());
    }
}

void WorldStream::frame(const gtx_view &view, Vector<gtx_instance> &instances)
{
    gtx_stream_view eye = {};
    gtx_error error;
    std::copy(view.view, view.view + 16, eye.view);
    std::copy(view.projection, view.projection + 16, eye.projection);
    for (int k = 0; k < 3; ++k)
        eye.origin[k] = centre_[k];
    eye.viewport_height = view.viewport_height;
    gtx_scene_destroy(ground_); /* its casters may go */
    ground_ = nullptr;
    take_answers(false);
    require_ok(gtx_stream_update(stream_, &eye, 1, &frame_, &error), error);
    for (uint32_t i = 0; i < frame_.request_count; ++i) {
        auto tile = std::make_unique<Tile>(frame_.requests[i], this);
        if (gtx_worker_push(worker_, tile.get()))
            tile.release();
        else
            gtx_stream_fail(stream_, frame_.requests[i].id, nullptr);
    }
    upload();
    places_.clear();
    coarse_.clear();
    for (uint32_t i = 0; i < frame_.draw_count; ++i) {
        const auto *tile = static_cast<const Tile *>(frame_.draws[i].payload);
        gtx_instance instance = {};
        gtx_scene_instance place = {};
        instance.model = tile->model;
        place.caster = tile->caster;
        std::copy(tile->transform, tile->transform + 16, instance.transform);
        std::copy(tile->transform, tile->transform + 16, place.transform);
        instances.push_back(instance);
        if (tile->caster)
            places_.push_back(place);
        else
            coarse_.push_back({&tile->rays, {tile->transform[12], tile->transform[13],
                                             tile->transform[14]}});
    }
}

void WorldStream::settle(const gtx_view &view, Vector<gtx_instance> &instances)
{
    const size_t before = instances.size();
    settles_ = true;
    do {
        instances.resize(before);
        frame(view, instances);
        take_answers(true);
        if (failure_.result)
            throw Error(failure_);
    } while (!is_settled());
    if (frame_.without_room && !frame_.resident)
        throw Error(GTX_ERROR_LIMIT, "the root of the world is larger than the memory for it");
}

float WorldStream::distance(const float origin[3], const float direction[3])
{
    gtx_ray ray = {};
    gtx_hit hit;
    float nearest = INFINITY;
    for (const Coarse &c : coarse_)
        nearest = std::min(nearest, c.rays->distance(origin, direction, c.place));
    if (!ground_ && (places_.empty() || gtx_scene_create(places_.data(), uint32_t(places_.size()),
                                                         nullptr, &ground_, nullptr)))
        return nearest;
    std::copy(origin, origin + 3, ray.origin);
    std::copy(direction, direction + 3, ray.direction);
    return gtx_scene_raycast(ground_, &ray, &hit, nullptr, 1, 0) ? nearest
                                                                 : std::min(nearest, hit.t);
}

std::string WorldStream::status() const
{
    char line[160];
    snprintf(line, sizeof line,
             "%u of %u tiles  %u parts there  %u to come%s  %.1f MB  %.1f MB GPU",
             frame_.draw_count, tiles_, frame_.resident, frame_.pending,
             frame_.without_room ? ", no room" : "", double(frame_.cpu_bytes) / 1e6,
             double(frame_.gpu_bytes) / 1e6);
    return line;
}

} // namespace gtx
