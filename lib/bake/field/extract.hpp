/* The paper's extraction of maps (section 5): a GPU renders each chart along its frame's z. */
#pragma once

#include "mesh/mesh.hpp"

#include <functional>
#include <memory>
#include <mutex>

namespace gtx {

namespace baking {
struct FlatChart;
struct Rendering;
struct GlState;
} // namespace baking

/* A context of OpenGL 3.3 core or later that nobody else draws with, as its maker lends it. */
struct GlContext {
    using Proc = void (*)();
    std::function<Proc(const char *name)> load; /* a function by its name, null where it is not */
    std::function<void()> acquire;              /* makes it current on the calling thread */
    std::function<void()> release;              /* gives the thread back what it had */
};

/* Renders charts in a context. What it makes there goes with the context, which must outlive it. */
class Extractor {
public:
    /* Throws Error: GL (a function or version is missing), SHADER, and what acquire() throws. */
    explicit Extractor(GlContext context);
    ~Extractor();
    Extractor(const Extractor &) = delete;
    Extractor &operator=(const Extractor &) = delete;

    /* GL_RENDERER and GL_VERSION: what the maps depend on beside the model and the options. */
    const std::string &renderer() const { return renderer_; }
    const std::string &version() const { return version_; }

    /* What of the core is topmost at the texel centres. Any thread; one at a time gets the context.
     * Throws Error: GL, and what acquire() throws. */
    baking::Rendering render(const Mesh &mesh, const baking::FlatChart &chart);

private:
    GlContext context_;
    std::mutex mutex_;
    std::unique_ptr<baking::GlState> gl_;
    std::string renderer_, version_;
};

} // namespace gtx
