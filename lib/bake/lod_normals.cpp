/* Fits the normals of an LOD mesh's vertices to the normal maps. */
#include "bake/lod_normals.hpp"

#include "asset/lod.h"
#include "asset/patch.h"
#include "base/bytes.h"
#include "mesh/vec.hpp"

#include <algorithm>
#include <cmath>

namespace gtx {

/* The root of the mean square of what normals stray from the maps, up to which a level has any:
 * 4 degrees, up to which levels are also lit at their vertices (lib/frame/lod_normals.c). Of the
 * bunny's levels the finest has 1.9, the next 4.1; of the dragon's 2.9 and just over 4. At half the
 * dragon has none; at double three levels of each do, which takes 7 and 32 KB more. */
static constexpr double MAX_ERROR = 4 * 0.017453292519943295;

/* Steps of least squares. Bunny, dragon: 2.4 and 3.7 degrees without, 1.79 and 2.75 after two,
 * 1.76 and 2.71 after eight. */
static constexpr int FITS = 2;

/* Codes are an expected one and a multiple of this. Bunny, by zstd at level 19: 15.8 KB and 1.79
 * degrees at 1, 9.2 KB and 1.92 at 3, 5.6 KB and 2.14 at 6. */
static constexpr int GRAIN = 3;

namespace {

Vec3d loaded(const float v[3])
{
    return {double(v[0]), double(v[1]), double(v[2])};
}

/* Of a patch: what takes points to its texels, and normals from there. */
struct Place {
    const gtx_patch &patch;
    const NormalMaps &maps;
    gtx_patch_frame frame;
    float rows[3][3];
    double weight; /* the area of a texel */

    Place(const NormalMaps &maps, uint32_t index)
        : patch(maps.patches[index]), maps(maps),
          frame(gtx_patch_frame_of(&patch, maps.height_bits))
    {
        gtx_normal_frame(&patch, rows);
        const double texels = double(patch.rect[2]) * double(patch.rect[3]);
        weight = length(cross(loaded(patch.axis_x), loaded(patch.axis_y))) *
                 double(patch.extent_x) * double(patch.extent_y) / texels;
    }

    size_t texel(uint32_t x, uint32_t y) const
    {
        const size_t row = size_t(patch.page) * maps.page_height + patch.rect[1] + y;
        return row * maps.page_width + patch.rect[0] + x;
    }
    bool is_coded(uint32_t x, uint32_t y) const
    {
        const size_t at = texel(x, y);
        return maps.height_bits == 8 ? maps.height[at]
                                     : maps.height[2 * at] | maps.height[2 * at + 1];
    }
    Vec3d normal(uint32_t x, uint32_t y) const
    {
        float n[3];
        gtx_decode_normal(maps.normal + 2 * texel(x, y), n);
        Vec3d out;
        for (int k = 0; k < 3; ++k)
            for (int r = 0; r < 3; ++r)
                out[k] += double(n[r]) * double(rows[r][k]);
        return out;
    }
    Vec3d to_texels(const Vec3d &p) const
    {
        Vec3d out;
        for (int a = 0; a < 2; ++a) {
            const double *row = frame.to_grid[a];
            out[a] = row[0] * p.x + row[1] * p.y + row[2] * p.z + row[3];
        }
        return out;
    }
    /* Of the nearest texel. */
    Vec3d normal_near(const Vec3d &at) const
    {
        uint32_t texel[2];
        for (int a = 0; a < 2; ++a)
            texel[a] = uint32_t(std::clamp(at[a] + 0.5, 0., double(patch.rect[2 + a] - 1)));
        return normal(texel[0], texel[1]);
    }
};

/* A texel with a height on which a triangle lies. */
struct Sample {
    Vec3f normal;                /* the map's */
    float b, c;                  /* shares of the second and third corner */
};

/* Those of one triangle, up to the next one's. */
struct Sampled {
    const uint32_t *vertex;
    double weight;               /* of each */
    size_t first;
};

class Fit {
public:
    /* Begins with the maps' normals where the vertices are. */
    Fit(const gtx_lod_mesh &level, const NormalMaps &maps);

