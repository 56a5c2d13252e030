/* Counts cells: the renderer gets the functions of the context, except for those that are replaced
 * so that shaders count and fragments add up in the framebuffer. */
#include "cli/bench/cells.hpp"

#include "cli/bench/scene.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>

namespace gtx {

namespace {

/* In place of the main of a fragment that casts. Depth is as it would be without blending, for rays
 * end at it where shaders are told of it. */
const char counting_main[] = R"(
layout(location = 0) out vec4 gtx_out_counts;
void main()
{
    gtx_surface s;
    float depth = gtx_find(s) ? gtx_window_depth(s) : 1.0;
#ifdef GTX_DEPTH_FETCH
    depth = min(depth, gl_LastFragDepthARM);
#endif
    gtx_out_counts = vec4(gtx_looked, gtx_looked.x > 0.0, 0.0);
    gl_FragDepth = depth;
}
)";

/* The context's own. */
PFNGLSHADERSOURCEPROC shader_source;
PFNGLDISABLEPROC disable;
PFNGLDEPTHFUNCPROC depth_func;

/* The first text is the version, the last one of a fragment shader its main. */
void APIENTRY counting_source(GLuint shader, GLsizei count, const GLchar *const *texts,
                              const GLint *lengths)
{
    Vector<const GLchar *> all(texts, texts + count);
    if (count > 1 && !lengths && std::strstr(all.back(), "gtx_find(s)")) {
        all.back() = counting_main;
        all.insert(all.begin() + 1, "#define GTX_COUNT\n");
    }
    shader_source(shader, GLsizei(all.size()), all.data(), lengths);
}

void APIENTRY disable_all_but_blending(GLenum what)
{
    if (what != GL_BLEND)
        disable(what);
}

void APIENTRY pass_always(GLenum)
{
    depth_func(GL_ALWAYS);
}

template <class Function> void look_up(const char *name, Function &out)
{
    out = reinterpret_cast<Function>(gtx_offscreen_load(name, nullptr));
}

gtx_host_proc load_counting(const char *name, void *user)
{
    const struct {
        const char *name;
        gtx_host_proc function;
    } own[] = {{"glShaderSource", reinterpret_cast<gtx_host_proc>(counting_source)},
               {"glDisable", reinterpret_cast<gtx_host_proc>(disable_all_but_blending)},
               {"glDepthFunc", reinterpret_cast<gtx_host_proc>(pass_always)}};
    look_up("glShaderSource", shader_source);
    look_up("glDisable", disable);
    look_up("glDepthFunc", depth_func);
    for (const auto &entry : own)
        if (!std::strcmp(name, entry.name))
            return entry.function;
    return gtx_offscreen_load(name, user);
}

/* A target whose colour is floats. */
class CountTarget {
public:
    CountTarget(const gtx_host_gl &gl, uint32_t width, uint32_t height)
        : target_(gl, width, height), size_(size_t(width) * height)
    {
        gl.BindRenderbuffer(GL_RENDERBUFFER, target_.framebuffer.color);
        gl.RenderbufferStorage(GL_RENDERBUFFER, GL_RGBA32F, GLsizei(width), GLsizei(height));
        gl.BindRenderbuffer(GL_RENDERBUFFER, 0);
        look_up("glBlendFunc", blend_func_);
    }
    void begin() const
    {
        target_.gl.ClearColor(0, 0, 0, 0);
        target_.gl.Enable(GL_BLEND);
        blend_func_(GL_ONE, GL_ONE);
    }
    /* What fragments added up to: four floats a pixel. */
    Vector<float> end() const
    {
        Vector<float> counts(4 * size_);
        disable(GL_BLEND);
        target_.gl.ReadPixels(0, 0, target_.framebuffer.width, target_.framebuffer.height, GL_RGBA,
                              GL_FLOAT, counts.data());
        return counts;
    }

private:
    Target target_;
    size_t size_;
    PFNGLBLENDFUNCPROC blend_func_;
};

void add_view(CellRow &row, const Vector<float> &counts, size_t view)
{
    for (size_t i = 0; i < counts.size(); i += 4) {
        const float cells = counts[i], slabs = counts[i + 1];
        if (!(cells > 0 || slabs > 0))
            continue;
        ++row.rays;
        row.cells += double(cells);
        row.slabs += double(slabs);
        row.fragments += double(counts[i + 2]);
        row.worst = uint32_t(cells) > row.most_cells ? view : row.worst;
        row.most_cells = std::max(row.most_cells, uint32_t(cells));
        row.most_slabs = std::max(row.most_slabs, uint32_t(slabs));
    }
}

CellRow count_cells(BenchScene &scene, const ViewPath *path, BenchMethod method,
                    const std::array<uint32_t, 2> &size)
{
    CellRow row = {size, method};
    const CountTarget target(scene.gl, size[0], size[1]);
    const size_t views = path ? path->views.size() : size_t(BENCH_TURNS);
    for (size_t v = 0; v < views; ++v) {
        target.begin();
        if (path)
            scene.draw(method, scene.view_of(*path, v, size[0], size[1]));
        else
            scene.draw(method, Shot{size[0], size[1], 1, int(v)});
        add_view(row, target.end(), v);
    }
    const double rays = double(std::max<uint64_t>(row.rays, 1));
    row.cells /= rays;
    row.slabs /= rays;
    row.fragments /= rays;
    return row;
}

} // namespace

bool casts_alone(BenchMethod method)
{
    return method == BenchMethod::PAPER || method == BenchMethod::CAST ||
           method == BenchMethod::CAST_FRAGMENT;
}

void run_cells(const std::string &asset_path, const ViewPath *path, BenchOptions options,
               const std::function<void(const CellRow &)> &tell)
{
    options.load = load_counting;
    BenchScene scene(asset_path, {}, options);
    for (const std::array<uint32_t, 2> &size : options.sizes)
        for (BenchMethod method : options.methods)
            tell(count_cells(scene, path, method, size));
}

void print_cells_head(const char *scene)
{
    std::string line = scene; /* of a table, whatever the path holds */
    gtx_make_printable(line.data());
    std::printf("%s: cells and slabs that a ray looks at (of the paper's search, points)\n"
                "| window    | method        | rays     | fragments | cells   | worst | view "
                "| slabs   | worst |\n|---|---|---|---|---|---|---|---|---|\n", line.c_str());
}

void print_cells(const CellRow &row)
{
    char window[32];
    std::snprintf(window, sizeof window, "%ux%u", row.size[0], row.size[1]);
    std::printf("| %-9s | %-13s | %8llu | %9.2f | %7.2f | %5u | %4zu | %7.2f | %5u |\n", window,
                bench_method_names[uint32_t(row.method)],
                static_cast<unsigned long long>(row.rays), row.fragments, row.cells,
                row.most_cells, row.worst, row.slabs, row.most_slabs);
    std::fflush(stdout);
}

} // namespace gtx
