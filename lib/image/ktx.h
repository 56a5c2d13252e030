/* KTX 2.0: textures of Basis Universal, as glTF's KHR_texture_basisu has them, and plain ones of 8
 * bits. Decoded here, for OpenImageIO knows none of them. Inside of lib/image. */
#ifndef GTX_IMAGE_KTX_H
#define GTX_IMAGE_KTX_H

#include "image/image.h"

/* Whether bytes start as a KTX 2.0 file does. */
int gtx_is_ktx(const void *data, size_t size);
/* The size of the finest level. Errors: READ (it ends before it says). */
gtx_result gtx_ktx_measure(const void *data, size_t size, uint32_t *width, uint32_t *height,
                           gtx_error *error);
/* The finest level of a flat image, rows from the top. Errors: READ (it ends too early, or says
 * what cannot be), UNSUPPORTED (another format, an array, a cube, a film), LIMIT, MEMORY. */
gtx_result gtx_ktx_decode(const void *data, size_t size, uint64_t max_pixels, gtx_image *out,
                          gtx_error *error);

#endif
