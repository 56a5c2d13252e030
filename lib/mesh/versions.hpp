/* The versions of the libraries that read and clean models. */
#pragma once

#include <string>

namespace gtx {

/* "zlib 1.2.13, OpenMesh 9.0, ..." */
std::string mesh_library_versions();

} // namespace gtx
