/* gtx render: assets, meshes, worlds and scenes into a PNG, without a window. */
#include "cli/guard.hpp"
#include "cli/view/still.hpp"
#include "image/image.h"

#include <cstring>

static const char *output, *depth_path;
static gtx::StillOptions still_options;
static uint32_t size[2] = {1024, 768};
static uint32_t method;
static bool gles, vulkan;
static const gtx_method methods[] = {GTX_METHOD_AUTO, GTX_METHOD_CAST, GTX_METHOD_LOD,
                                     GTX_METHOD_GRID, GTX_METHOD_PAPER};

static const option options[] = {
    {"output", 'o', OPTION_STRING, &output, "OUT.png", "where the picture goes (required)", 0, 0},
    {"size", 0, OPTION_SIZE, size, "WxH", "pixels [1024x768]", 1, 8192},
    {"camera", 0, OPTION_TRIPLE, still_options.camera, "AZ,EL,DIST",
     "degrees, degrees, bounding-sphere radii [30,20,2.8]", 0, 0},
    {"depth", 0, OPTION_STRING, &depth_path, "OUT.exr",
     "also write depth along the view axis, infinity for background", 0, 0},
    {"method", 0, OPTION_CHOICE, &method, "auto|cast|lod|grid|paper",
     "how patches are drawn [auto]", 0, 0},
    {"level", 0, OPTION_CHOICE, &still_options.level, "auto|0|1|2|3|4|5|6|7",
     "level of detail, or the coarsest there is; auto: by --max-error [auto]", 0, 0},
    {"max-error", 0, OPTION_NUMBER, &still_options.max_error, "PIXELS",
     "largest error of a level of detail on screen [0.5]", 1e-6, 1e6},
    {"gles", 0, OPTION_FLAG, &gles, nullptr, "draw with OpenGL ES 3", 0, 0},
    {"vulkan", 0, OPTION_FLAG, &vulkan, nullptr, "draw with Vulkan: assets alone", 0, 0},
    {nullptr, 0, OPTION_FLAG, nullptr, nullptr, nullptr, 0, 0}};

static const verb render = {
    "render", "FILE... -o OUT.png",
    "Draws assets, polygon models, worlds (DIR of gtx world) and glTF scenes into a PNG. A glTF\n"
    "node with the extras {\"geotex\": \"a.gtx\"}, or the extension GTX_geometry_texture, places\n"
    "an asset; one that lies in a GLB is shown as its mesh.",
    1, 64, options};

static int write_images(const gtx::Still &still)
{
    gtx_error error;
    catch_interrupt();
    if (gtx_image_write_png(output, size[0], size[1], 4, still.color.data(), &error) != GTX_OK)
        return report_error(output, &error);
    if (depth_path &&
        gtx_image_write_exr(depth_path, size[0], size[1], still.depth.data(), &error) != GTX_OK)
        return report_error(depth_path, &error);
    return EXIT_CODE_OK;
}

int cmd_render(int argc, char **argv)
{
    const char *files[64];
    int count;
    int code = parse_options(&render, argc, argv, files, &count);
    if (code >= 0)
        return code;
    if (!output) {
        print_message("gtx render: error[usage]: -o OUT.png is missing");
        return EXIT_CODE_USAGE;
    }
    if (gles && vulkan) {
        print_message("gtx render: error[usage]: --gles is not for --vulkan");
        return EXIT_CODE_USAGE;
    }
    const output_file outputs[] = {{"-o", output}, {"--depth", depth_path}, {nullptr, nullptr}};
    code = check_outputs("gtx render", outputs, files, size_t(count));
    if (code)
        return code;
    still_options.width = size[0];
    still_options.height = size[1];
    still_options.method = methods[method];
    still_options.gles = gles;
    still_options.vulkan = vulkan;

    return gtx::guarded(files[0], [&](std::string &current) {
        gtx::Task task(0, nullptr, nullptr, {}, {}, cli_limits);
        gtx::Scene scene;
        for (int i = 0; i < count; ++i) {
            current = files[i];
            gtx::add_file(scene, current, task);
        }
        gtx::report_warnings(files[0], task.warnings);
        current = "gtx render";
        gtx::refuse_sources(scene, outputs);
        current = files[0];
        gtx::measure_bounds(scene);
        return write_images(gtx::draw_still(scene, still_options));
    });
}
