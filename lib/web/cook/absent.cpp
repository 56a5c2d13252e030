/* What a browser has not: modules and programs beside the cooker, and an OpenGL driver. */
#include "cook/driver.hpp"
#include "image/open.h"

#include "base/error.h"

const void *gtx_open_module(const char *, const char *, const char *, gtx_error *error)
{
    gtx_fail(error, GTX_ERROR_UNSUPPORTED, "it is not read in a browser");
    return nullptr;
}

int gtx_find_program(const char *, char *)
{
    return 0;
}

namespace gtx {

struct Driver::Context {
};

Driver::Driver()
{
    throw Error(GTX_ERROR_GL, "no OpenGL driver in a browser: extract is to be cpu");
}

Driver::~Driver() = default;

} // namespace gtx
