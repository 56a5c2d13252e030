/* Holes, walls, leaks, depth and shading in one view of an asset. */
#include "measure/figures.hpp"

#include <algorithm>

namespace gtx {

/* Tolerances: pixels, height steps and fractions of the diagonal (format/measures.md). */
static const double HOLE_PIXELS = 2, HOLE_STEPS = 4, HOLE_DIAGONAL = 0.001, FLAT_DIAGONAL = 0.01;
static const double WALL_DIAGONAL = 0.01, TURNED_DEGREES = 45;

namespace {

/* The source around a pixel: whether all nine are seen from the front, and their depths, infinite
 * where there is none. */
struct Around {
    bool surface = true;
    float nearest = std::numeric_limits<float>::infinity(), deepest = 0;
};

/* A pixel where the asset is deeper, or nearer, than what all nine show of the source by more than
 * it may, or faces another way than the source does there. */
struct Suspect {
    uint32_t i, j;
    ViewHit hit;
    Fault kind;
    double off;                  /* from the nearest or the deepest of the nine; degrees */
    double tolerance;            /* of depths */
};

/* One view at one level while it is measured. */
struct Look {
    const Comparison &all;
    const Scene &scene;
    uint32_t view_index;
    const View &view;
    const MeshImage &image;
    const AssetView &asset;
    Figures &out;
    Vector<Suspect> suspects = {};