    /* Returns the error before. */
    double step()
    {
        Vector<Vec3d> change(level_.vertex_count);
        Vector<double> weights(level_.vertex_count);
        const double before = error([&](const Sampled &of, const double *shares,
                                        const Vec3d *apart) {
            for (int k = 0; k < 3; ++k) {
                change[of.vertex[k]] += apart[k] * of.weight;
                weights[of.vertex[k]] += shares[k] * of.weight;
            }
        });
        for (size_t v = 0; v < normals_.size(); ++v)
            if (weights[v] > 0)
                normals_[v] = normalize(normals_[v] + change[v] / weights[v]);
        return before;
    }
    double error() const
    {
        return error([](const Sampled &, const double *, const Vec3d *) {});
    }
    Vector<uint8_t> coded() const;
    /* Goes on with what codes stand for. */
    void take(const Vector<uint8_t> &codes)
    {
        for (size_t v = 0; v < level_.vertex_count; ++v) {
            float n[3];
            gtx_decode_octahedral(&codes[2 * v], n);
            normals_[v] = loaded(n);
        }
    }

private:
    Vec3d position(uint32_t vertex) const
    {
        const uint16_t *q = level_.positions + 3 * size_t(vertex);
        return loaded(level_.origin) + Vec3d(q[0], q[1], q[2]) * double(level_.step);
    }
    void sample(const Place &place, const Vec3d *at);
    template <class Each> double error(Each &&each) const;

