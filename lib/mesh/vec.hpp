/* Vectors of the cooker: three doubles, and three floats for storage. */
#pragma once

#include "base/exact.h"

#include <cmath>

namespace gtx {

template <class T> struct Vec3 {
    T x = 0, y = 0, z = 0;

    Vec3() = default;
    Vec3(T x, T y, T z) : x(x), y(y), z(z) {}
    template <class U> explicit Vec3(const Vec3<U> &v) : x(T(v.x)), y(T(v.y)), z(T(v.z)) {}

    T &operator[](int i) { return (&x)[i]; }
    T operator[](int i) const { return (&x)[i]; }
    Vec3 operator+(const Vec3 &b) const { return {x + b.x, y + b.y, z + b.z}; }
    Vec3 operator-(const Vec3 &b) const { return {x - b.x, y - b.y, z - b.z}; }
    Vec3 operator-() const { return {-x, -y, -z}; }
    Vec3 operator*(T s) const { return {x * s, y * s, z * s}; }
    Vec3 operator/(T s) const { return {x / s, y / s, z / s}; }
    Vec3 &operator+=(const Vec3 &b) { return *this = *this + b; }
    Vec3 &operator-=(const Vec3 &b) { return *this = *this - b; }
    Vec3 &operator*=(T s) { return *this = *this * s; }
    bool operator==(const Vec3 &b) const { return x == b.x && y == b.y && z == b.z; }
    bool operator!=(const Vec3 &b) const { return !(*this == b); }
};

using Vec3d = Vec3<double>;
using Vec3f = Vec3<float>;

template <class T> T dot(const Vec3<T> &a, const Vec3<T> &b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class T> Vec3<T> cross(const Vec3<T> &a, const Vec3<T> &b)
{
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class T> T length(const Vec3<T> &a)
{
    return std::sqrt(dot(a, a));
}

/* Of (x, y). */
inline double length(double x, double y)
{
    return gtx_hypot(x, y);
}

/* That times `parts`, a power of two, rounded down. The square root alone is nearly as exact, and
 * takes a fifth of the time. */
inline int whole_length(double parts, double x, double y)
{
    constexpr double ROUNDING = 1e-12;
    const double about = parts * std::sqrt(x * x + y * y);
    const bool sure = about < 1e9 && int(about * (1 - ROUNDING)) == int(about * (1 + ROUNDING));
    return int(sure ? about : parts * length(x, y));
}

/* The zero vector stays zero. */
template <class T> Vec3<T> normalize(const Vec3<T> &a)
{
    T l = length(a);
    return l > 0 ? a / l : a;
}

template <class T> bool is_finite(const Vec3<T> &a)
{
    return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

} // namespace gtx
