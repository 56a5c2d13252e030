/* Renders a chart orthographically: colours unlit, normals renormalised, heights as depth (paper,
 * section 5, map extraction). Its three passes are the three targets of one. */
#include "bake/field/gl.hpp"
#include "bake/field/chart_field.hpp"

#include <algorithm>

namespace gtx::baking {

/* Triangles sent at once: a bound on memory, whatever the chart. */
constexpr size_t BATCH = 1 << 16;
/* Heights are scaled to this part of clip space, so that none is clipped. */
constexpr double DEPTH_RANGE = 0.95;

constexpr char VERTEX_SHADER[] = R"(#version 330 core
layout(location = 0) in vec3 corner;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec4 color;
out vec3 between_normals;
out vec4 between_colors;
void main()
{
    gl_Position = vec4(corner, 1.0);
    between_normals = normal;
    between_colors = color;
}
)";

/* Normals that cancel out have no direction: zero. */
constexpr char FRAGMENT_SHADER[] = R"(#version 330 core
uniform uint first;
in vec3 between_normals;
in vec4 between_colors;
layout(location = 0) out uint triangle;
layout(location = 1) out vec4 normal;
layout(location = 2) out vec4 color;
void main()
{
    float size = length(between_normals);
    triangle = first + uint(gl_PrimitiveID);
    normal = vec4(size > 1e-3 ? between_normals / size : vec3(0.0), 0.0);
    color = between_colors;
}
)";

struct Vertex {
    float corner[3], normal[3], color[4];
};
constexpr struct {
    GLint count;
    size_t offset;
} ATTRIBUTES[] = {{3, offsetof(Vertex, corner)}, {3, offsetof(Vertex, normal)},
                  {4, offsetof(Vertex, color)}};

enum { TARGET_TRIANGLE, TARGET_NORMAL, TARGET_COLOR, TARGET_COUNT };
constexpr GLenum TARGET_FORMATS[TARGET_COUNT] = {GL_R32UI, GL_RGBA32F, GL_RGBA32F};

/* All that lives in the context. */
struct GlState {
    Gl gl;
    GLuint program = 0, targets[TARGET_COUNT] = {}, depth = 0;
    GLint first = -1;
    int w = 0, h = 0;            /* of the targets */

    explicit GlState(const GlContext &context) : gl(context)
    {
        make_program();
        make_buffers();
    }
    void draw(const Vector<Vertex> &vertices, size_t first_triangle);
    void begin(int width, int height);
    void read(int target, int width, int height, GLenum format, GLenum type, void *out);
    void check();

private:
    void make_program();
    void make_buffers();
    void resize(int width, int height);
};

void GlState::check()
{
    if (GLenum code = gl.GetError())
        throw Error(GTX_ERROR_GL, code == GL_OUT_OF_MEMORY
                                      ? "the GPU is out of memory"
                                      : "OpenGL error " + std::to_string(code));
}

void GlState::make_program()
{
    const std::pair<GLenum, const char *> shaders[] = {{GL_VERTEX_SHADER, VERTEX_SHADER},
                                                       {GL_FRAGMENT_SHADER, FRAGMENT_SHADER}};
    program = gl.CreateProgram();
    for (const auto &[kind, text] : shaders) {
        GLuint shader = gl.CreateShader(kind);
        gl.ShaderSource(shader, 1, &text, nullptr);
        gl.CompileShader(shader);
        gl.AttachShader(program, shader);
    }
    gl.LinkProgram(program);
    GLint linked = 0;
    gl.GetProgramiv(program, GL_LINK_STATUS, &linked);
    if (!linked)
        throw Error(GTX_ERROR_SHADER, "the driver refuses the shaders of the extraction");
    first = gl.GetUniformLocation(program, "first");
    gl.UseProgram(program);
}

