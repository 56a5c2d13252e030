/* The JSON of a glTF document, checked. Internal to lib/mesh. */
#pragma once

#include "mesh/import/import.hpp"

#include <nlohmann/json_fwd.hpp>

namespace gtx {

/* The parsed text: an object of glTF 2 whose members that geotex reads have the right types, and
 * that requires no unknown extension. Throws Error: INPUT, UNSUPPORTED, LIMIT. */
nlohmann::json read_gltf_json(std::string_view text, Task &task);

/* Takes off what must not reach tinygltf 2.7, and warns of what is thereby ignored. */
void strip_gltf_json(nlohmann::json &root, Task &task);

} // namespace gtx
