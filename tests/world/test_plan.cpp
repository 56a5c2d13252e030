/* plan.json and facts as others may have written them: what is no plan is refused with a sentence,
 * and nothing is read or written for it. */
#include "world/worlds.hpp"

#include <algorithm>
#include <string>

using namespace gtx;

/* A world of one leaf, and what its files say. */
static std::string world, plan_text;

static int make_plan(void **state)
{
    if (make_folder(state))
        return -1;
    write_file(in_folder("ball.ply"), ply_text(ball(12)));
    PlanOptions options;
    options.models = {in_folder("ball.ply")};
    options.folder = world = in_folder("world");
    make_world(options);
    plan_text = read_file(plan_path(world));
    return 0;
}

/* The text with what stands after "name": replaced up to the end of its line. */
static std::string changed(const std::string &text, const std::string &name,
                           const std::string &value)
{
    const size_t at = text.find('"' + name + "\":") + name.size() + 3;
    assert_true(at >= name.size() + 3 && at < text.size());
    const size_t end = text.find_first_of(",}\n", at);
    return text.substr(0, at) + value + text.substr(end);
}

static gtx_result read_result(const std::string &text)
{
    Task task(1, nullptr, nullptr, {"read"}, {1});
    write_file(plan_path(world), text);
    try {
        read_plan(world, task);
    } catch (const Error &error) {
        return error.result;
    }
    return GTX_OK;
}

static void numbers_of_a_plan_are_whole(void **)
{
    assert_int_equal(read_result(plan_text), GTX_OK);
    for (const char *name : {"triangles", "dropped", "tile_triangles", "memory", "work", "depth",
                             "parent"})
        for (const char *value : {"-1", "-1e300", "1e300", "0.5", "true", "\"1\"", "null", "[]"}) {
            if (read_result(changed(plan_text, name, value)) != GTX_ERROR_INPUT)
                fail_msg("a plan of %s %s was read", name, value);
        }
    for (const char *value : {"1e300", "-5000", "0.5", "\"1\"", "[]"})
        assert_int_equal(read_result(changed(plan_text, "exponent", value)), GTX_ERROR_INPUT);
    for (const char *value : {"0", "-1", "null", "1e999"})
        assert_int_equal(read_result(changed(plan_text, "unit", value)), GTX_ERROR_INPUT);
    const size_t after = plan_text.find("\"doubles\":");
    for (const char *value : {"null", "[]", "\"1\""})
        assert_int_equal(read_result(plan_text.substr(0, after) + "\"latitude\": " + value + "," +
                                     plan_text.substr(after)), GTX_ERROR_INPUT);
}

static void a_lattice_stays_in_its_numbers(void **)
{
    const size_t at = plan_text.find('[', plan_text.find("\"low\"")) + 1;
    for (const char *value : {"1e300,", "-9e18,", "0.25,", "null,", "2000000,"})
        assert_int_equal(read_result(plan_text.substr(0, at) + value + plan_text.substr(at)),
                         GTX_ERROR_INPUT);
    Lattice lattice;
    lattice.exponent = -1000;
    assert_int_equal(lattice.place(Vec3d(1e300, 1e300, 1e300)), UINT64_MAX >> 1);
    assert_int_equal(lattice.place(Vec3d(-1e300, -1e300, -1e300)), 0);
}

static void names_hold_no_paths(void **)
{
    for (const char *name : {"\"../r\"", "\"\"", "\"r8\"", "\"x\"", "\"r/\"", "7"}) {
        const size_t at = plan_text.find("\"tiles\"");
        const std::string tiles = changed(plan_text.substr(at), "name", name);
        assert_int_equal(read_result(plan_text.substr(0, at) + tiles), GTX_ERROR_INPUT);
    }
}

static void torn_plans_are_refused(void **)
{
    for (size_t size = 0; size + 2 < plan_text.size(); size += 7)
        assert_int_equal(read_result(plan_text.substr(0, size)), GTX_ERROR_INPUT);
    assert_int_equal(read_result(std::string(100000, '[')), GTX_ERROR_INPUT);
}

