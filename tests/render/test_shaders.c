/* The shader files under every dialect that they are written for, by the reference compiler. */
#define _POSIX_C_SOURCE 200809L
#include "stage.h"

#define SHARED                                                                                     \
    "geotex_dialect.glsl", "geotex_records.glsl", "geotex_height_field.glsl", "geotex_view.glsl"

static const char *const vertex[] = {SHARED, "geotex_proxy.vert", NULL};
/* A fragment shader: the parts before the method, the method, geotex_fragment.glsl, the main. */
static const char *const mains[] = {"geotex_forward.frag", "geotex_depth.frag", "geotex_id.frag",
                                    "geotex_gbuffer.frag"};
static const char *const methods[] = {"geotex_cast.glsl", "geotex_paper.glsl"};
enum { MAINS = sizeof mains / sizeof *mains, METHODS = 2 };

static const char *const lod_vertex[] = {SHARED, "geotex_lod.vert", NULL};
static const char *const lod[] = {SHARED, "geotex_surface.glsl", "geotex_lod_fragment.glsl",
                                  "geotex_lod.frag", NULL};

static const char *const lod_front[] = {SHARED, "geotex_surface.glsl",
                                        "geotex_lod_front.frag", NULL};
static const char *const lod_front_shaded[] = {SHARED, "geotex_surface.glsl",
                                               "geotex_material.glsl",
                                               "geotex_lod_front.frag", NULL};

static const char *const lit[] = {SHARED, "geotex_surface.glsl", "geotex_lit.frag", NULL};

/* What comes before an engine's own main, and a main. */
static const char *const rays[] = {SHARED, "geotex_surface.glsl", "geotex_material.glsl",
                                   "geotex_cast.glsl", "geotex_fragment.glsl", "geotex_rays.glsl",
                                   "geotex_forward.frag", NULL};

/* Compiles a program's stage and expects no word of complaint. */
static void compile(const char *version, const char *options, const char *kind,
                    const char *const *parts)
{
    char path[64] = "/tmp/geotex-shader-XXXXXX", command[512];
    const int handle = mkstemp(path);
    assert_true(handle >= 0);
    FILE *file = fdopen(handle, "w");
    fprintf(file, "%s\n", version);
    for (; *parts; ++parts) {
        assert_non_null(gtx_shader_source(*parts));
        fputs(gtx_shader_source(*parts), file);
    }
    fclose(file);
    snprintf(command, sizeof command, "glslangValidator %s -S %s %s >%s.log 2>&1", options, kind,
             path, path);
    const int status = system(command);
    if (status) {
        snprintf(command, sizeof command, "cat %s.log >&2", path);
        if (system(command))
            fputs("no log\n", stderr);
    }
    remove(path);
    strcat(path, ".log");
    remove(path);
    if (status)
        fail_msg("%s does not compile as %s", kind, version);
}

/* A #version line, and glslangValidator's options for it. */
typedef struct dialect {
    const char *version, *options;
} dialect;

/* With macros after the version: lines, or "". */
static void compile_as(const dialect *d, const char *macros, const char *kind,
                       const char *const *parts)
{
    char head[160];
    snprintf(head, sizeof head, "%s%s", d->version, macros);
    compile(head, d->options, kind, parts);
}

#define MATERIALS "\n#define GTX_MATERIALS"

static void compile_casts(const dialect *d)
{
    compile_as(d, "", "vert", vertex);
    for (int k = 0; k < MAINS * METHODS; ++k) {
        const char *const parts[] = {SHARED, "geotex_surface.glsl", methods[k % METHODS],
                                     "geotex_fragment.glsl", mains[k / METHODS], NULL};
        const char *const shaded[] = {SHARED, "geotex_surface.glsl", "geotex_material.glsl",
                                      methods[k % METHODS], "geotex_fragment.glsl",
                                      mains[k / METHODS], NULL};
        if (k / METHODS < 3)
            compile_as(d, "", "frag", parts);
        if (k / METHODS == 0 || k / METHODS == 3)
            compile_as(d, MATERIALS, "frag", shaded);
    }
    for (int k = 0; k < MAINS; ++k)
        compile_as(d, MATERIALS "\n#define GTX_SKIP", "frag",
                   (const char *const[]){SHARED, "geotex_surface.glsl", "geotex_material.glsl",
                                         "geotex_cast.glsl", "geotex_skip.glsl",
                                         "geotex_fragment.glsl", mains[k], NULL});
    compile_as(d, MATERIALS, "frag", rays);
}

