/* The inputs of a world: models, folders of them, grids, raw triangles. */
#include "world/cell.hpp"

#include "grid/grid.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace gtx {

namespace fs = std::filesystem;

/* ---- which files ---- */

static bool is_one_of(const std::string &extension, std::initializer_list<const char *> list)
{
    return std::find(list.begin(), list.end(), extension) != list.end();
}

/* Other images of a folder are some model's. */
static bool is_grid(const std::string &path)
{
    return is_one_of(model_extension(path), {".irap", ".gri", ".zmap", ".tif", ".tiff", ".asc",
                                             ".grd", ".hgt"});
}

/* Whether `path` is `folder` or lies below it. */
static bool is_below(const fs::path &path, const fs::path &folder)
{
    const fs::path a = fs::weakly_canonical(path), b = fs::weakly_canonical(folder / "");
    auto end = b.end();
    if (b.has_relative_path() && !b.has_filename())
        --end; /* the empty name after the last separator */
    return std::mismatch(a.begin(), a.end(), b.begin(), end).second == end;
}

static void add_folder(const std::string &folder, Vector<WorldInput> &out)
{
    Vector<std::string> paths;
    for (const fs::directory_entry &entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file() && (is_model_name(entry.path().native()) ||
                                        is_grid(entry.path().native())))
            paths.push_back(entry.path().native());
    std::sort(paths.begin(), paths.end());
    for (const std::string &path : paths)
        out.push_back({path, false, !is_model_name(path)});
}

Vector<WorldInput> find_inputs(const PlanOptions &options)
{
    Vector<WorldInput> out;
    for (const std::string &path : options.models) {
        if (path == "-") {
            out.push_back({fs::absolute(fs::path(options.folder) / "work/input.raw").native(),
                           true, false});
            continue;
        }
        std::error_code error;
        const bool is_folder = fs::is_directory(path, error);
        if (is_below(path, options.folder) || (is_folder && is_below(options.folder, path)))
            throw Error(GTX_ERROR_ARGUMENT, "the world's folder would hold what it is made of: " +
                                                path);
        const size_t before = out.size();
        if (is_folder)
            add_folder(path, out);
        else
            out.push_back({path, false, !is_model_name(path)});
        if (out.size() == before)
            throw Error(GTX_ERROR_EMPTY, "there is no model in the folder " + path);
    }
    for (WorldInput &input : out)
        input.path = fs::absolute(input.path).lexically_normal().native();
    return out;
}

/* ---- their triangles ---- */

namespace {

class GridStream : public TriangleStream {
public:
    GridStream(const std::string &path, const Plan &plan, Task &task)
        : path_(path), plan_(plan), task_(task) {}
    CornerTraits traits() const override { return {true, false, false}; }
    void read(const TriangleSink &sink) override
    {
        HeightGrid grid = read_grid(path_, {}, task_);
        if (!std::isnan(plan_.latitude))
            use_local_metres(grid, plan_.latitude);
        if (plan_.of_depths)
            use_depths(grid);
        require_lengths(grid);
        for (uint32_t row = 0; row + 1 < grid.ny; ++row) {
            task_.advance(double(row) / grid.ny);
            for_each_triangle(grid, row, [&](const std::array<size_t, 3> &nodes) {
                Corners3 out;
                for (size_t k = 0; k < 3; ++k)
                    out[k].position = grid_node(grid, nodes[k]);
                sink(out);
            });
        }
    }

private:
    const std::string path_;
    const Plan &plan_;
    Task &task_;
};

} // namespace

static std::unique_ptr<TriangleStream> open_input(const WorldInput &input, const Plan &plan,
                                                  Task &task)
{
    if (input.raw)
        return open_raw_triangles(input.path, task);
    if (input.grid)
        return std::make_unique<GridStream>(input.path, plan, task);
    return open_triangles(input.path, task);
}

/* Errors and warnings name the input. */
template <class Body> static void for_each_input(const Plan &plan, Task &task, Body body)
{
    for (const WorldInput &input : plan.inputs) {
        const size_t before = task.warnings.size();
        try {
            body(input, *open_input(input, plan, task));
        } catch (Error &e) {
            if (e.result != GTX_CANCELLED)
                e.message.insert(0, input.path + ": ");
            throw;
        }
        for (size_t i = before; i < task.warnings.size(); ++i)
            task.warnings[i].sentence.insert(0, input.path + ": ");
    }
}

CornerTraits input_traits(const Plan &plan, Task &task)
{
    CornerTraits traits;
    for_each_input(plan, task, [&](const WorldInput &, TriangleStream &stream) {
        traits.add(stream.traits());
    });
    return traits;
}

double input_latitude(const Plan &plan, Task &task)
{
    double latitude = NAN;
    for (const WorldInput &input : plan.inputs)
        if (input.grid && std::isnan(latitude)) {
            HeightGrid grid = read_grid(input.path, {}, task);
            use_common_metres(grid, latitude);
        }
    return latitude;
}

uint64_t read_inputs(const Plan &plan, Task &task, const TriangleSink &sink,
                     const LookSink &on_look)
{
    uint64_t dropped = 0, count = 0, materials = 0;
    size_t heard = task.warnings.size(); /* those of opening were, already */
    for_each_input(plan, task, [&](const WorldInput &input, TriangleStream &stream) {
        task.warnings.resize(heard);
        const bool turned = plan.z_up && !input.grid;
        uint64_t first = materials;
        stream.on_look = [&](const Appearance &look) {
            materials += look.materials.size();
            if (on_look)
                on_look(look);
        };
        stream.read([&](const Corners3 &read) {
            Corners3 corners = read;
            for (Corner &c : corners) {
                if (c.look.material != CornerLook::NO_MATERIAL)
                    c.look.material += uint32_t(first);
                if (!turned)
                    continue;
                c.position = {c.position.x, c.position.z, -c.position.y};
                c.normal = {c.normal.x, c.normal.z, -c.normal.y};
                std::swap(c.look.tangent[1], c.look.tangent[2]);
                c.look.tangent[2] = -c.look.tangent[2];
            }
            if (++count % 0x10000 == 0)
                task.limits.require(GTX_LIMITED_TRIANGLES, "the world", count);
            if (are_near(corners))
                sink(corners);
            else
                ++dropped;
        });
        heard = task.warnings.size();
    });
    task.limits.require(GTX_LIMITED_TRIANGLES, "the world", count);
    return dropped;
}

} // namespace gtx
