/* Why a chart ends at each edge of its outline: a neighbouring chart, an open border, or a crease,
 * behind which the surface turns away from the chart. */
#include "bake/field/chart_field.hpp"

namespace gtx::baking {

static Crease crease_of(const Job &job, uint32_t triangle, int side)
{
    const Mesh &mesh = job.mesh;
    return {mesh.position(triangle, side) - job.anchor,
            mesh.position(triangle, (side + 1) % 3) - job.anchor,
            normalize(mesh.area_vector(triangle)),
            normalize(mesh.area_vector(job.neighbours[triangle][size_t(side)]))};
}

Vector<Ending> find_endings(const Job &job, const ChartField &field, Vector<Crease> &creases)
{
    const Outline &outline = field.outline;
    Vector<Ending> endings(outline.edges.size(), AT_CHART);
    Vector<uint8_t> used(outline.edges.size());
    for (uint32_t nearest : outline.nearest)
        used[nearest] = 1;
    for (size_t e = 0; e < outline.edges.size(); ++e) {
        const OutlineEdge &edge = outline.edges[e];
        if (edge.border)
            endings[e] = AT_BORDER;
        if (edge.border || !used[e] || edge.triangle == NO_TRIANGLE)
            continue;
        const uint32_t source = field.flat.triangles[edge.triangle].source;
        if (is_crease(job.mesh, job.neighbours, source, edge.side)) {
            endings[e] = AT_CREASE;
            creases.push_back(crease_of(job, source, edge.side));
        }
    }
    return endings;
}

} // namespace gtx::baking
