/* Streaming a world that was made: 600 frames through its real tiles, in real memory. */
#include "worlds.hpp"

#include "base/hash.h"
#include "stream/index.h"

#include <geotex/stream.h>

#include <cmath>
#include <map>

using namespace gtx;

namespace {

/* Memory hooks that count what is taken. */
struct Books {
    uint64_t now = 0, most = 0;
    static void *take(size_t size, void *user)
    {
        auto *books = static_cast<Books *>(user);
        books->now += size;
        books->most = std::max(books->most, books->now);
        return std::malloc(size);
    }
    static void give(void *memory, size_t size, void *user)
    {
        static_cast<Books *>(user)->now -= size;
        std::free(memory);
    }
    gtx_allocator hooks() { return {take, give, this}; }
};

struct Walk {
    std::string folder;
    Books books;
    gtx_stream *stream = nullptr;
    gtx_stream_frame frame = {};
    uint64_t read = 0;               /* bytes of files */
    Vector<gtx_stream_request> under_way;

    explicit Walk(const std::string &world, uint64_t cpu_bytes, float max_error);
    ~Walk() { gtx_stream_destroy(stream); }
    void update(const gtx_stream_view &view);
    void answer(const gtx_stream_request &request);
};

void close_asset(void *asset, void *)
{
    gtx_close(static_cast<gtx_asset *>(asset));
}

Walk::Walk(const std::string &world, uint64_t cpu_bytes, float max_error) : folder(world)
{
    const std::string index = read_file(folder + "/" GTX_INDEX_FILE);
    const gtx_allocator hooks = books.hooks();
    gtx_stream_desc desc = {};
    gtx_error error;
    desc.index = index.data();
    desc.index_size = index.size();
    desc.cpu_bytes = cpu_bytes;
    desc.max_error = max_error;
    desc.release = close_asset;
    desc.allocator = &hooks;
    if (gtx_stream_create(&desc, &stream, &error))
        fail_msg("%s", error.message);
    read = index.size();
}

/* An asset alone is a payload: nothing here draws. What was read before is kept by who reads. */
void Walk::answer(const gtx_stream_request &request)
{
    const std::string bytes = read_file(folder + "/" + request.uri).substr(0, request.bytes);
    const gtx_allocator hooks = books.hooks();
    gtx_open_desc desc = {};
    gtx_asset *asset = nullptr;
    gtx_error error;
    uint64_t held = 0;
    read += bytes.size() - request.from;
    desc.allocator = &hooks;
    if (gtx_stream_open(&request, bytes.data(), bytes.size(), &desc, &asset, &held, &error))
        fail_msg("%s: %s", request.uri, error.message);
    assert_int_equal(gtx_stream_deliver(stream, request.id, asset, held, 0), GTX_OK);
}

void Walk::update(const gtx_stream_view &view)
{
    gtx_error error;
    if (gtx_stream_update(stream, &view, 1, &frame, &error))
        fail_msg("%s", error.message);
    for (uint32_t i = 0; i < frame.request_count; ++i)
        under_way.push_back(frame.requests[i]);
}

/* 90 degrees wide and high, with its eye at p, towards `azimuth` and down. */
gtx_stream_view look(const Vec3d &p, double azimuth, double down)
{
    const double ca = std::cos(azimuth), sa = std::sin(azimuth), ce = std::cos(down),
                 se = std::sin(down);
    const Vec3d right(ca, 0, sa), back(-sa * ce, se, ca * ce), up = cross(back, right);
    gtx_stream_view view = {};
    for (int k = 0; k < 3; ++k) {
        view.view[4 * k] = float(right[k]);
        view.view[4 * k + 1] = float(up[k]);
        view.view[4 * k + 2] = float(back[k]);
        view.origin[k] = p[k];
    }
    view.view[15] = 1;
    view.projection[0] = view.projection[5] = 1;
    view.projection[10] = view.projection[11] = -1;
    view.projection[14] = -0.01f;
    view.viewport_height = 720;
    return view;
}

/* Of the leaves none is shown twice, and each whose middle is in the picture is shown. */
void check_cover(const Plan &plan, const Walk &walk, const gtx_stream_view &view)
{
    Vector<uint32_t> covers(plan.tiles.size(), 0);
    for (uint32_t i = 0; i < walk.frame.draw_count; ++i)
        ++covers[walk.frame.draws[i].tile];
    for (size_t n = 0; n < plan.tiles.size(); ++n) {
        const Tile &tile = plan.tiles[n];
        covers[n] += n ? covers[tile.parent] : 0;
        if (!tile.is_leaf())
            continue;
        const TileFacts facts = read_facts(plan, tile);
        const Vec3d p = (facts.low + facts.high) / 2 -
                        Vec3d(view.origin[0], view.origin[1], view.origin[2]);
        double eye[3] = {0, 0, 0};
        for (int row = 0; row < 3; ++row)
            for (int k = 0; k < 3; ++k)
                eye[row] += double(view.view[4 * k + row]) * p[k];
        assert_true(covers[n] <= 1);
        if (eye[2] < 0 && std::fabs(eye[0]) < -eye[2] && std::fabs(eye[1]) < -eye[2])
            assert_int_equal(covers[n], 1);
    }
}

void in_turn(uint32_t count, void (*job)(uint32_t, void *), void *data, void *)
{
    for (uint32_t i = 0; i < count; ++i)
        job(i, data);
}

/* The most that opening the first bytes takes, with the host's jobs or without. */
uint64_t memory_of(const std::string &bytes, size_t size, decltype(gtx_jobs::run) run)
{
    gtx_prefix prefix;
    Books books;
    const gtx_allocator hooks = books.hooks();
    const gtx_jobs jobs = {run, nullptr};
    gtx_open_desc desc = {};
    gtx_asset *asset = nullptr;
    desc.allocator = &hooks;
    desc.jobs = run ? &jobs : nullptr;
    assert_int_equal(size < bytes.size()
                         ? gtx_open_prefix(bytes.data(), size, &desc, &prefix, &asset, nullptr)
                         : gtx_open_memory(bytes.data(), size, &desc, &asset, nullptr), GTX_OK);
    assert_non_null(asset);
    gtx_close(asset);
    return books.most;
}

const Plan &hills()
{
    static const Plan plan = [] {
        write_file(in_folder("hills.ply"), ply_text(terrain(110)));
        PlanOptions options;
        options.models = {in_folder("hills.ply")};
        options.folder = in_folder("hills");
        options.triangles = 1200;
        return make_world(options);
    }();
    return plan;
}

} // namespace

