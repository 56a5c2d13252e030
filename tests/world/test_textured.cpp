/* Worlds of textured models: colours at every level, across the borders of tiles, and the same
 * bytes whoever cooks. */
#include "world/worlds.hpp"

#include "measure/cast.hpp"

#include <algorithm>
#include <map>

using namespace gtx;

/* What the texture shows at a point of the terrain, of 255. */
static Vec3d shown(double x, double z)
{
    return {128 + 100 * std::sin(3 * x) * std::cos(2 * z), 128 + 90 * std::cos(4 * z + x),
            128 + 60 * std::sin(2 * x - 3 * z)};
}

/* Targa, rows from the top: u along x, v = 0 at z = 1. */
static std::string image(unsigned side)
{
    std::string out(18, 0);
    out[2] = 2;
    out[12] = out[14] = char(side & 255);
    out[13] = out[15] = char(side >> 8);
    out[16] = 24;
    out[17] = 0x20;
    for (unsigned j = 0; j < side; ++j)
        for (unsigned i = 0; i < side; ++i) {
            const Vec3d c = shown(2 * (i + 0.5) / side - 1, 2 * (j + 0.5) / side - 1);
            out += {char(uint8_t(c.z + 0.5)), char(uint8_t(c.y + 0.5)), char(uint8_t(c.x + 0.5))};
        }
    return out;
}

static void write_model(const std::string &path, const Mesh &mesh)
{
    std::string obj = "mtllib hills.mtl\nusemtl hills\n";
    char line[128];
    for (const Vec3d &p : mesh.positions) {
        snprintf(line, sizeof line, "v %.9g %.9g %.9g\nvt %.9g %.9g\n", p.x, p.y, p.z,
                 (p.x + 1) / 2, (1 - p.z) / 2);
        obj += line;
    }
    for (const auto &t : mesh.triangles) {
        snprintf(line, sizeof line, "f %u/%u %u/%u %u/%u\n", t[0] + 1, t[0] + 1, t[1] + 1,
                 t[1] + 1, t[2] + 1, t[2] + 1);
        obj += line;
    }
    write_file(path, obj);
}

static const Plan &textured_world()
{
    static Plan plan;
    if (!plan.tiles.empty())
        return plan;
    write_file(in_folder("hills.tga"), image(512));
    write_file(in_folder("hills.mtl"), "newmtl hills\nKd 1 1 1\nmap_Kd hills.tga\n");
    write_model(in_folder("hills.obj"), terrain(60));
    PlanOptions options;
    options.models = {in_folder("hills.obj")};
    options.folder = in_folder("world");
    options.triangles = 3000;
    options.glb = true;
    plan = make_world(options);
    return plan;
}

/* Means and maxima of 255, of what an asset shows from above. */
struct Colors {
    size_t pixels = 0, shared = 0;
    double off = 0, most = 0, across = 0;
};

static Colors measured(const Plan &plan, bool leaves)
{
    Task task(2, nullptr, nullptr);
    const Mesh source = import_mesh(in_folder("hills.obj"), task);
    const View view = comparison_views(extent_of(source), 200)[15]; /* from above */
    Vector<std::array<float, 3>> seen(size_t(view.size) * view.size, {-1, 0, 0});
    Colors out;
    for (const Tile &tile : plan.tiles) {
        if (leaves != tile.is_leaf() || (!leaves && tile.depth))
            continue;
        gtx_asset *asset = nullptr;
        gtx_error error;
        assert_int_equal(gtx_open_file(asset_path(plan, tile).c_str(), nullptr, &asset, &error), 0);
        {
            const AssetView of(asset, 0);
            Vector<ViewHit> hits;
            Vector<Crossing> crossings;
            for (uint32_t j = 0; j < view.size; ++j) {
                of.cast_row(view, j, hits, crossings);
                for (uint32_t i = 0; i < view.size; ++i) {
                    if (hits[i].patch == NO_HIT)
                        continue;
                    const Fragment fragment = of.fragment(hits[i], view);
                    const Vec3d at = view.at(i, j), true_color = shown(at.x, at.z);
                    auto &before = seen[size_t(j) * view.size + i];
                    ++out.pixels;
                    out.shared += before[0] >= 0;
                    for (int k = 0; k < 3; ++k) {
                        const float color = float(fragment.color[k]);
                        const double off = std::fabs(double(color) - true_color[k]);
                        out.off += off / 3;
                        out.most = std::max(out.most, off);
                        if (before[0] >= 0)
                            out.across = std::max(out.across,
                                                  std::fabs(double(color) -
                                                            double(before[size_t(k)])));
                    }
                    before = {float(fragment.color[0]), float(fragment.color[1]),
                              float(fragment.color[2])};
                }
            }
        }
        gtx_close(asset);
    }
    out.off /= double(std::max(out.pixels, size_t(1)));
    return out;
}

