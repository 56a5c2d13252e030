/* The part of JSON Schema 2020-12 that the schemas in format/ use, patterns left out. */
#pragma once

#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>
#include <string>

namespace schema {

using nlohmann::json;

inline json load(const std::string &path)
{
    std::ifstream file(path);
    return json::parse(file);
}

inline bool has_type(const json &value, const std::string &type)
{
    return type == "object"    ? value.is_object()
           : type == "array"   ? value.is_array()
           : type == "string"  ? value.is_string()
           : type == "integer" ? value.is_number_integer()
           : type == "number"  ? value.is_number()
           : type == "boolean" ? value.is_boolean()
           : type == "null"    ? value.is_null()
                               : false;
}

inline bool type_matches(const json &value, const json &types)
{
    if (types.is_string())
        return has_type(value, types);
    for (const json &type : types)
        if (has_type(value, type))
            return true;
    return false;
}

/* What is wrong with `value`, empty when nothing is. `root` resolves references. */
inline std::string broken(const json &value, const json &rule, const json &root,
                          const std::string &at = "")
{
    if (rule.contains("$ref")) {
        std::string path = rule["$ref"];
        return broken(value, root.at(json::json_pointer(path.substr(1))), root, at);
    }
    if (rule.contains("enum") &&
        std::find(rule["enum"].begin(), rule["enum"].end(), value) == rule["enum"].end())
        return at + ": none of the values";
    if (rule.contains("const") && value != rule["const"])
        return at + ": another value";
    if (rule.contains("if") && broken(value, rule["if"], root, at).empty())
        if (std::string why = broken(value, rule["then"], root, at); !why.empty())
            return why;
    if (rule.contains("type") && !type_matches(value, rule["type"]))
        return at + ": wrong type";
    if (value.is_number() && rule.contains("minimum") && value < rule["minimum"])
        return at + ": too small";
    if (value.is_number() && rule.contains("maximum") && value > rule["maximum"])
        return at + ": too large";
    if (value.is_array() && value.size() < rule.value("minItems", 0u))
        return at + ": too few items";
    if (value.is_array() && rule.contains("items"))
        for (const json &item : value)
            if (std::string why = broken(item, rule["items"], root, at + "[]"); !why.empty())
                return why;
    if (!value.is_object())
        return "";

    for (const json &name : rule.value("required", json::array()))
        if (!value.contains(std::string(name)))
            return at + "." + std::string(name) + ": missing";
    for (const auto &[name, member] : value.items()) {
        json known = rule.value("properties", json::object());
        json other = rule.value("additionalProperties", json(true));
        if (!known.contains(name) && other == false)
            return at + "." + name + ": unknown";
        json inner = known.contains(name) ? known[name] : other;
        if (!inner.is_object())
            continue;
        if (std::string why = broken(member, inner, root, at + "." + name); !why.empty())
            return why;
    }
    return "";
}

} // namespace schema
