/* What the programs of `make paper-figures` share: frame times as a table, JSON and curves. */
#pragma once

#include <cstdint>
#include <string>
#include <vector>

/* One measured cell of a figure. */
struct FigureRow {
    std::string scene;        /* a panel of the picture: "top", say */
    std::string method;       /* a curve in it */
    std::string window;       /* "640x480" */
    uint64_t pixels;          /* covered by what is drawn */
    int frames;
    double median, least;     /* milliseconds */
};

/* Median and least of the frames that `draw` finishes: `wanted` of them after one to warm up, or
 * that one alone where it takes more than two seconds. */
struct FigureTimes {
    int frames;
    double median, least;
};
template <class Draw> FigureTimes time_frames(int wanted, Draw draw);

/* Prints a line of the table; the head is printed with the first. */
void print_row(const FigureRow &row, bool first);

/* OUT/NAME.json and OUT/NAME.svg: frames a second over covered pixels, both logarithmic, a panel a
 * scene. Returns false where they cannot be written. */
bool write_figure(const std::string &folder, const std::string &name, const std::string &title,
                  const std::string &platform, const std::vector<FigureRow> &rows);

/* ---- */

#include <algorithm>
#include <chrono>

template <class Draw> FigureTimes time_frames(int wanted, Draw draw)
{
    constexpr double ONCE = 2000;
    auto time = [&] {
        const auto start = std::chrono::steady_clock::now();
        draw();
        return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
            .count();
    };
    const double first = time();
    if (first > ONCE)
        return {1, first, first};
    std::vector<double> times;
    for (int n = 0; n < wanted; ++n)
        times.push_back(time());
    std::sort(times.begin(), times.end());
    return {wanted, times[times.size() / 2], times[0]};
}
