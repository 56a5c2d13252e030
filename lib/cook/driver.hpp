/* The OpenGL driver that maps are extracted with. */
#pragma once

#include "bake/field/extract.hpp"

namespace gtx {

/* A context of its own, without window, surface or display server, through EGL. libEGL is looked
 * for when the first is made: nothing is linked. What context the calling threads hold is theirs
 * again after every use. */
class Driver {
public:
    /* Throws Error: GL, SHADER. */
    Driver();
    ~Driver();
    Driver(const Driver &) = delete;
    Driver &operator=(const Driver &) = delete;

    Extractor &extractor() const { return *extractor_; }

private:
    struct Context;
    std::unique_ptr<Context> context_;
    std::unique_ptr<Extractor> extractor_;
};

} // namespace gtx
