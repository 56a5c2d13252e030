/* Worlds measured against their source: whole ones, ones with a tile missing, and hostile ones. */
#include "worlds.hpp"

#include "stream/index.h"
#include "world/compare.hpp"

#include "base/hash.h"

#include <geotex/cook.h>

#include <cstring>

using namespace gtx;

namespace {

constexpr uint32_t SIZE = 96;

/* What a comparison returned, and of which file an error is told. */
struct Compared {
    gtx_compare_result result = {};
    gtx_result code = GTX_OK;
    std::string about, message, json;
};

Compared compared(const std::string &world, const std::string &model, double tile_error = 0,
                  const gtx_limits &limits = {})
{
    Compared out;
    gtx_compare_desc desc = {};
    gtx_report report = {};
    desc.size = SIZE;
    desc.levels = 1;
    desc.threads = 2;
    desc.limits = limits;
    try {
        compare_world(world, model.c_str(), tile_error, desc, &out.result, &report, out.about);
        out.json = report.json;
    } catch (...) {
        const gtx_error error = caught_error();
        out.code = error.result;
        out.message = error.message;
    }
    gtx_report_free(&report);
    return out;
}

struct World {
    std::string path, model, index;
    Vector<gtx_index_tile> tiles;
};

void load_index(World &world)
{
    world.index = read_file(world.path + "/" GTX_INDEX_FILE);
    const uint8_t *bytes = reinterpret_cast<const uint8_t *>(world.index.data());
    uint32_t count = 0;
    double unit;
    assert_int_equal(gtx_index_check(bytes, world.index.size(), &count, &unit, nullptr), GTX_OK);
    world.tiles.resize(count);
    for (uint32_t n = 0; n < count; ++n)
        assert_int_equal(gtx_index_read(bytes, &world.tiles[n], n, nullptr), GTX_OK);
}

World make(const char *name, const Mesh &mesh, uint32_t triangles, Sides sides = Sides::AUTO)
{
    World world;
    world.path = in_folder(name);
    world.model = in_folder(name) + ".ply";
    write_file(world.model, ply_text(mesh));
    PlanOptions options;
    options.models = {world.model};
    options.folder = world.path;
    options.triangles = triangles;
    options.sides = sides;
    make_world(options);
    load_index(world);
    return world;
}

void write_index(const World &world, const Vector<gtx_index_tile> &tiles)
{
    std::string bytes(GTX_INDEX_HEADER + tiles.size() * GTX_INDEX_RECORD, 0);
    gtx_index_write(tiles.data(), uint32_t(tiles.size()), 1,
                    reinterpret_cast<uint8_t *>(&bytes[0]));
    write_file(world.path + "/" GTX_INDEX_FILE, bytes);
}

bool is_leaf(const World &world, uint32_t number)
{
    for (uint32_t n = 1; n < world.tiles.size(); ++n)
        if (world.tiles[n].parent == number)
            return false;
    return true;
}

/* The last of the leaves. */
uint32_t a_leaf(const World &world)
{
    uint32_t n = uint32_t(world.tiles.size()) - 1;
    assert_true(is_leaf(world, n) && n > 0);
    return n;
}

World round_world()
{
    static const World world = make("ball", ball(36), 2000);
    return world;
}

} // namespace

/* Of leaves, and of coarser tiles, which are measured as such. */
static void a_whole_world_has_no_hole(void **)
{
    const World worlds[] = {round_world(), make("terrain", terrain(60), 2000),
                            make("front", terrain(60), 2000, Sides::FRONT)};
    for (const World &world : worlds) {
        uint32_t leaves = 0;
        for (uint32_t n = 0; n < world.tiles.size(); ++n)
            leaves += is_leaf(world, n);
        assert_true(leaves >= 4);
        const Compared whole = compared(world.path, world.model);
        if (whole.code)
            fail_msg("%s: %s", whole.about.c_str(), whole.message.c_str());
        print_message("# %u leaves: %g of %g are holes, IoU %.4f, RMS %.2e, seams %.2f steps\n",
                      leaves, double(whole.result.hole_pixels),
                      double(whole.result.surface_pixels), whole.result.silhouette_iou,
                      whole.result.forward_rms, whole.result.seam_p99_steps);
        assert_true(whole.result.surface_pixels > 20000);
        assert_int_equal(whole.result.hole_pixels, 0);
        assert_int_equal(whole.result.wall_pixels, 0);
        assert_true(whole.result.silhouette_iou > 0.99 && whole.result.forward_rms < 2e-4);
        assert_non_null(strstr(whole.json.c_str(), "\"details\""));

        const Compared coarse = compared(world.path, world.model, 1e9); /* the root */
        assert_int_equal(coarse.code, GTX_OK);
        assert_true(coarse.result.forward_rms > 2 * whole.result.forward_rms);
        const Compared mixed = compared(world.path, world.model,
                                        double(world.tiles[world.tiles.size() / 2].error));
        assert_int_equal(mixed.code, GTX_OK);
        assert_true(mixed.result.forward_rms <= coarse.result.forward_rms);
        assert_int_equal(mixed.result.hole_pixels, 0);
    }
}

