/* Surfaces around the eye, hollows in a ball of rock: a hall, and a cave of one long passage. */
#pragma once

#include "shell.hpp"

/* Four octaves of noise, about -1..1. */
inline double rough(Vec p)
{
    double sum = 0, share = 0.53;
    for (int octave = 0; octave < 4; ++octave, share /= 2) {
        sum += share * noise(p[0], p[1], p[2]);
        for (double &x : p)
            x = 2 * x + 11.5;
    }
    return sum;
}

/* Wet stone below, dry above, ochre where it bulges. */
inline Vec stone(double height, double bulge)
{
    const Vec wet = {.24, .25, .24}, dry = {.62, .58, .52}, ochre = {.66, .47, .28};
    return mix(mix(wet, dry, smooth(0.5 + height)), ochre, 0.6 * smooth(2 * bulge));
}

/* A flattened ball of radius 10, displaced inward by up to 4. */
inline ShellPoint hall_at(double s, double v)
{
    const double polar = PI * s;
    const Vec d = {std::sin(polar) * std::cos(v), std::cos(polar), std::sin(polar) * std::sin(v)};
    const double broad = 0.5 + 0.5 * rough({3 * d[0], 3 * d[1], 3 * d[2]});
    const double fine = rough({20 * d[0], 20 * d[1], 20 * d[2]});
    const double r = 10 - 3.5 * broad - 0.25 * (fine + 1);
    return {{r * d[0], 0.6 * r * d[1], r * d[2]}, stone(d[1], broad - 0.5)};
}

/* Where the passage goes: most of a circle of radius 14, up and down. t in 0..1. */
inline Vec passage(double t)
{
    const double a = 0.3 + 5.2 * t;
    return {14 * std::cos(a), 2 * std::sin(2 * a), 14 * std::sin(a)};
}

/* A tube of a radius of about 2.5, with niches and ridges, closed by domes. */
inline ShellPoint cave_at(double s, double v)
{
    const Vec p = passage(s), next = passage(s + 1e-4);
    Vec out = {next[2] - p[2], 0, p[0] - next[0]}; /* level, across the passage */
    const double length = std::hypot(out[0], out[2]);
    const double x = std::cos(v) / length, y = std::sin(v);
    const double broad = rough({60 * s, 1.5 * std::cos(v), 1.5 * std::sin(v)});
    const double fine = rough({400 * s, 9 * std::cos(v), 9 * std::sin(v)});
    const double r = (2.5 + 0.9 * broad + 0.12 * fine) * dome(s / 0.03) * dome((1 - s) / 0.03);
    return {{p[0] + r * x * out[0], p[1] + r * y, p[2] + r * x * out[2]}, stone(y, broad)};
}

/* A ball around all of it. */
inline ShellPoint rock_at(double s, double v)
{
    const double r = 20 * std::sin(PI * s);
    return {{r * std::cos(v), 20 * std::cos(PI * s), r * std::sin(v)}, stone(0, 0)};
}

/* Turned to face inward, with rock around it: what is closed would count as solid. */
inline Model in_rock(Model hollow)
{
    for (auto &t : hollow.triangles)
        std::swap(t[1], t[2]);
    for (Vec &normal : hollow.normals)
        for (double &x : normal)
            x = -x;
    const Model rock = make_rings(3000, 1, rock_at);
    const uint32_t before = uint32_t(hollow.positions.size());
    hollow.positions.insert(hollow.positions.end(), rock.positions.begin(), rock.positions.end());
    hollow.normals.insert(hollow.normals.end(), rock.normals.begin(), rock.normals.end());
    hollow.colors.insert(hollow.colors.end(), rock.colors.begin(), rock.colors.end());
    for (const auto &t : rock.triangles)
        hollow.triangles.push_back({before + t[0], before + t[1], before + t[2]});
    return hollow;
}
