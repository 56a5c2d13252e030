/* The filter of LOD mesh sections: triangles as steps over recent edges and vertices, positions as
 * differences from a prediction by the triangle before, normals from those of the triangles; all of
 * it in planes of bytes. After Touma and Gotsman 1998 (parallelogram) and Kapoulkine's
 * meshoptimizer (recent edges). */
#include "asset/lod.h"

#include "base/bytes.h"

enum { RECENT = 16 };

/* Where the parts of a level begin. In coded bytes they begin at the same places. */
typedef struct parts {
    size_t first_count, vertices, triangles;
    size_t first, indices, positions;
    size_t normals;               /* 0: none */
} parts;

static bool find_parts(const uint8_t *bytes, size_t size, parts *out)
{
    if (size < GTX_LOD_HEADER)
        return false;
    uint64_t vertices = gtx_load_u32(bytes + 20), triangles = gtx_load_u32(bytes + 24);
    const uint32_t flags = gtx_load_u32(bytes + 28);
    uint64_t arrays = 6 * vertices + 12 * triangles + gtx_lod_normals_size(flags, vertices);
    const uint64_t left = size - GTX_LOD_HEADER;
    if (arrays > left || (left - arrays) % 4 ||
        ((flags & GTX_LOD_NORMALS) && !gtx_lod_may_have_normals(vertices, triangles)))
        return false;
    size_t first_bytes = (size_t)(left - arrays);
    *out = (parts){.first_count = first_bytes / 4, .vertices = (size_t)vertices,
                   .triangles = (size_t)triangles, .first = GTX_LOD_HEADER};
    out->indices = out->first + first_bytes;
    out->positions = out->indices + 12 * (size_t)triangles;
    if (flags & GTX_LOD_NORMALS)
        out->normals = out->positions + 6 * (size_t)vertices;
    return true;
}

/* Number i of `count` whose bytes lie in `width` planes. */
static uint32_t load_planes(const uint8_t *planes, size_t count, size_t i, int width)
{
    uint32_t value = 0;
    for (int k = width; k-- > 0;)
        value = value << 8 | planes[(size_t)k * count + i];
    return value;
}

static void store_planes(uint8_t *planes, size_t count, size_t i, int width, uint32_t value)
{
    for (int k = 0; k < width; ++k)
        planes[(size_t)k * count + i] = (uint8_t)(value >> 8 * k);
}

/* An edge as the triangle on its other side sees it, and the third corner on this side. */
typedef struct edge {
    uint32_t from, to, across;
} edge;

/* A run over the triangles of a level, in either direction: `plain` and `coded` are its two forms,
 * and one of them grows. */
typedef struct run {
    parts at;
    uint8_t *plain, *coded;
    bool apply;                   /* plain -> coded */
    edge recent[RECENT];
    uint32_t newest;              /* edges put in so far */
    uint32_t next;                /* vertices met so far */
} run;

static void remember(run *r, uint32_t from, uint32_t to, uint32_t across)
{
    r->recent[r->newest++ % RECENT] = (edge){from, to, across};
}

/* The edge put in `age` steps ago. */
static const edge *recall(const run *r, uint32_t age)
{
    return &r->recent[(r->newest - 1 - age) % RECENT];
}

/* Position `vertex`: the difference to what is expected, zigzag. */
static void code_position(run *r, uint32_t vertex, const uint32_t near[3], bool known)
{
    uint8_t *position = r->plain + r->at.positions, *planes = r->coded + r->at.positions;
    for (size_t k = 0; k < 3; ++k) {
        uint32_t expected = 0;
        if (known)
            expected = (uint32_t)gtx_load_u16(position + 6 * (size_t)near[0] + 2 * k) +
                       gtx_load_u16(position + 6 * (size_t)near[1] + 2 * k) -
                       gtx_load_u16(position + 6 * (size_t)near[2] + 2 * k);
        else if (vertex)
            expected = gtx_load_u16(position + 6 * (size_t)(vertex - 1) + 2 * k);
        uint8_t *value = position + 6 * (size_t)vertex + 2 * k;
        uint8_t *plane = planes + 2 * k * r->at.vertices;
        if (r->apply) {
            uint32_t step = (gtx_load_u16(value) - expected) & 0xFFFF;
            uint32_t zigzag = (step << 1 ^ (step >> 15 ? 0xFFFF : 0)) & 0xFFFF;
            store_planes(plane, r->at.vertices, vertex, 2, zigzag);
        } else {
            uint32_t zigzag = load_planes(plane, r->at.vertices, vertex, 2);
            uint32_t step = zigzag >> 1 ^ (zigzag & 1 ? 0xFFFF : 0);
            gtx_store_u16(value, (uint16_t)(expected + step));
        }
    }
}

/* Code word `word` of a triangle and the corner that it stands for: how many vertices back it was
 * met first, 0 for one never met. */
