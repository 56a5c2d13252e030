/* The window of `gtx view`: what it shows, its keys, its text. */
#pragma once

#include "cli/view/legend.hpp"
#include "cli/view/loader.hpp"
#include "cli/view/scene_renderer.hpp"
#include "cli/view/walk.hpp"
#include "host/framebuffer.h"
#include "host/text.h"
#include "host/window.h"

namespace gtx {

/* The last part of a path. */
std::string file_name(const std::string &path);

/* What drives the viewer instead of a person. */
struct ViewScript {
    const char *keys = "";      /* pressed one a frame; see cmd_view.cpp */
    const char *drop = nullptr; /* a file dropped before the first frame */
    uint32_t frames = 0;        /* it closes after as many, once all keys are pressed and nothing
                                   is being cooked; 0: it stays */
    const char *picture = nullptr; /* where the last frame goes */
};

class Viewer {
public:
    /* Opens the window. Throws Error: GL, SHADER, MEMORY. */
    Viewer(Scene scene, std::string name, const uint32_t size[2], const double camera[3],
           size_t method);
    Viewer(const Viewer &) = delete;
    ~Viewer();

    /* What X shows in place of the assets; else the models that were dropped and cooked. */
    void set_source(std::string path) { given_source = std::move(path); }

    /* Draws until the window is closed. Returns an exit code; throws Error: GL, MEMORY, WRITE. */
    int run(const ViewScript &script);

    struct Key {
        char key;
        const char *help;
        void (*act)(Viewer &);
    };

private:
    struct Method {
        gtx_method method;
        const char *name;
    };
    struct Facts {
        uint64_t triangles = 0, patches = 0, bytes = 0;
    };
    static const Key keys[15];
    static const Method methods[5];
    void press(char key);
    void toggle(DebugView view);
    void press_script(char key);
    void escape();
    void save_screenshot();
    void save_cooked();
    void toggle_source();
    void open_source();
    void take_drops();
    void take_loaded();
    void receive(Loader::Result result);
    void show(Scene shown, Vector<gtx_model *> models);
    void frame_all();
    void change_motion();
    bool walk(char key, double seconds);
    void walk_by_hand();
    void draw_frame();
    void draw_lines();
    void draw_overlay();
    Legend legend() const;
    void add_status(gtx_shapes &shapes, float dot);
    void add_progress(gtx_shapes &shapes, float dot);
    void add_help(gtx_shapes &shapes, float dot);
    void write_picture(const std::string &path);
    void release();

    gtx_window *window = nullptr;
    std::unique_ptr<SceneRenderer> scene_renderer;
    gtx_framebuffer target = {};
    int width = 0, height = 0;
    Scene scene;
    std::string given_source;
    Scene source;               /* of models, seen from where the scene is */
    std::unique_ptr<SceneRenderer> source_renderer;    /* none until it is asked for */
    bool shows_source = false;
    std::string name, note;     /* what is shown; a line about what happened last */
    Facts facts;                /* of the scene */
    Loader loader;
    Loader::Result incoming;    /* is being uploaded where it has models */
    gtx_camera camera = {};
    Walk walker;
    double stepped = 0;         /* seconds of the clock at the last step; 0: none yet */
    float home[3];              /* azimuth, elevation and distance */
    gtx_view view = {};
    size_t method;              /* in the table of methods */
    DebugView debug = DebugView::NONE;
    bool boxes = false, contours = false, help = false, text = true, fixed_light = false;
    bool wants_picture = false, minimised = false;
    double milliseconds = 0;    /* of a frame, lately */
    int code = 0;
};

} // namespace gtx