static void tiles_show_what_the_texture_shows(void **)
{
    const Colors leaves = measured(textured_world(), true);
    printf("    leaves: %.2f of 255 off in the mean, %.1f at most; %zu shared pixels, %.1f apart\n",
           leaves.off, leaves.most, leaves.shared, leaves.across);
    assert_true(leaves.pixels > 15000 && leaves.shared > 100);
    assert_true(leaves.off < 1 && leaves.most < 16);
    assert_true(leaves.across < 6);
}

static void the_root_shows_means(void **)
{
    const Colors root = measured(textured_world(), false);
    printf("    root: %.2f of 255 off in the mean, %.1f at most\n", root.off, root.most);
    assert_true(root.pixels > 15000);
    assert_true(root.off < 5 && root.most < 40);
}

/* Where low surfaces of two tiles meet, both have the same colours. */
static void low_surfaces_agree_where_they_meet(void **)
{
    const Plan &plan = textured_world();
    std::map<std::array<double, 3>, Rgba8> known;
    size_t met = 0;
    for (const Tile &tile : plan.tiles) {
        if (!tile.depth || !tile.is_leaf())
            continue;
        const TileSurface low = load_cell(low_path(plan, tile));
        assert_true(low.traits.colors && !low.traits.textured);
        for (size_t v = 0; v < low.positions.size(); ++v) {
            const Vec3d &p = low.positions[v];
            const auto at = known.insert({{p.x, p.y, p.z}, low.colors[v]});
            const Rgba8 a = at.first->second, b = low.colors[v];
            if (!at.second)
                ++met;
            assert_true(std::abs(a.r - b.r) < 2 && std::abs(a.g - b.g) < 2 &&
                        std::abs(a.b - b.b) < 2);
        }
    }
    assert_true(met > 100);
}

static void threads_change_no_byte(void **)
{
    const Plan &plan = textured_world();
    Plan again = plan;
    again.folder = in_folder("again");
    fs::copy(plan.folder, again.folder, fs::copy_options::recursive);
    Task task(1, nullptr, nullptr, {"read", "cook", "simplify"}, {1, 1, 1});
    const Tile &leaf = plan.tiles.back();
    for (const std::string &path : {asset_path(again, leaf), glb_path(again, leaf),
                                    low_path(again, leaf)})
        fs::remove(path);
    assert_false(cook_tile(again.folder, leaf.name, task).unchanged);
    for (auto *path : {asset_path, glb_path, low_path})
        assert_true(read_file(path(again, leaf)) == read_file(path(plan, leaf)));
    assert_true(cook_tile(again.folder, leaf.name, task).unchanged);
}

/* What lies beside the cells, as others may have written it. */
static void looks_that_are_none_are_refused(void **)
{
    const Plan &plan = textured_world();
    Plan bad = plan;
    bad.folder = in_folder("bad");
    fs::copy(plan.folder, bad.folder, fs::copy_options::recursive);
    const std::string leaf = plan.tiles.back().name, split = bad.folder + "/work/split/";
    fs::remove(asset_path(bad, plan.tiles.back()));
    for (const char *name : {"look", "image-0"}) {
        const std::string text = read_file(split + name);
        for (size_t at = 0; at < 14; ++at)
            for (int how = 0; how < 2; ++how) {
                std::string changed = how ? text.substr(0, at) : text;
                if (!how && name[0] == 'l' && at >= 8) /* there may be more images */
                    continue;
                if (!how)
                    changed[at] = char(changed[at] ^ 0xf0);
                write_file(split + name, changed);
                Task task(1, nullptr, nullptr, {"read", "cook", "simplify"}, {1, 1, 1});
                try {
                    cook_tile(bad.folder, leaf, task);
                    fail_msg("%s was read, changed at byte %zu", name, at);
                } catch (const Error &e) {
                    assert_true(e.result == GTX_ERROR_INPUT || e.result == GTX_ERROR_LIMIT);
                }
            }
        write_file(split + name, text);
    }
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(tiles_show_what_the_texture_shows),
        cmocka_unit_test(the_root_shows_means),
        cmocka_unit_test(low_surfaces_agree_where_they_meet),
        cmocka_unit_test(threads_change_no_byte),
        cmocka_unit_test(looks_that_are_none_are_refused),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