    const gtx_lod_mesh &level_;
    Vector<Vec3d> normals_;      /* of vertices, unit */
    Vector<Sampled> triangles_;  /* and an end */
    Vector<Sample> samples_;
};

Fit::Fit(const gtx_lod_mesh &level, const NormalMaps &maps)
    : level_(level), normals_(level.vertex_count)
{
    triangles_.reserve(size_t(level.triangle_count) + 1);
    for (uint32_t p = 0; p < maps.patch_count; ++p) {
        const Place place(maps, p);
        for (uint32_t t = level.first[p]; t < level.first[p + 1]; ++t) {
            const uint32_t *vertex = level.indices + 3 * size_t(t);
            Vec3d at[3];
            for (int c = 0; c < 3; ++c) {
                at[c] = place.to_texels(position(vertex[c]));
                normals_[vertex[c]] += place.normal_near(at[c]);
            }
            triangles_.push_back({vertex, place.weight, samples_.size()});
            sample(place, at);
        }
    }
    triangles_.push_back({nullptr, 0, samples_.size()});
    for (Vec3d &n : normals_)
        n = normalize(n);
}

void Fit::sample(const Place &place, const Vec3d *at)
{
    const Vec3d e = at[1] - at[0], f = at[2] - at[0];
    const double area = e.x * f.y - e.y * f.x;
    if (area == 0)
        return;
    uint32_t low[2], high[2];
    for (int a = 0; a < 2; ++a) {
        const double most = double(place.patch.rect[2 + a] - 1);
        low[a] = uint32_t(
            std::clamp(std::ceil(std::min({at[0][a], at[1][a], at[2][a]})), 0., most));
        high[a] = uint32_t(
            std::clamp(std::floor(std::max({at[0][a], at[1][a], at[2][a]})), 0., most));
    }
    for (uint32_t y = low[1]; y <= high[1]; ++y) {
        cancel_point();
        for (uint32_t x = low[0]; x <= high[0]; ++x) {
            const double du = x - at[0].x, dv = y - at[0].y;
            const double at_b = du * f.y - dv * f.x, at_c = e.x * dv - e.y * du;
            if (at_b * area < 0 || at_c * area < 0) /* which spares divisions */
                continue;
            const double b = at_b / area, c = at_c / area;
            if (1 - b - c >= 0 && b >= 0 && c >= 0 && place.is_coded(x, y))
                samples_.push_back({Vec3f(place.normal(x, y)), float(b), float(c)});
        }
    }
}

/* The root of the mean square; 2 where no texel tells. Calls each(triangle, sums of its corners'
 * shares, sums of what the map has more by corner). */
template <class Each> double Fit::error(Each &&each) const
{
    double sum = 0, area = 0;
    for (size_t t = 0; t + 1 < triangles_.size(); ++t) {
        const Sampled &of = triangles_[t];
        const size_t end = triangles_[t + 1].first;
        cancel_point(end - of.first);
        const Vec3d n = normals_[of.vertex[0]], to_b = normals_[of.vertex[1]] - n,
                    to_c = normals_[of.vertex[2]] - n;
        double square = 0, shares[3] = {};
        Vec3d apart[3];
        for (size_t i = of.first; i < end; ++i) {
            const Sample &is = samples_[i];
            const double b = double(is.b), c = double(is.c);
            const Vec3d more = Vec3d(is.normal) - normalize(n + to_b * b + to_c * c);
            square += dot(more, more);
            apart[0] += more;
            apart[1] += more * b;
            apart[2] += more * c;
            shares[1] += b;
            shares[2] += c;
        }
        const double count = double(end - of.first);
        apart[0] = apart[0] - apart[1] - apart[2];
        shares[0] = count - shares[1] - shares[2];
        sum += of.weight * square;
        area += of.weight * count;
        each(of, shares, apart);
    }
    return area > 0 ? std::sqrt(sum / area) : 2;
}

Vector<uint8_t> Fit::coded() const
{
    const size_t count = level_.vertex_count;
    Vector<uint8_t> sums(12 * count), expected(2 * count), out(2 * count);
    Vector<uint8_t> indices(12 * size_t(level_.triangle_count)), positions(6 * count);
    for (size_t i = 0; i < indices.size() / 4; ++i)
        gtx_store_u32(&indices[4 * i], level_.indices[i]);
    for (size_t i = 0; i < positions.size() / 2; ++i)
        gtx_store_u16(&positions[2 * i], level_.positions[i]);
    gtx_lod_expect_normals(indices.data(), level_.triangle_count, positions.data(), count,
                           sums.data(), expected.data());
    for (size_t v = 0; v < count; ++v) {
        const Vec3f n(normals_[v]);
        gtx_encode_octahedral(&n.x, &out[2 * v]);
    }
    for (size_t i = 0; i < out.size(); ++i) {
        const int apart = out[i] - expected[i];
        const int steps = (apart + (apart < 0 ? -GRAIN : GRAIN) / 2) / GRAIN;
        const int code = expected[i] + GRAIN * steps;
        if (code >= 0 && code <= 255)
            out[i] = uint8_t(code);
    }
    return out;
}

} // namespace

LodNormals lod_normals(const gtx_lod_mesh &level, const NormalMaps &maps)
{
    LodNormals out;
    if ((level.flags & GTX_LOD_FAR) ||
        !gtx_lod_may_have_normals(level.vertex_count, level.triangle_count))
        return out;
    Fit fit(level, maps);
    if (!(fit.step() <= 2 * MAX_ERROR)) /* fitting takes a fourth off */
        return out;
    for (int i = 1; i < FITS; ++i)
        fit.step();
    Vector<uint8_t> codes = fit.coded();
    fit.take(codes);
    const double error = fit.error();
    if (!(error <= MAX_ERROR))
        return out;
    out.codes = std::move(codes);
    out.error = float(error);
    return out;
}

bool put_lod_normals(const LodNormals &normals, gtx_lod_mesh &level)
{
    if (normals.codes.empty())
        return false;
    level.flags |= GTX_LOD_NORMALS;
    level.normals = normals.codes.data();
    level.normal_error = normals.error;
    return true;
}

void add_lod_normals(Vector<gtx_lod_mesh> &levels, const NormalMaps &maps, Vector<LodNormals> &out,
                     Task &task)
{
    constexpr size_t AT_ONCE = 2; /* of levels most have one or two with normals */
    out.assign(levels.size(), {});
    for (size_t k = 0; k < levels.size(); ++k) {
        if (k % AT_ONCE == 0)
            task.parallel(std::min(AT_ONCE, levels.size() - k), [&](size_t i) {
                out[k + i] = lod_normals(levels[k + i], maps);
            }, 0, 0);
        if (!put_lod_normals(out[k], levels[k]))
            return;
    }
}

} // namespace gtx
