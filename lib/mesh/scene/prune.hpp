/* Dropping from a glTF document what nothing refers to. Internal to lib/mesh. */
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace gtx {

/* Whether all references of the document are known, those of its extensions included. */
bool can_prune(const nlohmann::json &root);

/* Drops meshes that no node shows, and the materials, textures, images, accessors and buffer views
 * that nothing refers to, and renumbers the rest. Throws Error(INPUT) for references to nothing. */
void prune_gltf(nlohmann::json &root);

} // namespace gtx
