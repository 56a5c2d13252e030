/* Compressed sections made by hand: which zstd frames are a section and which break rule 213, and
 * every filter, in the library and in the decoder of the specification. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "asset/codec.h"
#include "asset/golden.h"
#include "base/alloc.h"

#define GTX_DECODE_NO_MAIN
#ifndef GTX_ZSTD
#define NO_ZSTD
#endif
#include "../../format/gtx_decode.c"

enum { CODES = 64, HEIGHTS = 1 }; /* texels of `minimal`, and the entry of its heights */

/* A golden file with one of its sections in the given frame. */
static bytes with_frame(const char *name, uint32_t index, uint32_t filter, bytes frame)
{
    bytes old = read_golden(name);
    uint32_t count = gtx_load_u32(old.data + 28);
    uint64_t end = GTX_HEADER_SIZE + (uint64_t)GTX_ENTRY_SIZE * count;
    bytes out = {need(calloc(old.size + frame.size + 64, 1)), 0};
    memcpy(out.data, old.data, end);
    for (uint32_t i = 0; i < count; ++i) {
        uint8_t *entry = out.data + GTX_HEADER_SIZE + GTX_ENTRY_SIZE * i;
        gtx_section section = gtx_entry_load(entry);
        const uint8_t *from = old.data + section.offset;
        if (i == index) {
            from = frame.data;
            section.stored_size = frame.size;
            gtx_store_u64(entry + 24, frame.size);
            gtx_store_u32(entry + 40, GTX_SCHEME_ZSTD);
            gtx_store_u32(entry + 44, filter);
        }
        gtx_store_u64(entry + 16, end);
        memcpy(out.data + end, from, section.stored_size);
        end = gtx_align64(end + section.stored_size);
    }
    out.size = end;
    gtx_store_u64(out.data + 32, end);
    rehash_header(out, true);
    free(old.data);
    return out;
}

/* Opens a file with the library and with the decoder, and frees it; returns the rule. */
static unsigned rule_of_file(bytes file)
{
    gtx_asset *asset = NULL;
    gtx_error error = {0};
    gtx_result result = gtx_open_memory(file.data, file.size, NULL, &asset, &error);
    static struct file decoded;
    unsigned rule = decode(file.data, file.size, &decoded);
    release(&decoded);
    gtx_close(asset);
    free(file.data);
    assert_int_equal(result == GTX_OK, rule == 0);
    assert_int_equal(error.rule, rule);
    return rule;
}

/* The same with the heights of `minimal` in a frame. */
static unsigned rule_of(const uint8_t *data, size_t size)
{
    return rule_of_file(with_frame("minimal", HEIGHTS, 0, (bytes){(uint8_t *)data, size}));
}

/* A frame around the codes of `minimal`: RFC 8878, 3.1.1. */
typedef struct frame_shape {
    const char *name;
    uint8_t header[8], header_size; /* of the frame, behind its magic number */
    uint32_t block;                 /* last | type << 1 | size << 3 */
    size_t content, tail;           /* bytes of the block and of what follows */
    uint32_t tail_value;
    unsigned rule;
} frame_shape;

#define RAW(size) (1u | (size) << 3)
#define RLE(size) (1u | 1u << 1 | (size) << 3)

static const frame_shape shapes[] = {
    {"one segment", {0x20, 64}, 2, RAW(64u), 64, 0, 0, 0},
    {"size of 8 bytes", {0xE0, 64}, 9, RAW(64u), 64, 0, 0, 0},
    {"dictionary 0", {0x21, 0, 64}, 3, RAW(64u), 64, 0, 0, 0},
    {"largest window", {0x80, 0x88, 64}, 6, RAW(64u), 64, 0, 0, 0},
    {"window above 2^27", {0x80, 0x89, 64}, 6, RAW(64u), 64, 0, 0, 213},
    {"no content size", {0x00, 0x00}, 2, RAW(64u), 64, 0, 0, 213},
    {"smaller content size", {0x20, 63}, 2, RAW(64u), 64, 0, 0, 213},
    {"larger content size", {0x20, 65}, 2, RAW(64u), 64, 0, 0, 213},
    {"a dictionary", {0x21, 5, 64}, 3, RAW(64u), 64, 0, 0, 213},
    {"reserved bit", {0x28, 64}, 2, RAW(64u), 64, 0, 0, 213},
    {"reserved block", {0x20, 64}, 2, RAW(64u) | 3u << 1, 64, 0, 0, 213},
    {"block too short", {0x20, 64}, 2, RAW(63u), 63, 0, 0, 213},
    {"block too long", {0x20, 64}, 2, RLE(65u), 1, 0, 0, 213},
    {"block of 2 MiB", {0x20, 64}, 2, RLE(0x1FFFFFu), 1, 0, 0, 213},
    {"other codes", {0x20, 64}, 2, RLE(64u), 1, 0, 0, 210},
    {"cut block", {0x20, 64}, 2, RAW(64u), 63, 0, 0, 213},
    {"no last block", {0x20, 64}, 2, RAW(64u) & ~1u, 64, 0, 0, 213},
    {"a byte behind", {0x20, 64}, 2, RAW(64u), 64, 1, 0, 213},
    {"wrong checksum", {0x24, 64}, 2, RAW(64u), 64, 4, 0, 213},
    {"no checksum", {0x24, 64}, 2, RAW(64u), 64, 0, 0, 213},
};

