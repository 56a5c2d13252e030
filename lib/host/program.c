/* Compiles and links shaders; draws full-screen triangles. */
#include "host/program.h"

#include "base/error.h"

#include <stdbool.h>
#include <string.h>

const char gtx_screen_vertex[] =
    "out vec2 at;\n"
    "void main()\n"
    "{\n"
    "    at = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0;\n"
    "    gl_Position = vec4(at * 2.0 - 1.0, 0.0, 1.0);\n"
    "}\n";

/* Nothing stands before the extensions that a text asks for but #version. */
static void attach(const gtx_host_gl *gl, GLuint program, GLenum stage, const char *text)
{
    const char *version = (const char *)gl->GetString(GL_VERSION);
    const bool es = version && !strncmp(version, "OpenGL ES", 9);
    const char *const texts[3] = {
        es ? "#version 300 es\n" : "#version 330 core\n",
        es && !strstr(text, "\nprecision ") ? "precision highp float;\nprecision highp int;\n"
                                             : "",
        text};
    const GLuint shader = gl->CreateShader(stage);
    gl->ShaderSource(shader, 3, texts, NULL);
    gl->CompileShader(shader);
    gl->AttachShader(program, shader);
    gl->DeleteShader(shader);
}

gtx_result gtx_host_program_create(const gtx_host_gl *gl, const char *vertex,
                                   const char *fragment, GLuint *out, gtx_error *error)
{
    const GLuint program = gl->CreateProgram();
    GLint linked = 0;
    attach(gl, program, GL_VERTEX_SHADER, vertex);
    attach(gl, program, GL_FRAGMENT_SHADER, fragment);
    gl->LinkProgram(program);
    gl->GetProgramiv(program, GL_LINK_STATUS, &linked);
    if (!linked) {
        char log[160] = "";
        gl->GetProgramInfoLog(program, sizeof log, NULL, log);
        gl->DeleteProgram(program);
        return gtx_fail(error, GTX_ERROR_SHADER, "a shader did not link: %s", log);
    }
    *out = program;
    return GTX_OK;
}

void gtx_screen_draw(const gtx_host_gl *gl)
{
    GLuint nothing; /* core contexts draw with no vertex array but 0 nothing at all */
    gl->GenVertexArrays(1, &nothing);
    gl->BindVertexArray(nothing);
    gl->DrawArrays(GL_TRIANGLES, 0, 3);
    gl->BindVertexArray(0);
    gl->DeleteVertexArrays(1, &nothing);
}

void gtx_set_matrix(const gtx_host_gl *gl, GLuint program, const char *name, const float value[16])
{
    gl->UniformMatrix4fv(gl->GetUniformLocation(program, name), 1, GL_FALSE, value);
}

void gtx_set_vector(const gtx_host_gl *gl, GLuint program, const char *name, const float value[4])
{
    gl->Uniform4fv(gl->GetUniformLocation(program, name), 1, value);
}

void gtx_set_texture(const gtx_host_gl *gl, GLuint program, const char *name, GLuint unit,
                     GLuint texture)
{
    gl->Uniform1i(gl->GetUniformLocation(program, name), (GLint)unit);
    gl->ActiveTexture(GL_TEXTURE0 + unit);
    gl->BindTexture(GL_TEXTURE_2D, texture);
    gl->ActiveTexture(GL_TEXTURE0);
}
