/* Finds out how fine texels must be for what textures show, chart by chart.
 *
 * Textures are looked up at a grid of points of each chart, as squares of the size of a texel see
 * them and as they are. Where both differ too much to the eye, smaller squares are tried. */
#include "chart/texture_density.hpp"

#include "chart/frame.hpp"
#include "chart/raster.hpp"

#include <algorithm>

namespace gtx {

namespace {

/* How many times as fine as relief needs, along both sides. */
constexpr double STEPS[] = {1, 1.4142135623730951, 2, 2.8284271247461903, 4};
constexpr size_t STEP_COUNT = sizeof STEPS / sizeof *STEPS;
/* Points along a chart's longer side. */
constexpr int POINTS = 16;
/* Root of the mean square of what a look may differ by, of its range. `make bench-texels`: with
 * this a helmet's file grows by half, with 0.05 by a quarter, with 0.03 by 160 %; colours gain 0.9,
 * 0.5 and 1.8 dB. A truck's grows by 45, 32 and 73 % for 1.4, 1.1 and 2.1 dB. */
constexpr double TOLERANCE = 0.04;
/* What may be left of the mean square, times the finer side: 1 where all that differs are edges. Of
 * noise that is finer than any texel all of it is left: a chair's weave alone would take six times
 * the bytes and look the same. */
constexpr double WORTH = 1.25;
/* Part of a difference of normals that the eye takes for one of light. */
constexpr double OF_NORMAL = 0.25;
/* Texels that patches may take beyond what relief needs: of any model, and for each byte read.
 * Without a bound a small file of a checkerboard would ask for most. */
constexpr double FREE_TEXELS = 1 << 19, BYTE_TEXELS = 1;
/* Texels along a side: a patch with more is not cast by its hull. */
constexpr double LONGEST = 512, MARGIN = 8;

/* What the eye has of a point: light as sRGB has it, about, and where the surface faces. */
struct Look {
    double value[6];

    explicit Look(const SurfaceSample &s)
        : value{light(s, 0), light(s, 1), light(s, 2), OF_NORMAL * double(s.normal.x),
                OF_NORMAL * double(s.normal.y), OF_NORMAL * double(s.normal.z)}
    {
    }
    static double light(const SurfaceSample &s, int k)
    {
        const double sum = double(s.color[k]) * double(s.occlusion) + double(s.emission[k]);
        return std::sqrt(std::clamp(sum, 0., 1.));
    }
    /* Mean of the channels of light, and what normals add. */
    double square_from(const Look &other) const
    {
        double sum[2] = {0, 0};
        for (int k = 0; k < 6; ++k)
            sum[k / 3] += (value[k] - other.value[k]) * (value[k] - other.value[k]);
        return sum[0] / 3 + sum[1];
    }
};

struct Demand {
    double size[2] = {0, 0};              /* texels for relief */
    double most = 1;                      /* times finer that a side may become */
    double off[STEP_COUNT] = {};          /* mean square, at each step */
    double texture = 0;                   /* pixels of its textures along a unit */

    double texels() const { return size[0] * size[1]; }
    /* Least times that keep to a mean square, if they are worth their texels. */
    double times(double square) const
    {
        size_t step = 0;
        while (step + 1 < STEP_COUNT && off[step] > square)
            ++step;
        while (step && off[step] * STEPS[step] > WORTH * off[0])
            --step;
        return std::min(STEPS[step], most);
    }
};

/* Pixels of a material's finest texture along a unit of a triangle. */
double pixels_along(const Mesh &mesh, uint32_t triangle)
{
    const Appearance &look = mesh.appearance;
    const Material &material = look.materials[look.material[triangle]];
    double most = 0;
    for (auto map : MATERIAL_TEXTURES)
        if ((material.*map).used())
            most = std::max(most, texture_pixels(mesh, triangle, material.*map));
    return std::sqrt(most / (length(mesh.area_vector(triangle)) / 2));
}

class Meter {
public:
    Meter(const Mesh &mesh, double pitch, const Chart &chart)
        : mesh_(mesh), chart_(chart), inverse_(chart.frame)
    {
        for (int a = 0; a < 2; ++a)
            demand_.size[a] = chart.cells[a] ? chart.cells[a]
                                             : std::max(1., chart.frame.extent[a] / pitch);
        const double longest = std::max(demand_.size[0], demand_.size[1]);
        demand_.most = std::max(1., (LONGEST - 2 * MARGIN) / longest);
        const double *extent = chart.frame.extent;
        texel_ = std::sqrt(extent[0] / demand_.size[0] * (extent[1] / demand_.size[1]));
        for (int a = 0; a < 2; ++a)
            grid_[a] = std::clamp(int(demand_.size[a] / longest * POINTS), 1, POINTS);
    }

