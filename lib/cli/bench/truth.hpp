/* The reference picture, which is the mesh with many samples per pixel, and the error of others. */
#pragma once

#include "base/json.h"
#include "cli/bench/picture.hpp"

#include <functional>
#include <string>

namespace gtx {

constexpr uint32_t TRUTH_SIDE = 8; /* samples along a side of a pixel */

/* Light and coverage of a pixel, of TRUTH_SIDE x TRUTH_SIDE samples, each as much (a box). Light is
 * averaged, as an eye or a camera does, not its sRGB code. */
struct Truth {
    Vector<float> code;        /* RGB, of that light, 0..255 */
    Vector<uint8_t> samples;   /* covered */
};

/* Of the pictures that `draw` makes with the window moved by so many pixels in x and y. */
Truth make_truth(const std::function<Picture(double, double)> &draw);

/* How pictures differ from the truth: where either covers, inside, where all samples are covered,
 * and by luck of the outline, the rest. */
struct TruthError {
    uint64_t values = 0, inside_values = 0;
    double square = 0, inside_square = 0;  /* of differences of codes */

    void add(const Truth &truth, const Picture &picture);
    void add(const TruthError &other);
    /* Decibels; infinite: equal. NaN: there is nothing to see. */
    double psnr() const;
    double inside_psnr() const;
    double outline_share() const;          /* of the squares; 0 where there are none */
};

/* The same as columns of a table, empty if there was nothing to compare, and as members. */
constexpr const char *TRUTH_COLUMNS = " truth | inside | outline |", *TRUTH_RULES = "---|---|---|";
std::string truth_cells(const TruthError &error);
void write_truth(gtx_json &json, const TruthError &error);

} // namespace gtx
