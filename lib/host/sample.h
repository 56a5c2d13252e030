/* What the samples share: their arguments, then a window or a PNG. */
#ifndef GTX_HOST_SAMPLE_H
#define GTX_HOST_SAMPLE_H

#include "host/show.h"

#ifdef __cplusplus
extern "C" {
#endif

/* The whole main of a sample that is started as
 *   NAME ASSET.gtx [--headless OUT.png] [--size WxH]
 * where NAME is show->title. *asset gets the path before show->load is called. Returns the exit
 * code; the process is meant to end with it, and with it the context and all memory. */
int gtx_sample_main(gtx_show *show, int argc, char **argv, const char **asset);

#ifdef __cplusplus
}
#endif
#endif
