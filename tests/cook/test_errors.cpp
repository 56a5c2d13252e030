/* A failed call of cook.h says no number that nobody has set: every field of the error is
 * written. */
#include "cook/build.hpp"

static gtx_error error;

static gtx_error *noisy()
{
    memset(&error, 0xa5, sizeof error);
    return &error;
}

static void is_whole(const char *call, gtx_result result, gtx_result wanted)
{
    if (result != wanted || error.result != wanted)
        fail_msg("%s: %d and %d, not %d", call, result, error.result, wanted);
    const bool broken = wanted == GTX_ERROR_NOT_GTX;
    if (broken != (error.rule > 0 && error.rule < 999) || broken != (error.rule_name != nullptr) ||
        error.offset || error.limit)
        fail_msg("%s: rule %u", call, error.rule);
    const void *end = memchr(error.message, 0, sizeof error.message);
    if (!end || end == error.message || strchr(error.message, char(0xa5)))
        fail_msg("%s: '%.*s'", call, int(sizeof error.message), error.message);
}

#define FAILS(wanted, call) is_whole(#call, call, GTX_ERROR_##wanted)

static void every_field_is_set(void **)
{
    const std::string obj = in_folder("e.obj"), bad = in_folder("bad.obj");
    const std::string out = in_folder("e.gtx");
    const char *model = obj.c_str(), *path = out.c_str();
    write_file(obj, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    write_file(bad, "v 0 0\n");
    gtx_cook_desc odd = {}, strict = {}, lost = {};
    odd.reserved[0] = 1;
    strict.strict = 1;
    lost.charts_ply = "/nowhere/a.ply";
    gtx_asset *asset = nullptr;
    FAILS(ARGUMENT, gtx_cook_file(nullptr, path, nullptr, nullptr, noisy()));
    FAILS(ARGUMENT, gtx_cook_file(model, model, nullptr, nullptr, noisy()));
    FAILS(NOT_ZEROED, gtx_cook_file(model, path, &odd, nullptr, noisy()));
    FAILS(READ, gtx_cook_file("/nowhere/a.obj", path, nullptr, nullptr, noisy()));
    FAILS(INPUT, gtx_cook_file(bad.c_str(), path, nullptr, nullptr, noisy()));
    FAILS(INPUT, gtx_cook_file(model, path, &strict, nullptr, noisy()));
    FAILS(WRITE, gtx_cook_file(model, "/nowhere/a.gtx", nullptr, nullptr, noisy()));
    FAILS(WRITE, gtx_cook_file(model, path, &lost, nullptr, noisy()));
    FAILS(EMPTY, gtx_cook_memory("", 0, "a.obj", nullptr, &asset, nullptr, noisy()));
    FAILS(UNSUPPORTED, gtx_cook_memory("x", 1, "a", nullptr, &asset, nullptr, noisy()));
    FAILS(ARGUMENT, gtx_cook_lod_meshes(nullptr, nullptr, &asset, noisy()));
    FAILS(ARGUMENT, gtx_compare_files(nullptr, model, nullptr, nullptr, nullptr, noisy()));
    FAILS(READ, gtx_compare_files("/nowhere", model, nullptr, nullptr, nullptr, noisy()));
    FAILS(NOT_GTX, gtx_compare_files(model, model, nullptr, nullptr, nullptr, noisy()));

    gtx_height_grid grid = {};
    gtx_height_grid_desc marked = {};
    marked.reserved[0] = 1;
    FAILS(READ, gtx_height_grid_read("/nowhere/a.irap", nullptr, &grid, noisy()));
    FAILS(NOT_ZEROED, gtx_height_grid_read(model, &marked, &grid, noisy()));
    FAILS(ARGUMENT, gtx_horizons(nullptr, 0, nullptr, &asset, nullptr, noisy()));
    FAILS(ARGUMENT, gtx_horizons(&grid, 1, nullptr, &asset, nullptr, noisy()));
    assert_false(fs::exists(out));
}

/* Who is told of the sources may refuse them, before anything is made. */
static void sources_may_be_refused(void **)
{
    struct Told {
        std::vector<std::string> paths;
        gtx_result answer;
    } told = {{}, GTX_ERROR_INPUT};
    const std::string obj = in_folder("s.obj"), out = in_folder("s.gtx");
    write_file(in_folder("s.mtl"), "newmtl m\nKd 1 0 0\n");
    write_file(obj, "mtllib s.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    gtx_cook_desc desc = {};
    desc.sources_user = &told;
    desc.sources_fn = [](const char *const *paths, size_t count, void *user, gtx_error *) {
        auto *t = static_cast<Told *>(user);
        t->paths.assign(paths, paths + count);
        return t->answer;
    };
    Cooked cooked = try_cook(obj, out, desc);
    assert_int_equal(cooked.result, GTX_ERROR_INPUT);
    assert_string_equal(cooked.message.c_str(), "a file that the model is read from was refused");
    assert_int_equal(told.paths.size(), 2);
    assert_true(told.paths[0] == obj && told.paths[1] == in_folder("s.mtl"));
    assert_false(fs::exists(out));
    told.answer = GTX_OK;
    cook(obj, out, desc);
    desc.charts_ply = told.paths[1].c_str();
    assert_int_equal(try_cook(obj, out, desc).result, GTX_ERROR_ARGUMENT);
    desc.charts_ply = out.c_str();
    assert_int_equal(try_cook(obj, out, desc).result, GTX_ERROR_ARGUMENT);
    assert_int_equal(fs::file_size(in_folder("s.mtl")), strlen("newmtl m\nKd 1 0 0\n"));
}

int main()
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_field_is_set),
                                       cmocka_unit_test(sources_may_be_refused)};
    return cmocka_run_group_tests(tests, make_ball_folder, remove_folder);
}
