/* A JSON writer: text into a growing buffer, independent of the locale. */
#ifndef GTX_BASE_JSON_H
#define GTX_BASE_JSON_H

#include <geotex/geotex.h>

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Zero-fill to start, but for `allocator` where it is not to be malloc. `text` is terminated and
 * owned by the writer; `failed` stays set once memory ran out, and the text is then incomplete. */
typedef struct gtx_json {
    gtx_allocator allocator;
    char *text;
    size_t size, capacity;
    unsigned depth;
    bool comma, failed;
} gtx_json;

/* Members: `key` names a member of the enclosing object and is NULL inside arrays and at the
 * top. */
void gtx_json_begin_object(gtx_json *json, const char *key);
void gtx_json_end_object(gtx_json *json);
void gtx_json_begin_array(gtx_json *json, const char *key);
void gtx_json_end_array(gtx_json *json);
void gtx_json_string(gtx_json *json, const char *key, const char *value);
void gtx_json_number(gtx_json *json, const char *key, double value); /* null unless finite */
/* With all the digits that a double has. */
void gtx_json_exact(gtx_json *json, const char *key, double value);
void gtx_json_integer(gtx_json *json, const char *key, uint64_t value);
void gtx_json_bool(gtx_json *json, const char *key, bool value);
/* A hash as "0x" and 16 hexadecimal digits: JSON numbers lose bits beyond 2^53. */
void gtx_json_hash(gtx_json *json, const char *key, uint64_t value);
void gtx_json_null(gtx_json *json, const char *key);

void gtx_json_free(gtx_json *json);

#ifdef __cplusplus
}
#endif
#endif
