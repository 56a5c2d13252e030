/* No sight passes between tiles: of one level, and of levels next to each other. */
#include "worlds.hpp"

#include "measure/cast.hpp"

#include <functional>
#include <map>

using namespace gtx;

namespace {

/* The tolerances of lib/measure/compare.cpp: pixels, and a share of the diagonal. */
constexpr double HOLE_PIXELS = 2, HOLE_DIAGONAL = 0.001;

/* A tile as it is drawn: its height fields, and its finest LOD mesh. */
struct Shown {
    std::unique_ptr<gtx_asset, void (*)(gtx_asset *)> asset{nullptr, gtx_close};
    std::unique_ptr<AssetView> view;
    double cell_error, lod_error;    /* of its cell file, of its finest LOD mesh */
};

/* A world, and the source to hold it against. */
struct Scene {
    Mesh source;
    Plan plan;
    std::map<std::string, Shown> tiles;
    Extent extent;
};

using Cut = std::function<bool(const Tile &)>; /* whether to show a tile, not those below it */

void open_tile(Scene &scene, const Tile &tile)
{
    Shown &shown = scene.tiles[tile.name];
    gtx_asset *asset = nullptr;
    gtx_error error;
    if (gtx_open_file(asset_path(scene.plan, tile).c_str(), nullptr, &asset, &error))
        fail_msg("%s", error.message);
    shown.asset.reset(asset);
    shown.view = std::make_unique<AssetView>(asset, 0);
    shown.cell_error = CellReader(cell_path(scene.plan, tile)).header().deviation;
    shown.lod_error = read_facts(scene.plan, tile).error;
}

Vector<const Tile *> cut_of(const Plan &plan, const Cut &cut)
{
    Vector<const Tile *> left = {&plan.tiles[0]}, out;
    while (!left.empty()) {
        const Tile *tile = left.back();
        left.pop_back();
        if (tile->is_leaf() || cut(*tile)) {
            out.push_back(tile);
            continue;
        }
        for (uint32_t child : tile->children)
            left.push_back(&plan.tiles[child]);
    }
    return out;
}

/* Depths of what the height fields show, the nearest of all tiles. */
Vector<float> cast_all(const Scene &scene, const Vector<const Tile *> &tiles, const View &view)
{
    Vector<float> depth(size_t(view.size) * view.size, INFINITY);
    Vector<ViewHit> hits;
    Vector<Crossing> crossings;
    for (const Tile *tile : tiles)
        for (uint32_t j = 0; j < view.size; ++j) {
            scene.tiles.at(tile->name).view->cast_row(view, j, hits, crossings);
            for (uint32_t i = 0; i < view.size; ++i) {
                float &to = depth[size_t(j) * view.size + i];
                to = std::min(to, hits[i].t);
            }
        }
    return depth;
}

/* Depths of the finest LOD meshes. */
Vector<float> draw_all(const Scene &scene, const Vector<const Tile *> &tiles, const View &view)
{
    Mesh all;
    for (const Tile *tile : tiles) {
        gtx_lod_mesh lod;
        gtx_info info;
        const gtx_asset *asset = scene.tiles.at(tile->name).asset.get();
        gtx_get_info(asset, &info);
        assert_int_equal(gtx_get_lod_mesh(asset, 0, &lod), GTX_OK);
        const uint32_t first = uint32_t(all.positions.size());
        for (uint32_t v = 0; v < lod.vertex_count; ++v) {
            Vec3d p;
            for (int k = 0; k < 3; ++k)
                p[k] = info.anchor[k] + double(lod.origin[k]) +
                       double(lod.step) * lod.positions[3 * v + uint32_t(k)];
            all.positions.push_back(p);
        }
        for (uint32_t t = 0; t < lod.triangle_count; ++t)
            all.triangles.push_back({first + lod.indices[3 * t], first + lod.indices[3 * t + 1],
                                     first + lod.indices[3 * t + 2]});
    }
    return rasterise(all, view).depth;
}

/* Every other tile is whole; of the others beginnings alone are there, which show LOD meshes. */
Vector<float> show_parts(const Scene &scene, const Vector<const Tile *> &tiles, const View &view)
{
    Vector<const Tile *> parts[2];
    for (size_t n = 0; n < tiles.size(); ++n)
        parts[n % 2].push_back(tiles[n]);
    Vector<float> depth = cast_all(scene, parts[0], view);
    const Vector<float> others = draw_all(scene, parts[1], view);
    for (size_t i = 0; i < depth.size(); ++i)
        depth[i] = std::min(depth[i], others[i]);
    return depth;
}

/* Pixels where the world is deeper than what the source shows anywhere within a pixel, while all
 * around them show the source from the front: nine, and more where outlines may be off by an
 * error. */
size_t holes_in(const Scene &scene, const View &view, const Vector<float> &depth, double error)
{
    const MeshImage image = rasterise(scene.source, view);
    const double tolerance = std::max({HOLE_PIXELS * view.pixel,
                                       HOLE_DIAGONAL * scene.extent.diagonal, error});
    const uint32_t reach = 1 + uint32_t(std::ceil(error / view.pixel));
    size_t holes = 0;
    for (uint32_t j = reach; j + reach < view.size; ++j)
        for (uint32_t i = reach; i + reach < view.size; ++i) {
            double deepest = image.depth[size_t(j) * view.size + i];
            bool front = true;
            const double seen = depth[size_t(j) * view.size + i];
            if (seen - deepest <= tolerance)
                continue;
            for (uint32_t b = j - reach; b <= j + reach; ++b)
                for (uint32_t a = i - reach; a <= i + reach; ++a) {
                    front = front && image.front[size_t(b) * view.size + a];
                    deepest = std::max(deepest, double(image.depth[size_t(b) * view.size + a]));
                }
            if (!front || seen - deepest <= tolerance)
                continue;
            const MeshImage close = rasterise_close(scene.source, view, {{i, j, INFINITY}})[0];
            bool as_deep = false;
            for (size_t at = 0; at < close.depth.size(); ++at)
                as_deep = as_deep || !close.front[at] || seen - close.depth[at] <= tolerance;
            holes += !as_deep;
        }
    return holes;
}

/* As one sees who stands on it: a flat look at a small part. */
Vector<View> standing_views(const Scene &scene, uint32_t size)
{
    Vector<View> views;
    for (int n = 0; n < 6; ++n) {
        const double turn = 1.1 * n, up = 0.12 + 0.03 * n;
        View view;
        view.toward = normalize(Vec3d(std::cos(turn), up, std::sin(turn)));
        view.right = normalize(cross(Vec3d(0, 1, 0), view.toward));
        view.up = cross(view.toward, view.right);
        view.size = size;
        view.pixel = 0.5 * scene.extent.radius / size;
        const Vec3d at = scene.source.positions[(n * 7919 + 100) % scene.source.positions.size()];
        view.middle = at + view.toward * (2 * scene.extent.radius);
        views.push_back(view);
    }
    return views;
}

Scene make_scene(const char *name, Mesh mesh, uint32_t triangles)
{
    Scene scene;
    const std::string path = in_folder(name) + ".ply";
    write_file(path, ply_text(mesh));
    PlanOptions options;
    options.models = {path};
    options.folder = in_folder(name);
    options.triangles = triangles;
    scene.plan = make_world(options);
    Task task(2, nullptr, nullptr);
    CleanReport report;
    scene.source = clean_mesh(std::move(mesh), task, report);
    scene.extent = extent_of(scene.source);
    for (const Tile &tile : scene.plan.tiles)
        open_tile(scene, tile);
    return scene;
}

/* `by_turns`: with beginnings too. */
size_t check(const Scene &scene, const char *what, bool by_turns, const Cut &cut)
{
    const Vector<const Tile *> tiles = cut_of(scene.plan, cut);
    Vector<View> views = comparison_views(scene.extent, 160);
    for (const View &view : standing_views(scene, 160))
        views.push_back(view);
    double cell_error = 0, lod_error = 0;
    for (const Tile *tile : tiles) {
        cell_error = std::max(cell_error, scene.tiles.at(tile->name).cell_error);
        lod_error = std::max(lod_error, scene.tiles.at(tile->name).lod_error);
    }
    size_t cast = 0, drawn = 0, both = 0;
    Task task(2, nullptr, nullptr);
    Vector<std::array<size_t, 3>> found(views.size());
    task.parallel(views.size(), [&](size_t v) {
        found[v] = {holes_in(scene, views[v], cast_all(scene, tiles, views[v]), cell_error),
                    holes_in(scene, views[v], draw_all(scene, tiles, views[v]), lod_error),
                    by_turns ? holes_in(scene, views[v], show_parts(scene, tiles, views[v]),
                                        std::max(cell_error, lod_error)) : 0};
    });
    for (const auto &f : found) {
        cast += f[0];
        drawn += f[1];
        both += f[2];
    }
    printf("    %s: %zu tiles, errors %.4f %.4f, holes cast %zu, drawn %zu, by turns %zu\n", what,
           tiles.size(), cell_error, lod_error, cast, drawn, both);
    return cast + drawn + both;
}

size_t check_all(const Scene &scene)
{
    size_t holes = check(scene, "leaves", false, [](const Tile &) { return false; });
    for (uint32_t depth = 1; depth + 1 < scene.plan.depths(); ++depth)
        holes += check(scene, "one level", false, [&](const Tile &t) { return t.depth == depth; });
    for (unsigned seed = 1; seed <= 3; ++seed)
        holes += check(scene, "mixed", seed == 2, [&](const Tile &t) {
            unsigned hash = seed;
            for (char c : t.name)
                hash = (hash ^ unsigned(c)) * 2654435761u;
            return t.depth > 0 && (hash >> 16) % 3 == 0;
        });
    return holes;
}

} // namespace