/* The context is nobody else's, so its state is set once. */
void GlState::make_buffers()
{
    GLuint array, buffer, framebuffer;
    gl.GenVertexArrays(1, &array);
    gl.BindVertexArray(array);
    gl.GenBuffers(1, &buffer);
    gl.BindBuffer(GL_ARRAY_BUFFER, buffer);
    for (GLuint i = 0; i < std::size(ATTRIBUTES); ++i) {
        gl.VertexAttribPointer(i, ATTRIBUTES[i].count, GL_FLOAT, GL_FALSE, sizeof(Vertex),
                               reinterpret_cast<const void *>(ATTRIBUTES[i].offset));
        gl.EnableVertexAttribArray(i);
    }
    gl.GenFramebuffers(1, &framebuffer);
    gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    gl.GenRenderbuffers(TARGET_COUNT, targets);
    gl.GenRenderbuffers(1, &depth);
    gl.Enable(GL_DEPTH_TEST);
    gl.DepthFunc(GL_GREATER);
    check();
}

void GlState::resize(int width, int height)
{
    w = std::max(w, width);
    h = std::max(h, height);
    GLenum attached[TARGET_COUNT];
    for (unsigned i = 0; i < TARGET_COUNT; ++i) {
        attached[i] = GL_COLOR_ATTACHMENT0 + i;
        gl.BindRenderbuffer(GL_RENDERBUFFER, targets[i]);
        gl.RenderbufferStorage(GL_RENDERBUFFER, TARGET_FORMATS[i], w, h);
        gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, attached[i], GL_RENDERBUFFER, targets[i]);
    }
    gl.BindRenderbuffer(GL_RENDERBUFFER, depth);
    gl.RenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, w, h);
    gl.FramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth);
    gl.DrawBuffers(TARGET_COUNT, attached);
    check();
    if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        throw Error(GTX_ERROR_GL, "the driver cannot draw integers and floats at once");
}

void GlState::begin(int width, int height)
{
    if (width > w || height > h)
        resize(width, height);
    const GLuint nothing[4] = {NO_TRIANGLE};
    const GLfloat black[4] = {}, bottom = 0;
    gl.ClearBufferuiv(GL_COLOR, TARGET_TRIANGLE, nothing);
    gl.ClearBufferfv(GL_COLOR, TARGET_NORMAL, black);
    gl.ClearBufferfv(GL_COLOR, TARGET_COLOR, black);
    gl.ClearBufferfv(GL_DEPTH, 0, &bottom);
    gl.Viewport(0, 0, width, height);
}

void GlState::draw(const Vector<Vertex> &vertices, size_t first_triangle)
{
    gl.BufferData(GL_ARRAY_BUFFER, GLsizeiptr(vertices.size() * sizeof(Vertex)), vertices.data(),
                  GL_STREAM_DRAW);
    gl.Uniform1ui(first, GLuint(first_triangle));
    gl.DrawArrays(GL_TRIANGLES, 0, GLsizei(vertices.size()));
}

void GlState::read(int target, int width, int height, GLenum format, GLenum type, void *out)
{
    gl.ReadBuffer(GLenum(GL_COLOR_ATTACHMENT0 + target));
    gl.ReadPixels(0, 0, width, height, format, type, out);
}

/* ---- what is drawn ---- */

/* Clip space of a chart: its grid's texels are pixels, heights fill the depth (`low` to `high`). */
struct Projection {
    const Grid &grid;
    double low, high;

    void place(const Vec3d &texel, float out[3]) const
    {
        double depth = high > low ? 2 * (texel.z - low) / (high - low) - 1 : 0;
        out[0] = float((texel.x + 0.5) / grid.w * 2 - 1);
        out[1] = float((texel.y + 0.5) / grid.h * 2 - 1);
        out[2] = float(DEPTH_RANGE * depth);
    }
};

static Projection project(const FlatChart &chart, const Vector<uint32_t> &seen)
{
    Projection p = {chart.grid, INFINITY, -INFINITY};
    for (uint32_t t : seen) {
        for (const Vec3d &corner : chart.triangles[t].corner) {
            p.low = std::min(p.low, corner.z);
            p.high = std::max(p.high, corner.z);
        }
    }
    return p;
}

