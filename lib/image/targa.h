/* TGA images, of whatever kind: decoded here, for OpenImageIO 2.4 reads past the ends of palettes.
 * Inside of lib/image. */
#ifndef GTX_IMAGE_TARGA_H
#define GTX_IMAGE_TARGA_H

#include "image/image.h"

enum { GTX_TARGA_HEADER = 18 };

/* Whether bytes start as a TGA file does. The format has no mark, but no other that is read here
 * has such a header. */
int gtx_is_targa(const void *data, size_t size);
/* Of bytes that do: no errors. */
gtx_result gtx_targa_measure(const void *data, size_t size, uint32_t *width, uint32_t *height,
                             gtx_error *error);
/* Likewise. Errors: READ (it ends too early, or names colours that its palette lacks), MEMORY. */
gtx_result gtx_targa_decode(const void *data, size_t size, uint64_t max_pixels, gtx_image *out,
                            gtx_error *error);

#endif
