/* Rectangles over covered pixels, shaded with the shaders of the library. */
#include "cli/bench/floor.hpp"

#include "host/offscreen.h"
#include "host/program.h"
#include "mesh/task.hpp"

#include <cmath>
#include <string>

namespace gtx {

constexpr uint32_t SIDE = 1024; /* of the textures, texels */
constexpr GLenum ARRAY = GL_TEXTURE_2D_ARRAY;

/* What geotex_lod.vert gives: a patch in the plane of the window, lit from the front. */
static const char vertex_text[] = R"(
layout(location = 0) in vec3 position;
uniform vec4 toward;
out vec2 gtx_at;
flat out vec3 gtx_page;
flat out vec3 gtx_toward;
flat out vec3 gtx_eye;
#ifdef GTX_MATERIALS
flat out vec4 gtx_between;
#endif
flat out vec4 gtx_color;
void main()
{
    gtx_at = position.xy * 0.5 + 0.5;
    const float deviation = 0.001; /* of normals: the least */
    const vec3 eye = vec3(0.0, 0.0, 1.0);
    gtx_page = vec3(0.0, 0.0, deviation);
    gtx_toward = toward.xyz / deviation;
    gtx_eye = eye / deviation;
#ifdef GTX_MATERIALS
    gtx_between = vec4(normalize(eye + toward.xyz), 0.0);
#endif
    gtx_color = vec4(1.0);
    gl_Position = vec4(position, 1.0);
}
)";

Floor::Floor(const gtx_host_gl &gl, const gtx_info &info)
    : gl_(gl), has_color_(info.has_color != 0), has_material_(info.has_material != 0)
{
    const std::string defines = has_material_ ? "#define GTX_MATERIALS\n"
                                : has_color_  ? ""
                                              : "#define GTX_PLAIN\n";
    std::string fragment = defines;
    for (const char *file : {"geotex_dialect.glsl", "geotex_records.glsl",
                             "geotex_height_field.glsl", "geotex_view.glsl", "geotex_surface.glsl"})
        fragment += gtx_shader_source(file);
    if (has_material_)
        fragment += gtx_shader_source("geotex_material.glsl");
    fragment += gtx_shader_source("geotex_lod_front.frag");
    gtx_error error;
    require_ok(gtx_host_program_create(&gl, (defines + vertex_text).c_str(), fragment.c_str(),
                                       &program_, &error), error);
    add_map("gtx_normals", GL_RG8, GL_RG, 2);
    if (has_color_)
        add_map("gtx_colors", GL_SRGB8_ALPHA8, GL_RGBA, 4);
    if (has_material_)
        add_map("gtx_materials", GL_RGBA8, GL_RGBA, 4);
}

Floor::~Floor()
{
    for (const Map &map : maps_)
        gl_.DeleteTextures(1, &map.texture);
    gtx_polygons_destroy(&gl_, &rectangles_);
    gl_.DeleteProgram(program_);
}

/* One layer, one level, looked up bilinearly as the library does; all values differ a little. */
void Floor::add_map(const char *sampler, GLint format, GLenum type, uint32_t channels)
{
    const auto image = reinterpret_cast<PFNGLTEXIMAGE3DPROC>(
        gtx_offscreen_load("glTexImage3D", nullptr));
    Vector<uint8_t> texels(size_t(SIDE) * SIDE * channels);
    for (size_t i = 0; i < texels.size(); ++i)
        texels[i] = uint8_t(112 + i * 2654435761u % 32);
    GLuint texture;
    gl_.GenTextures(1, &texture);
    gl_.BindTexture(ARRAY, texture);
    for (GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
        gl_.TexParameteri(ARRAY, filter, GL_LINEAR);
    image(ARRAY, 0, format, GLsizei(SIDE), GLsizei(SIDE), 1, 0, type, GL_UNSIGNED_BYTE,
          texels.data());
    gl_.BindTexture(ARRAY, 0);
    maps_.push_back({sampler, texture});
}

namespace {

/* Covered pixels of one row, or of several that are alike. */
struct Rectangle {
    uint32_t left, right, top, bottom;
};

void extend(Vector<Rectangle> &done, Vector<Rectangle> &open, Vector<Rectangle> &row)
{
    size_t next = 0; /* of the row above that has not been passed */
    for (Rectangle &r : row) {
        while (next < open.size() && open[next].left < r.left)
            done.push_back(open[next++]);
        if (next < open.size() && open[next].left == r.left) {
            if (open[next].right == r.right)
                r.top = open[next].top;
            else
                done.push_back(open[next]);
            ++next;
        }
    }
    done.insert(done.end(), open.begin() + ptrdiff_t(next), open.end());
    open.swap(row);
    row.clear();
}

Vector<Rectangle> rectangles_of(const Picture &picture, uint32_t width, uint32_t height)
{
    Vector<Rectangle> done, open, row;
    for (uint32_t y = 0; y < height; ++y) {
        for (uint32_t x = 0; x < width; ++x) {
            const uint32_t left = x;
            while (x < width && picture.covers(size_t(y) * width + x))
                ++x;
            if (x > left)
                row.push_back({left, x, y, y + 1});
        }
        extend(done, open, row);
    }
    extend(done, open, row);
    return done;
}

} // namespace

void Floor::cover(const Picture &picture, uint32_t width, uint32_t height)
{
    Vector<gtx_polygon_vertex> vertices;
    Vector<uint32_t> indices;
    for (const Rectangle &r : rectangles_of(picture, width, height)) {
        const uint32_t first = uint32_t(vertices.size());
        for (uint32_t k = 0; k < 4; ++k) {
            gtx_polygon_vertex v = {};
            v.position[0] = 2 * float(k % 2 ? r.right : r.left) / float(width) - 1;
            v.position[1] = 1 - 2 * float(k / 2 ? r.top : r.bottom) / float(height);
            vertices.push_back(v);
        }
        indices.insert(indices.end(), {first, first + 1, first + 3, first, first + 3, first + 2});
    }
    gtx_polygons_destroy(&gl_, &rectangles_);
    const gtx_polygon_data data = {vertices.data(), indices.data(), uint32_t(vertices.size()),
                                   uint32_t(indices.size())};
    gtx_error error;
    require_ok(gtx_polygons_create(&gl_, &data, &rectangles_, &error), error);
}

void Floor::draw(const gtx_view &view)
{
    const float toward[4] = {0, 0, 1, 0}, light[4] = {0, 0, 1, view.ambient};
    const float maps[4] = {0, has_color_ ? 1.f : 0.f, 0, has_material_ ? 1.f : 0.f};
    gl_.UseProgram(program_);
    gtx_set_vector(&gl_, program_, "toward", toward);
    gtx_set_vector(&gl_, program_, "gtx_light", light);
    gtx_set_vector(&gl_, program_, "gtx_maps", maps);
    for (size_t i = 0; i < maps_.size(); ++i) {
        gl_.Uniform1i(gl_.GetUniformLocation(program_, maps_[i].sampler), GLint(i));
        gl_.ActiveTexture(GLenum(GL_TEXTURE0 + i));
        gl_.BindTexture(ARRAY, maps_[i].texture);
    }
    gl_.BindVertexArray(rectangles_.vertex_array);
    gl_.DrawElements(GL_TRIANGLES, rectangles_.index_count, GL_UNSIGNED_INT, nullptr);
    gl_.BindVertexArray(0);
    for (size_t i = maps_.size(); i-- > 0;) {
        gl_.ActiveTexture(GLenum(GL_TEXTURE0 + i));
        gl_.BindTexture(ARRAY, 0);
    }
    gl_.UseProgram(0);
}

} // namespace gtx
