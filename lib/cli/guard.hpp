/* What the verbs written in C++ throw -> one line on stderr and an exit code. */
#pragma once

#include "cli/cli.h"
#include "mesh/task.hpp"

#include <string>

namespace gtx {

/* Runs the body, which returns an exit code. Its argument is what the line is about, at first
 * `first`; the body keeps it up to date. */
template <class Body> int guarded(const char *first, Body body)
{
    std::string about;
    try {
        about = first;
        return body(about);
    } catch (...) {
        const gtx_error error = caught_error();
        return report_error(about.empty() ? first : about.c_str(), &error);
    }
}

inline void report_warnings(const char *file, const Vector<Warning> &warnings)
{
    for (const Warning &warning : warnings)
        report_warning(file, gtx_warning_name(warning.kind), warning.sentence.c_str());
}

/* Once something is about to be written, Ctrl-C no longer kills. */
inline void stop_if_interrupted()
{
    if (was_interrupted())
        throw Error(GTX_CANCELLED, "cancelled");
}

} // namespace gtx
