/* What tests of the partition pgp share: a mesh parameterized, and its charts. */
#pragma once

#include "chart/pgp/pgp.hpp"
#include "shapes.hpp"

/* A mesh with all that comes before its charts. */
struct Mapped {
    gtx::Task task{2, nullptr, nullptr, {"partition"}};
    gtx::Mesh mesh;
    gtx::Surface surface;
    gtx::HalfEdges edges;
    gtx::CrossField field;
    gtx::Vector<double> scale;

    explicit Mapped(gtx::Mesh of)
        : mesh(std::move(of)),
          surface(gtx::make_surface(mesh, gtx::expected_pitch(mesh, 50), task)),
          edges(gtx::make_half_edges(surface)), field(gtx::make_cross_field(surface, edges)),
          scale(gtx::make_scale(edges, field))
    {
        task.begin("partition");
    }
    gtx::Periodic parameterize(double cell)
    {
        return gtx::parameterize(edges, field, scale, cell);
    }
    /* Cells of a mean length that cover as much as the surface. */
    double cell_for(double count) const { return std::sqrt(surface.area / count); }
};

inline gtx::CutMesh cells(const gtx::Mesh &mesh, uint32_t &count, unsigned threads = 2,
                          bool adaptive = false)
{
    gtx::Task task(threads, nullptr, nullptr, {"partition"});
    task.begin("partition");
    gtx::Surface surface = gtx::make_surface(mesh, gtx::expected_pitch(mesh, count), task);
    return gtx::square_cells(surface, count, adaptive, task);
}