/* A world of one tile has the figures of that tile's asset. */
static void one_tile_is_measured_as_an_asset(void **)
{
    const World world = make("single", ball(30), 20000);
    assert_int_equal(world.tiles.size(), 1);
    const Compared tile = compared(world.path, world.model);
    gtx_compare_desc desc = {};
    desc.size = SIZE;
    desc.levels = desc.any_model = 1;
    gtx_compare_result asset;
    gtx_report report = {};
    gtx_error error;
    if (gtx_compare_files((world.path + "/tiles/r.gtx").c_str(), world.model.c_str(), &desc,
                          &asset, &report, &error))
        fail_msg("%s", error.message);
    assert_string_equal(tile.json.c_str(), report.json);
    gtx_report_free(&report);
    assert_memory_equal(&tile.result, &asset, sizeof asset);
}

static void a_missing_tile_is_a_hole(void **)
{
    const World world = round_world();
    const Compared whole = compared(world.path, world.model);
    Vector<gtx_index_tile> fewer = world.tiles;
    gtx_index_tile &lost = fewer[a_leaf(world)];
    lost.whole = lost.beginning = {};
    lost.beginning_error = 0;
    write_index(world, fewer);
    const Compared without = compared(world.path, world.model);
    assert_int_equal(without.code, GTX_OK);
    print_message("# %g hole pixels\n", double(without.result.hole_pixels));
    assert_true(without.result.hole_pixels > without.result.surface_pixels / 100);
    assert_int_equal(without.result.surface_pixels, whole.result.surface_pixels);
    assert_true(without.result.forward_rms > 4 * whole.result.forward_rms);

    for (gtx_index_tile &tile : fewer) {
        tile.whole = tile.beginning = {};
        tile.beginning_error = 0;
    }
    write_index(world, fewer);
    const Compared nothing = compared(world.path, world.model);
    assert_int_equal(nothing.code, GTX_ERROR_EMPTY);
    assert_string_equal(nothing.message.c_str(), "the world shows nothing");
    write_file(world.path + "/" GTX_INDEX_FILE, world.index);
}

static void refuse(const World &world, gtx_result code, const std::string &about)
{
    const Compared is = compared(world.path, world.model);
    if (is.code != code)
        fail_msg("%d, not %d: %s", is.code, code, is.message.c_str());
    assert_string_equal(is.about.c_str(), (world.path + "/" + about).c_str());
}

static void hostile_worlds_are_refused(void **)
{
    const World world = round_world();
    const std::string index = world.path + "/" GTX_INDEX_FILE;
    for (size_t size = 0; size < world.index.size(); size += size < 200 ? 1 : 97) {
        write_file(index, world.index.substr(0, size));
        refuse(world, size < 12 ? GTX_ERROR_NOT_GTX : GTX_ERROR_TRUNCATED, GTX_INDEX_FILE);
    }
    for (size_t at = 40; at < world.index.size(); at += 53) {
        std::string bytes = world.index;
        bytes[at] = char(bytes[at] ^ 4);
        write_file(index, bytes);
        refuse(world, GTX_ERROR_CORRUPT, GTX_INDEX_FILE);
    }
    write_file(index, world.index);

    const uint32_t leaf = a_leaf(world);
    const std::string name = std::string("tiles/") + world.tiles[leaf].name + ".gtx";
    const std::string tile = world.path + "/" + name, whole = read_file(tile);
    std::string wrong = whole;
    wrong[wrong.size() / 2] = char(wrong[wrong.size() / 2] ^ 1);
    write_file(tile, wrong);
    refuse(world, GTX_ERROR_INPUT, name);
    Vector<gtx_index_tile> lying = world.tiles; /* the index agrees with what is no asset */
    lying[leaf].whole.hash = gtx_hash_bytes(wrong.data(), wrong.size());
    write_index(world, lying);
    refuse(world, GTX_ERROR_CORRUPT, name);
    write_file(index, world.index);
    write_file(tile, whole.substr(0, whole.size() / 2));
    refuse(world, GTX_ERROR_INPUT, name);
    fs::remove(tile);
    refuse(world, GTX_ERROR_READ, name);
    write_file(tile, whole);
    assert_int_equal(compared(world.path, world.model).code, GTX_OK);
}

/* What tiles and casters take counts: where it is too much, LIMIT says so. */
static void memory_is_limited(void **)
{
    const World world = round_world();
    int refused = 0;
    for (uint64_t memory = 100000; memory < uint64_t(1) << 32; memory *= 3) {
        gtx_limits limits = {};
        limits.memory = memory;
        const Compared is = compared(world.path, world.model, 0, limits);
        if (is.code == GTX_OK)
            break;
        assert_int_equal(is.code, GTX_ERROR_LIMIT);
        ++refused;
    }
    assert_true(refused > 3);
}

int main()
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_whole_world_has_no_hole),
        cmocka_unit_test(one_tile_is_measured_as_an_asset),
        cmocka_unit_test(a_missing_tile_is_a_hole),
        cmocka_unit_test(hostile_worlds_are_refused),
        cmocka_unit_test(memory_is_limited),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
