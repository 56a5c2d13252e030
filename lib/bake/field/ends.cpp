/* The outline of a height field that ends at creases, for those that meet it there. */
#include "bake/field/chart_field.hpp"

namespace gtx::baking {

/* Cosine between the normals beside an edge that is a crease: what is shown past it stands out.
 * Truck: 12 % more wall pixels at 0.7, where bevels are no creases. */
constexpr double CREASE = 0.94;
static bool is_convex_crease(const Job &job, uint32_t source, int side)
{
    const Mesh &mesh = job.mesh;
    const uint32_t across = job.neighbours[source][size_t(side)];
    if (across == NO_TRIANGLE)
        return false;
    const Vec3d own = normalize(mesh.area_vector(source));
    if (!(dot(own, normalize(mesh.area_vector(across))) < CREASE))
        return false;
    double lowest = 0;
    for (int k = 0; k < 3; ++k)
        lowest = std::min(lowest, dot(mesh.position(across, k) - mesh.position(source, side), own));
    return lowest < 0;
}

Vector<EndEdge> find_ends(const Job &job, const ChartField &field, int x, int y, int w, int h)
{
    Vector<EndEdge> out;
    bool any = false;
    auto apart = [](double a, double b, int size) {
        return std::max(a, b) < 0 || std::min(a, b) > size - 1;
    };
    for (const OutlineEdge &edge : field.outline.edges) {
        cancel_point();
        if (apart(edge.from.x - x, edge.to.x - x, w) || apart(edge.from.y - y, edge.to.y - y, h))
            continue;
        const uint32_t source = field.flat.triangles[edge.triangle].source;
        const bool crease = is_convex_crease(job, source, edge.side);
        out.push_back({source, uint8_t(edge.side), crease, edge.triangle < field.flat.core,
                       float(edge.from.x - x), float(edge.from.y - y),
                       float(edge.to.x - edge.from.x), float(edge.to.y - edge.from.y)});
        any = any || crease;
    }
    return any ? std::move(out) : Vector<EndEdge>();
}

} // namespace gtx::baking
