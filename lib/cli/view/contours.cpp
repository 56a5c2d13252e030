/* Contours as a pass over a picture and its depth. */
#include "cli/view/contours.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace gtx {

constexpr double WIDE = 5;      /* every so many steps a line is wider */

/* As gtx_horizons writes it. Untrusted: anything else is 1. */
static double vertical_of(const Scene &scene)
{
    for (const PlacedAsset &placed : scene.assets) {
        size_t size = 0;
        const char *text = gtx_meta(placed.asset.get(), &size);
        const auto meta = nlohmann::json::parse(text, text + size, nullptr, false);
        if (meta.is_object() && meta.contains("vertical") && meta["vertical"].is_number())
            if (const double vertical = meta["vertical"].get<double>();
                vertical > 1e-9 && vertical < 1e9)
                return vertical;
    }
    return 1;
}

/* Of everything, along +Y. */
static double height_of(const Scene &scene)
{
    double low = INFINITY, high = -INFINITY;
    const auto add = [&](double y) {
        low = std::min(low, y);
        high = std::max(high, y);
    };
    for (const Mesh &mesh : scene.meshes)
        for (const Vec3d &p : mesh.positions)
            add(p.y);
    for (const PlacedWorld &world : scene.worlds) {
        add(world.info.low[1]);
        add(world.info.high[1]);
    }
    for (const PlacedAsset &placed : scene.assets) {
        gtx_info info;
        gtx_get_info(placed.asset.get(), &info);
        const Transform &m = placed.transform;
        for (int corner = 0; corner < 8; ++corner) {
            double y = m[13];
            for (int i = 0; i < 3; ++i)
                y += m[size_t(4 * i + 1)] *
                     (info.anchor[i] + double(corner >> i & 1 ? info.bounds_max[i]
                                                              : info.bounds_min[i]));
            add(y);
        }
    }
    return high > low ? high - low : 0;
}

Contours contours_of(const Scene &scene, double step)
{
    constexpr double MAX_LINES = 25;
    Contours out = {step, vertical_of(scene)};
    const double height = height_of(scene) / out.vertical;
    if (step > 0 || height <= 0)
        return out;
    const double power = std::pow(10, std::floor(std::log10(height / MAX_LINES)));
    for (double times : {1., 2., 5., 10.})
        if (out.step <= 0 && height / (times * power) <= MAX_LINES)
            out.step = times * power;
    return out;
}

namespace {

/* Heights in steps, pixel by pixel; NaN where there is nothing. */
class Heights {
public:
    Heights(const Contours &contours, const Scene &scene, const gtx_view &view,
            const Vector<float> &depth)
        : width_(view.viewport_width), heights_(depth.size(), NAN)
    {
        const double scale = 1 / (contours.step * contours.vertical);
        const float *v = view.view, *p = view.projection;
        const double shift = double(v[4]) * v[12] + double(v[5]) * v[13] + double(v[6]) * v[14];
        for (size_t i = 0; i < depth.size(); ++i) {
            if (!std::isfinite(depth[i]))
                continue;
            const double x = 2 * (double(i % width_) + 0.5) / width_ - 1;
            const double y = 1 - 2 * (double(i / width_) + 0.5) / view.viewport_height;
            const double d = double(depth[i]);
            const double eye[3] = {d * (x + double(p[8])) / double(p[0]),
                                   d * (y + double(p[9])) / double(p[5]), -d};
            const double up = double(v[4]) * eye[0] + double(v[5]) * eye[1] +
                              double(v[6]) * eye[2] - shift;
            heights_[i] = (up + scene.centre.y) * scale;
        }
    }
    double at(uint32_t x, uint32_t y) const { return heights_[size_t(y) * width_ + x]; }

    /* How much they change to the next pixel, on the side where that is less: the other one may
     * belong to what is behind. */
    double slope(uint32_t x, uint32_t y, uint32_t height) const
    {
        return std::hypot(less(x, y, x > 0 ? x - 1 : x, y, x + 1 < width_ ? x + 1 : x, y),
                          less(x, y, x, y > 0 ? y - 1 : y, x, y + 1 < height ? y + 1 : y));
    }

private:
    double less(uint32_t x, uint32_t y, uint32_t ax, uint32_t ay, uint32_t bx, uint32_t by) const
    {
        const double here = at(x, y);
        const double a = std::fabs(at(ax, ay) - here), b = std::fabs(at(bx, by) - here);
        const bool has_a = (ax != x || ay != y) && !std::isnan(a);
        const bool has_b = (bx != x || by != y) && !std::isnan(b);
        return has_a && has_b ? std::min(a, b) : has_a ? a : has_b ? b : 0;
    }

    uint32_t width_;
    Vector<double> heights_;
};

/* The share of a pixel that a line covers which is so many pixels away. */
double cover(double away, double width)
{
    return std::clamp(width / 2 + 0.5 - away, 0., 1.);
}

} // namespace

void draw_contours(const Contours &contours, const Scene &scene, const gtx_view &view,
                   const Vector<float> &depth, Vector<uint8_t> &color)
{
    constexpr double THIN = 1, THICK = 2, DARK = 0.7; /* pixels; the share of black */
    constexpr double CROWDED = 0.4; /* lines a pixel, where none are drawn */
    if (!(contours.step > 0))
        return;
    const Heights heights(contours, scene, view, depth);
    for (uint32_t y = 0; y < view.viewport_height; ++y)
        for (uint32_t x = 0; x < view.viewport_width; ++x) {
            const double here = heights.at(x, y);
            if (std::isnan(here))
                continue;
            const double slope = heights.slope(x, y, view.viewport_height);
            if (slope <= 0 || slope > CROWDED)
                continue;
            const double away = std::fabs(here - std::round(here)) / slope;
            const double far = std::fabs(here / WIDE - std::round(here / WIDE)) * WIDE / slope;
            const double fade = std::min(1., (CROWDED - slope) / (CROWDED / 2));
            const double share = DARK * std::max(fade * cover(away, THIN), cover(far, THICK));
            uint8_t *pixel = &color[4 * (size_t(y) * view.viewport_width + x)];
            for (int c = 0; c < 3; ++c)
                pixel[c] = uint8_t(double(pixel[c]) * (1 - share) + 0.5);
        }
}

} // namespace gtx