/* Every tile is what the index tells: its file, its memory, its box. */
static void the_index_is_right(void **)
{
    const Plan &plan = hills();
    const std::string index = read_file(plan.folder + "/" GTX_INDEX_FILE);
    const auto *data = reinterpret_cast<const uint8_t *>(index.data());
    uint32_t count;
    double unit;
    assert_int_equal(gtx_index_check(data, index.size(), &count, &unit, nullptr), GTX_OK);
    assert_int_equal(count, plan.tiles.size());
    Vector<gtx_index_tile> tiles(count);
    for (uint32_t n = 0; n < count; ++n) {
        assert_int_equal(gtx_index_read(data, &tiles[n], n, nullptr), GTX_OK);
        assert_string_equal(tiles[n].name, plan.tiles[n].name.c_str());
        assert_int_equal(tiles[n].parent, plan.tiles[n].parent);
        const std::string bytes = read_file(asset_path(plan, plan.tiles[n]));
        assert_int_equal(tiles[n].whole.bytes, bytes.size());
        assert_true(tiles[n].error > 0 && tiles[n].beginning_error >= tiles[n].error);
        assert_in_range(tiles[n].beginning.bytes, 1, bytes.size() / 2);
        for (const gtx_index_part *part : {&tiles[n].whole, &tiles[n].beginning}) {
            const uint64_t alone = memory_of(bytes, part->bytes, nullptr),
                           jobs = memory_of(bytes, part->bytes, in_turn);
            assert_int_equal(part->memory, std::max(alone, jobs));
            assert_int_equal(part->hash, gtx_hash_bytes(bytes.data(), part->bytes));
        }
    }
}