static uint32_t code_corner(run *r, size_t triangle, size_t word, uint32_t bias)
{
    uint8_t *index = r->plain + r->at.indices + 12 * triangle + 4 * word;
    uint8_t *planes = r->coded + r->at.indices + 4 * word * r->at.triangles;
    if (r->apply)
        store_planes(planes, r->at.triangles, triangle, 4, r->next - gtx_load_u32(index) + bias);
    else
        gtx_store_u32(index,
                      r->next - (load_planes(planes, r->at.triangles, triangle, 4) - bias));
    return gtx_load_u32(index);
}

/* Counts a vertex that was not met before, and codes its position. */
static void meet(run *r, uint32_t vertex, const uint32_t near[3])
{
    if (vertex != r->next || vertex >= r->at.vertices)
        return;
    bool known = near && near[0] < vertex && near[1] < vertex && near[2] < vertex;
    code_position(r, vertex, near, known);
    ++r->next;
}

/* The age of the edge that the triangle starts with, RECENT when it is none of the recent ones. */
static uint32_t find_recent(run *r, size_t triangle)
{
    uint8_t *planes = r->coded + r->at.indices;
    uint32_t held = r->newest < RECENT ? r->newest : RECENT;
    if (!r->apply) {
        uint32_t word = load_planes(planes, r->at.triangles, triangle, 4);
        return word < held ? word : RECENT;
    }
    const uint8_t *index = r->plain + r->at.indices + 12 * triangle;
    uint32_t from = gtx_load_u32(index), to = gtx_load_u32(index + 4);
    for (uint32_t age = 0; age < held; ++age) {
        if (recall(r, age)->from == from && recall(r, age)->to == to) {
            store_planes(planes, r->at.triangles, triangle, 4, age);
            store_planes(planes + 4 * r->at.triangles, r->at.triangles, triangle, 4, 0);
            return age;
        }
    }
    return RECENT;
}

static void code_triangle(run *r, size_t triangle)
{
    uint32_t age = find_recent(r, triangle), a, b, c;
    if (age < RECENT) {
        const edge shared = *recall(r, age);
        const uint32_t near[3] = {a = shared.from, b = shared.to, shared.across};
        if (!r->apply) {
            gtx_store_u32(r->plain + r->at.indices + 12 * triangle, a);
            gtx_store_u32(r->plain + r->at.indices + 12 * triangle + 4, b);
        }
        meet(r, c = code_corner(r, triangle, 2, 0), near);
    } else {
        meet(r, a = code_corner(r, triangle, 0, RECENT), NULL);
        meet(r, b = code_corner(r, triangle, 1, 0), NULL);
        meet(r, c = code_corner(r, triangle, 2, 0), NULL);
        remember(r, b, a, c);
    }
    remember(r, c, b, a);
    remember(r, a, c, b);
}

static void code_level(run *r)
{
    uint8_t *plain = r->plain + r->at.first, *coded = r->coded + r->at.first;
    uint32_t before = 0;
    for (size_t i = 0; i < r->at.first_count; ++i) {
        if (r->apply)
            store_planes(coded, r->at.first_count, i, 4, gtx_load_u32(plain + 4 * i) - before);
        else
            gtx_store_u32(plain + 4 * i, before + load_planes(coded, r->at.first_count, i, 4));
        before = gtx_load_u32(plain + 4 * i);
    }
    for (size_t t = 0; t < r->at.triangles; ++t)
        code_triangle(r, t);
    while (r->next < r->at.vertices) /* in no triangle */
        meet(r, r->next, NULL);
}

/* Triangles and positions are known, and what is before coded normals is free: sums go there, which
 * it has room for where a level may have normals. The expected ones are found in their place. */
static void code_normals(run *r, size_t size)
{
    const size_t count = r->at.vertices;
    uint8_t *plain = r->plain + r->at.normals, *coded = r->coded + r->at.normals;
    uint8_t *to = r->apply ? coded : plain;
    if (!r->at.normals)
        return;
    uint8_t *expected = r->coded;
    gtx_lod_expect_normals(r->plain + r->at.indices, r->at.triangles, r->plain + r->at.positions,
                           count, r->coded, expected);
    for (size_t i = 0; i < count; ++i)
        for (size_t k = 0; k < 2; ++k) {
            if (r->apply)
                coded[k * count + i] = (uint8_t)(plain[2 * i + k] - expected[2 * i + k]);
            else
                plain[2 * i + k] = (uint8_t)(coded[k * count + i] + expected[2 * i + k]);
        }
    const uint8_t *from = r->apply ? plain : coded;
    memcpy(to + 2 * count, from + 2 * count, size - r->at.normals - 2 * count); /* their error */
}

void gtx_lod_filter_apply(const uint8_t *in, size_t size, uint8_t *out)
{
    run r = {.plain = (uint8_t *)in, .coded = out, .apply = true};
    if (find_parts(in, size, &r.at)) {
        code_normals(&r, size);
        code_level(&r);
    }
    memcpy(out, in, size < GTX_LOD_HEADER ? size : GTX_LOD_HEADER);
}

bool gtx_lod_filter_undo(uint8_t *in, size_t size, uint8_t *out)
{
    run r = {.plain = out, .coded = in};
    if (!find_parts(in, size, &r.at))
        return false;
    memcpy(out, in, GTX_LOD_HEADER);
    code_level(&r);
    code_normals(&r, size);
    return true;
}