static Vertex vertex(const Mesh &mesh, const Projection &projection, const FlatTriangle &t, int k)
{
    Vertex v;
    float weights[3] = {0, 0, 0};
    weights[k] = 1;
    const Interpolated corner = interpolate(mesh, t.source, weights);
    projection.place(t.corner[k], v.corner);
    std::copy_n(&corner.normal.x, 3, v.normal);
    std::copy_n(corner.color.data(), 4, v.color);
    return v;
}

/* The core's triangles that can be seen; one without area would be drawn by a rounding. */
static Vector<uint32_t> seen_triangles(const FlatChart &chart)
{
    Vector<uint32_t> seen;
    for (uint32_t t = 0; t < chart.core; ++t)
        if (chart.triangles[t].front && chart.triangles[t].signed_area() != 0)
            seen.push_back(t);
    return seen;
}

static void draw_core(GlState &state, const Mesh &mesh, const FlatChart &chart,
                      const Vector<uint32_t> &seen)
{
    const Projection projection = project(chart, seen);
    Vector<Vertex> vertices;
    for (size_t first = 0; first < seen.size(); first += BATCH) {
        vertices.clear();
        for (size_t i = first; i < std::min(first + BATCH, seen.size()); ++i)
            for (int k = 0; k < 3; ++k)
                vertices.push_back(vertex(mesh, projection, chart.triangles[seen[i]], k));
        state.draw(vertices, first);
    }
}

/* Gives a thread the context for as long as it lives. */
struct Borrowed {
    const GlContext &context;

    explicit Borrowed(const GlContext &context) : context(context) { context.acquire(); }
    ~Borrowed() { context.release(); }
    Borrowed(const Borrowed &) = delete;
    Borrowed &operator=(const Borrowed &) = delete;
};

Cover core_of(const FlatChart &chart, const Rendering &rendering)
{
    const Grid &grid = chart.grid;
    Cover cover;
    cover.triangle = rendering.triangle;
    cover.height.assign(grid.texels(), 0);
    for (size_t texel = 0; texel < grid.texels(); ++texel) {
        if (cover.triangle[texel] == NO_TRIANGLE)
            continue;
        const FlatTriangle &t = chart.triangles[cover.triangle[texel]];
        const Vec3d weight = weights_at(t, double(texel % grid.w), double(texel / grid.w));
        cover.height[texel] =
            weight.x * t.corner[0].z + weight.y * t.corner[1].z + weight.z * t.corner[2].z;
    }
    return cover;
}

} // namespace gtx::baking

namespace gtx {

using namespace baking;

Extractor::Extractor(GlContext context) : context_(std::move(context))
{
    Borrowed current(context_);
    gl_ = std::make_unique<GlState>(context_);
    auto text = [&](GLenum name) {
        const GLubyte *string = gl_->gl.GetString(name);
        return std::string(string ? reinterpret_cast<const char *>(string) : "");
    };
    renderer_ = text(GL_RENDERER);
    version_ = text(GL_VERSION);
}

Extractor::~Extractor() = default;

Rendering Extractor::render(const Mesh &mesh, const FlatChart &chart)
{
    const int w = chart.grid.w, h = chart.grid.h;
    const Vector<uint32_t> seen = seen_triangles(chart);
    Rendering out;
    out.triangle.resize(chart.grid.texels());
    out.normal.resize(chart.grid.texels());
    out.color.resize(chart.grid.texels());
    {
        std::lock_guard<std::mutex> lock(mutex_);
        Borrowed current(context_);
        gl_->begin(w, h);
        draw_core(*gl_, mesh, chart, seen);
        gl_->read(TARGET_TRIANGLE, w, h, GL_RED_INTEGER, GL_UNSIGNED_INT, out.triangle.data());
        gl_->read(TARGET_NORMAL, w, h, GL_RGB, GL_FLOAT, out.normal.data());
        gl_->read(TARGET_COLOR, w, h, GL_RGBA, GL_FLOAT, out.color.data());
        gl_->check();
    }
    for (uint32_t &t : out.triangle) {
        if (t == NO_TRIANGLE)
            continue;
        if (t >= seen.size())
            throw Error(GTX_ERROR_GL, "the driver drew a triangle that there is not");
        t = seen[t];
    }
    return out;
}

} // namespace gtx
