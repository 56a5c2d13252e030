/* Several pictures in one: sheets of views, a source beside its asset, frames of a turn. */
#pragma once

#include "cli/view/still.hpp"

#include <functional>

namespace gtx {

struct SheetOptions {
    Vector<std::string> files;
    std::string beside;         /* a model seen from where the files are seen; may be empty */
    bool is_sheet = false;      /* each file a scene of its own, unless there is one beside */
    uint32_t views = 1;         /* of each scene */
    uint32_t frames = 1;        /* of one turn around what is shown */
};

/* Opens a scene of some files and measures it. */
using OpenScene = std::function<Scene(const Vector<std::string> &files)>;

/* The frames, each of the size in `still`, cells side by side from the upper left; depth only where
 * there is one cell. Throws Error: ARGUMENT (cells too small), LIMIT, and as Studio. */
Vector<Still> draw_sheet(const SheetOptions &sheet, const StillOptions &still,
                         const OpenScene &open);

} // namespace gtx
