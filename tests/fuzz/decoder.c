/* The decoder of the specification, and with its help files made right after a change. */
#include "fuzz/decoder.h"

#define GTX_DECODE_NO_MAIN
#ifndef GTX_ZSTD
#define NO_ZSTD
#endif
#include "../../format/gtx_decode.c"

/* More pages than these are not repaired: it would take too long. */
enum { MAX_TEXELS = 1 << 20 };

unsigned decoder_run(const uint8_t *data, size_t size, decoder_fn fn, void *user)
{
    static struct file f;
    unsigned rule = decode(data, size, &f);
    for (uint32_t i = 0; !rule && i < f.section_count; ++i)
        if (f.section[i].bytes)
            fn(f.section[i].type, f.section[i].level, f.section[i].bytes,
               (size_t)f.section[i].size, user);
    release(&f);
    return rule;
}

int decoder_tolerates(unsigned rule)
{
    return (rule >= 301 && rule <= 304) || rule == 308 || rule == 311 || rule == 505;
}

static void put(byte *p, uint64_t value, int count)
{
    for (int i = 0; i < count; ++i)
        p[i] = (byte)(value >> 8 * i);
}

static void put_float(byte *p, double value)
{
    float rounded = (float)value;
    uint32_t bits;
    memcpy(&bits, &rounded, 4);
    put(p, bits, 4);
}

/* A box around the points of coded texels, which it grows; returns how many there are. */
static double add_points(const struct file *f, const byte *r, const byte *heights, double box[6])
{
    uint32_t w = u16(r + 72), h = u16(r + 74);
    double levels = f->bits == 8 ? 254 : 65534, coded = 0;
    for (uint32_t j = 0; j < h; ++j)
        for (uint32_t i = 0; i < w; ++i) {
            uint32_t code = height_code(f, heights, texel_at(f, r, i, j));
            if (!code)
                continue;
            ++coded;
            for (int k = 0; k < 3; ++k) {
                double p = f32(r + 4 * k) + (i + 0.5) / w * f32(r + 12) * f32(r + 16 + 4 * k) +
                           (j + 0.5) / h * f32(r + 28) * f32(r + 32 + 4 * k) +
                           (code - 1) / levels * f32(r + 44) * f32(r + 48 + 4 * k);
                box[k] = fmin(box[k], p);
                box[3 + k] = fmax(box[3 + k], p);
            }
        }
    return coded;
}

static void repair_record(const struct file *f, byte *r, const byte *heights, double bounds[6])
{
    double box[6] = {HUGE_VAL, HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, radius = 0;
    double coded = add_points(f, r, heights, box);
    put_float(r + 60, coded / ((double)u16(r + 72) * u16(r + 74)));
    if (!coded)
        return;
    for (int k = 0; k < 3; ++k) {
        put_float(r + 80 + 4 * k, (box[k] + box[3 + k]) / 2);
        radius += pow((box[3 + k] - box[k]) / 2, 2);
        bounds[k] = fmin(bounds[k], box[k]);
        bounds[3 + k] = fmax(bounds[3 + k], box[3 + k]);
    }
    put_float(r + 92, fmax(sqrt(radius), 1e-30));
}

static void repair_records(const struct file *f, byte *header, const byte *heights)
{
    const struct section *s = find(f, "PTCH");
    double bounds[6];
    for (int k = 0; k < 6; ++k)
        bounds[k] = f32(header + 72 + 4 * k);
    for (uint32_t n = 0; n < f->patches; ++n)
        repair_record(f, s->bytes + RECORD * (uint64_t)n, heights, bounds);
    for (int k = 0; k < 6; ++k)
        put_float(header + 72 + 4 * k, bounds[k]);
    memcpy(header + s->offset, s->bytes, (size_t)s->size);
}

static void put_hash(byte *data, const struct file *f, const struct section *s)
{
    put(data + HEADER + ENTRY * (s - f->section) + 48, xxh64(s->bytes, s->size), 8);
}

/* In the order of decode_content; stops at the first rule that is broken. */
static void settle_sections(struct file *f, byte *data, int repair)
{
    byte *taken = calloc((size_t)f->pages * f->width, f->height);
    unsigned rule = taken ? 0 : NO_MEMORY;
    for (uint32_t n = 0; !rule && n < 8 * f->section_count; ++n) {
        struct section *s = &f->section[n % f->section_count];
        if (order_of(f, s) == UNKNOWN || s->level != n / f->section_count)
            continue;
        rule = decode_section(f, s);
        if (rule && rule != 210)
            break;
        rule = is_type(s, "PTCH") ? check_patches(f, s->bytes, taken) : 0;
        put_hash(data, f, s);
        if (!rule && repair && is_type(s, "HGHT") && !find(f, "PTCH")->scheme) {
            repair_records(f, data, s->bytes);
            put_hash(data, f, find(f, "PTCH"));
        }
    }
    free(taken);
}

static int check_entries(struct file *f)
{
    uint64_t end = HEADER + (uint64_t)ENTRY * f->section_count;
    for (uint32_t i = 0; i < f->section_count; ++i)
        if (check_entry(f, i, &end))
            return 0;
    return !check_presence(f) &&
           (uint64_t)f->pages * f->width * f->height <= MAX_TEXELS;
}

void decoder_settle(uint8_t *data, size_t size, int repair)
{
    static struct file f;
    memset(&f, 0, sizeof f);
    f.data = data;
    f.size = size;
    if (check_header(&f) || check_values(&f))
        return;
    if (check_entries(&f))
        settle_sections(&f, data, repair);
    release(&f);

    byte hashes[8 * MAX_SECTIONS], copy[184 + ENTRY * MAX_SECTIONS];
    size_t table = (size_t)ENTRY * f.section_count;
    uint32_t count = 0;
    for (uint32_t i = 0; i < f.section_count; ++i)
        if (memcmp(data + HEADER + ENTRY * i, "META", 4))
            memcpy(hashes + 8 * count++, data + HEADER + ENTRY * i + 48, 8);
    put(data + 128, xxh64(hashes, 8 * count), 8);
    memcpy(copy, data, 184);
    memcpy(copy + 184, data + HEADER, table);
    put(data + 184, xxh64(copy, 184 + table), 8);
}
