/* Plans, cell files, simplified surfaces, and the tileset. */
#include "worlds.hpp"

#include "measure/cast.hpp"

#include <algorithm>
#include <map>

#include <nlohmann/json.hpp>

using namespace gtx;
using nlohmann::json;

static Vec3d some_point(uint64_t &state, double size)
{
    double x[3];
    for (double &k : x) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        k = size * (double(state >> 11) / 9007199254740992.0 - 0.3);
    }
    return {x[0], x[1], x[2]};
}

static void cells_do_not_depend_on_the_order(void **)
{
    constexpr size_t COUNT = 1500000; /* more than there may be cells */
    Vector<Vec3d> points;
    uint64_t state = 1;
    for (size_t i = 0; i < COUNT; ++i)
        points.push_back(some_point(state, i % 3 ? 1 : 1e5));
    points[7] = {};
    CellCounts forward, backward;
    for (size_t i = 0; i < COUNT; ++i) {
        forward.add(points[i]);
        backward.add(points[COUNT - 1 - i]);
    }
    Lattice a, b;
    const Vector<CountedCell> at = forward.finish(a), back = backward.finish(b);
    assert_int_equal(a.exponent, b.exponent);
    assert_int_equal(at.size(), back.size());
    assert_true(at.size() > 1000 && at.size() <= size_t(1) << 20);
    uint64_t sum = 0;
    for (size_t i = 0; i < at.size(); ++i) {
        assert_true(at[i].place == back[i].place && at[i].count == back[i].count);
        sum += at[i].count;
    }
    assert_int_equal(sum, COUNT);
    std::map<uint64_t, uint64_t> again;
    for (const Vec3d &p : points)
        ++again[a.place(p)];
    for (const CountedCell &cell : at)
        assert_int_equal(again[cell.place], cell.count);
}

static void tiles_hold_every_cell_once(void **)
{
    Vector<CountedCell> cells;
    uint64_t state = 3, total = 0;
    for (uint64_t x = 0; x < 40; ++x)
        for (uint64_t y = 0; y < 40; ++y) {
            state = state * 6364136223846793005u + 1;
            cells.push_back({morton(x, y, (x * y) % 5), 1 + (state >> 60) * (x > 30)});
            total += cells.back().count;
        }
    std::sort(cells.begin(), cells.end(),
              [](const CountedCell &a, const CountedCell &b) { return a.place < b.place; });
    const Vector<Tile> tiles = make_tiles(cells, 50);
    uint64_t held = 0;
    for (const CountedCell &cell : cells) {
        size_t owners = 0;
        for (const Tile &tile : tiles)
            owners += tile.is_leaf() && cell.place >= tile.first && cell.place < tile.end;
        assert_int_equal(owners, 1);
    }
    for (size_t n = 0; n < tiles.size(); ++n) {
        assert_true(tiles[n].triangles <= 50);
        held += tiles[n].is_leaf() ? tiles[n].triangles : 0;
        assert_true(n == 0 || tiles[n].depth >= tiles[n - 1].depth);
        assert_true(tiles[n].is_leaf() || tiles[n].children.size() > 1);
    }
    assert_int_equal(held, total);
    cells.assign(1, {0, 51});
    try {
        make_tiles(cells, 50);
        fail_msg("a cell of more triangles than a tile may have was planned");
    } catch (const Error &e) {
        assert_int_equal(e.result, GTX_ERROR_LIMIT);
    }
}

/* Hills with a colour, normals of their own, and 16 leaves or so. */
static const Plan &colored_world()
{
    static Plan plan;
    if (!plan.tiles.empty())
        return plan;
    const Mesh mesh = terrain(140);
    TileSurface s;
    s.traits = {true, true, true};
    s.positions = mesh.positions;
    s.normals.resize(s.positions.size());
    for (size_t c = 0; c < mesh.normals.size(); ++c)
        s.normals[mesh.triangles[c / 3][c % 3]] = mesh.normals[c];
    for (const Vec3d &p : mesh.positions)
        s.colors.push_back({uint8_t(128 + 120 * std::sin(2 * p.x)), uint8_t(128 + 400 * p.y), 90,
                            255});
    s.triangles = mesh.triangles;
    write_file(in_folder("colored.ply"), ply_of(s));
    PlanOptions options;
    options.models = {in_folder("colored.ply")};
    options.folder = in_folder("colored");
    options.triangles = 4000;
    options.glb = true;
    plan = make_world(options);
    return plan;
}