    void pixel(uint32_t i, uint32_t j, const ViewHit &hit);
    void faults();
    void fault(const Suspect &suspect);
    bool is_excused(const Suspect &suspect, const MeshImage &close) const;
    bool faces_alike(const Vec3d &normal, const View &shown, const MeshImage &of, uint32_t i,
                     uint32_t j) const;
    bool shows_as_turned(const Suspect &suspect, const MeshImage &close) const;
    bool tells_which_way(size_t at, const Vec3d &normal) const;
    void appearance(uint32_t i, uint32_t j, const ViewHit &hit, double depth_error,
                    double tolerance);
    void leaks(const Vector<Crossing> &crossings);
};

} // namespace

static Around look_around(const MeshImage &image, uint32_t size, uint32_t i, uint32_t j)
{
    Around around;
    around.surface = i > 0 && j > 0 && i + 1 < size && j + 1 < size;
    for (uint32_t b = j - (j > 0); b <= std::min(j + 1, size - 1); ++b)
        for (uint32_t a = i - (i > 0); a <= std::min(i + 1, size - 1); ++a) {
            size_t at = size_t(b) * size + a;
            around.surface &= image.front[at] != 0;
            around.nearest = std::min(around.nearest, image.depth[at]);
            around.deepest = std::max(around.deepest, image.depth[at]);
        }
    return around;
}

/* Headlight Lambert, in 8-bit sRGB. */
static void shade(const Fragment &fragment, const Vec3d &toward, double out[3])
{
    double light = 0.2 + 0.8 * std::max(0., dot(fragment.normal, toward));
    for (int k = 0; k < 3; ++k)
        out[k] = std::round(std::clamp(fragment.color[k] * light, 0., 255.));
}

/* Sum of squared differences of the two images, black where nothing is. */
static double color_difference(const Fragment *source, const Fragment *asset, const Vec3d &toward)
{
    double a[3] = {0, 0, 0}, b[3] = {0, 0, 0}, sum = 0;
    if (source)
        shade(*source, toward, a);
    if (asset)
        shade(*asset, toward, b);
    for (int k = 0; k < 3; ++k)
        sum += (a[k] - b[k]) * (a[k] - b[k]);
    return sum;
}

static double degrees_between(const Vec3d &a, const Vec3d &b)
{
    return std::atan2(length(cross(a, b)), dot(a, b)) * 180 / 3.14159265358979323846;
}

void Look::fault(const Suspect &s)
{
    ++(s.kind == Fault::hole ? out.holes : s.kind == Fault::wall ? out.walls : out.turned);
    if (!scene.list_faults)
        return;
    const size_t at = size_t(s.j) * view.size + s.i;
    const double depth = s.kind == Fault::hole ? image.depth[at] : double(s.hit.t);
    out.faults.push_back({s.kind, scene.level, view.size, view_index, s.i, s.j, image.triangle[at],
                          s.hit.patch, s.hit.asset, s.off,
                          view.at(s.i, s.j) - view.toward * depth});
}

/* Whether the source, too, shows something as deep: past an outline that runs between the centres
 * of pixels, where no more than that has moved. */
static bool shows_as_deep(const MeshImage &close, const Suspect &s)
{
    for (size_t at = 0; at < close.depth.size(); ++at)
        if (!close.front[at] || s.hit.t - close.depth[at] <= s.tolerance)
            return true;
    return false;
}

/* Likewise something as near: what juts out less than that is excused. */
static bool shows_as_near(const MeshImage &close, const Suspect &s)
{
    return std::any_of(close.depth.begin(), close.depth.end(),
                       [&](float depth) { return depth <= s.hit.t + s.tolerance; });
}

bool Look::faces_alike(const Vec3d &normal, const View &shown, const MeshImage &of, uint32_t i,
                       uint32_t j) const
{
    return of.triangle[size_t(j) * shown.size + i] != NO_HIT &&
           degrees_between(fragment_at(all.mesh, shown, of, i, j).normal, normal) <= TURNED_DEGREES;
}

/* Whether the source faces as the asset does anywhere within a texel, or a pixel. */
bool Look::shows_as_turned(const Suspect &s, const MeshImage &close) const
{
    const Vec3d normal = asset.fragment(s.hit, view).normal;
    const View closer = close_view(view, s.i, s.j);
    for (uint32_t b = 0; b < CLOSE_SIDE; ++b)
        for (uint32_t a = 0; a < CLOSE_SIDE; ++a)
            if (faces_alike(normal, closer, close, a, b))
                return true;
    const uint32_t reach = uint32_t(std::min(asset.texel(s.hit) / view.pixel, double(view.size)));
    for (uint32_t b = s.j - std::min(s.j, reach); b < std::min(s.j + reach + 1, view.size); ++b)
        for (uint32_t a = s.i - std::min(s.i, reach); a < std::min(s.i + reach + 1, view.size); ++a)
            if (faces_alike(normal, view, image, a, b))
                return true;
    return false;
}

bool Look::is_excused(const Suspect &s, const MeshImage &close) const
{
    switch (s.kind) {
    case Fault::hole: return shows_as_deep(close, s);
    case Fault::wall: return shows_as_near(close, s);
    case Fault::turned: return shows_as_turned(s, close);
    }
    return false;
}

/* Suspects are looked at more closely, so many at a time that their images take little room. */
void Look::faults()
{
    constexpr size_t AT_ONCE = 1024;
    for (size_t first = 0; first < suspects.size(); first += AT_ONCE) {
        const size_t end = std::min(first + AT_ONCE, suspects.size());
        Vector<ClosePixel> pixels;
        for (size_t k = first; k < end; ++k) {
            const Suspect &s = suspects[k];
            pixels.push_back({s.i, s.j, s.kind == Fault::hole ? double(INFINITY)
                                                              : double(s.hit.t) + s.tolerance});
        }
        const Vector<MeshImage> close = rasterise_close(all.mesh, view, pixels);
        for (size_t k = first; k < end; ++k)
            if (!is_excused(suspects[k], close[k - first]))
                fault(suspects[k]);
    }
}

/* Whether the source is seen from its front there, by a normal on that side of its triangle: no
 * height field has others. */
bool Look::tells_which_way(size_t at, const Vec3d &normal) const
{
    const Vec3d area = all.mesh.area_vector(image.triangle[at]);
    return image.front[at] && dot(area, normal) * dot(area, view.toward) > 0;
}

void Look::appearance(uint32_t i, uint32_t j, const ViewHit &hit, double depth_error,
                      double tolerance)
{
    const size_t at = size_t(j) * view.size + i;
    bool in_source = image.triangle[at] != NO_HIT;
    bool in_asset = hit.patch != NO_HIT;
    Fragment source = {}, seen = {};
    if (in_source)
        source = fragment_at(all.mesh, view, image, i, j);
    if (in_asset)
        seen = asset.fragment(hit, view);
    out.color_square += color_difference(in_source ? &source : nullptr, in_asset ? &seen : nullptr,
                                         view.toward);
    if (!in_source || !in_asset || std::abs(depth_error) > tolerance)
        return;
    const double angle = degrees_between(source.normal, seen.normal);
    out.angle.push_back(float(angle));
    if (angle > TURNED_DEGREES && tells_which_way(at, source.normal))
        suspects.push_back({i, j, hit, Fault::turned, angle, tolerance});
}

void Look::pixel(uint32_t i, uint32_t j, const ViewHit &hit)
{
    const size_t at = size_t(j) * view.size + i;
    const bool in_source = image.triangle[at] != NO_HIT, in_asset = hit.patch != NO_HIT;
    out.both += in_source && in_asset;
    out.either += in_source || in_asset;
    if (!in_source && !in_asset)
        return;

    const double diagonal = all.extent.diagonal;
    double tolerance = std::max(HOLE_PIXELS * view.pixel, HOLE_DIAGONAL * diagonal);
    if (in_asset)
        tolerance = std::max(tolerance, HOLE_STEPS * asset.height_step(hit));
    const double error = double(hit.t) - image.depth[at]; /* meaningless unless in both */
    const Around around = look_around(image, view.size, i, j);
    if (around.surface) {
        ++out.surface;
        if (!in_asset || hit.t - around.deepest > tolerance)
            suspects.push_back({i, j, hit, Fault::hole, hit.t - around.deepest, tolerance});
    }
    const double thick = std::max(WALL_DIAGONAL * diagonal, tolerance);
    if (in_asset && around.nearest - hit.t > thick)
        suspects.push_back({i, j, hit, Fault::wall, around.nearest - hit.t, thick});
    if (!scene.appearance)
        return;
    if (around.surface && in_asset && around.deepest - around.nearest < FLAT_DIAGONAL * diagonal)
        out.depth.push_back(float(std::abs(error) / diagonal));
    appearance(i, j, hit, error, tolerance);
}

/* A leak counts where its 3x3 is covered. */
void Look::leaks(const Vector<Crossing> &crossings)
{
    const uint32_t size = view.size;
    for (uint32_t j = 1; j + 1 < size; ++j)
        for (uint32_t i = 1; i + 1 < size; ++i) {
            if (crossings[size_t(j) * size + i] != Crossing::leak)
                continue;
            bool covered = true;
            for (uint32_t b = j - 1; b <= j + 1; ++b)
                for (uint32_t a = i - 1; a <= i + 1; ++a)
                    covered &= crossings[size_t(b) * size + a] != Crossing::none;
            out.leaks += covered;
        }
}

void measure_view(const Comparison &all, const Scene &scene, uint32_t view_index,
                         const MeshImage &image, Figures &out)
{
    const View &view = scene.views[view_index];
    Look look = {all, scene, view_index, view, image, scene.asset, out};
    Vector<ViewHit> hits;
    Vector<Crossing> row, crossings;
    crossings.reserve(size_t(view.size) * view.size);
    for (uint32_t j = 0; j < view.size; ++j) {
        cancel_point();
        look.asset.cast_row(view, j, hits, row);
        crossings.insert(crossings.end(), row.begin(), row.end());
        for (uint32_t i = 0; i < view.size; ++i)
            look.pixel(i, j, hits[i]);
    }
    look.faults();
    look.leaks(crossings);
}

} // namespace gtx