static void facts_of_numbers_that_are_none_are_refused(void **)
{
    assert_int_equal(read_result(plan_text), GTX_OK);
    Task task(1, nullptr, nullptr, {"read"}, {1});
    const Plan plan = read_plan(world, task);
    const std::string path = facts_path(plan, plan.tiles[0]), text = read_file(path);
    for (const char *name : {"triangles", "lod_triangles", "size"})
        for (const char *value : {"-1", "1e300", "0.5", "{}"}) {
            write_file(path, changed(text, name, value));
            gtx_result result = GTX_OK;
            try {
                read_facts(plan, plan.tiles[0]);
            } catch (const Error &error) {
                result = error.result;
            }
            assert_int_equal(result, GTX_ERROR_INPUT);
        }
    write_file(path, text);
    assert_int_equal(read_facts(plan, plan.tiles[0]).triangles, plan.total);
}

/* What a plan says of the mesh in a file. */
static bool is_closed(const Mesh &mesh, Sides sides = Sides::AUTO)
{
    PlanOptions options;
    options.sides = sides;
    Task task(1, nullptr, nullptr, {"read"}, {1});
    options.models = {in_folder("surface.ply")};
    options.folder = in_folder("surface");
    write_file(options.models[0], ply_text(mesh));
    plan_world(options, task);
    return read_plan(options.folder, task).closed;
}

static void a_plan_knows_closed_surfaces(void **)
{
    const Mesh whole = ball(12);
    assert_true(is_closed(whole));
    assert_false(is_closed(terrain(12)));
    assert_true(is_closed(terrain(12), Sides::FRONT));
    assert_false(is_closed(whole, Sides::BOTH));
    Mesh mesh = whole;
    std::swap(mesh.triangles[3][0], mesh.triangles[3][1]);
    assert_false(is_closed(mesh));
    mesh = whole;
    mesh.triangles.pop_back();
    assert_false(is_closed(mesh));
    mesh.triangles.insert(mesh.triangles.begin(), whole.triangles.back());
    assert_true(is_closed(mesh));
    for (auto &t : mesh.triangles)
        std::swap(t[0], t[1]);
    assert_false(is_closed(mesh)); /* inside out */
}

/* A plan says which tiles an inner one waits for: no fewer than those whose surfaces touch it; and
 * not all. */
static void neighbours_are_known_before(void **)
{
    write_file(in_folder("terrain.ply"), ply_text(terrain(90)));
    PlanOptions options;
    options.models = {in_folder("terrain.ply")};
    options.folder = in_folder("wide");
    options.triangles = 1000;
    const Plan plan = make_world(options);
    const std::string build = read_file(options.folder + "/build.ninja");
    size_t touching = 0, known = 0, all = 0;
    for (const Tile &tile : plan.tiles) {
        const CellHeader box = CellReader(cell_path(plan, tile)).header();
        for (int k = 0; k < 3; ++k)
            assert_true(tile.low[k] <= box.low[k] && box.high[k] <= tile.high[k]);
        if (tile.is_leaf())
            continue;
        const Vector<const Tile *> near = plan.low_neighbours(tile);
        const size_t at = build.find("build work/facts/" + tile.name + ".json ");
        const std::string line = build.substr(at, build.find('\n', at) - at) + " ";
        known += near.size();
        for (const Tile &other : plan.tiles) {
            const bool low = other.depth == tile.depth + 1 ||
                             (other.is_leaf() && other.depth <= tile.depth);
            if (!low || &plan.tiles[other.parent] == &tile)
                continue;
            ++all;
            if (!CellReader(low_path(plan, other)).header().touches(box))
                continue;
            ++touching;
            assert_true(std::count(near.begin(), near.end(), &other) == 1);
            assert_true(line.find(" work/facts/" + other.name + ".json ") != line.npos);
        }
    }
    assert_true(touching > 10 && known < 3 * touching && 2 * known < all);
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(numbers_of_a_plan_are_whole),
        cmocka_unit_test(a_lattice_stays_in_its_numbers),
        cmocka_unit_test(names_hold_no_paths),
        cmocka_unit_test(torn_plans_are_refused),
        cmocka_unit_test(facts_of_numbers_that_are_none_are_refused),
        cmocka_unit_test(a_plan_knows_closed_surfaces),
        cmocka_unit_test(neighbours_are_known_before),
    };
    return cmocka_run_group_tests(tests, make_plan, remove_folder);
}