static void compile_lods(const dialect *d)
{
    compile_as(d, "", "vert", lod_vertex);
    for (int k = 0; k < MAINS; ++k) {
        const char *main = k ? mains[k] : "geotex_lod.frag";
        const char *const parts[] = {SHARED, "geotex_surface.glsl", "geotex_lod_fragment.glsl",
                                     main, NULL};
        const char *const shaded[] = {SHARED, "geotex_surface.glsl", "geotex_material.glsl",
                                      "geotex_lod_fragment.glsl", main, NULL};
        if (k < 3)
            compile_as(d, "", "frag", parts);
        if (k == 0 || k == 3)
            compile_as(d, MATERIALS "\n#define GTX_SKIP", "frag", shaded);
    }
    compile_as(d, MATERIALS, "frag", lod_front_shaded);
    compile_as(d, MATERIALS "\n#define GTX_CONSTANT", "frag", lod_front_shaded);
    compile_as(d, "\n#define GTX_PLAIN", "frag", lod);
    compile_as(d, "\n#define GTX_PLAIN", "frag", lod_front);
    compile_as(d, "", "frag", lod_front);
    compile_as(d, "\n#define GTX_FRONT", "vert", lod_vertex);
    compile_as(d, "\n#define GTX_FRONT" MATERIALS, "vert", lod_vertex);
}

static void compile_grids(const dialect *d)
{
#define LIT_GRID "\n#define GTX_GRID\n#define GTX_LIT\n#define GTX_TRIMMED"
#define BLOCKS "\n#define GTX_GRID\n#define GTX_BLOCKS\n#define GTX_TRIMMED"
    compile_as(d, LIT_GRID, "vert", lod_vertex);
    compile_as(d, LIT_GRID, "frag", lit);
    compile_as(d, LIT_GRID "\n#define GTX_PLAIN", "vert", lod_vertex);
    compile_as(d, BLOCKS, "vert", lod_vertex);
    compile_as(d, BLOCKS, "frag", lod);
    compile_as(d, BLOCKS, "frag", lod_front);
}

static void every_dialect(void **state)
{
    (void)state;
    static const dialect dialects[] = {{"#version 330 core", ""}, {"#version 450 core", ""},
                                       {"#version 300 es", ""}, {"#version 310 es", ""},
                                       {"#version 450", "-V -o /dev/null"}};
    if (system("glslangValidator --version >/dev/null 2>&1"))
        skip();
    for (size_t i = 0; i < sizeof dialects / sizeof *dialects; ++i) {
        compile_casts(&dialects[i]);
        compile_lods(&dialects[i]);
        compile_grids(&dialects[i]);
    }
}

/* Casting by tiles is OpenGL's alone. */
static void tiles(void **state)
{
    (void)state;
    static const char *const corners[] = {SHARED, "geotex_tiles.vert", NULL};
    if (system("glslangValidator --version >/dev/null 2>&1"))
        skip();
    compile("#version 330 core", "", "vert", corners);
    for (int k = 0; k < MAINS; ++k) {
        const char *const parts[] = {SHARED, "geotex_surface.glsl",
                                     "geotex_material.glsl", "geotex_cast.glsl",
                                     "geotex_fragment.glsl", "geotex_tiles.glsl", mains[k], NULL};
        compile("#version 330 core\n#define GTX_TILES\n#define GTX_MATERIALS", "", "frag", parts);
    }
}

/* The files are complete by themselves: an engine's own main needs the caster and nothing of the
 * stock one. */
static void a_main_of_ones_own(void **state)
{
    STAGE_OR_SKIP(state);
    static const char text[] =
        "in vec3 origin, direction;\n"
        "flat in int index;\n"
        "out vec4 position;\n"
        "void main()\n"
        "{\n"
        "    gtx_height_field field = gtx_field_of(index, 0);\n"
        "    gtx_hit hit;\n"
        "    float t0 = 0.0, t1 = 1e30;\n"
        "    gtx_clip_box(field, origin, direction, t0, t1);\n"
        "    if (t0 > t1 || !gtx_cast(field, origin, direction, t0, t1, hit))\n"
        "        discard;\n"
        "    gtx_frame frame = gtx_frame_of(index);\n"
        "    position = vec4(gtx_object_point(frame, hit.grid), gtx_facet(frame, hit).x);\n"
        "}\n";
    const char *parts[] = {"#version 330 core\n", gtx_shader_source("geotex_dialect.glsl"),
                           gtx_shader_source("geotex_records.glsl"),
                           gtx_shader_source("geotex_height_field.glsl"),
                           gtx_shader_source("geotex_cast.glsl"), text};
    PFNGLGETSHADERIVPROC get_shader =
        (PFNGLGETSHADERIVPROC)gtx_offscreen_load("glGetShaderiv", NULL);
    const GLuint shader = s->gl.CreateShader(GL_FRAGMENT_SHADER);
    GLint compiled = 0;
    s->gl.ShaderSource(shader, 6, parts, NULL);
    s->gl.CompileShader(shader);
    get_shader(shader, GL_COMPILE_STATUS, &compiled);
    s->gl.DeleteShader(shader);
    assert_true(compiled);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_dialect),
        cmocka_unit_test(tiles),
        cmocka_unit_test(a_main_of_ones_own),
    };
    return cmocka_run_group_tests(tests, stage_open, stage_close);
}
