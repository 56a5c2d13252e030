/* The JSON of a glTF document, checked. Internal to lib/mesh. */
#pragma once

#include "mesh/import/import.hpp"

#include <nlohmann/json_fwd.hpp>

namespace gtx {

/* What a GLB file holds; pieces of its bytes. Throws Error: INPUT, UNSUPPORTED. */
struct GlbChunks {
    std::string_view json, binary;
    bool has_binary = false;
};
GlbChunks split_glb(std::string_view bytes);

/* Any text, parsed and not too deep. Throws Error: INPUT, LIMIT. */
nlohmann::json parse_gltf_json(std::string_view text);

/* The parsed text: an object of glTF 2 whose members that geotex reads have the right types, and
 * that requires no unknown extension. Throws Error: INPUT, UNSUPPORTED, LIMIT. */
nlohmann::json read_gltf_json(std::string_view text, Task &task);

/* Takes off what must not reach tinygltf 2.7, and warns of what is thereby ignored. */
void strip_gltf_json(nlohmann::json &root, Task &task);

} // namespace gtx