static size_t make_frame(const frame_shape *s, const uint8_t *codes, uint8_t *out)
{
    uint8_t *p = out;
    gtx_store_u32(p, 0xFD2FB528);
    memcpy(p + 4, s->header, s->header_size < 8 ? s->header_size : 8);
    p += 4 + s->header_size;
    gtx_store_u32(p, s->block);
    p += 3;
    memcpy(p, codes, s->content);
    p += s->content;
    gtx_store_u32(p, s->tail_value);
    return (size_t)(p - out) + s->tail;
}

static void test_shapes(void **state)
{
    (void)state;
    if (!gtx_has_zstd())
        skip();
    bytes minimal = read_golden("minimal");
    const uint8_t *codes = minimal.data + gtx_load_u64(minimal.data + 192 + 64 * HEIGHTS + 16);
    for (size_t i = 0; i < sizeof shapes / sizeof shapes[0]; ++i) {
        uint8_t frame[128] = {0};
        size_t size = make_frame(&shapes[i], codes, frame);
        unsigned rule = rule_of(frame, size);
        if (rule != shapes[i].rule)
            print_error("%s: rule %u\n", shapes[i].name, rule);
        assert_int_equal(rule, shapes[i].rule);
    }
    free(minimal.data);
}

/* A section is one frame: not none, not two, and none that readers of zstd skip. */
static void test_sequences(void **state)
{
    (void)state;
    if (!gtx_has_zstd())
        skip();
    bytes minimal = read_golden("minimal");
    const uint8_t *codes = minimal.data + gtx_load_u64(minimal.data + 192 + 64 * HEIGHTS + 16);
    uint8_t frame[256] = {0}, skipped[256] = {0x50, 0x2A, 0x4D, 0x18};
    size_t size = make_frame(&shapes[0], codes, frame);
    assert_int_equal(rule_of(frame, size), 0);
    for (size_t cut = 0; cut < size; ++cut)
        assert_int_equal(rule_of(frame, cut), 213);
    memcpy(frame + size, frame, size);
    assert_int_equal(rule_of(frame, 2 * size), 213);
    assert_int_equal(rule_of(skipped, 8), 213);
    memcpy(skipped + 8, frame, size);
    assert_int_equal(rule_of(skipped, 8 + size), 213);
    memcpy(frame + size, skipped, 8);
    assert_int_equal(rule_of(frame, size + 8), 213);
    free(minimal.data);
}

static void test_checksum(void **state)
{
    (void)state;
    if (!gtx_has_zstd())
        skip();
    bytes minimal = read_golden("minimal");
    const uint8_t *codes = minimal.data + gtx_load_u64(minimal.data + 192 + 64 * HEIGHTS + 16);
    frame_shape right = {.header = {0x24, 64}, .header_size = 2, .block = RAW(64u),
                         .content = CODES, .tail = 4,
                         .tail_value = (uint32_t)gtx_hash_bytes(codes, CODES)};
    uint8_t frame[128];
    assert_int_equal(rule_of(frame, make_frame(&right, codes, frame)), 0);
    free(minimal.data);
}

/* Every filter that fits, on texels of 1 to 4 bytes, also those that the encoder does not choose.
 * The hash tells whether the image came back. */
static void test_filters(void **state)
{
    (void)state;
    if (!gtx_has_zstd())
        skip();
    static const struct {
        const char *name;
        uint32_t index, texel;
    } images[] = {{"color", 4, 1},     {"color", 5, 1},     {"color", 7, 2},
                  {"color", 8, 2},     {"emission", 2, 3},  {"color", 3, 4}, {"height16", 1, 2},
                  {"two-pages", 1, 1}, {"two-pages", 2, 1}, {"two-pages", 3, 2}};
    for (size_t i = 0; i < sizeof images / sizeof images[0]; ++i) {
        bytes file = read_golden(images[i].name);
        gtx_asset *asset;
        assert_int_equal(gtx_open_memory(file.data, file.size, NULL, &asset, NULL), GTX_OK);
        gtx_section section = gtx_entry_load(file.data + 192 + 64 * images[i].index);
        gtx_map_shape shape = gtx_section_shape(&asset->info, section.kind, section.level);
        assert_int_equal(shape.texel, images[i].texel);
        for (section.filter = 0; section.filter < 6; ++section.filter) {
            if (!gtx_filter_fits(section.kind, section.filter))
                continue;
            uint8_t coded[1024];
            assert_in_range(section.size, 1, sizeof coded);
            const size_t memory = gtx_encoder_size(19, section.size);
            const gtx_encoder encoder = {19, need(malloc(memory)), memory,
                                         need(malloc(1 + gtx_apply_size(&section, shape)))};
            size_t size = gtx_encode_section(
                &encoder, &section, asset, gtx_asset_data(asset, section.kind, section.level),
                coded);
            free(encoder.memory);
            free(encoder.filtered);
            assert_int_not_equal(size, 0);
            assert_int_equal(rule_of_file(with_frame(images[i].name, images[i].index,
                                                     section.filter, (bytes){coded, size})), 0);
        }
        gtx_close(asset);
        free(file.data);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shapes), cmocka_unit_test(test_sequences),
        cmocka_unit_test(test_checksum), cmocka_unit_test(test_filters)};
    return cmocka_run_group_tests_name("frames", tests, NULL, NULL);
}
