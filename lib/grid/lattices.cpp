/* Grids beside and above each other: parts of one lattice, values at the nodes of another, and what
 * seems to be a mistake. */
#include "grid/text.hpp"

#include <algorithm>

namespace gtx {

/* ---- places ---- */

void use_local_metres(HeightGrid &grid, double latitude)
{
    if (!grid.in_degrees)
        return;
    if (!(std::fabs(latitude) < 90))
        malformed("it lies in degrees, beyond the poles");
    if (grid.rotation != 0)
        malformed("it lies in degrees, and is rotated");
    const double phi = latitude * std::acos(-1.0) / 180;
    const double metres[2] = {111412.84 * gtx_cos(phi) - 93.5 * gtx_cos(3 * phi),
                              111132.92 - 559.82 * gtx_cos(2 * phi) + 1.175 * gtx_cos(4 * phi)};
    for (int k = 0; k < 2; ++k) {
        grid.origin[k] *= metres[k];
        grid.step[k] *= metres[k];
    }
    grid.in_degrees = false;
}

void use_common_metres(HeightGrid &grid, double &latitude)
{
    if (!grid.in_degrees)
        return;
    if (std::isnan(latitude))
        latitude = grid.origin[1] + grid.step[1] * (grid.ny - 1) / 2;
    use_local_metres(grid, latitude);
}

void use_depths(HeightGrid &grid)
{
    for (float &value : grid.values)
        value = -value;
}

/* Node coordinates in one lattice -> those in another. */
class Passage {
public:
    Passage(const HeightGrid &from, const HeightGrid &to)
    {
        if (from.is_unplaced || to.is_unplaced) { /* one over all of the other */
            along_[0][0] = (from.nx - 1) / std::max(to.nx - 1.0, 1.0);
            along_[1][1] = (from.ny - 1) / std::max(to.ny - 1.0, 1.0);
            return;
        }
        const double turn = from.rotation * std::acos(-1.0) / 180;
        const double c = gtx_cos(turn), s = gtx_sin(turn);
        const auto local = [&](const std::array<double, 2> &p, double out[2]) {
            const double x = p[0] - from.origin[0], y = p[1] - from.origin[1];
            out[0] = (c * x + s * y) / from.step[0];
            out[1] = (c * y - s * x) / from.step[1];
        };
        double at[2];
        local(to.place(0, 0), at_);
        for (int k = 0; k < 2; ++k) {
            local(to.place(k == 0, k == 1), at);
            for (int d = 0; d < 2; ++d)
                along_[k][d] = at[d] - at_[d];
        }
    }
    /* Where the node i, j of `to` lies in `from`. */
    std::array<double, 2> operator()(double i, double j) const
    {
        return {at_[0] + i * along_[0][0] + j * along_[1][0],
                at_[1] + i * along_[0][1] + j * along_[1][1]};
    }

private:
    double at_[2] = {0, 0}, along_[2][2] = {{0, 0}, {0, 0}};
};

/* Between four nodes, of those that have a value; of categories the nearest; NaN where the
 * nearest has none, or beyond the outermost by more than half a step. */
static double value_at(const HeightGrid &grid, double x, double y)
{
    constexpr double BESIDE = 0.5 + 1e-6;
    if (!(x >= -BESIDE && y >= -BESIDE && x <= grid.nx - 1 + BESIDE && y <= grid.ny - 1 + BESIDE))
        return NAN;
    x = std::clamp(x, 0.0, double(grid.nx - 1));
    y = std::clamp(y, 0.0, double(grid.ny - 1));
    const float nearest = grid.at(uint32_t(x + 0.5), uint32_t(y + 0.5));
    if (std::isnan(nearest) || grid.has_categories)
        return double(nearest);
    const uint32_t i = std::min(uint32_t(x), std::max(grid.nx, 2u) - 2);
    const uint32_t j = std::min(uint32_t(y), std::max(grid.ny, 2u) - 2);
    double sum = 0, weights = 0;
    for (uint32_t k = 0; k < 4; ++k) {
        const uint32_t a = std::min(i + k % 2, grid.nx - 1), b = std::min(j + k / 2, grid.ny - 1);
        const double wx = k % 2 ? x - i : 1 - (x - i), wy = k / 2 ? y - j : 1 - (y - j);
        const float value = grid.at(a, b);
        if (!std::isnan(value) && wx * wy > 0) {
            sum += wx * wy * double(value);
            weights += wx * wy;
        }
    }
    return weights > 0 ? sum / weights : NAN;
}

/* ---- other sizes ---- */

/* Samples along a side of what a node stands for: no node of a finer grid is passed over. */
static uint32_t samples_in(double nodes)
{
    constexpr double MAX_SAMPLES = 64; /* 4096 looks a node */
    return uint32_t(std::clamp(std::ceil(nodes - 1e-6), 1.0, MAX_SAMPLES));
}

/* The mean, or of categories the most frequent, of which the lowest. Sorts them. */
static double middle_of(Vector<double> &values, bool has_categories)
{
    if (!has_categories) {
        double sum = 0;
        for (double value : values)
            sum += value;
        return sum / double(values.size());
    }
    std::sort(values.begin(), values.end());
    size_t best = 0, most = 0;
    for (size_t i = 0, j = 0; i < values.size(); i = j) {
        while (j < values.size() && values[j] == values[i])
            ++j;
        if (j - i > most) {
            most = j - i;
            best = i;
        }
    }
    return values[best];
}

Vector<float> resample(const HeightGrid &from, const HeightGrid &to)
{
    if (from.in_degrees != to.in_degrees && !from.is_unplaced && !to.is_unplaced)
        malformed(std::string("it lies in ") + (from.in_degrees ? "degrees" : "metres") +
                  ", and its grid in " + (to.in_degrees ? "degrees" : "metres"));
    const bool same_place = from.is_unplaced || to.is_unplaced ||
                            (from.place(0, 0) == to.place(0, 0) &&
                             from.place(from.nx - 1, from.ny - 1) ==
                                 to.place(to.nx - 1, to.ny - 1));
    if (from.nx == to.nx && from.ny == to.ny && same_place)
        return from.values;
    const Passage passage(from, to);
    const auto at = passage(0, 0), right = passage(1, 0), up = passage(0, 1);
    const auto far = [&](const std::array<double, 2> &p) {
        return std::max(std::fabs(p[0] - at[0]), std::fabs(p[1] - at[1]));
    };
    const uint32_t nx = samples_in(far(right)), ny = samples_in(far(up));
    Vector<float> out(to.count(), NAN);
    Vector<double> found;
    bool any = false;
    for (uint32_t j = 0; j < to.ny; ++j) {
        cancel_point(size_t(to.nx) * nx * ny);
        for (uint32_t i = 0; i < to.nx; ++i) {
            found.clear();
            for (uint32_t k = 0; k < nx * ny; ++k) {
                const double dx = (k % nx + 0.5) / nx - 0.5, dy = (k / nx + 0.5) / ny - 0.5;
                const auto place = passage(i + dx, j + dy);
                const double value = value_at(from, place[0], place[1]);
                if (!std::isnan(value))
                    found.push_back(value);
            }
            if (found.empty() || 2 * found.size() < nx * ny)
                continue;
            out[size_t(j) * to.nx + i] = float(middle_of(found, from.has_categories));
            any = true;
        }
    }
    if (!any)
        malformed("it has no value anywhere on its grid: they lie apart, or in other units");
    return out;
}

/* ---- parts ---- */

/* Nodes of one lattice may differ by this part of a step: headers are rounded. */
constexpr double OFF_LATTICE = 1e-3;

/* The node of the first part's lattice that a part begins at. */
static std::array<int64_t, 2> place_of(const HeightGrid &part, const HeightGrid &first)
{
    const double turn = -first.rotation * std::acos(-1.0) / 180;
    const double x = part.origin[0] - first.origin[0], y = part.origin[1] - first.origin[1];
    const double local[2] = {gtx_cos(turn) * x - gtx_sin(turn) * y,
                             gtx_sin(turn) * x + gtx_cos(turn) * y};
    const uint32_t size[2] = {part.nx, part.ny};
    std::array<int64_t, 2> place;
    for (int k = 0; k < 2; ++k) {
        const double nodes = local[k] / first.step[k];
        place[size_t(k)] = std::llround(std::clamp(nodes, -1e9, 1e9));
        if (std::fabs(nodes - double(place[size_t(k)])) > OFF_LATTICE ||
            std::fabs(part.step[k] / first.step[k] - 1) * size[k] > OFF_LATTICE ||
            part.rotation != first.rotation)
            malformed("parts of one surface have other steps, or nodes beside each other's");
    }
    return place;
}

/* Copies a part to column x and row y of the surface; what an earlier part had stays. */
static void lay(const HeightGrid &part, size_t x, size_t y, HeightGrid &out, SharedNodes *shared)
{
    for (uint32_t j = 0; j < part.ny; ++j)
        for (uint32_t i = 0; i < part.nx; ++i) {
            float &to = out.values[(y + j) * out.nx + x + i];
            const float value = part.at(i, j);
            if (shared && !std::isnan(to) && !std::isnan(value)) {
                ++shared->count;
                shared->differing += to != value;
                shared->difference =
                    std::max(shared->difference, std::fabs(double(to) - double(value)));
            }
            if (std::isnan(to))
                to = value;
        }
}

HeightGrid mosaic(const Vector<HeightGrid> &parts, const Limits &limits, SharedNodes *shared)
{
    const HeightGrid &first = parts.at(0);
    Vector<std::array<int64_t, 2>> at;
    int64_t low[2] = {0, 0}, high[2] = {0, 0};
    for (const HeightGrid &part : parts) {
        at.push_back(place_of(part, first));
        const uint32_t size[2] = {part.nx, part.ny};
        for (int k = 0; k < 2; ++k) {
            low[k] = std::min(low[k], at.back()[size_t(k)]);
            high[k] = std::max(high[k], at.back()[size_t(k)] + size[k]);
        }
    }
    limits.require(GTX_LIMITED_TEXELS, "the surface of all parts",
                   uint64_t(high[0] - low[0]) * uint64_t(high[1] - low[1]));
    if (std::max(high[0] - low[0], high[1] - low[1]) > MAX_SIDE)
        throw Error(GTX_ERROR_LIMIT, "the parts of the surface span more than 2^24 nodes");
    HeightGrid out = first;
    const auto origin = first.place(double(low[0]), double(low[1]));
    out.nx = uint32_t(high[0] - low[0]);
    out.ny = uint32_t(high[1] - low[1]);
    out.origin[0] = origin[0];
    out.origin[1] = origin[1];
    out.values.assign(out.count(), NAN);
    for (size_t p = 0; p < parts.size(); ++p)
        lay(parts[p], size_t(at[p][0] - low[0]), size_t(at[p][1] - low[1]), out, shared);
    return out;
}

/* ---- mistakes ---- */

/* Looks at up to so many places of each. */
constexpr uint32_t LOOKS = 24;

bool are_alike(const HeightGrid &a, const HeightGrid &b)
{
    constexpr uint32_t FEW = 16;
    constexpr double SAME = 1e-3; /* of how far the heights looked at differ */
    const Passage passage(a, b);
    double low = INFINITY, high = -INFINITY;
    double differences[LOOKS * LOOKS];
    uint32_t found = 0, same = 0;
    for (uint32_t k = 0; k < LOOKS * LOOKS; ++k) {
        const uint32_t i = uint32_t(uint64_t(b.nx - 1) * (k % LOOKS) / (LOOKS - 1));
        const uint32_t j = uint32_t(uint64_t(b.ny - 1) * (k / LOOKS) / (LOOKS - 1));
        const auto place = passage(i, j);
        const double there = value_at(a, place[0], place[1]), here = double(b.at(i, j));
        if (std::isnan(there) || std::isnan(here))
            continue;
        low = std::min(low, here);
        high = std::max(high, here);
        differences[found++] = std::fabs(there - here);
    }
    for (uint32_t k = 0; k < found; ++k)
        same += differences[k] <= SAME * (high - low);
    return found >= FEW && 2 * same > found;
}

uint64_t count_crossings(const HeightGrid &a, const HeightGrid &b)
{
    if (a.nx != b.nx || a.ny != b.ny || a.place(0, 0) != b.place(0, 0) ||
        a.place(a.nx - 1, a.ny - 1) != b.place(b.nx - 1, b.ny - 1))
        return 0;
    uint64_t above = 0, below = 0;
    for (size_t k = 0; k < a.count(); ++k) { /* NaN is neither */
        above += a.values[k] > b.values[k];
        below += a.values[k] < b.values[k];
    }
    return std::min(above, below);
}

} // namespace gtx
