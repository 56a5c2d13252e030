/* Fits the height field to the source between the texels too. */
#include "bake/field/chart_field.hpp"

#include <algorithm>

namespace gtx::baking {

/* Heights sampled at the texels alone cut every crest and fill every groove that runs between them.
 * So the height field is fitted by least squares to samples along the source's edges, where a mesh
 * has its crests, with the sampled height itself as one more observation of each texel. On texels
 * that are not finer for the sake of outlines, distances count along the source's normal: on a
 * steep side those along the axis are larger, and heights that follow them stand out at the crest.
 * Gargoyle: RMS -6 %. On finer ones that opens holes (cesium_143_draco: 38 pixels for 26). */

/* Measured on Spot's control mesh, the truck, Duck and bunny, at half and at double:
 * STEP        RMS +6 % | -8 %, and 6 % more texels
 * FARTHEST    6 % more texels | 2 % RMS more
 * MISSED      45 % more texels, and a hole | 8 % fewer texels, RMS +6 %
 * ROUNDS      RMS +6 % | -2 %
 * BELOW       a hole, 11 % more texels | RMS +10 %
 * LEEWAY      RMS +4 % | a hole, 14 % more texels
 * SUNK        within 2 % both ways
 * OVERLAP_COUNTS  RMS -7 % | +4 %, and 3 % more texels */
constexpr double STEP = 0.5;   /* texels between samples on an edge */
constexpr double FARTHEST = 1; /* texels of depth that a height may move */
/* Texels along the source's normal that the fit may raise a height where there is source. At 0.5 an
 * engine had 153 wall pixels for 79, where fins.cpp looked for no source BESIDE. */
constexpr double RISE = 0.3;
/* Texels that the fit and the stitch together may raise a height: along the normal, and above all
 * that the source has in the four cells around it. On a steep side a height may rise far, but not
 * over the crest beside it. One that rises further to meet a crest stands out as a fin. RISE_IN_ALL
 * at 0.6: CesiumMan has 131 wall pixels for 18, the gargoyle 125 for 81; at 0.4 and 0.3 one pixel
 * of the gargoyle's second level is a hole. ABOVE_CREST at a third: an engine has 70 hole pixels
 * for 64. */
constexpr double RISE_IN_ALL = 0.5, ABOVE_CREST = 0.3;
/* Distance below the source that counts as missed, in texels of the model, or of the chart's own
 * where these are finer. */
constexpr double MISSED = 0.3;
constexpr int ROUNDS = 6;
/* A height field below the source lets a grazing ray pass over a crest and open a hole, one above
 * it only moves an outline by as much: being below by more than `LEEWAY` texels weighs this
 * many times more. */
constexpr double BELOW = 6, LEEWAY = 0.1;
/* So does, this many times more, a texel that sinks below its own sample to follow the foot of a
 * wall beside it. */
constexpr double SUNK = 5;
/* The overlap is another chart's core and better shown there: it counts this much. So across a
 * crease the height field follows the core to its very edge. */
constexpr double OVERLAP_COUNTS = 0.1;
/* A limit on time: samples for a texel of the chart, and in all beyond that. An engine of 82 nodes
 * takes up to 12 in a chart, others 4. */
constexpr double SAMPLES = 16, SAMPLES_OF_ALL = 1 << 24;

struct Observation {
    uint32_t texel;             /* the lower corner of its cell */
    double weight[4];           /* of the cell's four texels */
    double height;
    double counts[2];           /* in the sum of squares: as it is, and below the source */
    double facing;              /* the cosine that turns depths into distances */
    bool core;
};

/* The cosine of the angle between a triangle and the plane of the map; never 0, for it weighs. */
static double facing_of(const FlatTriangle &triangle, const Grid &grid)
{
    constexpr double LEAST = 1e-3; /* against junk: no model has such triangles to speak of */
    const Vec3d normal = cross(triangle.corner[1] - triangle.corner[0],
                               triangle.corner[2] - triangle.corner[0]);
    const double x = normal.x / grid.pitch[0], y = normal.y / grid.pitch[1], z = normal.z;
    return z > 0 ? std::clamp(z / std::sqrt(x * x + y * y + z * z), LEAST, 1.) : LEAST;
}

static Vector<double> facings_of(const FlatChart &chart)
{
    Vector<double> facings;
    facings.reserve(chart.triangles.size());
    for (const FlatTriangle &triangle : chart.triangles)
        facings.push_back(facing_of(triangle, chart.grid));
    return facings;
}

/* Adds what `o` says of its source at a place, if the height field is there. */
static void observe(const ChartField &field, const Vec3d &at, Observation o,
                    Vector<Observation> &out)
{
    const Grid &grid = field.flat.grid;
    if (!(at.x >= 0 && at.y >= 0 && at.x < grid.w - 1 && at.y < grid.h - 1))
        return;
    const int i = int(at.x), j = int(at.y);
    uint32_t texel = uint32_t(j) * uint32_t(grid.w) + uint32_t(i);
    const uint32_t corner[4] = {texel, texel + 1, texel + uint32_t(grid.w),
                                texel + uint32_t(grid.w) + 1};
    float u = float(at.x - i), v = float(at.y - j);
    const float weight[4] = {(1 - u) * (1 - v), u * (1 - v), (1 - u) * v, u * v};
    o.texel = texel;
    o.height = at.z;
    std::copy_n(weight, 4, o.weight);
    double height = 0;
    for (int k = 0; k < 4; ++k) {
        if (!field.support[corner[k]])
            return;
        height += o.weight[k] * field.cover.height[corner[k]];
    }
    if (std::fabs(at.z - height) <= JUMP * grid.coarse_pitch())
        out.push_back(o); /* farther ones are of another height field */
}

/* An edge counts as the steeper one of its sides does. */
static Vector<Observation> observe_edges(const Job &job, const ChartField &field,
                                         const Vector<double> &facings)
{
    const FlatChart &chart = field.flat;
    Vector<Observation> out;
    Budget budget(SAMPLES * double(chart.grid.texels()) + SAMPLES_OF_ALL / double(chart.of));
    for (size_t t = 0; t < chart.triangles.size(); ++t) {
        const FlatTriangle &triangle = chart.triangles[t];
        if (!triangle.front)
            continue;
        for (int k = 0; k < 3; ++k) {
            uint32_t mate = chart.mate[t][size_t(k)];
            if (mate != NO_TRIANGLE && mate < t)
                continue; /* seen from the other side */
            Vec3d from = triangle.corner[k], along = triangle.corner[(k + 1) % 3] - from;
            int steps = std::max(1, whole_length(1 / STEP, along.x, along.y));
            budget.spend(steps);
            if (budget.spent())
                return out;
            Observation o = {};
            o.core = t < chart.core;
            o.facing = facings[t];
            const double steeper = mate == NO_TRIANGLE ? o.facing
                                                       : std::min(o.facing, facings[mate]);
            o.counts[0] = (o.core ? 1 : OVERLAP_COUNTS) * (job.sharp ? 1 : steeper * steeper);
            o.counts[1] = o.counts[0] * BELOW;
            for (int s = 0; s < steps; ++s)
                observe(field, from + along * ((s + 0.5) / steps), o, out);
        }
    }
    return out;
}

/* The share of the core's observations that the height field passes below, `missed` or more. */
static double missed_share(const FlatChart &chart, const Vector<Observation> &observations,
                           const Cover &cover, double missed)
{
    const uint32_t row = uint32_t(chart.grid.w);
    size_t core = 0, below = 0;
    for (const Observation &o : observations) {
        if (!o.core)
            continue;
        const uint32_t corner[4] = {o.texel, o.texel + 1, o.texel + row, o.texel + row + 1};
        double residual = o.height;
        for (int k = 0; k < 4; ++k)
            residual -= o.weight[k] * cover.height[corner[k]];
        ++core;
        below += residual * o.facing > missed;
    }
    return core ? double(below) / double(core) : 0;
}

/* How far along the axis a height may rise for a distance along the source's normal. Where the
 * surface is only continued its slope tells little. */
static double along_axis(const ChartField &field, const Vector<double> &facings, size_t texel,
                         double texels)
{
    const uint32_t t = field.cover.triangle[texel];
    return texels / (t != NO_TRIANGLE ? facings[t] : 1) * field.flat.grid.coarse_pitch();
}

/* How high the source is in each cell, at least. */
static Vector<double> crests(const ChartField &field, const Vector<Observation> &observations)
{
    const Cover &cover = field.cover;
    const size_t w = size_t(field.flat.grid.w);
    Vector<double> crest(cover.height.size(), -INFINITY);
    for (const Observation &o : observations)
        crest[o.texel] = std::max(crest[o.texel], o.height);
    for (size_t cell = 0; cell + w + 1 < crest.size(); ++cell)
        for (size_t texel : {cell, cell + 1, cell + w, cell + w + 1})
            if (field.support[texel] || cover.triangle[texel] != NO_TRIANGLE)
                crest[cell] = std::max(crest[cell], cover.height[texel]);
    return crest;
}

static Vector<double> find_ceilings(const ChartField &field,
                                    const Vector<Observation> &observations,
                                    const Vector<double> &facings)
{
    const size_t w = size_t(field.flat.grid.w);
    const Vector<double> crest = crests(field, observations);
    Vector<double> ceiling = field.cover.height;
    for (size_t texel = w + 1; texel < ceiling.size(); ++texel) {
        const double highest = std::max({crest[texel], crest[texel - 1], crest[texel - w],
                                         crest[texel - w - 1]});
        ceiling[texel] = std::min(ceiling[texel] +
                                      along_axis(field, facings, texel, RISE_IN_ALL),
                                  highest + ABOVE_CREST * field.flat.grid.coarse_pitch());
    }
    return ceiling;
}

/* How high the fit may put each height. */
static Vector<double> highest_fits(const ChartField &field, const Vector<double> &facings)
{
    Vector<double> highest = field.cover.height;
    for (size_t texel = 0; texel < highest.size(); ++texel) {
        const double farthest = FARTHEST * field.flat.grid.coarse_pitch();
        const double rise = field.cover.triangle[texel] == NO_TRIANGLE
                                ? farthest
                                : std::min(farthest, along_axis(field, facings, texel, RISE));
        highest[texel] = std::min(highest[texel] + rise, field.ceiling[texel]);
    }
    return highest;
}

double fit_heights(const Job &job, ChartField &field)
{
    const FlatChart &chart = field.flat;
    Cover &cover = field.cover;
    const Vector<double> facings = facings_of(chart);
    const Vector<Observation> observations = observe_edges(job, field, facings);
    field.ceiling = find_ceilings(field, observations, facings);
    const Vector<double> sampled = cover.height, highest = highest_fits(field, facings);
    const uint32_t row = uint32_t(chart.grid.w);
    const double farthest = FARTHEST * chart.grid.coarse_pitch();
    const double leeway = LEEWAY * chart.grid.coarse_pitch();
    struct Step {
        double pull, weight;
    };
    Vector<Step> steps(sampled.size());
    Vector<double> even(sampled.size()), sunk(sampled.size()); /* what a texel's sample weighs */
    for (size_t i = 0; i < sampled.size(); ++i) {
        const uint32_t t = cover.triangle[i]; /* NO_TRIANGLE is the largest of all */
        const double weight = t < chart.core ? 1 : OVERLAP_COUNTS;
        const double facing = t == NO_TRIANGLE || job.sharp ? 1 : facings[t] * facings[t];
        even[i] = weight * facing;
        sunk[i] = t == NO_TRIANGLE ? weight : weight * (facing * SUNK);
    }
    for (int round = 0; round < ROUNDS; ++round) {
        for (size_t i = 0; i < sampled.size(); ++i) {
            const double residual = sampled[i] - cover.height[i];
            const double weight = residual > leeway ? sunk[i] : even[i];
            steps[i] = {weight * residual, weight};
        }
        for (const Observation &o : observations) {
            const uint32_t corner[4] = {o.texel, o.texel + 1, o.texel + row, o.texel + row + 1};
            double residual = o.height;
            for (int k = 0; k < 4; ++k)
                residual -= o.weight[k] * cover.height[corner[k]];
            const double distance = residual * (job.sharp ? 1 : o.facing);
            const double trust = o.counts[distance > leeway];
            double weight[4], pull[4];
            for (int k = 0; k < 4; ++k) {
                weight[k] = trust * o.weight[k];
                pull[k] = weight[k] * residual;
            }
            for (int k = 0; k < 4; ++k) {
                Step &step = steps[corner[k]];
                step.pull += pull[k];
                step.weight += weight[k]; /* row sums: no step overshoots */
            }
        }
        for (size_t i = 0; i < sampled.size(); ++i)
            cover.height[i] = std::clamp(cover.height[i] + steps[i].pull / steps[i].weight,
                                         sampled[i] - farthest, highest[i]);
    }
    return missed_share(chart, observations, cover,
                        MISSED * std::min(job.pitch, chart.grid.coarse_pitch()));
}

} // namespace gtx::baking