/* Border vertices of a low surface are the source's own; no triangle leaves its bounds. */
static void borders_stay_as_they_are(void **)
{
    const Plan &plan = colored_world();
    Task task(1, nullptr, nullptr);
    for (const Tile &tile : plan.tiles) {
        if (!tile.depth)
            continue;
        const TileSurface from = load_surface(plan, tile, task);
        const TileSurface low = load_cell(low_path(plan, tile));
        assert_true(low.own < from.own);
        std::map<std::pair<uint32_t, uint32_t>, int> sides;
        for (size_t t = 0; t < from.own; ++t)
            for (size_t k = 0; k < 3; ++k) {
                const uint32_t a = from.place[from.triangles[t][k]];
                const uint32_t b = from.place[from.triangles[t][(k + 1) % 3]];
                ++sides[{std::min(a, b), std::max(a, b)}];
            }
        auto key = [](const Vec3d &p) { return std::array<double, 3>{p.x, p.y, p.z}; };
        std::map<std::array<double, 3>, int> left;
        for (const Vec3d &p : low.positions)
            left[key(p)] = 1;
        size_t border = 0;
        for (const auto &[side, count] : sides) {
            if (count != 1)
                continue;
            ++border;
            assert_int_equal(left.count(key(from.positions[side.first])), 1);
            assert_int_equal(left.count(key(from.positions[side.second])), 1);
        }
        assert_true(border > 50);
    }
}

/* Where two leaves show the same surface, they show it alike. */
static void normals_and_colors_go_on_across_borders(void **)
{
    const Plan &plan = colored_world();
    Task task(2, nullptr, nullptr);
    const Mesh source = import_mesh(in_folder("colored.ply"), task);
    const Extent extent = extent_of(source);
    const View view = comparison_views(extent, 300)[16]; /* from above */
    struct Seen {
        float depth = INFINITY;
        Fragment fragment;
    };
    Vector<Seen> seen(size_t(view.size) * view.size);
    size_t shared = 0;
    double turn = 0, color = 0, turns = 0, colors = 0;
    for (const Tile &tile : plan.tiles) {
        if (!tile.is_leaf())
            continue;
        gtx_asset *asset = nullptr;
        gtx_error error;
        assert_int_equal(gtx_open_file(asset_path(plan, tile).c_str(), nullptr, &asset, &error), 0);
        {
            const AssetView shown(asset, 0);
            Vector<ViewHit> hits;
            Vector<Crossing> crossings;
            for (uint32_t j = 0; j < view.size; ++j) {
                shown.cast_row(view, j, hits, crossings);
                for (uint32_t i = 0; i < view.size; ++i) {
                    if (hits[i].patch == NO_HIT)
                        continue;
                    Seen &to = seen[size_t(j) * view.size + i];
                    const Fragment fragment = shown.fragment(hits[i], view);
                    if (std::fabs(to.depth - hits[i].t) < 0.002 * extent.diagonal) {
                        ++shared;
                        const double angle = std::acos(std::clamp(
                            dot(to.fragment.normal, fragment.normal), -1., 1.)) * 180 / M_PI;
                        turn = std::max(turn, angle);
                        turns += angle;
                        for (int k = 0; k < 3; ++k) {
                            const double off = std::fabs(to.fragment.color[k] - fragment.color[k]);
                            color = std::max(color, off);
                            colors += off / 3;
                        }
                    }
                    to = {hits[i].t, fragment};
                }
            }
        }
        gtx_close(asset);
    }
    printf("    %zu shared pixels: normals %.2f degrees at most, %.2f in the mean; colours %.1f, "
           "%.2f of 255\n", shared, turn, turns / double(shared), color, colors / double(shared));
    assert_true(shared > 300);
    assert_true(turn < 3 && turns < 0.6 * double(shared));
    assert_true(color < 4 && colors < 0.3 * double(shared));
}

static bool is_inside(const json &child, const json &parent)
{
    bool inside = true;
    const json &a = child["boundingVolume"]["box"], &b = parent["boundingVolume"]["box"];
    for (size_t k = 0; k < 3; ++k)
        inside = inside && std::fabs(double(a[k]) - double(b[k])) + double(a[3 + 4 * k]) <=
                               double(b[3 + 4 * k]) * (1 + 1e-6) + 1e-9;
    return inside;
}

static size_t check_tile(const json &tile)
{
    size_t count = 1;
    const std::string content = tile["content"]["uri"];
    assert_true(fs::exists(in_folder("colored") + "/" + content));
    assert_true(content.substr(content.size() - 4) == ".glb");
    Task task(1, nullptr, nullptr);
    const Mesh mesh = import_mesh(in_folder("colored") + "/" + content, task);
    const json &box = tile["boundingVolume"]["box"];
    for (const Vec3d &p : mesh.positions) { /* +Z is up in the box */
        const double at[3] = {p.x, -p.z, p.y};
        for (size_t k = 0; k < 3; ++k)
            assert_true(std::fabs(at[k] - double(box[k])) <= double(box[3 + 4 * k]) + 1e-5);
    }
    for (const json &child : tile.value("children", json::array())) {
        assert_true(is_inside(child, tile));
        assert_true(child["geometricError"] <= tile["geometricError"]);
        count += check_tile(child);
    }
    return count;
}

