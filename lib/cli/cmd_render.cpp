/* gtx render: assets, meshes, worlds and scenes into a PNG, without a window. */
#include "cli/guard.hpp"
#include "cli/view/sheet.hpp"
#include "image/image.h"

#include <cerrno>
#include <cmath>
#include <cstring>
#include <sys/stat.h>

static const char *output, *depth_path, *turntable, *beside, *light_color, *background, *contours;
static gtx::StillOptions still_options;
static uint32_t size[2] = {1024, 768};
static uint32_t method, views, frames = 36, debug;
static double frames_per_second = 12, light[3] = {NAN, 0, 0};
static bool gles, vulkan;
static const gtx_method methods[] = {GTX_METHOD_AUTO, GTX_METHOD_CAST, GTX_METHOD_LOD,
                                     GTX_METHOD_GRID, GTX_METHOD_PAPER};

static const option options[] = {
    {"output", 'o', OPTION_STRING, &output, "OUT.png",
     "picture to write (this or --turntable)", 0, 0},
    {"size", 0, OPTION_SIZE, size, "WxH",
     "size in pixels; with --sheet, of the whole sheet [1024x768]", 1, 8192},
    {"camera", 0, OPTION_TRIPLE, still_options.camera, "AZ,EL,DIST",
     "azimuth and elevation in degrees, distance in bounding-sphere radii [30,20,2.8]", 0, 0},
    {"depth", 0, OPTION_STRING, &depth_path, "OUT.exr",
     "also write depth along the view axis, infinity where there is nothing", 0, 0},
    {"sheet", 0, OPTION_UINT, &views, "N",
     "a contact sheet of N views; of several files: a row of N views each", 1, 64},
    {"beside", 0, OPTION_STRING, &beside, "MODEL",
     "show a model, such as the source, next to FILE, from the same camera", 0, 0},
    {"turntable", 0, OPTION_STRING, &turntable, "OUT.gif|DIR",
     "write a turntable: an animated GIF, or frame-000.png ... in a folder", 0, 0},
    {"frames", 0, OPTION_UINT, &frames, "N", "frames of the turntable [36]", 2, 720},
    {"rate", 0, OPTION_NUMBER, &frames_per_second, "FPS",
     "frames per second of the GIF [12]", 1, 50},
    {"show", 0, OPTION_CHOICE, &debug, "color|patches|normals",
     "the model's colours, a colour per patch, or normals as colours [color]", 0, 0},
    {"legend", 0, OPTION_FLAG, &still_options.legend, nullptr,
     "draw a legend of the colours", 0, 0},
    {"contours", 0, OPTION_STRING, &contours, "STEP|auto",
     "draw lines of equal height every STEP units of the model", 0, 0},
    {"light", 0, OPTION_TRIPLE, light, "AZ,EL,AMBIENT",
     "direction of the light, as in --camera, and share of ambient light [left of the camera]", 0,
     0},
    {"light-color", 0, OPTION_STRING, &light_color, "RRGGBB", "colour of the light [FFFFFF]", 0, 0},
    {"background", 0, OPTION_STRING, &background, "RRGGBB|none",
     "background colour; none: transparent [EBEDF2]", 0, 0},
    {"method", 0, OPTION_CHOICE, &method, "auto|cast|lod|grid|paper",
     "how patches are drawn [auto]", 0, 0},
    {"level", 0, OPTION_CHOICE, &still_options.level, "auto|0|1|2|3|4|5|6|7",
     "level of detail to draw, or the coarsest there is; auto: by --max-error [auto]", 0, 0},
    {"max-error", 0, OPTION_NUMBER, &still_options.max_error, "PIXELS",
     "largest error on screen of a level of detail [0.5]", 1e-6, 1e6},
    {"gles", 0, OPTION_FLAG, &gles, nullptr, "draw with OpenGL ES 3", 0, 0},
    {"vulkan", 0, OPTION_FLAG, &vulkan, nullptr, "draw with Vulkan; assets only", 0, 0},
    {nullptr, 0, OPTION_FLAG, nullptr, nullptr, nullptr, 0, 0}};

enum { MAX_FILES = 64 };

static const verb render = {
    "render", "FILE... -o OUT.png",
    "Draws assets, polygon models, height grids, worlds (DIR of gtx world) and glTF scenes to a\n"
    "PNG. A glTF node with the extras {\"geotex\": \"a.gtx\"} or the extension\n"
    "GTX_geometry_texture places an asset; an asset embedded in a GLB is drawn as its mesh. Grids\n"
    "are drawn as gtx horizons makes them. --legend explains the colours of --show, or those that\n"
    "gtx horizons gave.",
    1, MAX_FILES, options, DRAWING_LIMITS};

static int usage(const char *sentence)
{
    print_message("gtx render: error[usage]: %s", sentence);
    return EXIT_CODE_USAGE;
}

/* Six hexadecimal digits, or, where `none` is allowed, that. */
static bool parse_color(const char *text, uint8_t *out, bool none)
{
    if (none && !std::strcmp(text, "none")) {
        std::memset(out, 0, 4);
        return true;
    }
    if (std::strlen(text) != 6 || std::strspn(text, "0123456789abcdefABCDEF") != 6)
        return false;
    const unsigned long code = std::strtoul(text, nullptr, 16);
    for (int k = 0; k < 3; ++k)
        out[k] = uint8_t(code >> (16 - 8 * k));
    return true;
}

static bool parse_step(const char *text)
{
    char *end;
    still_options.contour_step = std::strtod(text, &end);
    return end != text && !*end && still_options.contour_step > 0 &&
           still_options.contour_step < 1e15;
}

