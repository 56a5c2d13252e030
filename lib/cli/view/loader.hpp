/* Files dropped onto the viewer, opened or cooked on another thread while it draws. */
#pragma once

#include "cli/view/scene.hpp"

#include <geotex/render.h>

#include <atomic>
#include <thread>

namespace gtx {

/* One job at a time. Used from one thread. */
class Loader {
public:
    Loader() = default;
    Loader(const Loader &) = delete;
    ~Loader() { stop(); }

    /* Opens assets and worlds and cooks models into one scene; ends the job before. */
    void start(Vector<std::string> paths);
    /* Asks the job to end soon; join() then tells GTX_CANCELLED. */
    void cancel() { cancelled_ = true; }

    bool busy() const { return thread_.joinable(); }
    bool finished() const { return finished_; } /* join() will not wait */
    bool cancelling() const { return cancelled_; }
    float fraction() const { return fraction_; }
    const char *stage() const { return stage_; }

    struct Result {
        gtx_error error = {}; /* of `path`, unless it is GTX_OK */
        std::string path;
        Scene scene;
        Vector<gtx_model *> models;      /* of the scene's assets, prepared, not yet uploaded */
        Vector<std::pair<const char *, std::string>> warnings; /* names, sentences */
    };
    /* The result of the job. The models belong to the caller. */
    Result join();

private:
    void run(const Vector<std::string> &paths);
    void load(const std::string &path);
    AssetPointer cook(const std::string &path);
    void stop();
    static int on_progress(const gtx_progress *progress, void *user);

    std::thread thread_;
    std::atomic<bool> cancelled_{false}, finished_{false};
    std::atomic<float> fraction_{0};
    std::atomic<const char *> stage_{""};
    Result result_;
};

} // namespace gtx