/* How many patches of all tiles show from both sides, and how many there are. */
static std::pair<size_t, size_t> count_sides(const Scene &scene)
{
    std::pair<size_t, size_t> count;
    for (const auto &[name, tile] : scene.tiles) {
        gtx_info info;
        gtx_get_info(tile.asset.get(), &info);
        count.second += info.patch_count;
        for (uint32_t i = 0; i < info.patch_count; ++i)
            count.first += (gtx_patches(tile.asset.get())[i].flags & GTX_PATCH_TWO_SIDED) != 0;
    }
    return count;
}

static void terrain_has_no_hole(void **)
{
    const Scene scene = make_scene("terrain", terrain(150), 4000);
    assert_true(cut_of(scene.plan, [](const Tile &) { return false; }).size() >= 8);
    assert_int_equal(count_sides(scene).first, count_sides(scene).second);
    assert_int_equal(check_all(scene), 0);
}

static void a_closed_ball_has_no_hole(void **)
{
    const Scene scene = make_scene("ball", ball(60), 4000);
    assert_true(cut_of(scene.plan, [](const Tile &) { return false; }).size() >= 8);
    assert_int_equal(count_sides(scene).first, 0);
    assert_int_equal(check_all(scene), 0);
}

/* A leaf of a model without normals has those of the whole, also where it ends: at the vertices of
 * the ring, which lie within another tile. */
