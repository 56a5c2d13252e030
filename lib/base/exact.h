/* Functions of the C library that round differently on different processors or systems, for
 * computations that cooked bytes depend on: made of + - * / alone, which IEEE 754 defines bit by
 * bit. In double precision, within 4 units in the last place unless said otherwise. */
#ifndef GTX_BASE_EXACT_H
#define GTX_BASE_EXACT_H

#ifdef __cplusplus
extern "C" {
#endif

double gtx_hypot(double x, double y); /* nearly always what is nearest */
double gtx_exp2(double x);            /* infinite from 1024 on */
double gtx_log2(double x);            /* x > 0; at powers of two exact */
double gtx_exp(double x);             /* relative error: |x| units in the last place */
double gtx_log(double x);             /* x > 0 */
double gtx_pow(double x, double y);   /* x >= 0; relative error: |y log x| units */
double gtx_sin(double x);             /* |x| < 10^5; absolute error 2e-16 (1 + |x|) */
double gtx_cos(double x);
double gtx_atan2(double y, double x); /* (0, 0) gives 0; signs of zero do not count */

#ifdef __cplusplus
}
#endif
#endif