    Demand measure()
    {
        if (!(texel_ > 0)) /* a needle of no width */
            return demand_;
        for (uint32_t t : chart_.triangles)
            look_at(t);
        for (double &square : demand_.off)
            square /= std::max(points_, 1.);
        demand_.texture /= std::max(points_, 1.);
        if (!std::isfinite(demand_.texture))
            demand_.texture = 0;
        return demand_;
    }

private:
    void look_at(uint32_t triangle);
    void look_at(uint32_t triangle, const float weights[3]);

    const Mesh &mesh_;
    const Chart &chart_;
    const FrameInverse inverse_;
    int grid_[2];
    double texel_, points_ = 0;
    Demand demand_;
};

void Meter::look_at(uint32_t triangle)
{
    Vec3d corner[3];
    for (int k = 0; k < 3; ++k) {
        corner[k] = inverse_(mesh_.position(triangle, k));
        for (int a = 0; a < 2; ++a)
            corner[k][a] *= grid_[a] / chart_.frame.extent[a];
    }
    const double ux = corner[1].x - corner[0].x, uy = corner[1].y - corner[0].y;
    const double vx = corner[2].x - corner[0].x, vy = corner[2].y - corner[0].y;
    const double area = ux * vy - uy * vx;
    raster_centres(corner, grid_[0], grid_[1], [&](int i, int j, double) {
        const double x = i + 0.5 - corner[0].x, y = j + 0.5 - corner[0].y;
        const double b = (x * vy - y * vx) / area, c = (ux * y - uy * x) / area;
        const float weights[3] = {float(1 - b - c), float(b), float(c)};
        look_at(triangle, weights);
    });
}

void Meter::look_at(uint32_t triangle, const float weights[3])
{
    cancel_point();
    const Interpolated corners = interpolate(mesh_, triangle, weights);
    const Look fine(sample_surface(mesh_, triangle, weights, 0, corners));
    for (size_t step = 0; step < STEP_COUNT; ++step)
        demand_.off[step] += fine.square_from(
            Look(sample_surface(mesh_, triangle, weights, texel_ / STEPS[step], corners)));
    demand_.texture += pixels_along(mesh_, triangle) * texel_;
    points_ += 1;
}

/* Texels of all, and with `times` of each chart. */
template <class Times> double sum_texels(const Vector<Demand> &demands, Times times)
{
    double sum = 0;
    for (const Demand &demand : demands)
        sum += demand.texels() * times(demand) * times(demand);
    return sum;
}

/* The mean square that all keep to who can, with no more texels than `most`. */
double affordable(const Vector<Demand> &demands, double most)
{
    constexpr double COARSER = 1.2;
    double square = TOLERANCE * TOLERANCE;
    while (square < 8 && sum_texels(demands, [&](const Demand &d) { return d.times(square); }) >
                             most)
        square *= COARSER * COARSER;
    return square;
}

bool has_texture(const Mesh &mesh)
{
    const Appearance &look = mesh.appearance;
    return !look.material.empty() && !look.images.empty();
}

} // namespace

void follow_textures(const Mesh &mesh, const ChartOptions &options, Partition &partition,
                     Task &task)
{
    if (options.texel_density < 0 || !has_texture(mesh))
        return;
    const Mesh &charted = partition.charted(mesh);
    Vector<Demand> demands(partition.charts.size());
    task.parallel(demands.size(), [&](size_t i) {
        demands[i] = Meter(charted, partition.pitch, partition.charts[i]).measure();
    }, 1, 1);
    const double relief = sum_texels(demands, [](const Demand &) { return 1.; });
    const double most = relief + FREE_TEXELS + BYTE_TEXELS * double(task.limits.bytes_read());
    const double square = affordable(demands, most);
    auto times = [&](const Demand &demand) {
        return options.texel_density > 0
                   ? std::clamp(demand.texture * options.texel_density, 1., demand.most)
                   : demand.times(square);
    };
    for (size_t i = 0; i < demands.size(); ++i)
        partition.charts[i].finer = times(demands[i]);
    partition.more_texels = sum_texels(demands, times) / relief;
}

} // namespace gtx
