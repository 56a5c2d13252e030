/* The filter of LOD mesh sections: triangles as steps along the boundary of those before, positions
 * as differences from a prediction by the triangle joined, normals from those of the triangles; all
 * of it in planes of bytes. After Touma and Gotsman 1998 (parallelogram, active boundary) and
 * Kapoulkine's meshoptimizer (recent edges). */
#include "asset/boundary.h"
#include "asset/lod.h"

#include "base/bytes.h"

/* How a triangle starts, times KINDS, plus what its third corner is. */
enum { ALONG = GTX_LATEST_EDGES, FREE, KINDS = 4 };
enum { NEW, AFTER, BEFORE, TOLD };

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
    const uint64_t arrays = 6 * vertices + 12 * triangles + gtx_lod_normals_size(flags, vertices);
    const uint64_t left = size - GTX_LOD_HEADER;
    if (arrays > left || (left - arrays) % 4 || vertices > GTX_MAX_LOD_VERTICES ||
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

/* Number i whose bytes lie in `width` planes, which begin `stride` bytes apart. */
static uint32_t load_planes(const uint8_t *planes, size_t stride, size_t i, int width)
{
    uint32_t value = 0;
    for (int k = width; k-- > 0;)
        value = value << 8 | planes[(size_t)k * stride + i];
    return value;
}

static void store_planes(uint8_t *planes, size_t stride, size_t i, int width, uint32_t value)
{
    for (int k = 0; k < width; ++k)
        planes[(size_t)k * stride + i] = (uint8_t)(value >> 8 * k);
}

/* A run over the triangles of a level, in either direction: `plain` and `coded` are its two forms,
 * and one of them grows. */
typedef struct run {
    parts at;
    uint8_t *plain, *coded;
    bool apply;                   /* plain -> coded */
    gtx_boundary boundary;
    size_t words;                 /* told so far */
    uint32_t next;                /* vertices met so far */
} run;

/* Coordinate k of a vertex that was met. While steps are undone they lie where coded ones were, for
 * the boundary's links take their place. */
static uint32_t coordinate(const run *r, uint32_t vertex, size_t k)
{
    if (r->apply)
        return gtx_load_u16(r->plain + r->at.positions + 6 * (size_t)vertex + 2 * k);
    const size_t count = r->at.vertices;
    return load_planes(r->coded + r->at.positions + k * count, 3 * count, vertex, 2);
}

/* The position of a vertex: the difference to what is expected, zigzag; low bytes of all three
 * coordinates, then high ones. */
static void code_position(run *r, uint32_t vertex, const uint32_t near[3])
{
    const size_t count = r->at.vertices;
    for (size_t k = 0; k < 3; ++k) {
        uint8_t *planes = r->coded + r->at.positions + k * count;
        uint32_t expected = 0;
        if (near)
            expected = coordinate(r, near[0], k) + coordinate(r, near[1], k) -
                       coordinate(r, near[2], k);
        else if (vertex)
            expected = coordinate(r, vertex - 1, k);
        if (r->apply) {
            uint32_t step = (coordinate(r, vertex, k) - expected) & 0xFFFF;
            uint32_t zigzag = (step << 1 ^ (step >> 15 ? 0xFFFF : 0)) & 0xFFFF;
            store_planes(planes, 3 * count, vertex, 2, zigzag);
        } else {
            uint32_t zigzag = load_planes(planes, 3 * count, vertex, 2);
            uint32_t step = zigzag >> 1 ^ (zigzag & 1 ? 0xFFFF : 0);
            store_planes(planes, 3 * count, vertex, 2, expected + step);
        }
    }
}

/* Counts a vertex that was not met before, and codes its position, expected at the first of three
 * vertices plus the second minus the third. */
static void meet(run *r, uint32_t vertex, const uint32_t near[3])
{
    if (vertex != r->next || vertex >= r->at.vertices)
        return;
    bool known = near && near[0] < vertex && near[1] < vertex && near[2] < vertex;
    code_position(r, vertex, known ? near : NULL);
    ++r->next;
}

/* The next word and the corner that it stands for: how many vertices back it was met first, 0 for
 * one never met. */
static uint32_t code_word(run *r, uint32_t corner)
{
    const size_t count = 3 * r->at.triangles;
    uint8_t *planes = r->coded + r->at.indices + r->at.triangles;
    if (r->apply)
        store_planes(planes, count, r->words, 3, r->next - corner);
    else
        corner = (r->next - load_planes(planes, count, r->words, 3)) & 0xFFFFFF;
    ++r->words;
    return corner;
}

/* How the triangle starts: the age of the edge that it joins, ALONG or FREE. */
static uint32_t start_of(const gtx_boundary *b, const uint32_t corner[3])
{
    for (uint32_t age = 0; age < b->count; ++age)
        if (gtx_boundary_latest(b, age)->from == corner[0] &&
            gtx_boundary_latest(b, age)->to == corner[1])
            return age;
    return gtx_boundary_after(b, corner[0]) == corner[1] ? ALONG : FREE;
}

static void code_triangle(run *r, size_t triangle)
{
    uint8_t *index = r->plain + r->at.indices + 12 * triangle;
    uint8_t *code = r->coded + r->at.indices + triangle;
    const gtx_boundary *b = &r->boundary;
    uint32_t corner[3] = {0, 0, 0}, near[3];
    for (int k = 0; k < 3 && r->apply; ++k)
        corner[k] = gtx_load_u32(index + 4 * k);

    const uint32_t start = r->apply ? start_of(b, corner) : (uint32_t)*code / KINDS;
    const bool joined = start < b->count;
    if (joined) {
        const gtx_boundary_edge *edge = gtx_boundary_latest(b, start);
        near[0] = corner[0] = edge->from;
        near[1] = corner[1] = edge->to;
        near[2] = edge->across;
    } else {
        meet(r, corner[0] = code_word(r, corner[0]), NULL);
        near[0] = near[1] = near[2] = corner[0];
        corner[1] = start == ALONG ? gtx_boundary_after(b, corner[0]) : code_word(r, corner[1]);
        meet(r, corner[1], near);
        near[0] = near[1] = near[2] = corner[1];
    }

    const uint32_t third[] = {r->next, gtx_boundary_after(b, corner[1]),
                              gtx_boundary_before(b, corner[0])};
    uint32_t kind = NEW;
    if (!r->apply)
        kind = *code % KINDS;
    else
        while (kind < TOLD && third[kind] != corner[2])
            ++kind;
    corner[2] = kind < TOLD ? third[kind] : code_word(r, corner[2]);
    meet(r, corner[2], near);

    if (r->apply)
        *code = (uint8_t)(KINDS * start + kind);
    for (int k = 0; k < 3 && !r->apply; ++k)
        gtx_store_u32(index + 4 * k, corner[k]);
    gtx_boundary_add(&r->boundary, corner, joined);
}

/* What the links leave behind them. */
static void place_vertices(run *r)
{
    for (uint32_t v = 0; v < r->at.vertices; ++v)
        for (size_t k = 0; k < 3; ++k)
            gtx_store_u16(r->plain + r->at.positions + 6 * (size_t)v + 2 * k,
                          (uint16_t)coordinate(r, v, k));
}

/* `links` have room for GTX_LINK_BYTES. */
static void code_level(run *r, uint8_t *links)
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
    gtx_boundary_begin(&r->boundary, links, (uint32_t)r->at.vertices);
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

void gtx_lod_filter_apply(const uint8_t *in, size_t size, uint8_t *out, uint8_t *links)
{
    run r = {.plain = (uint8_t *)in, .coded = out, .apply = true};
    if (find_parts(in, size, &r.at)) {
        code_normals(&r, size);
        memset(out + r.at.indices, 0, 12 * r.at.triangles);
        code_level(&r, links);
    }
    memcpy(out, in, size < GTX_LOD_HEADER ? size : GTX_LOD_HEADER);
}

bool gtx_lod_filter_undo(uint8_t *in, size_t size, uint8_t *out)
{
    run r = {.plain = out, .coded = in};
    if (!find_parts(in, size, &r.at))
        return false;
    memcpy(out, in, GTX_LOD_HEADER);
    code_level(&r, out + r.at.positions);
    place_vertices(&r);
    code_normals(&r, size);
    return true;
}
