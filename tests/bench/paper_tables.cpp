/* The paper's Tables 2 and 3: what partitions of one model fold, and how full their maps are.
 *
 * By its rules (section 5.4): one density for the model, 128 texels along the longest side of any
 * chart, sides rounded up to powers of two and charts stretched to fill them, texel centres, no
 * overlap, no dilation. Then as a user has them, at equal texels. Prints text; writes the rows as
 * JSON beside the assets. */
#include "equal_texels.hpp"

#include "asset/patch.h"
#include "chart/frame.hpp"
#include "chart/raster.hpp"

#include <nlohmann/json.hpp>

#include <cstdio>
#include <cstdlib>
#include <fstream>

using namespace gtx;

namespace {

/* As the paper's tables have it. */
struct Figures {
    uint64_t charts = 0, inverted = 0, folding = 0, texels = 0, empty = 0;
};

struct Row {
    const char *method;
    Figures initial; /* before folding charts are split: what the paper counts */
    Figures final;
    double second_layer;
    AssetFigures asset;
};

const struct {
    const char *name;
    PartitionMethod method;
    gtx_partition partition;
} METHODS[] = {{"cuts", PartitionMethod::CUTS, GTX_PARTITION_CUTS},
               {"vsa", PartitionMethod::VSA, GTX_PARTITION_VSA},
               {"pgp", PartitionMethod::PGP, GTX_PARTITION_PGP},
               {"layers", PartitionMethod::LAYERS, GTX_PARTITION_LAYERS},
               {"relief", PartitionMethod::RELIEF, GTX_PARTITION_RELIEF}};

/* The part of a chart's core between its cuts, in its frame's coordinates, corner by corner. */
std::vector<Vec3d> clipped(const Mesh &mesh, uint32_t triangle, const Chart &chart,
                           const FrameInverse &inverse)
{
    std::vector<Vec3d> polygon;
    for (int k = 0; k < 3; ++k)
        polygon.push_back(inverse(mesh.position(triangle, k)));
    for (int side = 0; side < 4; ++side) {
        int axis = side / 2;
        double sign = side % 2 ? -1 : 1;
        double limit = side % 2 ? chart.clip_high[axis] : chart.clip_low[axis];
        if (std::isinf(limit))
            continue;
        std::vector<Vec3d> kept;
        for (size_t i = 0; i < polygon.size(); ++i) {
            const Vec3d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
            double da = sign * (a[axis] - limit), db = sign * (b[axis] - limit);
            if (da >= 0)
                kept.push_back(a);
            if ((da >= 0) != (db >= 0))
                kept.push_back(a + (b - a) * (da / (da - db)));
        }
        polygon = std::move(kept);
    }
    return polygon;
}

struct Extent {
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    double side(int axis) const { return std::max(0., high[axis] - low[axis]); }
};

Extent extent_of(const Mesh &mesh, const Chart &chart)
{
    FrameInverse inverse(chart.frame);
    Extent out;
    for (uint32_t t : chart.triangles)
        for (const Vec3d &p : clipped(mesh, t, chart, inverse))
            for (int a = 0; a < 2; ++a) {
                out.low[a] = std::min(out.low[a], p[a]);
                out.high[a] = std::max(out.high[a], p[a]);
            }
    return out;
}

int power_of_two(double texels)
{
    int size = 1;
    while (size < texels - 1e-9)
        size *= 2;
    return size;
}

void count_texels(const Mesh &mesh, const Vector<Chart> &charts, Figures &figures)
{
    constexpr double LONGEST = 128;
    std::vector<Extent> extents;
    double longest = 0;
    for (const Chart &chart : charts) {
        extents.push_back(extent_of(mesh, chart));
        longest = std::max({longest, extents.back().side(0), extents.back().side(1)});
    }
    for (size_t i = 0; i < extents.size(); ++i) {
        const Chart &chart = charts[i];
        const Extent &e = extents[i];
        int size[2];
        for (int a = 0; a < 2; ++a)
            size[a] = power_of_two(e.side(a) / longest * LONGEST);
        std::vector<uint8_t> hit(size_t(size[0]) * size_t(size[1]));
        FrameInverse inverse(chart.frame);
        for (uint32_t t : chart.triangles) {
            Vec3d corner[3];
            for (int k = 0; k < 3; ++k) {
                Vec3d p = inverse(mesh.position(t, k));
                corner[k] = {(p.x - e.low[0]) / e.side(0) * size[0],
                             (p.y - e.low[1]) / e.side(1) * size[1], 0};
            }
            raster_centres(corner, size[0], size[1], [&](int x, int y, double) {
                hit[size_t(y) * size_t(size[0]) + size_t(x)] = 1;
            });
        }
        figures.texels += hit.size();
        figures.empty += uint64_t(std::count(hit.begin(), hit.end(), 0));
    }
}

/* The charts as they were clustered, in frames of the paper's: along the median of the normals. */
Vector<Chart> initial_charts(const Mesh &mesh, const Partition &partition)
{
    Vector<Chart> out(partition.report.initial_charts);
    for (uint32_t t = 0; t < mesh.triangle_count(); ++t)
        out[partition.initial_chart[t]].triangles.push_back(t);
    for (Chart &chart : out)
        chart.frame = make_frame(mesh, chart.triangles, median_axis(mesh, chart.triangles));
    return out;
}

Row make_row(const Mesh &mesh, const char *name, PartitionMethod method, unsigned charts)
{
    ChartOptions options;
    options.method = method;
    options.charts = charts;
    options.grain = 1;
    options.overlap[0] = options.overlap[1] = 0;
    options.one_density = true;
    options.height_steps = gtx_height_steps(16); /* the rules ask for full maps, not flat ones */
    Task task(0, nullptr, nullptr);
    Partition p = make_partition(mesh, options, task);
    const ChartReport &r = p.report;
    Row row = {name, {r.initial_charts, r.initial_inverted, r.initial_folding},
               {p.charts.size(), r.inverted_triangles, r.folding_charts}, r.second_layer_fraction,
               {}};
    const Mesh &charted = p.charted(mesh);
    count_texels(charted, initial_charts(charted, p), row.initial);
    count_texels(charted, p.charts, row.final);
    return row;
}

void print_figures(const std::string &name, const Figures &f)
{
    std::printf("%-24s %6llu %9llu %8llu %9llu %8.2f %%\n", name.c_str(),
                static_cast<unsigned long long>(f.charts),
                static_cast<unsigned long long>(f.inverted),
                static_cast<unsigned long long>(f.folding),
                static_cast<unsigned long long>(f.texels),
                100 * double(f.empty) / double(f.texels));
}

/* Of the bunny (paper, Tables 2 and 3). */
constexpr Figures PAPER_VSA = {222, 3, 3, 461312, 179194};
constexpr Figures PAPER_PGP = {224, 817, 45, 1008128, 240357};

void print_head(const std::string &title)
{
    std::printf("%s\n%-24s %6s %9s %8s %9s %10s\n", title.c_str(), "", "charts", "inverted",
                "folding", "texels", "empty");
}

void print_paper()
{
    print_head("the paper, bunny, 69451 triangles");
    print_figures("VSA", PAPER_VSA);
    print_figures("PGP", PAPER_PGP);
}

void print_rows(const std::vector<Row> &rows)
{
    for (const Row &row : rows) {
        if (row.method != std::string("cuts")) /* its clusters are no charts yet */
            print_figures(row.method + std::string(", before splitting"), row.initial);
        print_figures(row.method, row.final);
    }
    std::printf("%-24s %6s %9s %9s %9s %10s %9s %9s %7s %7s  %s\n", "assets of equal texels",
                "charts", "texels", "empty", "range", "RMS", "bytes", "grid", "seconds", "lost",
                "hole pixels");
    for (const Row &row : rows) {
        const AssetFigures &a = row.asset;
        std::printf("%-24s %6llu %9llu %7.2f %% %7.2f %% %8.5f %% %9llu %9llu %7.2f %5.1f %%  "
                    "%llu of %llu\n", row.method,
                    static_cast<unsigned long long>(a.patches),
                    static_cast<unsigned long long>(a.texels),
                    100 * double(a.empty) / double(a.texels), 100 * a.range, 100 * a.rms,
                    static_cast<unsigned long long>(a.bytes),
                    static_cast<unsigned long long>(a.grid_triangles), a.seconds, 100 * a.lost,
                    static_cast<unsigned long long>(a.holes),
                    static_cast<unsigned long long>(a.pixels));
    }
}

void print_notes()
{
    std::printf("\nbefore splitting: as the paper counts; then folding charts are split until "
                "none\nis left, and crumbs are attached, which the paper leaves open\n"
                "texels: the longest side of all charts sets the density, so one chart decides;\n"
                "the paper does not say how it finds rectangles: these are of least area\n"
                "grid: triangles of the displaced mesh (Cook 1984), which draws the same maps, at\n"
                "most; seconds: to cook, of a processor; lost: surface that no view sees\n"
                "range: of heights in a patch, mean over texels; as RMS, of the diagonal\n");
}

nlohmann::json to_json(const Figures &f)
{
    return {{"charts", f.charts}, {"inverted", f.inverted}, {"folding", f.folding},
            {"texels", f.texels}, {"empty", f.empty}};
}

nlohmann::json to_json(const Row &row, const std::string &model, size_t triangles)
{
    nlohmann::json out = to_json(row.final);
    out["model"] = model;
    out["method"] = row.method;
    out["triangles"] = triangles;
    out["second_layer_fraction"] = row.second_layer;
    const nlohmann::json initial = to_json(row.initial);
    for (const auto &[key, value] : initial.items())
        out["initial_" + key] = value;
    const AssetFigures &a = row.asset;
    out["equal_texels"] = {{"charts", a.patches}, {"texels", a.texels}, {"empty", a.empty},
                           {"height_range", a.range}, {"rms", a.rms}, {"bytes", a.bytes},
                           {"grid_triangles", a.grid_triangles}, {"seconds", a.seconds},
                           {"lost", a.lost}, {"hole_pixels", a.holes},
                           {"surface_pixels", a.pixels}};
    return out;
}

void add_model(const std::string &model, unsigned charts, const std::string &folder,
               nlohmann::json &rows_json)
{
    Task task(0, nullptr, nullptr);
    CleanReport clean;
    Mesh mesh = clean_mesh(import_mesh(model, task), task, clean);
    std::vector<gtx_partition> partitions;
    std::vector<Row> rows;
    for (const auto &m : METHODS) {
        partitions.push_back(m.partition);
        rows.push_back(make_row(mesh, m.name, m.method, charts));
    }
    std::vector<AssetFigures> assets = equal_texels(model, charts, partitions, folder);
    for (size_t i = 0; i < rows.size(); ++i)
        rows[i].asset = assets[i];
    print_head("\n" + model + ", " + std::to_string(mesh.triangle_count()) + " triangles");
    print_rows(rows);
    for (const Row &row : rows)
        rows_json.push_back(to_json(row, model, mesh.triangle_count()));
}

} // namespace

int main(int argc, char **argv)
{
    if (argc < 4 || argc % 2) {
        std::fprintf(stderr, "usage: paper_tables FOLDER MODEL CHARTS [MODEL CHARTS]...\n");
        return 1;
    }
    const std::string folder = argv[1];
    try {
        nlohmann::json table = {
            {"paper", {{"vsa", to_json(PAPER_VSA)}, {"pgp", to_json(PAPER_PGP)}}},
            {"rows", nlohmann::json::array()}};
        print_paper();
        for (int i = 2; i < argc; i += 2)
            add_model(argv[i], unsigned(std::atoi(argv[i + 1])), folder, table["rows"]);
        print_notes();
        std::ofstream file(folder + "/tables.json");
        file << table.dump(2) << "\n";
        return file.good() ? 0 : 2;
    } catch (const Error &e) {
        std::fprintf(stderr, "paper_tables: %s\n", e.message.c_str());
        return 3;
    }
}
