/* What the verbs written in C++ throw -> one line on stderr and an exit code. */
#pragma once

#include "cli/cli.h"
#include "mesh/task.hpp"

#include <string>

namespace gtx {

/* Runs the body, which returns an exit code. `about` is the file that the line is about; the body
 * keeps it up to date. */
template <class Body> int guarded(const std::string &about, Body body)
{
    try {
        return body();
    } catch (...) {
        const gtx_error error = caught_error();
        return report_error(about.c_str(), &error);
    }
}

} // namespace gtx
