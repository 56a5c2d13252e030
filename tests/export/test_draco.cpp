/* Exports with KHR_draco_mesh_compression, read back by the importer. */
#include "mesh/import/import.hpp"

#include "exported.hpp"

#include <algorithm>
#include <set>

static gtx::Mesh imported(const std::string &file)
{
    gtx::Task task(1, nullptr, nullptr);
    gtx::Mesh mesh = gtx::import_model(gtx::model_in_memory(file, "a.glb", task), task);
    assert_true(task.warnings.empty());
    return mesh;
}

/* Corners of triangles by where they are, so that meshes in another order compare. */
struct Corner {
    gtx::Vec3d position;
    size_t number;
};

static std::vector<std::array<Corner, 3>> sorted(const gtx::Mesh &mesh)
{
    std::vector<std::array<Corner, 3>> out;
    auto key = [](const Corner &c) {
        return std::array<long, 3>{std::lround(c.position.x * 1e4), std::lround(c.position.y * 1e4),
                                   std::lround(c.position.z * 1e4)};
    };
    for (size_t t = 0; t < mesh.triangle_count(); ++t) {
        std::array<Corner, 3> corners;
        for (size_t k = 0; k < 3; ++k)
            corners[k] = {gtx::Vec3d(mesh.positions[mesh.triangles[t][k]]), 3 * t + k};
        std::rotate(corners.begin(), /* turned, the smallest first: the winding stays */
                    std::min_element(corners.begin(), corners.end(),
                                     [&](auto &a, auto &b) { return key(a) < key(b); }),
                    corners.end());
        out.push_back(corners);
    }
    std::sort(out.begin(), out.end(), [&](auto &a, auto &b) {
        return std::array{key(a[0]), key(a[1]), key(a[2])} <
               std::array{key(b[0]), key(b[1]), key(b[2])};
    });
    return out;
}

static size_t places(const gtx::Mesh &mesh)
{
    std::set<std::array<double, 3>> out;
    for (const auto &p : mesh.positions)
        out.insert({double(p.x), double(p.y), double(p.z)});
    return out.size();
}

/* The same triangles, wound alike, and on them nearly the same normals and coordinates. */
static void the_same_within_its_steps(void **)
{
    const std::string asset = cooked_sphere();
    gtx_export_desc desc = {};
    for (uint32_t collision = 0; collision < 2; ++collision) {
        desc.collision = collision;
        desc.compress = GTX_EXPORT_UNCOMPRESSED;
        const std::string plain = exported(asset, desc);
        desc.compress = GTX_EXPORT_DRACO;
        const std::string packed = exported(asset, desc);
        assert_true(packed == exported(asset, desc));
        const gtx::Mesh a = imported(plain), b = imported(packed);
        const auto of_a = sorted(a), of_b = sorted(b);
        assert_int_equal(of_a.size(), of_b.size());
        for (size_t t = 0; t < of_a.size(); ++t)
            for (size_t k = 0; k < 3; ++k) {
                const Corner &p = of_a[t][k], &q = of_b[t][k];
                assert_true(length(p.position - q.position) < 2e-6);
                if (collision)
                    continue;
                assert_true(length(a.normals[p.number] - b.normals[q.number]) < 2e-3f);
                for (size_t i = 0; i < 2; ++i) /* a 32nd of a texel */
                    assert_true(std::abs(a.appearance.uv[0][p.number][i] -
                                         b.appearance.uv[0][q.number][i]) * 1024 < 1.f / 16);
            }
        assert_int_equal(places(b), places(a)); /* patches meet as they did */
    }
}

static void what_it_says_of_itself(void **)
{
    const std::string asset = cooked_sphere();
    gtx_export_desc desc = {};
    desc.compress = GTX_EXPORT_DRACO;
    desc.lods = 1;
    const std::string file = exported(asset, desc);
    const Glb glb(file);
    assert_true(glb.root["extensionsRequired"] == json::array({"KHR_draco_mesh_compression"}));
    for (const json &mesh : glb.root["meshes"])
        for (const json &primitive : mesh["primitives"]) {
            const json &stream = primitive["extensions"]["KHR_draco_mesh_compression"];
            assert_int_equal(glb.view(stream["bufferView"]).compare(0, 5, "DRACO"), 0);
            assert_int_equal(stream["attributes"].size(), 4);
            for (const auto &[name, accessor] : primitive["attributes"].items()) {
                assert_true(stream["attributes"].contains(name));
                assert_false(glb.root["accessors"][accessor.get<size_t>()].contains("bufferView"));
            }
        }
    const void *held = nullptr;
    size_t size = 0;
    assert_int_equal(gtx_find_asset(file.data(), file.size(), &held, &size, nullptr), GTX_OK);
    assert_true(size == asset.size() && !std::memcmp(held, asset.data(), size));
    desc.compress = GTX_EXPORT_MESHOPT;
    desc.without_asset = 1;
    const size_t meshopt = exported(asset, desc).size();
    desc.compress = GTX_EXPORT_DRACO;
    assert_true(exported(asset, desc).size() < meshopt);
}

/* What the encoder takes counts against the memory that is allowed. */
static void memory_is_limited(void **)
{
    gtx_export_desc desc = {};
    desc.collision = 1;
    desc.compress = GTX_EXPORT_DRACO;
    const std::string asset = cooked_sphere();
    std::string out;
    desc.limits.memory = 1 << 20;
    assert_int_equal(try_export(asset, desc, out), GTX_ERROR_LIMIT);
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(the_same_within_its_steps),
        cmocka_unit_test(what_it_says_of_itself),
        cmocka_unit_test(memory_is_limited),
    };
    return cmocka_run_group_tests(tests, nullptr, nullptr);
}
