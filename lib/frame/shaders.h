/* The shader files of shaders/, as the build puts them into the library. */
#ifndef GTX_FRAME_SHADERS_H
#define GTX_FRAME_SHADERS_H

typedef struct gtx_shader_file {
    const char *name, *text;
} gtx_shader_file;

/* Ends with a NULL name. */
extern const gtx_shader_file gtx_shader_files[];

#endif
