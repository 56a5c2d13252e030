/* Where C++ ends: exceptions become results, and descriptors are checked. */
#pragma once

#include "mesh/task.hpp"

#include "base/error.h"

#include <cstring>
#include <new>

namespace gtx {

/* Runs `body` and turns whatever it throws into `error` and a result. */
template <class Body> gtx_result guard(gtx_error *error, Body body)
{
    try {
        body();
        return GTX_OK;
    } catch (const Error &e) {
        return gtx_fail(error, e.result, "%s", e.what());
    } catch (const std::bad_alloc &) {
        return gtx_fail(error, GTX_ERROR_MEMORY, "out of memory");
    } catch (const std::exception &e) {
        return gtx_fail(error, GTX_ERROR_INTERNAL, "%s", e.what());
    } catch (...) {
        return gtx_fail(error, GTX_ERROR_INTERNAL, "an unknown exception");
    }
}

/* Throws what a C function reported. */
inline void require_ok(gtx_result result, const gtx_error &error)
{
    if (result != GTX_OK)
        throw Error(result, error.message);
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

inline void require_models(const char *const *more, uint32_t count)
{
    require_argument(count <= 4096, "more_count is at most 4096");
    require_argument(more || !count, "more is NULL, and more_count is not 0");
    for (uint32_t i = 0; i < count; ++i)
        require_argument(more[i], "one of the further models is NULL");
}

} // namespace gtx
