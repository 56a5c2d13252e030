/* The decoder of the specification, for what the library must agree with it on. */
#ifndef GTX_TESTS_FUZZ_DECODER_H
#define GTX_TESTS_FUZZ_DECODER_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Called for every section that is decoded. */
typedef void (*decoder_fn)(const char *type, uint32_t level, const uint8_t *bytes, size_t size,
                           void *user);

/* 0, or the rule that the file breaks; 1 where there is no memory. */
unsigned decoder_run(const uint8_t *data, size_t size, decoder_fn fn, void *user);

/* Whether two readers may differ on a rule, or a file breaks it within its tolerance. */
int decoder_tolerates(unsigned rule);

/* Makes the hashes of a file right where its sections can be decoded. With `repair`, records that
 * are stored also get the coverage and sphere, and the header the bounds, that heights ask for. */
void decoder_settle(uint8_t *data, size_t size, int repair);

#ifdef __cplusplus
}
#endif
#endif
