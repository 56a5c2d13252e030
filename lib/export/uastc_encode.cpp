/* Encoding of UASTC blocks (Khronos Data Format Specification 1.4, chapter 25): every mode that
 * might do is fitted, packed as numbers, and the one of the least squared error is taken. */
#include "export/uastc_block.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace gtx {

namespace {

/* ---- lines of colours ---- */

struct Line {
    float low[CHANNELS], high[CHANNELS];
};

/* The line of the least squares through texels of a mask, over the channels of another. */
Line line_through(const UastcTexels &t, uint32_t mask, uint32_t channels, float *residual = nullptr)
{
    float mean[3] = {}, spread[3][3] = {}, axis[3] = {1, 1, 1}, count = 0;
    for (unsigned i = 0; i < UASTC_TEXELS; ++i)
        if (mask >> i & 1) {
            ++count;
            for (unsigned c = 0; c < 3; ++c)
                mean[c] += t[i][c];
        }
    for (float &m : mean)
        m /= std::max(count, 1.f);
    for (unsigned i = 0; i < UASTC_TEXELS; ++i)
        for (unsigned a = 0; a < 3; ++a)
            for (unsigned b = 0; b < 3; ++b)
                if (mask >> i & channels >> a & channels >> b & 1)
                    spread[a][b] += (t[i][a] - mean[a]) * (t[i][b] - mean[b]);
    for (unsigned c = 0; c < 3; ++c) /* the row that has most turns soonest */
        if (spread[c][c] >= std::max({spread[0][0], spread[1][1], spread[2][2]}))
            std::copy(spread[c], spread[c] + 3, axis);
    float size = 0;
    for (int turn = 0; turn < 6; ++turn) {
        float next[3];
        for (unsigned a = 0; a < 3; ++a)
            next[a] = spread[a][0] * axis[0] + spread[a][1] * axis[1] + spread[a][2] * axis[2];
        size = std::sqrt(next[0] * next[0] + next[1] * next[1] + next[2] * next[2]);
        for (unsigned a = 0; a < 3; ++a)
            axis[a] = size > 0 ? next[a] / size : 0;
    }
    if (residual)
        *residual = std::max(spread[0][0] + spread[1][1] + spread[2][2] - size, 0.f);
    float from = 0, to = 0;
    for (unsigned i = 0; i < UASTC_TEXELS; ++i)
        if (mask >> i & 1) {
            float along = 0;
            for (unsigned c = 0; c < 3; ++c)
                along += (t[i][c] - mean[c]) * axis[c];
            from = std::min(from, along);
            to = std::max(to, along);
        }
    Line out;
    for (unsigned c = 0; c < 3; ++c) {
        out.low[c] = mean[c] + from * axis[c];
        out.high[c] = mean[c] + to * axis[c];
    }
    return out;
}

uint8_t clamped(float value)
{
    return uint8_t(std::clamp(std::lround(value), 0l, 255l));
}

void set_ends(UastcFit &fit, unsigned subset, const Line &line)
{
    const UastcEnds &table = ends_of(*fit.mode);
    for (unsigned c = 0; c < CHANNELS; ++c) {
        fit.ends[subset][0][c] = table.value[clamped(line.low[c])];
        fit.ends[subset][1][c] = table.value[clamped(line.high[c])];
    }
}

/* The weight of each texel and plane that is nearest, and the error of it all. */
void set_weights(UastcFit &fit, const UastcTexels &t)
{
    const uint32_t count = 1u << fit.mode->weight_bits;
    fit.error = 0;
    for (unsigned i = 0; i < UASTC_TEXELS; ++i) {
        const auto &end = fit.ends[fit.subset_of(i)];
        for (unsigned plane = 0; plane < fit.mode->planes; ++plane) {
            float along = 0, length = 0;
            for (unsigned c = 0; c < CHANNELS; ++c)
                if (fit.plane_of(c) == plane) {
                    const float d = float(end[1][c]) - end[0][c];
                    along += d * (float(t[i][c]) - end[0][c]);
                    length += d * d;
                }
            const float share = length > 0 ? std::clamp(along / length, 0.f, 1.f) : 0;
            const uint32_t guess = uint32_t(share * float(count - 1) + 0.5f);
            uint32_t least = ~0u, best = guess;
            for (uint32_t w = guess ? guess - 1 : 0; w < std::min(guess + 2, count); ++w) {
                uint32_t error = 0;
                for (unsigned c = 0; c < CHANNELS; ++c)
                    if (fit.plane_of(c) == plane) {
                        const int d = between(end[0][c], end[1][c],
                                              weight_of(w, fit.mode->weight_bits)) - t[i][c];
                        error += uint32_t(d * d);
                    }
                if (error < least) {
                    least = error;
                    best = w;
                }
            }
            fit.weights[plane][i] = uint8_t(best);
            fit.error += least;
        }
    }
}

/* The ends of least squares for the weights as they are. */
void refine(UastcFit &fit, const UastcTexels &t)
{
    for (unsigned s = 0; s < fit.mode->subsets; ++s) {
        Line line;
        for (unsigned c = 0; c < CHANNELS; ++c) {
            float aa = 0, ab = 0, bb = 0, ax = 0, bx = 0;
            for (unsigned i = 0; i < UASTC_TEXELS; ++i) {
                if (fit.subset_of(i) != s)
                    continue;
                const float b = float(weight_of(fit.weights[fit.plane_of(c)][i],
                                                fit.mode->weight_bits)) / 64, a = 1 - b;
                aa += a * a;
                ab += a * b;
                bb += b * b;
                ax += a * t[i][c];
                bx += b * t[i][c];
            }
            const float determinant = aa * bb - ab * ab;
            const bool solvable = determinant > 1e-3f;
            line.low[c] = solvable ? (ax * bb - bx * ab) / determinant : float(fit.ends[s][0][c]);
            line.high[c] = solvable ? (bx * aa - ax * ab) / determinant : float(fit.ends[s][1][c]);
        }
        set_ends(fit, s, line);
    }
    set_weights(fit, t);
}

void try_fit(UastcFit fit, const UastcTexels &t, UastcFit &best)
{
    constexpr int TURNS = 2;
    set_weights(fit, t);
    for (int turn = 0;; ++turn) {
        if (fit.error < best.error)
            best = fit;
        if (turn == TURNS || fit.error == 0)
            break;
        refine(fit, t);
    }
}

/* ---- choices ---- */

constexpr uint32_t ALL = 0xffff, RGB = 7;

void try_pairs(const UastcTexels &t, UastcFit &best)
{
    float least = INFINITY;
    UastcFit fit;
    for (uint32_t p = 0; p < std::size(HALVES); ++p) {
        float first, second;
        line_through(t, ALL & ~HALVES[p], RGB, &first);
        line_through(t, HALVES[p], RGB, &second);
        if (first + second < least) {
            least = first + second;
            fit.pattern = p;
        }
    }
    if (least >= float(best.error))
        return;
    for (const Mode &mode : PAIR) {
        fit.mode = &mode;
        set_ends(fit, 0, line_through(t, ALL & ~HALVES[fit.pattern], RGB));
        set_ends(fit, 1, line_through(t, HALVES[fit.pattern], RGB));
        try_fit(fit, t, best);
    }
}

void try_apart(const UastcTexels &t, UastcFit &best)
{
    for (uint32_t channel = 0; channel < CHANNELS; ++channel) {
        UastcFit fit;
        fit.mode = &APART;
        fit.apart = channel;
        Line line = line_through(t, ALL, RGB & ~(1u << channel));
        line.low[channel] = 255;
        line.high[channel] = 0;
        for (const auto &texel : t) {
            line.low[channel] = std::min(line.low[channel], float(texel[channel]));
            line.high[channel] = std::max(line.high[channel], float(texel[channel]));
        }
        set_ends(fit, 0, line);
        try_fit(fit, t, best);
    }
}

} // namespace

UastcBlock encode_uastc(const UastcTexels &texels)
{
    /* Squared error of all 48 numbers that needs no second line, on the helmet's four maps of 938k
     * texels: half takes a tenth more time for .02 dB, three times as much gives .2 dB away. */
    constexpr uint32_t GOOD = 128;
    if (std::all_of(texels.begin(), texels.end(), [&](auto &t) { return t == texels[0]; }))
        return pack_solid(texels[0]);
    UastcFit best, fit;
    const Line line = line_through(texels, ALL, RGB);
    for (const Mode &mode : SINGLE) {
        fit.mode = &mode;
        set_ends(fit, 0, line);
        try_fit(fit, texels, best);
    }
    if (best.error > GOOD) {
        try_apart(texels, best);
        try_pairs(texels, best);
    }
    return pack(best, texels);
}

} // namespace gtx
