/* Assets inside GLB files. */
#pragma once

#include <string_view>

namespace gtx {

/* The asset that a GLB file holds beside its mesh (format/GTX_geometry_texture.md): a piece of the
 * bytes; empty where they are no GLB or hold none. Throws Error: INPUT, LIMIT, UNSUPPORTED (it
 * holds several). */
std::string_view embedded_asset(std::string_view bytes);

} // namespace gtx
