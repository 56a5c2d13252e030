/* Cleaning: from the triangles of a file to a mesh that keeps the promises of mesh.hpp. */
#include "mesh/clean/clean.hpp"

namespace gtx {

/* "3 triangles without area: dropped" */
static void warn(Task &task, gtx_warning kind, uint64_t count, const char *noun, const char *what)
{
    if (count)
        task.warn(kind, std::to_string(count) + " " + noun + (count > 1 ? "s " : " ") + what);
}

static void warn_dropped(Task &task, const CleanReport &report)
{
    static const struct {
        gtx_warning kind;
        const char *reason, *what;
    } reasons[] = {
        {GTX_WARNING_BAD_INDICES, "index", "naming a vertex that does not exist: dropped"},
        {GTX_WARNING_NON_FINITE, "non-finite",
         "with coordinates that are not finite or beyond 1e75: dropped"},
        {GTX_WARNING_DEGENERATE, "degenerate", "without area: dropped"},
        {GTX_WARNING_DUPLICATE, "duplicate", "on the same vertices as another: dropped"},
    };
    for (const auto &r : reasons) {
        auto found = report.dropped.find(r.reason);
        warn(task, r.kind, found == report.dropped.end() ? 0 : found->second, "triangle", r.what);
    }
}

static void warn_repaired(Task &task, const Draft &surface, const CleanReport &report)
{
    warn(task, GTX_WARNING_NONMANIFOLD, report.nonmanifold_edges, "edge",
         "with more than two triangles: split");
    warn(task, GTX_WARNING_UNORIENTABLE, surface.cut_edges, "edge",
         "where a one-sided surface meets itself reversed: cut");
    warn(task, GTX_WARNING_WINDING, report.flipped, "triangle",
         "wound against the others or inwards: turned");
    warn(task, GTX_WARNING_INSIDE_OUT, surface.inside_out, "closed component",
         "inside out: turned");
    warn(task, GTX_WARNING_OPEN_EDGES, surface.open_components, "component",
         "with a border: made two-sided");
    warn(task, GTX_WARNING_BAD_NORMALS, surface.new_normals, "corner normal",
         "missing or facing inwards: derived");
}

/* Attributes that do not fit the triangles are no attributes, and a texture without coordinates or
 * an image is none. */
static void drop_misfits(Mesh &mesh)
{
    const size_t triangles = mesh.triangles.size();
    Appearance &look = mesh.appearance;
    for_each_corner_attribute(mesh, [&](auto &items) {
        if (items.size() != 3 * triangles)
            items.clear();
    });
    mesh.flags.resize(triangles, 0);
    auto exists = [&](uint32_t m) { return m < look.materials.size(); };
    if (look.material.size() != triangles ||
        !std::all_of(look.material.begin(), look.material.end(), exists))
        look.material.clear();
    for (Material &m : look.materials)
        for (Texture Material::*map : MATERIAL_TEXTURES) {
            Texture &t = m.*map;
            if (t.image >= look.images.size() || t.set > 1 || look.uv[t.set].empty())
                t.image = Texture::NONE;
        }
}

Mesh clean_mesh(Mesh mesh, Task &task, CleanReport &report, bool closed)
{
    report = CleanReport();
    if (mesh.triangles.size() >= NO_EDGE / 3 || mesh.positions.size() >= NO_EDGE)
        throw Error(GTX_ERROR_LIMIT, "more triangles than 32 bits can count");
    drop_misfits(mesh);
    drop_invalid(mesh, task, report);
    task.advance(0.1);
    weld(mesh, &task);
    task.advance(0.2);
    Vector<uint8_t> thin = drop_duplicates(mesh, task, report);
    task.advance(0.3);
    warn_dropped(task, report);
    if (mesh.triangles.empty())
        throw Error(GTX_ERROR_EMPTY, "no triangle with a finite, non-zero area");

    Draft surface{mesh, std::move(thin), {}, {}, Vector<uint8_t>(mesh.triangles.size(), 0)};
    pair_edges(surface, task, report);
    task.advance(0.4);
    orient(surface);
    task.advance(0.5);
    split_fans(surface, task);
    task.advance(0.6);
    choose_sides(surface, closed, task, report);
    task.advance(0.7);
    make_normals(surface, task);
    for (uint8_t turned : surface.turned)
        report.flipped += turned;
    warn_repaired(task, surface, report);
    return mesh;
}

} // namespace gtx
