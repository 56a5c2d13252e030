/* GLB files: their bytes, and assets inside them. */
#pragma once

#include "mesh/memory.hpp"

#include <string_view>

namespace gtx {

/* The asset that a GLB file holds beside its mesh (format/GTX_geometry_texture.md): a piece of the
 * bytes; empty where they are no GLB or hold none. Throws Error: INPUT, LIMIT, UNSUPPORTED (it
 * holds several). */
std::string_view embedded_asset(std::string_view bytes);

/* The file of a document and its only buffer. Throws Error: LIMIT beyond 4 GiB. */
Bytes glb_file(std::string_view json, std::string_view binary);

} // namespace gtx
