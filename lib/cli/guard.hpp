/* What the verbs written in C++ throw -> one line on stderr and an exit code. */
#pragma once

#include "cli/cli.h"
#include "mesh/task.hpp"

#include <new>
#include <string>

namespace gtx {

/* Runs the body, which returns an exit code. `about` is the file that the line is about; the body
 * keeps it up to date. */
template <class Body> int guarded(const std::string &about, Body body)
{
    gtx_error error = {};
    try {
        return body();
    } catch (const Error &e) {
        error.result = e.result;
        std::snprintf(error.message, sizeof error.message, "%s", e.message.c_str());
    } catch (const std::bad_alloc &) {
        error.result = GTX_ERROR_MEMORY;
        std::snprintf(error.message, sizeof error.message, "out of memory");
    } catch (const std::exception &e) {
        error.result = GTX_ERROR_INTERNAL;
        std::snprintf(error.message, sizeof error.message, "%s", e.what());
    }
    return report_error(about.c_str(), &error);
}

} // namespace gtx