static void normals_are_those_of_the_whole(void **)
{
    Mesh mesh = ball(60);
    mesh.normals.clear();
    write_file(in_folder("plain.ply"), ply_text(mesh));
    PlanOptions options;
    options.models = {in_folder("plain.ply")};
    options.folder = in_folder("plain");
    options.triangles = 1000;
    const Plan plan = make_world(options);
    std::map<std::array<double, 3>, Vec3d> areas;
    auto key = [](const Vec3d &p) { return std::array<double, 3>{p.x, p.y, p.z}; };
    Task task(1, nullptr, nullptr);
    for (const Tile &tile : plan.tiles)
        if (tile.is_leaf()) {
            const TileSurface s = load_cell(cell_path(plan, tile));
            for (const auto &[a, b, c] : s.triangles)
                for (uint32_t v : {a, b, c})
                    areas[key(s.positions[v])] += cross(s.positions[b] - s.positions[a],
                                                        s.positions[c] - s.positions[a]);
        }
    size_t leaves = 0;
    for (const Tile &tile : plan.tiles) {
        const TileSurface s = load_surface(plan, tile, task);
        leaves += tile.is_leaf();
        assert_true(s.traits.normals);
        for (size_t v = 0; tile.is_leaf() && v < s.positions.size(); ++v)
            assert_true(dot(Vec3d(s.normals[v]), normalize(areas[key(s.positions[v])])) > 1 - 1e-6);
    }
    assert_true(leaves > 4);
}

int main()
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(terrain_has_no_hole),
        cmocka_unit_test(a_closed_ball_has_no_hole),
        cmocka_unit_test(normals_are_those_of_the_whole),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
