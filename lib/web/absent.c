/* What a page never asks for, and need not wait for: its textures are uncompressed, and no encoder
 * of blocks is linked. Built by emscripten alone; see web.mk. */
#include "frame/compress.h"

void gtx_compress_rows(const gtx_asset *asset, const gtx_block_rows *rows)
{
    (void)asset, (void)rows;
}
