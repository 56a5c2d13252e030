/* A tree of JSON that is taken apart without memory: nlohmann's destructor of a value that holds
 * others takes some, and ends the program where there is none. */
#pragma once

#include <nlohmann/json.hpp>

namespace gtx {

using Json = nlohmann::json; /* an ordered one copies trees as it grows */

struct JsonTree {
    Json root;

    ~JsonTree() { empty(root, DEPTH); }

private:
    /* As deep as what unpack writes. */
    static constexpr int DEPTH = 4;

    static void empty(Json &value, int depth)
    {
        if (depth < 0)
            return;
        /* NULL where it could not be made. */
        if (auto *object = value.get_ptr<Json::object_t *>()) {
            for (auto &member : *object)
                empty(member.second, depth - 1);
            object->clear();
        } else if (auto *array = value.get_ptr<Json::array_t *>()) {
            for (Json &member : *array)
                empty(member, depth - 1);
            array->clear();
        }
    }
};

} // namespace gtx
