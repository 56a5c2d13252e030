/* Elementary functions by argument reduction and power series (Muller, Elementary Functions,
 * chapters 3 and 11). */
#include "base/exact.h"

#include <math.h>

static const double LN2 = 0.69314718055994530942, PI = 3.14159265358979323846;

/* A series in x: c[n - 1] + c[n - 2] x + ... */
static double series(const double *c, int n, double x)
{
    double sum = c[0];
    for (int i = 1; i < n; ++i)
        sum = sum * x + c[i];
    return sum;
}

/* a * a = high + low (Dekker 1971). */
static void square(double a, double *high, double *low)
{
    const double split = 134217729 * a, head = split - (split - a), tail = a - head;
    *high = a * a;
    *low = ((head * head - *high) + 2 * head * tail) + tail * tail;
}

double gtx_hypot(double x, double y)
{
    const double a = fmax(fabs(x), fabs(y)), b = fmin(fabs(x), fabs(y));
    if (!(a < 1e140))
        return a < INFINITY ? gtx_hypot(a * 0x1p-600, b * 0x1p-600) * 0x1p+600 : a;
    if (a < 1e-140)
        return a > 0 ? gtx_hypot(a * 0x1p+600, b * 0x1p+600) * 0x1p-600 : 0;
    double aa, bb, hh, a_low, b_low, h_low;
    const double h = sqrt(a * a + b * b);
    square(a, &aa, &a_low);
    square(b, &bb, &b_low);
    square(h, &hh, &h_low);
    return h + ((aa - hh + bb) + (a_low + b_low - h_low)) / (2 * h);
}

double gtx_exp2(double x)
{
    static const double c[] = {1 / 6227020800., 1 / 479001600., 1 / 39916800., 1 / 3628800.,
                               1 / 362880., 1 / 40320., 1 / 5040., 1 / 720., 1 / 120., 1 / 24.,
                               1 / 6., 1 / 2., 1, 1};
    if (!(x < 1024))
        return x > 0 ? INFINITY : x;
    if (x < -1080)
        return 0;
    const double whole = floor(x + 0.5);
    return ldexp(series(c, 14, (x - whole) * LN2), (int)whole);
}

/* Of m in [sqrt(1/2), sqrt(2)), by 2 artanh((m - 1) / (m + 1)). */
static double log_of_mantissa(double m)
{
    static const double c[] = {1 / 21., 1 / 19., 1 / 17., 1 / 15., 1 / 13., 1 / 11., 1 / 9.,
                               1 / 7., 1 / 5., 1 / 3., 1};
    const double s = (m - 1) / (m + 1);
    return 2 * s * series(c, 11, s * s);
}

double gtx_log2(double x)
{
    int exponent;
    double m = frexp(x, &exponent);
    if (!(x > 0) || isinf(x))
        return x == 0 ? -INFINITY : x > 0 ? x : NAN;
    if (m < 0.70710678118654752440) {
        m *= 2;
        --exponent;
    }
    return exponent + log_of_mantissa(m) / LN2;
}

double gtx_exp(double x)
{
    return gtx_exp2(x / LN2);
}

double gtx_log(double x)
{
    return gtx_log2(x) * LN2;
}

double gtx_pow(double x, double y)
{
    return y == 0 ? 1 : gtx_exp2(y * gtx_log2(x));
}

/* Of |r| <= pi / 4. */
static double sine(double r)
{
    static const double c[] = {-1 / 1307674368000., 1 / 6227020800., -1 / 39916800., 1 / 362880.,
                               -1 / 5040., 1 / 120., -1 / 6., 1};
    return r * series(c, 8, r * r);
}

static double cosine(double r)
{
    static const double c[] = {1 / 20922789888000., -1 / 87178291200., 1 / 479001600.,
                               -1 / 3628800., 1 / 40320., -1 / 720., 1 / 24., -1 / 2., 1};
    return series(c, 9, r * r);
}

/* The sine of x and `ahead` quarters of a turn. */
static double sine_of(double x, int ahead)
{
    /* pi / 2 in two parts: a count of quarters times the first is exact. */
    const double high = 1.5707963267341256, low = 6.0771005065061922e-11;
    if (!(fabs(x) < 1e9))
        return isfinite(x) ? sine_of(fmod(x, 2 * PI), ahead) : NAN;
    const double quarters = floor(x / (PI / 2) + 0.5);
    const double r = x - quarters * high - quarters * low;
    const int which = (int)(((long long)quarters + ahead) & 3);
    const double value = which & 1 ? cosine(r) : sine(r);
    return which & 2 ? -value : value;
}

double gtx_sin(double x)
{
    return sine_of(x, 0);
}

double gtx_cos(double x)
{
    return sine_of(x, 1);
}

/* Of t in [0, 1]: turned by pi / 4 or pi / 8 to where the series is short. */
static double arctangent(double t)
{
    static const double c[] = {1 / 21., -1 / 19., 1 / 17., -1 / 15., 1 / 13.,
                               -1 / 11., 1 / 9., -1 / 7., 1 / 5., -1 / 3., 1};
    const double turn = t > 0.66817863791929892 ? 1 : t > 0.19891236737965801 ? 0.5 : 0;
    const double tangent = turn == 1 ? 1 : turn * 0.82842712474619010;
    const double s = (t - tangent) / (1 + t * tangent);
    return turn * (PI / 4) + s * series(c, 11, s * s);
}

double gtx_atan2(double y, double x)
{
    const double ax = fabs(x), ay = fabs(y);
    if (ax == 0 && ay == 0)
        return 0;
    double angle = ay <= ax ? arctangent(ay / ax) : PI / 2 - arctangent(ax / ay);
    angle = x < 0 ? PI - angle : angle;
    return y < 0 ? -angle : angle;
}