/* Along a circle, near the ground, looking ahead; answers come three frames late, the last request
 * first. */
static void a_walk_of_600_frames(void **)
{
    const Plan &plan = hills();
    gtx_stream_info info;
    uint64_t all, most = 0, first = 0, drawn = 0;
    {
        Walk walk(plan.folder, 0, 1);
        gtx_stream_get_info(walk.stream, &info);
        all = info.bytes;
    }
    const uint64_t budget = 14000000;
    Walk walk(plan.folder, budget, 2);
    uint32_t complete = 0;
    for (int n = 0; n < 600; ++n) {
        const double turn = n * 2 * 3.14159265 / 600;
        const gtx_stream_view view =
            look({0.7 * std::sin(turn), 0.35, -0.7 * std::cos(turn)}, turn + 1.3, 0.5);
        const bool root = walk.frame.delivered > 0;
        walk.update(view);
        if (root)
            check_cover(plan, walk, view);
        assert_true(walk.books.now <= walk.frame.cpu_bytes);
        assert_in_range(walk.frame.cpu_bytes, 1, budget);
        assert_int_equal(walk.frame.failed + walk.frame.refused, 0);
        if (!first && walk.frame.draw_count)
            first = walk.read;
        most = std::max(most, walk.frame.cpu_bytes);
        drawn += walk.frame.draw_count;
        complete += walk.frame.pending == 0;
        if (n % 3 == 2)
            for (; !walk.under_way.empty(); walk.under_way.pop_back())
                walk.answer(walk.under_way.back());
        assert_in_range(walk.books.most, 1, budget);
    }
    printf("    %zu tiles of %llu bytes: at most %llu bytes resident, %llu read before the first "
           "picture;\n    %.1f tiles a frame, %u of 600 frames complete, %llu read, %llu dropped\n",
           plan.tiles.size(), (unsigned long long)all, (unsigned long long)most,
           (unsigned long long)first, double(drawn) / 600, complete,
           (unsigned long long)walk.frame.delivered, (unsigned long long)walk.frame.released);
    assert_true(plan.tiles.size() > 25);
    assert_true(walk.frame.released > 10 && complete > 60);
    assert_in_range(first, 1, 2000000);
}

/* Octants on the way to a tile may hold nothing else: its name is then longer than it is deep. Far
 * from the origin boxes have all their digits. */
static void clusters_far_apart(void **)
{
    Mesh all;
    for (double x : {3e7, 3e7 + 16, 3e7 + 4096}) {
        const Mesh part = terrain(26);
        const uint32_t first = uint32_t(all.positions.size());
        for (const Vec3d &p : part.positions)
            all.positions.push_back(p * 4 + Vec3d(x, 0, -2e7));
        for (const auto &t : part.triangles)
            all.triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
    write_file(in_folder("far.ply"), ply_text(all));
    PlanOptions options;
    options.models = {in_folder("far.ply")};
    options.folder = in_folder("far");
    options.triangles = 1000;
    const Plan plan = make_world(options);
    assert_true(plan.tiles[1].name.size() > 3);
    Walk walk(plan.folder, 0, 1);
    const gtx_stream_view view = look({3e7, 3, -2e7 + 5}, 0, 0.6);
    for (int n = 0; n < 60; ++n) {
        const bool root = walk.frame.delivered > 0;
        walk.update(view);
        if (root)
            check_cover(plan, walk, view);
        for (; !walk.under_way.empty(); walk.under_way.pop_back())
            walk.answer(walk.under_way.back());
    }
    assert_int_equal(walk.frame.pending, 0);
    assert_true(walk.frame.draw_count >= 3);
}

int main()
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_index_is_right),
        cmocka_unit_test(a_walk_of_600_frames),
        cmocka_unit_test(clusters_far_apart),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
