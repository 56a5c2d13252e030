/* gtx view: assets, meshes and scenes in a window. */
#include "cli/guard.hpp"
#include "cli/view/viewer.hpp"

static double camera[3] = {30, 20, 2.8};
static uint32_t size[2] = {1024, 768};
static uint32_t method; /* in the viewer's table */
static gtx::ViewScript script;
static const char *source;

static const option options[] = {
    {"size", 0, OPTION_SIZE, size, "WxH", "size of the window [1024x768]", 16, 8192},
    {"camera", 0, OPTION_TRIPLE, camera, "AZ,EL,DIST",
     "azimuth and elevation in degrees, distance in bounding-sphere radii [30,20,2.8]", 0, 0},
    {"method", 0, OPTION_CHOICE, &method, "auto|cast|lod|grid|paper",
     "how patches are drawn [auto]", 0, 0},
    {"source", 0, OPTION_STRING, &source, "MODEL", "model that X shows instead of FILE", 0, 0},
    {"frames", 0, OPTION_UINT, &script.frames, "N",
     "close after N frames, once --keys and cooking are done", 1, 1e9},
    {"keys", 0, OPTION_STRING, &script.keys, "KEYS",
     "press KEYS, one a frame: . none, ~ none until all is cooked, ! Escape, < > halve, double "
     "the window, _ minimise", 0, 0},
    {"drop", 0, OPTION_STRING, &script.drop, "FILE",
     "drop FILE onto the window when it opens", 0, 0},
    {"screenshot", 0, OPTION_STRING, &script.picture, "OUT.png",
     "write the last frame, text included", 0, 0},
    {nullptr, 0, OPTION_FLAG, nullptr, nullptr, nullptr, 0, 0}};

static const verb view = {
    "view", "[FILE...]",
    "Shows assets, polygon models, height grids, worlds (DIR of gtx world, streamed) and glTF\n"
    "scenes in a window. Left drag orbits, right or middle drag pans, the wheel zooms, H lists\n"
    "the keys. Files, and a world's folder or tileset.json, that are dropped onto the window\n"
    "replace what it shows; models and grids are cooked first, in the background. K then saves\n"
    "the asset in the current folder, and X switches between asset and model.\n"
    "G walks on the surface in the middle of the window, then flies, then orbits again: W, A, S,\n"
    "D move, E and Q raise and lower the eye, Shift is faster, left drag looks around.\n"
    "Exit code 5 if no display offers OpenGL 3.3; with --frames, that of cook if a drop failed.",
    0, 64, options, DRAWING_LIMITS};

int cmd_view(int argc, char **argv)
{
    const char *files[64];
    int count;
    int code = parse_options(&view, argc, argv, files, &count);
    if (code >= 0)
        return code;

    const output_file outputs[] = {{"--screenshot", script.picture}, {nullptr, nullptr}};
    code = check_outputs("gtx view", outputs, files, size_t(count));
    if (!code && script.drop)
        code = check_outputs("gtx view", outputs, &script.drop, 1);
    if (!code && source)
        code = check_outputs("gtx view", outputs, &source, 1);
    if (code)
        return code;
    return gtx::guarded("gtx view", [&](std::string &current) {
        gtx::Task task(0, nullptr, nullptr, {}, {}, cli_limits);
        gtx::Scene scene;
        std::string name = gtx::file_name(count ? files[0] : "nothing");
        for (int i = 0; i < count; ++i) {
            current = files[i];
            gtx::add_file(scene, current, task);
        }
        gtx::report_warnings(files[0], task.warnings);
        current = "gtx view";
        gtx::refuse_sources(scene, outputs);
        gtx::measure_bounds(scene);
        if (count > 1)
            name += " and " + std::to_string(count - 1) + " more";
        current = "gtx view";
        gtx::Viewer viewer(std::move(scene), name, size, camera, method);
        viewer.set_source(source ? source : "");
        return viewer.run(script);
    });
}
