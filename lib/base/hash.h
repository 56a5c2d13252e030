/* XXH64, the format's hash (xxHash specification 0.1.1, seed 0). */
#ifndef GTX_BASE_HASH_H
#define GTX_BASE_HASH_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct gtx_hash {
    uint64_t lane[4], total;
    uint8_t pending[32];
    size_t pending_size;
} gtx_hash;

void gtx_hash_begin(gtx_hash *hash);
void gtx_hash_add(gtx_hash *hash, const void *data, size_t size);
uint64_t gtx_hash_end(const gtx_hash *hash);

/* The hash of one block. */
uint64_t gtx_hash_bytes(const void *data, size_t size);

#ifdef __cplusplus
}
#endif
#endif