static bool is_gif(const char *path)
{
    const size_t length = std::strlen(path);
    return length > 4 && !std::strcmp(path + length - 4, ".gif");
}

static int check(void)
{
    if (!output && !turntable)
        return usage("-o OUT.png is missing");
    if (depth_path && (views > 1 || beside || turntable))
        return usage("--depth is of one view");
    if (vulkan && (gles || debug || still_options.legend))
        return usage("--gles, --show and --legend are not for --vulkan");
    if (light_color && !parse_color(light_color, still_options.light_color, false))
        return usage("--light-color takes RRGGBB");
    if (background && !parse_color(background, still_options.background, true))
        return usage("--background takes RRGGBB or none");
    if (turntable && is_gif(turntable) && !still_options.background[3])
        return usage("only frames in a folder can be transparent, no GIF");
    still_options.contours = contours != nullptr;
    if (contours && std::strcmp(contours, "auto") && !parse_step(contours))
        return usage("--contours takes a step above 0, or auto");
    still_options.has_light = !std::isnan(light[0]);
    if (still_options.has_light && (light[2] < 0 || light[2] > 1))
        return usage("--light takes AZ,EL,AMBIENT, the last from 0 to 1");
    return EXIT_CODE_OK;
}

/* Everything that will be written. */
struct Outputs {
    gtx::Vector<std::string> frames;     /* of a turn that goes into a folder */
    gtx::Vector<output_file> list;
    Outputs()
    {
        char name[32];
        const bool folder = turntable && !is_gif(turntable);
        for (uint32_t i = 0; folder && i < ::frames; ++i) {
            std::snprintf(name, sizeof name, "/frame-%03u.png", i);
            frames.push_back(turntable + std::string(name));
        }
        list.push_back({"-o", output});
        list.push_back({"--depth", depth_path});
        list.push_back({"--turntable", folder ? nullptr : turntable});
        for (const std::string &frame : frames)
            list.push_back({"--turntable", frame.c_str()});
        list.push_back({nullptr, nullptr});
    }
    Outputs(const Outputs &) = delete;
};

static void write_png(const char *path, const gtx::Still &still)
{
    gtx_error error;
    gtx::require_ok(gtx_image_write_png(path, size[0], size[1], 4, still.color.data(), &error),
                    error);
}

static void write_turn(const gtx::Vector<gtx::Still> &turn, const Outputs &outputs,
                       std::string &current)
{
    gtx_error error;
    current = turntable;
    if (is_gif(turntable)) {
        gtx::Vector<uint8_t> pixels;
        for (const gtx::Still &still : turn)
            pixels.insert(pixels.end(), still.color.begin(), still.color.end());
        gtx::require_ok(gtx_image_write_gif(turntable, size[0], size[1], uint32_t(turn.size()),
                                            frames_per_second, pixels.data(), &error), error);
        return;
    }
    if (mkdir(turntable, 0777) && errno != EEXIST)
        throw gtx::Error(GTX_ERROR_WRITE, std::strerror(errno));
    for (size_t i = 0; i < turn.size(); ++i) {
        gtx::stop_if_interrupted();
        write_png(outputs.frames[i].c_str(), turn[i]);
    }
}

static int write_images(const gtx::Vector<gtx::Still> &turn, const Outputs &outputs,
                        std::string &current)
{
    gtx_error error;
    current = output ? output : "";
    if (output)
        write_png(output, turn[0]);
    if (depth_path) {
        current = depth_path;
        gtx::require_ok(gtx_image_write_exr(depth_path, size[0], size[1], turn[0].depth.data(),
                                            &error), error);
    }
    if (turntable)
        write_turn(turn, outputs, current);
    return EXIT_CODE_OK;
}

int cmd_render(int argc, char **argv)
{
    const char *files[MAX_FILES + 1]; /* and what is beside them */
    int count;
    int code = parse_options(&render, argc, argv, files, &count);
    if (code >= 0)
        return code;
    code = check();
    const Outputs outputs;
    files[count] = beside;
    if (!code)
        code = check_outputs("gtx render", outputs.list.data(), files,
                             size_t(count + (beside != nullptr)));
    if (code)
        return code;
    still_options.width = size[0];
    still_options.height = size[1];
    still_options.method = methods[method];
    still_options.gles = gles;
    still_options.vulkan = vulkan;
    still_options.debug = gtx::DebugView(debug);
    if (still_options.has_light)
        std::copy(light, light + 3, still_options.light);

    return gtx::guarded(files[0], [&](std::string &current) {
        gtx::SheetOptions sheet;
        sheet.files.assign(files, files + count);
        sheet.beside = beside ? beside : "";
        sheet.is_sheet = views > 0;
        sheet.views = views ? views : 1;
        sheet.frames = turntable ? frames : 1;
        auto open = [&](const gtx::Vector<std::string> &names) {
            gtx::Task task(0, nullptr, nullptr, {}, {}, cli_limits);
            gtx::Scene scene;
            for (const std::string &name : names) {
                current = name;
                gtx::add_file(scene, current, task);
            }
            gtx::report_warnings(names[0].c_str(), task.warnings);
            current = "gtx render";
            gtx::refuse_sources(scene, outputs.list.data());
            current = names[0];
            gtx::measure_bounds(scene);
            return scene;
        };
        const gtx::Vector<gtx::Still> turn = gtx::draw_sheet(sheet, still_options, open);
        catch_interrupt();
        return write_images(turn, outputs, current);
    });
}
