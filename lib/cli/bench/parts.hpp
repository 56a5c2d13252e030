/* A mesh in parts, of which those out of view are not drawn, and simplifications of known error. */
#pragma once

#include "cli/bench/mesh.hpp"

namespace gtx {

/* Neighbouring triangles, one range of the indices. */
struct MeshPart {
    float low[3], high[3];    /* box */
    uint32_t first, count;    /* indices */
    bool two_sided;           /* drawn from behind, too */
};

/* indices[0] of the levels is the source, the others are simplified from it. */
struct PartLevels {
    MeshLevels mesh;
    Vector<Vector<MeshPart>> parts;   /* of each level */
    Vector<double> errors;            /* object units, as meshopt_simplify tells them; 0 first */
};

/* `simplified`: with levels of half the triangles each, until their error is past `max_error`.
 * Throws Error: LIMIT. */
PartLevels make_part_levels(const Mesh &mesh, const Vec3d &centre, bool simplified,
                            double max_error);

/* Whether a part's box may be in view. */
class Frustum {
public:
    explicit Frustum(const float view_projection[16]);
    bool sees(const MeshPart &part) const;

private:
    float planes_[6][4];
};

/* The coarsest level with an error of at most `max_error` pixels at the nearest vertex of the
 * source in view. */
size_t coarsest_level(const PartLevels &levels, const gtx_view &view, double max_error);

/* Draws what is in view in one call, or two where some of it is two-sided. */
class PartDrawer {
public:
    /* Throws Error: GL. */
    explicit PartDrawer(const gtx_host_gl &gl);
    void draw(const gtx_polygon_program &program, const gtx_polygons &polygons,
              const Vector<MeshPart> &parts, const gtx_view &view);

private:
    void draw_side(const Vector<MeshPart> &parts, const Frustum &frustum, bool two_sided);

    const gtx_host_gl &gl_;
    PFNGLMULTIDRAWELEMENTSPROC multi_draw_;
    Vector<GLsizei> counts_;
    Vector<const void *> offsets_;
};

} // namespace gtx
