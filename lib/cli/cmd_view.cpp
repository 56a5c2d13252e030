/* gtx view: assets, meshes and scenes in a window. */
#include "cli/guard.hpp"
#include "cli/view/viewer.hpp"

static double camera[3] = {30, 20, 2.8};
static uint32_t size[2] = {1024, 768};
static uint32_t method; /* in the viewer's table */
static gtx::ViewScript script;

static const option options[] = {
    {"size", 0, OPTION_SIZE, size, "WxH", "of the window [1024x768]", 16, 8192},
    {"camera", 0, OPTION_TRIPLE, camera, "AZ,EL,DIST",
     "degrees, degrees, bounding-sphere radii [30,20,2.8]", 0, 0},
    {"method", 0, OPTION_CHOICE, &method, "auto|cast|lod|paper",
     "how patches are drawn [auto]", 0, 0},
    {"frames", 0, OPTION_UINT, &script.frames, "N",
     "close after N frames, once all is pressed and cooked", 1, 1e9},
    {"keys", 0, OPTION_STRING, &script.keys, "KEYS",
     "press these, one a frame; . nothing, ! Escape, < > halve, double the size, _ minimise", 0, 0},
    {"drop", 0, OPTION_STRING, &script.drop, "FILE", "drop it onto the window when it opens", 0, 0},
    {"screenshot", 0, OPTION_STRING, &script.picture, "OUT.png",
     "write what the window shows last, its text too", 0, 0},
    {nullptr, 0, OPTION_FLAG, nullptr, nullptr, nullptr, 0, 0}};

static const verb view = {
    "view", "[FILE...]",
    "Shows assets, polygon models and glTF scenes in a window, as render draws them. Left drag\n"
    "turns, right or middle drag moves, the wheel comes nearer; H lists the keys. What is dropped\n"
    "onto the window replaces what is shown; a model is cooked first, while the view stays alive.\n"
    "Exit: 5 where no display offers OpenGL 3.3; with --frames, as cook where a drop failed.",
    0, 64, options};

int cmd_view(int argc, char **argv)
{
    const char *files[64];
    int count;
    int code = parse_options(&view, argc, argv, files, &count);
    if (code >= 0)
        return code;

    std::string current = "gtx view";
    return gtx::guarded(current, [&] {
        gtx::Task task(0, nullptr, nullptr);
        gtx::Scene scene;
        std::string name = gtx::file_name(count ? files[0] : "nothing");
        for (int i = 0; i < count; ++i) {
            current = files[i];
            gtx::add_file(scene, current, task);
        }
        for (const std::string &warning : task.warnings)
            report_warning(files[0], warning.c_str());
        gtx::measure_bounds(scene);
        if (count > 1)
            name += " and " + std::to_string(count - 1) + " more";
        current = "gtx view";
        gtx::Viewer viewer(std::move(scene), name, size, camera, method);
        return viewer.run(script);
    });
}
