/* The C boundary: exceptions become results, and descriptors are checked. */
#pragma once

#include "mesh/task.hpp"

#include "base/limits.h"

#include <cstring>

namespace gtx {

/* Runs `body` and turns whatever it throws into `error` and a result. */
template <class Body> gtx_result guard(gtx_error *error, Body body)
{
    try {
        body();
        return GTX_OK;
    } catch (...) {
        const gtx_error caught = caught_error();
        if (error)
            *error = caught;
        return caught.result;
    }
}

inline void require_argument(bool fine, const char *message)
{
    if (!fine)
        throw Error(GTX_ERROR_ARGUMENT, message);
}

/* A C caller can store any number in an enum, which C++ may not even read as one. */
template <class Enum> unsigned number_of(const Enum &field)
{
    std::underlying_type_t<Enum> number;
    std::memcpy(&number, &field, sizeof number);
    return unsigned(number);
}

template <size_t N> void require_zeroed(const uint32_t (&reserved)[N])
{
    gtx_error error;
    require_ok(gtx_check_reserved(reserved, N, &error), error);
}

inline void require_limits(const gtx_limits &limits)
{
    gtx_error error;
    require_ok(gtx_check_limits(&limits, &error), error);
}

inline void require_models(const char *const *more, uint32_t count)
{
    require_argument(count <= 4096, "more_count is at most 4096");
    require_argument(more || !count, "more is NULL, and more_count is not 0");
    for (uint32_t i = 0; i < count; ++i)
        require_argument(more[i], "one of the further models is NULL");
}

} // namespace gtx