static void the_tileset_is_what_lies_there(void **)
{
    const Plan &plan = colored_world();
    const json set = json::parse(read_file(in_folder("colored") + "/tileset.json"));
    assert_true(set["asset"]["version"] == "1.1");
    assert_true(set["root"]["refine"] == "REPLACE");
    assert_true(set["geometricError"] > set["root"]["geometricError"]);
    assert_int_equal(check_tile(set["root"]), plan.tiles.size());
    for (const Tile &tile : plan.tiles)
        assert_true(CellReader(cell_path(plan, tile)).header().count <= plan.triangles);
}

/* Where borders take more than their share, merging goes on to the tile's number; what a worker
 * that was killed on the way left is not taken for the result. */
static void merged_tiles_are_as_small_as_planned(void **)
{
    Plan plan = colored_world();
    fs::copy(plan.folder, in_folder("smaller"), fs::copy_options::recursive);
    plan.folder = in_folder("smaller");
    plan.triangles = 1000;
    write_plan(plan);
    Task task(1, nullptr, nullptr, {"read", "cook", "simplify"}, {1, 1, 1});
    const std::string path = cell_path(plan, plan.tiles[0]);
    const CellHeader before = CellReader(path).header();
    assert_true(before.count > 1000);
    assert_false(merge_tile(plan.folder, "r", task).unchanged);
    const CellHeader after = CellReader(path).header();
    assert_true(after.count <= 1000 && after.deviation > before.deviation);
    assert_true(merge_tile(plan.folder, "r", task).unchanged);
    CellWriter halfway(low_traits(plan.traits));
    write_whole(path, halfway.finish());
    assert_false(merge_tile(plan.folder, "r", task).unchanged);
    assert_int_equal(CellReader(path).header().hash, after.hash);
}

/* A leaf of nothing but points and lines has no asset, and the world goes on without it. */
static void a_tile_may_be_empty(void **)
{
    Mesh mesh = terrain(24);
    for (uint32_t k = 0; k < 990; ++k) {
        mesh.positions.push_back({50 + 0.001 * k, 50, 50});
        const uint32_t last = uint32_t(mesh.positions.size() - 1);
        mesh.triangles.push_back({last, last, last});
    }
    write_file(in_folder("lines.ply"), ply_text(mesh));
    PlanOptions options;
    options.models = {in_folder("lines.ply")};
    options.folder = in_folder("lines");
    options.triangles = 1000;
    const Plan plan = make_world(options);
    size_t empty = 0;
    for (const Tile &tile : plan.tiles)
        empty += read_facts(plan, tile).empty;
    assert_int_equal(empty, 1);
    const json set = json::parse(read_file(in_folder("lines") + "/tileset.json"));
    assert_true(set["root"].contains("content"));
}

/* Grids, folders, several models; +Z up; metres. */
static void inputs_of_every_kind(void **)
{
    fs::create_directories(in_folder("inputs/below"));
    write_file(in_folder("inputs/b.ply"), ply_text(terrain(10)));
    write_file(in_folder("inputs/below/a.obj"), "v 0 0 5\nv 1 0 5\nv 0 1 5\nf 1 2 3\n");
    write_file(in_folder("inputs/c.irap"), "-996 3 1 1\n0 1 0 2\n2 0 0 0\n0 0 0 0 0 0 0\n"
                                           "1 2 3 4 5 9999900.000\n");
    PlanOptions options;
    options.models = {in_folder("inputs")};
    options.folder = in_folder("mixed");
    options.z_up = true;
    Task task(1, nullptr, nullptr, {"read", "cook", "simplify"}, {1, 1, 1});
    plan_world(options, task);
    const Plan plan = read_plan(options.folder, task);
    assert_int_equal(plan.inputs.size(), 3);
    assert_int_equal(plan.total, 200 + 1 + 3);
    Vec3d high(-INFINITY, -INFINITY, -INFINITY);
    read_inputs(plan, task, [&](const Corners3 &corners) {
        for (const Corner &c : corners)
            for (int k = 0; k < 3; ++k)
                high[k] = std::max(high[k], c.position[k]);
    });
    assert_true(high.y == 5); /* of the grid, which is not turned, and of the model, which is */
}

int main()
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cells_do_not_depend_on_the_order),
        cmocka_unit_test(tiles_hold_every_cell_once),
        cmocka_unit_test(borders_stay_as_they_are),
        cmocka_unit_test(normals_and_colors_go_on_across_borders),
        cmocka_unit_test(the_tileset_is_what_lies_there),
        cmocka_unit_test(merged_tiles_are_as_small_as_planned),
        cmocka_unit_test(a_tile_may_be_empty),
        cmocka_unit_test(inputs_of_every_kind),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
