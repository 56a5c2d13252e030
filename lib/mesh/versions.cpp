/* The versions of the libraries that read and clean models. */
#include "mesh/versions.hpp"

#include <OpenMesh/Core/System/config.h>
#include <draco/core/draco_version.h>
#include <meshoptimizer.h>
#include <zlib.h>

namespace gtx {

std::string mesh_library_versions()
{
    return std::string("zlib ") + zlibVersion() + ", OpenMesh " + std::to_string(OM_GET_VER) + '.' +
           std::to_string(OM_GET_MAJ) + ", Draco " + draco::kDracoVersion + ", meshoptimizer " +
           std::to_string(MESHOPTIMIZER_VERSION / 1000) + '.' +
           std::to_string(MESHOPTIMIZER_VERSION / 10 % 100);
}

} // namespace gtx
