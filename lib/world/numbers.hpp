/* Whole numbers from untrusted JSON files. */
#pragma once

#include "mesh/task.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

namespace gtx {

/* A conversion of the JSON library's own wraps, and is undefined for fractions out of range. */
inline uint64_t whole_number(const nlohmann::json &object, const char *name, uint64_t most)
{
    const nlohmann::json &value = object.at(name);
    if (!value.is_number_unsigned() || value.get<uint64_t>() > most)
        throw Error(GTX_ERROR_INPUT, std::string(name) + " is not a whole number up to " +
                                         std::to_string(most));
    return value.get<uint64_t>();
}

/* Of either sign. */
inline int64_t whole_of(const nlohmann::json &value, int64_t most)
{
    const double number = value.get<double>();
    if (!(std::abs(number) <= double(most)) || number != std::floor(number))
        throw Error(GTX_ERROR_INPUT, "a number of the lattice is not whole");
    return int64_t(number);
}

} // namespace gtx
