/* Searches the texel pitch, then the height bits and the number of patches, that keep a bound on
 * the error with the fewest bytes. */
#include "cook/target.hpp"
#include "base/exact.h"

#include "asset/patch.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

namespace gtx {

namespace {

/* Measured on spot's control mesh and the duck at errors of 1e-3 and 1e-4 (A), where a search takes
 * 6 to 10 attempts, and on both at 2e-5 and spot at 1e-2 (B). */

/* Errors go with this power of the pitch, until measured otherwise. A: half and double end within
 * 9 % of the bytes after up to 5 attempts more. */
constexpr double POWER = 1.4;
/* Part of the error to aim at. A: at half three files of four are larger, by up to 82 %, after up
 * to 21 attempts more; above 1 every second attempt is in vain and spot at 1e-4 fails. */
constexpr double AIM = 0.97;
/* Part of the error from which no coarser pitch is looked for. A: half leaves spot at 1e-3 11 %
 * larger; above 1 it is never enough, up to 3 attempts more for 2 %. */
constexpr double CLOSE_ENOUGH = 0.94;
/* Ratio of pitches between which the search ends. A: below 1 it never does, up to 5 attempts more
 * for the same bytes; at double up to 2 fewer, and spot at 1e-3 7 % smaller, by luck. */
constexpr double NARROW = 1.03;
/* Ratio of the pitches of two attempts. A: files of at least 90,000 bytes stay at half and double;
 * the small ones shrink by up to 15 %, by luck. */
constexpr double LONGEST_STEP = 4;
/* A limit: no search of A or B comes to it, and half ends one of them an attempt earlier. */
constexpr int MAX_ATTEMPTS = 12;
/* Pitches beyond these parts of the default one are not tried. COARSEST: spot at 1e-2 is 69 %
 * larger at half and 59 % smaller at double, of 9 patches. FINEST: at double spot does not reach
 * 2e-5. */
constexpr double COARSEST = 16, FINEST = 1.0 / 8;
/* Sixteen bits are tried where they take as much from the error at the same pitch. At half the duck
 * at 2e-5 stays at eight and is 18 % larger; at double up to 5 attempts more for the same bytes. */
constexpr double WORTH_BITS = 0.92;
/* Patches are tried at that many times as many, and as few. A: at half, which swaps the two, and at
 * double two files of four stay, the small ones shrink by up to 13 %. */
constexpr double PATCHES_STEP = 1.5;

struct Point {
    double pitch, error;
};

class Search {
public:
    Search(double error, const Cook &cook) : error_(error), cook_(cook) {}

    /* From options of the error `rms`. */
    void find_pitch(Options options, double rms);
    void try_sixteen_bits();
    void try_patches();
    Attempt take(const char *limit);
    /* Cooks, keeps what is best so far, and tells the error. */
    double attempt(const Options &options)
    {
        Attempt made = cook_(options);
        double rms = made.error.forward.rms;
        least_ = std::min(least_, rms);
        if (first_pitch_ == 0)
            first_pitch_ = made.partition.pitch;
        if (rms <= error_ && (!best_ || made.bytes < best_->bytes)) {
            best_ = std::move(made);
            best_options_ = options;
        }
        return rms;
    }

private:
    double next_pitch(const std::optional<Point> &good, const std::optional<Point> &bad) const;

    double error_;
    const Cook &cook_;
    std::optional<Attempt> best_;
    Options best_options_;
    double first_pitch_ = 0, least_ = INFINITY;
};

/* The pitch at which the error would be right: between what is good and what is bad, or beyond. */
double Search::next_pitch(const std::optional<Point> &good, const std::optional<Point> &bad) const
{
    if (good && bad) {
        double power = gtx_log(bad->error / good->error) / gtx_log(bad->pitch / good->pitch);
        double part = gtx_log(AIM * error_ / good->error) /
                      (std::max(power, 0.1) * gtx_log(bad->pitch / good->pitch));
        part = std::clamp(part, 0.1, 0.9);
        return good->pitch * gtx_pow(bad->pitch / good->pitch, part);
    }
    const Point &only = good ? *good : *bad;
    double step = gtx_pow(AIM * error_ / only.error, 1 / POWER);
    step = std::clamp(step, 1 / LONGEST_STEP, LONGEST_STEP);
    return std::clamp(only.pitch * step, FINEST * first_pitch_, COARSEST * first_pitch_);
}

void Search::find_pitch(Options options, double rms)
{
    std::optional<Point> good, bad;
    for (int n = 1;; ++n) {
        Point here = {options.chart.pitch > 0 ? options.chart.pitch : first_pitch_, rms};
        (rms <= error_ ? good : bad) = here;
        if (good && (good->error >= CLOSE_ENOUGH * error_ ||
                     (bad && bad->pitch < NARROW * good->pitch)))
            return;
        double pitch = next_pitch(good, bad);
        if (n == MAX_ATTEMPTS || pitch == here.pitch) /* at the end of what is tried */
            return;
        options.chart.pitch = pitch;
        rms = attempt(options);
    }
}

void Search::try_sixteen_bits()
{
    if (!best_ || best_options_.bake.height_bits == 16)
        return;
    double coarse = best_->error.forward.rms;
    Options fine = best_options_;
    fine.bake.height_bits = 16;
    fine.chart.height_steps = gtx_height_steps(fine.bake.height_bits);
    double rms = attempt(fine);
    if (rms <= WORTH_BITS * coarse)
        find_pitch(fine, rms);
}

void Search::try_patches()
{
    if (!best_)
        return;
    for (double step : {PATCHES_STEP, 1 / PATCHES_STEP}) {
        Options other = best_options_;
        double charts = double(best_->partition.charts.size()) * step;
        other.chart.charts = uint32_t(std::max(1., std::round(charts)));
        other.chart.pitch = best_->partition.pitch;
        uint64_t before = best_->bytes;
        attempt(other);
        if (best_->bytes < before)
            return;
    }
}

Attempt Search::take(const char *limit)
{
    if (best_)
        return std::move(*best_);
    char text[128];
    snprintf(text, sizeof text,
             "an RMS of %.3g of the diagonal is out of reach: %.3g was the least", error_, least_);
    Error error(GTX_ERROR_LIMIT, text);
    error.limit = limit;
    throw error;
}

} // namespace

Attempt cook_to_error(const Options &options, const Cook &cook)
{
    Search search(options.error, cook);
    const char *limit = nullptr; /* what held the search back */
    try {
        search.find_pitch(options, search.attempt(options));
        if (options.free_bits)
            search.try_sixteen_bits();
        if (options.free_charts)
            search.try_patches();
    } catch (const Error &e) {
        if (e.result != GTX_ERROR_LIMIT)
            throw;
        limit = e.limit;
    }
    return search.take(limit);
}

} // namespace gtx
