/* The partition as a coloured PLY. */
#include "test_partition.hpp"

static std::string read_file(const std::string &path)
{
    std::FILE *file = std::fopen(path.c_str(), "rb");
    assert_non_null(file);
    std::string text(1 << 22, 0);
    text.resize(std::fread(&text[0], 1, text.size(), file));
    std::fclose(file);
    return text;
}

static void test_charts_ply(void **)
{
    Mesh mesh = shapes::torus(10, 0.4);
    /* half of it faces away */
    Partition p = partition(mesh, 2, with(PartitionMethod::VSA, 1));
    std::string path = "/tmp/geotex_charts_" + std::to_string(uintptr_t(&p)) + ".ply";
    write_charts_ply(path, mesh, p);
    std::string text = read_file(path);
    std::remove(path.c_str());
    assert_int_equal(text.compare(0, 4, "ply\n"), 0);
    size_t data = text.find("end_header\n") + 11;
    assert_int_equal(text.size() - data, 24 * mesh.positions.size() + 20 * mesh.triangle_count());
    size_t green = 0;
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        green += !text.compare(data + 24 * mesh.positions.size() + 20 * t + 13, 3, "\0\xff\0", 3);
    assert_int_equal(green, p.report.initial_inverted);
    assert_true(green > mesh.triangle_count() / 4);
    try {
        write_charts_ply("/nowhere/charts.ply", mesh, p);
        fail();
    } catch (const Error &e) {
        assert_int_equal(e.result, GTX_ERROR_WRITE);
    }
}

/* Pieces have their charts' colours; a triangle that folds counts once, in however many pieces. */
static void test_charts_ply_of_pieces(void **)
{
    Mesh mesh = shapes::torus(12, 0.4);
    Partition p = partition(mesh, 2, with(PartitionMethod::PGP, 6));
    assert_true(p.mesh.triangle_count() > mesh.triangle_count());
    std::string path = "/tmp/geotex_pieces_" + std::to_string(uintptr_t(&p)) + ".ply";
    write_charts_ply(path, p.charted(mesh), p);
    Task task(1, nullptr, nullptr, {"import"});
    task.begin("import");
    Mesh read = import_mesh(path, task);
    std::remove(path.c_str());
    assert_int_equal(read.triangle_count(), p.mesh.triangle_count());
    assert_int_equal(read.colors.size(), 3 * read.triangle_count());
    gtx::Vector<uint32_t> green;
    for (uint32_t t = 0; t < read.triangle_count(); ++t)
        if (read.colors[3 * t] == Rgba8{0, 255, 0, 255})
            green.push_back(p.source_of(t));
    green.erase(std::unique(green.begin(), green.end()), green.end());
    assert_int_equal(green.size(), p.report.initial_inverted);
    assert_true(!green.empty() && p.report.initial_folding > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_charts_ply), cmocka_unit_test(test_charts_ply_of_pieces),
    };
    return cmocka_run_group_tests_name("charts_ply", tests, nullptr, nullptr);
}
