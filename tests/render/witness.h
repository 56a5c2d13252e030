/* A witness of what the context says about a draw; what a driver says of its own speed is not of
 * interest. */
#ifndef GTX_TESTS_WITNESS_H
#define GTX_TESTS_WITNESS_H

#include "stage.h"

typedef struct witness {
    int complaints, groups;
} witness;

static inline void APIENTRY on_message(GLenum source, GLenum type, GLuint id, GLenum severity,
                                GLsizei length, const GLchar *text, const void *user)
{
    witness *w = (witness *)(uintptr_t)user;
    (void)source, (void)id, (void)length;
    if (type == GL_DEBUG_TYPE_PUSH_GROUP && !strcmp(text, "geotex draw"))
        ++w->groups;
    else if (type != GL_DEBUG_TYPE_POP_GROUP && type != GL_DEBUG_TYPE_PERFORMANCE &&
             severity != GL_DEBUG_SEVERITY_NOTIFICATION) {
        fprintf(stderr, "%s\n", text);
        ++w->complaints;
    }
}

static inline int has_debug(const stage *s)
{
    GLint major = 0, minor = 0;
    s->gl.GetIntegerv(GL_MAJOR_VERSION, &major);
    s->gl.GetIntegerv(GL_MINOR_VERSION, &minor);
    return 10 * major + minor >= (getenv("GEOTEX_ES") ? 32 : 43);
}

static inline void witness_call(stage *s, witness *w)
{
    PFNGLDEBUGMESSAGECALLBACKPROC set_callback =
        (PFNGLDEBUGMESSAGECALLBACKPROC)gtx_offscreen_load("glDebugMessageCallback", NULL);
    set_callback(on_message, w);
    s->gl.Enable(GL_DEBUG_OUTPUT);
    s->gl.Enable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
}

static inline void witness_dismiss(stage *s)
{
    PFNGLDEBUGMESSAGECALLBACKPROC set_callback =
        (PFNGLDEBUGMESSAGECALLBACKPROC)gtx_offscreen_load("glDebugMessageCallback", NULL);
    s->gl.Disable(GL_DEBUG_OUTPUT);
    s->gl.Disable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    set_callback(NULL, NULL);
}

/* A stage whose context a witness hears, to the last test. */
static witness the_witness;

static inline int open_watched(void **state)
{
    const int result = stage_open(state);
    if (!result && the_stage.offscreen && has_debug(&the_stage))
        witness_call(&the_stage, &the_witness);
    return result;
}

static inline void expect_no_complaint(stage *s, int least_groups)
{
    if (!has_debug(s))
        skip();
    witness_dismiss(s);
    assert_int_equal(the_witness.complaints, 0);
    assert_true(the_witness.groups >= least_groups);
}

#endif
