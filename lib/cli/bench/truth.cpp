/* Averages pictures of a window that is moved by parts of a pixel, and compares others with the
 * average. */
#include "cli/bench/truth.hpp"

#include "mesh/material/srgb.hpp"

#include <cmath>
#include <cstdio>

namespace gtx {

constexpr uint32_t SAMPLES = TRUTH_SIDE * TRUTH_SIDE;

/* The sRGB code of light, not rounded. */
static float code_of(float light)
{
    return 255 * (light <= 0.0031308f ? 12.92f * light
                                      : 1.055f * std::pow(light, 1 / 2.4f) - 0.055f);
}

Truth make_truth(const std::function<Picture(double, double)> &draw)
{
    Truth out;
    for (uint32_t i = 0; i < SAMPLES; ++i) {
        const double x = (i % TRUTH_SIDE + 0.5) / TRUTH_SIDE - 0.5;
        const double y = (double(i / TRUTH_SIDE) + 0.5) / TRUTH_SIDE - 0.5;
        const Picture picture = draw(x, y);
        out.samples.resize(picture.depth.size());
        out.code.resize(3 * picture.depth.size());
        for (size_t p = 0; p < picture.depth.size(); ++p) {
            out.samples[p] += picture.covers(p);
            for (size_t k = 0; k < 3; ++k)
                out.code[3 * p + k] += srgb_to_linear(picture.color[4 * p + k]);
        }
    }
    for (float &value : out.code)
        value = code_of(value / SAMPLES);
    return out;
}

void TruthError::add(const Truth &truth, const Picture &picture)
{
    for (size_t p = 0; p < picture.depth.size(); ++p) {
        if (!truth.samples[p] && !picture.covers(p))
            continue;
        double here = 0;
        for (size_t k = 0; k < 3; ++k)
            here += std::pow(double(truth.code[3 * p + k]) - picture.color[4 * p + k], 2);
        square += here;
        values += 3;
        if (truth.samples[p] == SAMPLES) {
            inside_square += here;
            inside_values += 3;
        }
    }
}

void TruthError::add(const TruthError &other)
{
    values += other.values;
    inside_values += other.inside_values;
    square += other.square;
    inside_square += other.inside_square;
}

static double decibels(uint64_t values, double square)
{
    return 10 * std::log10(255. * 255. * double(values) / square);
}

double TruthError::psnr() const
{
    return decibels(values, square);
}

double TruthError::inside_psnr() const
{
    return decibels(inside_values, inside_square);
}

double TruthError::outline_share() const
{
    return square > 0 ? 1 - inside_square / square : 0;
}

std::string truth_cells(const TruthError &error)
{
    char text[64];
    std::snprintf(text, sizeof text, " %5.2f | %6.2f | %7.3f |", error.psnr(), error.inside_psnr(),
                  error.outline_share());
    return error.values ? text : "";
}

void write_truth(gtx_json &json, const TruthError &error)
{
    if (!error.values)
        return;
    gtx_json_number(&json, "truth_psnr_db", error.psnr());
    gtx_json_number(&json, "truth_inside_psnr_db", error.inside_psnr());
    gtx_json_number(&json, "truth_outline_share", error.outline_share());
}

} // namespace gtx
