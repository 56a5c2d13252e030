/* Elementary functions that give the same bits on every processor and system. */
#include "base/bytes.h"
#include "base/exact.h"
#include "base/hash.h"

#include <math.h>
#include <stdio.h>

/* Last, for its macros take names that the standard library uses. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static const double PI = 3.14159265358979323846;

/* Of one function: what the C library says, over a range; the allowance is relative or absolute. */
typedef struct function {
    const char *name;
    double (*ours)(double), (*theirs)(double);
    double low, high, relative, absolute;
} function;

static double from_two(double x) { return gtx_pow(x, 1.7); }
static double from_two_theirs(double x) { return pow(x, 1.7); }
static double half_turn(double x) { return gtx_atan2(sin(x), cos(x)); }
static double half_turn_theirs(double x) { return atan2(sin(x), cos(x)); }

static double slanted(double x) { return gtx_hypot(x, 0.7); }
static double slanted_theirs(double x) { return hypot(x, 0.7); }

static const function FUNCTIONS[] = {
    {"hypot", slanted, slanted_theirs, -3, 3, 2.3e-16, 0},
    {"exp2", gtx_exp2, exp2, -1000, 1000, 9e-16, 0},
    {"exp", gtx_exp, exp, -20, 20, 5e-15, 0},
    {"log2", gtx_log2, log2, 1e-9, 9, 9e-16, 9e-16},
    {"log", gtx_log, log, 1e-9, 1e6, 9e-16, 9e-16},
    {"pow", from_two, from_two_theirs, 0, 40, 5e-15, 0},
    {"sin", gtx_sin, sin, -20, 20, 0, 5e-15},
    {"cos", gtx_cos, cos, -20, 20, 0, 5e-15},
    {"atan2", half_turn, half_turn_theirs, -3.14, 3.14, 9e-16, 9e-16},
};
enum { COUNT = sizeof FUNCTIONS / sizeof *FUNCTIONS, VALUES = 100000 };

/* The n-th of values spread evenly, without a function of the C library. */
static double value(const function *f, uint32_t n)
{
    const uint32_t mixed = n * 2654435769u;
    return f->low + (f->high - f->low) * ((double)mixed / 4294967296.0);
}

static void they_are_what_the_c_library_says(void **state)
{
    (void)state;
    for (int i = 0; i < COUNT; ++i) {
        const function *f = &FUNCTIONS[i];
        double worst = 0;
        for (uint32_t n = 0; n < VALUES; ++n) {
            const double x = value(f, n), wanted = f->theirs(x);
            const double off = fabs(f->ours(x) - wanted);
            worst = fmax(worst, off / (f->absolute + f->relative * fabs(wanted)));
        }
        printf("    %s: %.2f of what is allowed\n", f->name, worst);
        assert_true(worst <= 1);
    }
}

static void corners_are_exact(void **state)
{
    (void)state;
    for (int n = -1000; n <= 1000; ++n) {
        assert_true(gtx_exp2(n) == ldexp(1, n));
        assert_true(gtx_log2(ldexp(1, n)) == n);
    }
    assert_true(gtx_exp2(2000) == INFINITY && gtx_exp2(-2000) == 0 && isnan(gtx_exp2(NAN)));
    assert_true(gtx_log2(0) == -INFINITY && isnan(gtx_log2(-1)) && gtx_log2(INFINITY) == INFINITY);
    assert_true(gtx_log2(5e-324) == -1074);
    assert_true(gtx_pow(0, 2) == 0 && gtx_pow(0, 0) == 1 && gtx_pow(7, 0) == 1);
    assert_true(gtx_hypot(3, -4) == 5 && gtx_hypot(0, 0) == 0 && gtx_hypot(0, 2) == 2);
    assert_true(gtx_hypot(3e300, 4e300) == hypot(3e300, 4e300) && gtx_hypot(3e-300, 4e-300) > 0);
    assert_true(gtx_hypot(INFINITY, 1) == INFINITY && gtx_hypot(1e308, 1e308) < INFINITY);
    assert_true(gtx_sin(0) == 0 && gtx_cos(0) == 1);
    assert_true(fabs(gtx_sin(1e300)) <= 1 && isnan(gtx_cos(INFINITY)));
    assert_true(gtx_atan2(0, 0) == 0 && gtx_atan2(0, -1) == PI && gtx_atan2(1, 0) == PI / 2 &&
                gtx_atan2(-1, 1) == -PI / 4);
}

static void add(gtx_hash *hash, double y)
{
    uint8_t bytes[8];
    gtx_store_f64(bytes, y);
    gtx_hash_add(hash, bytes, sizeof bytes);
}

/* This number is the same wherever it is computed. */
static void bits_are_the_same_everywhere(void **state)
{
    gtx_hash hash;
    (void)state;
    gtx_hash_begin(&hash);
    for (int i = 0; i < COUNT - 1; ++i)
        for (uint32_t n = 0; n < VALUES; ++n)
            add(&hash, FUNCTIONS[i].ours(value(&FUNCTIONS[i], n)));
    for (uint32_t n = 0; n < VALUES; ++n)
        add(&hash, gtx_atan2(value(&FUNCTIONS[6], n), value(&FUNCTIONS[6], 3 * n + 1)));
    const uint64_t seen = gtx_hash_end(&hash);
    printf("    %016llx\n", (unsigned long long)seen);
    assert_true(seen == 0x1ada23985d0e0baf);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(they_are_what_the_c_library_says),
        cmocka_unit_test(corners_are_exact),
        cmocka_unit_test(bits_are_the_same_everywhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
