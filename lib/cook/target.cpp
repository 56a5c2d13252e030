/* Searches the texel pitch, then bits and patches, that keep to an error with the fewest bytes. */
#include "cook/target.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

namespace gtx {

namespace {

/* Errors go with this power of the pitch, until measured otherwise. */
constexpr double POWER = 1.4;
constexpr double AIM = 0.97;           /* of the error that is asked for */
constexpr double CLOSE_ENOUGH = 0.94;  /* likewise: no coarser pitch is looked for */
constexpr double NARROW = 1.03;        /* ratio of pitches between which the search ends */
constexpr double LONGEST_STEP = 4;
constexpr int MAX_ATTEMPTS = 12;
/* Pitches beyond these parts of the default one are not tried. */
constexpr double COARSEST = 16, FINEST = 1.0 / 8;
/* Sixteen bits are tried where they take as much from the error at the same pitch. */
constexpr double WORTH_BITS = 0.92;
constexpr double PATCHES_STEP = 1.5;

struct Point {
    double pitch, error;
};

class Search {
public:
    Search(const Options &options, const Cook &cook)
        : options_(options), error_(options.error), cook_(cook)
    {
    }

    void find_pitch();
    void try_sixteen_bits();
    void try_patches();
    Attempt take();

private:
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
    double next_pitch(const std::optional<Point> &good, const std::optional<Point> &bad) const;

    Options options_;
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
        double power = std::log(bad->error / good->error) / std::log(bad->pitch / good->pitch);
        double part = std::log(AIM * error_ / good->error) /
                      (std::max(power, 0.1) * std::log(bad->pitch / good->pitch));
        part = std::clamp(part, 0.1, 0.9);
        return good->pitch * std::pow(bad->pitch / good->pitch, part);
    }
    const Point &only = good ? *good : *bad;
    double step = std::pow(AIM * error_ / only.error, 1 / POWER);
    step = std::clamp(step, 1 / LONGEST_STEP, LONGEST_STEP);
    return std::clamp(only.pitch * step, FINEST * first_pitch_, COARSEST * first_pitch_);
}

void Search::find_pitch()
{
    std::optional<Point> good, bad;
    Options options = options_;
    for (int n = 0; n < MAX_ATTEMPTS; ++n) {
        double rms = attempt(options);
        Point here = {options.chart.pitch > 0 ? options.chart.pitch : first_pitch_, rms};
        (rms <= error_ ? good : bad) = here;
        if (good && (good->error >= CLOSE_ENOUGH * error_ ||
                     (bad && bad->pitch < NARROW * good->pitch)))
            return;
        double pitch = next_pitch(good, bad);
        if (pitch == here.pitch) /* at the end of what is tried */
            return;
        options.chart.pitch = pitch;
    }
}

void Search::try_sixteen_bits()
{
    if (!best_ || options_.bake.height_bits == 16)
        return;
    double coarse = best_->error.forward.rms;
    Options fine = best_options_;
    fine.bake.height_bits = fine.chart.height_bits = 16;
    if (attempt(fine) > WORTH_BITS * coarse)
        return;
    options_ = fine;
    find_pitch();
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

Attempt Search::take()
{
    if (best_)
        return std::move(*best_);
    char text[128];
    snprintf(text, sizeof text,
             "an RMS of %.3g of the diagonal is out of reach: %.3g was the least", error_, least_);
    throw Error(GTX_ERROR_LIMIT, text);
}

} // namespace

Attempt cook_to_error(const Options &options, const Cook &cook)
{
    Search search(options, cook);
    search.find_pitch();
    if (options.free_bits)
        search.try_sixteen_bits();
    if (options.free_charts)
        search.try_patches();
    return search.take();
}

} // namespace gtx
