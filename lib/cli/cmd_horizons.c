/* gtx horizons: height grids -> an asset. */
#include "cli/cli.h"

#include "base/error.h"
#include "base/warnings.h"

#include <geotex/cook.h>

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_GRIDS = 4096, MAX_NAME = 4096 };

static gtx_horizons_desc desc;
static gtx_height_grid_desc reading, reading_property;
static made_file making = {.verb = "horizons"};
static const char *range, *property_range, *spacing, *origin, *color_range;
static double missing = NAN, rotation = NAN, unit = 1;
static uint32_t colors, lod_levels = 5;
static int32_t zstd_level = 6;
static bool depths, one_surface, local_metres, categories;
static char property_name[64];
static double latitude = NAN; /* of the first grid in degrees */

static const option options[] = {
    {"output", 'o', OPTION_STRING, &making.output, "OUT.gtx",
     "file to write (required)", 0, 0},
    {"colors", 0, OPTION_CHOICE, &colors, "viridis|rainbow|none",
     "colour map of the properties or, without, of the heights [viridis]", 0, 0},
    {"color-range", 0, OPTION_STRING, &color_range, "LOW,HIGH",
     "values at the ends of the colour map [the data's own range]", 0, 0},
    {"depths", 0, OPTION_FLAG, &depths, NULL, "values are depths: positive is down", 0, 0},
    {"vertical", 0, OPTION_NUMBER, &desc.vertical, "X", "vertical exaggeration [1]", 1e-6, 1e6},
    {"one-surface", 0, OPTION_FLAG, &one_surface, NULL,
     "the grids are tiles of one larger grid: join them", 0, 0},
    {"missing", 0, OPTION_NUMBER, &missing, "V",
     "value of nodes without data", -1e30, 1e30},
    {"range", 0, OPTION_STRING, &range, "LOW,HIGH",
     "heights of black and white in height images [the pixel values]", 0, 0},
    {"property-range", 0, OPTION_STRING, &property_range, "LOW,HIGH",
     "likewise for property images", 0, 0},
    {"categories", 0, OPTION_FLAG, &categories, NULL,
     "properties are categories, such as kinds of rock: do not interpolate them", 0, 0},
    {"spacing", 0, OPTION_STRING, &spacing, "DX,DY", "distance between nodes [the file's, or 1]", 0,
     0},
    {"origin", 0, OPTION_STRING, &origin, "X,Y", "position of the first node [the file's, or 0]", 0,
     0},
    {"local-metres", 0, OPTION_FLAG, &local_metres, NULL,
     "convert grids in degrees to metres, by the latitude of the first one's middle", 0, 0},
    {"rotation", 0, OPTION_NUMBER, &rotation, "DEG",
     "counter-clockwise rotation [the file's, or 0]", -360, 360},
    {"tile", 0, OPTION_UINT, &desc.tile, "N", "a patch's largest side in texels [128]", 16, 512},
    {"height-bits", 0, OPTION_ONE_OF, &desc.height_bits, "8|16", "bits per height [8]", 0, 0},
    {"mips", 0, OPTION_UINT, &desc.mips, "N", "mip levels of normals and colours [4]", 1, 8},
    {"lod-levels", 0, OPTION_UINT, &lod_levels, "N",
     "most LOD meshes, besides far ones; 0 = none at all [5]", 0, 5},
    {"zstd", 0, OPTION_INT, &zstd_level, "L", "compression level, 0 = stored [6]", 0, 19},
    {"unit", 0, OPTION_NUMBER, &unit, "M", "metres per unit of the grids [1]", 1e-30, 1e30},
    THREADS_OPTION(&desc.threads),
    PROGRESS_OPTION,
    MADE_OPTIONS(making),
    {0}};

static const verb horizons = {
    "horizons", "GRID[@X,Y][=PROPERTY]... -o OUT.gtx",
    "Makes one asset of height grids: IRAP classic or binary, ZMAP+, CPS-3, NetCDF,\n"
    "ESRI ASCII, Surfer, HGT, XYZ (all also gzipped), GeoTIFF, and other images (PNG, TIFF, EXR)\n"
    "of 8 or 16 bits or floats. ESRI ASCII to GeoTIFF are read by GDAL. @X,Y sets the position of\n"
    "a grid's first node. =PROPERTY is a grid to colour it by; it is resampled at the grid's\n"
    "nodes, and an image is stretched over them. East becomes +X, up +Y, north -Z.",
    1, MAX_GRIDS, options, MAKING_LIMITS | 1 << GTX_LIMITED_PIXELS};

static int usage(const char *sentence)
{
    print_message("gtx horizons: error[usage]: %s (see gtx horizons --help)", sentence);
    return EXIT_CODE_USAGE;
}

/* "a,b". */
static bool parse_pair(const char *text, double out[2])
{
    char *end;
    out[0] = strtod(text, &end);
    if (end == text || *end != ',')
        return false;
    text = end + 1;
    out[1] = strtod(text, &end);
    return end != text && !*end && isfinite(out[0]) && isfinite(out[1]);
}

static int check(void)
{
    double pair[2];
    if (!making.output)
        return usage("-o OUT.gtx is missing");
    if (range && !parse_pair(range, reading.range))
        return usage("--range takes LOW,HIGH");
    if (property_range && !parse_pair(property_range, reading_property.range))
        return usage("--property-range takes LOW,HIGH");
    if (color_range && !parse_pair(color_range, desc.color_range))
        return usage("--color-range takes LOW,HIGH");
    if (spacing && (!parse_pair(spacing, pair) || pair[0] <= 0 || pair[1] <= 0))
        return usage("--spacing takes DX,DY, both above 0");
    if (origin && !parse_pair(origin, pair))
        return usage("--origin takes X,Y");
    return EXIT_CODE_OK;
}

/* The parts of an operand. */
typedef struct parts {
    char name[MAX_NAME];
    const char *property; /* or NULL */
    bool has_place;
    double place[2];
} parts;

/* The operand "GRID[@X,Y][=PROPERTY]", cut at its marks; an @ in a folder's name is none. */
static int cut(const char *operand, parts *out)
{
    if (strlen(operand) >= sizeof out->name)
        return usage("a name is too long");
    strcpy(out->name, operand);
    char *property = strchr(out->name, '=');
    if (property)
        *property++ = 0;
    out->property = property;
    char *slash = strrchr(out->name, '/'), *place = strchr(slash ? slash : out->name, '@');
    out->has_place = place != NULL;
    if (!place)
        return EXIT_CODE_OK;
    *place++ = 0;
    return parse_pair(place, out->place) ? EXIT_CODE_OK : usage("a grid's place is @X,Y");
}

static int add_sources(const char *operand)
{
    parts p;
    int code = cut(operand, &p);
    if (!code)
        code = made_from(&making, p.name);
    return code || !p.property ? code : made_from(&making, p.property);
}

/* With --local-metres; the latitude of all is that of the first. */
static int use_metres(const char *name, gtx_height_grid *grid)
{
    gtx_error error;
    if (!local_metres || !grid->in_degrees)
        return EXIT_CODE_OK;
    if (isnan(latitude))
        latitude = grid->origin[1] + grid->spacing[1] * (grid->ny - 1) / 2;
    return gtx_height_grid_to_metres(grid, latitude, &error) ? report_error(name, &error)
                                                              : EXIT_CODE_OK;
}

/* The stem of its file, which META and legends have. */
static void name_property(const char *path)
{
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
    snprintf(property_name, sizeof property_name, "%.*s", (int)strcspn(name, "."), name);
    desc.property_name = property_name;
}

/* The values of a property at the nodes of its grid, wherever its own are. */
static int read_property(const char *path, gtx_height_grid *grid)
{
    gtx_height_grid property = {0}, fitted;
    gtx_error error;
    if (gtx_height_grid_read(path, &reading_property, &property, &error))
        return report_error(path, &error);
    property.categories = categories;
    int code = use_metres(path, &property);
    if (!code && gtx_height_grid_resample(&property, grid, NULL, &fitted, &error))
        code = report_error(path, &error);
    gtx_height_grid_free(&property);
    if (code)
        return code;
    grid->property = fitted.values; /* of malloc, freed with free */
    grid->categories = fitted.categories;
    if (!desc.property_name)
        name_property(path);
    return EXIT_CODE_OK;
}

static int read_operand(const char *operand, gtx_height_grid *grid)
{
    parts p;
    gtx_error error;
    int code = cut(operand, &p);
    if (code)
        return code;
    if (gtx_height_grid_read(p.name, &reading, grid, &error))
        return report_error(p.name, &error);
    code = use_metres(p.name, grid);
    if (!code && p.property)
        code = read_property(p.property, grid);
    if (code)
        return code;
    if (spacing) {
        parse_pair(spacing, grid->spacing); /* the property has been fitted to the file's own */
        if (grid->in_degrees)
            grid->origin[0] = grid->origin[1] = 0;
        grid->in_degrees = 0;
    }
    if (origin)
        parse_pair(origin, grid->origin);
    if (p.has_place)
        memcpy(grid->origin, p.place, sizeof p.place);
    if (!isnan(rotation))
        grid->rotation = rotation;
    return EXIT_CODE_OK;
}

static int warn(const gtx_horizons_result *r)
{
    char text[160];
    int code = EXIT_CODE_OK;
    if (!isnan(latitude)) {
        snprintf(text, sizeof text, "degrees were taken for metres as they are at latitude %.4g",
                 latitude);
        code = made_warn(&making, making.output, GTX_WARNING_LOCAL_METRES, text);
    }
    if (!code && r->differing) {
        snprintf(text, sizeof text, "of %" PRIu64 " nodes that parts share %" PRIu64
                 " have other values, by up to %g: those of the first count", r->shared,
                 r->differing, r->difference);
        code = made_warn(&making, making.output, GTX_WARNING_GRIDS_DIFFER, text);
    }
    if (!code && r->alike[1]) {
        snprintf(text, sizeof text, "grids %u and %u have the same heights where both are: "
                 "--one-surface joins tiles", r->alike[0] + 1, r->alike[1] + 1);
        code = made_warn(&making, making.output, GTX_WARNING_GRIDS_OVERLAP, text);
    }
    if (!code && r->crossings) {
        snprintf(text, sizeof text, "grids lie on the other side of the next one at %" PRIu64
                 " nodes", r->crossings);
        code = made_warn(&making, making.output, GTX_WARNING_GRIDS_CROSS, text);
    }
    return code;
}

static void tell(const gtx_horizons_result *r)
{
    if (cli_quiet)
        return;
    char colored[64] = "";
    if (desc.colors != GTX_COLORS_NONE)
        snprintf(colored, sizeof colored, ", colours %g to %g", r->color_range[0],
                 r->color_range[1]);
    print_message("%s: %" PRIu64 " nodes, %" PRIu64 " triangles, %u patches, heights within %g "
                  "(RMS %g)%s", making.output, r->nodes, r->triangles, r->patches, r->height_max,
                  r->height_rms, colored);
}

static int make(const gtx_height_grid *grids, int count)
{
    gtx_asset *asset = NULL;
    gtx_horizons_result result;
    gtx_error error;
    gtx_encode_desc encode = {.zstd_level = encode_level(zstd_level)};
    catch_interrupt();
    const gtx_result failed = gtx_horizons(grids, (uint32_t)count, &desc, &asset, &result, &error);
    end_progress();
    if (failed)
        return report_error("gtx horizons", &error);
    int code = warn(&result);
    if (!code)
        code = made_save(&making, asset, &encode);
    gtx_close(asset);
    if (!code)
        tell(&result);
    return code;
}

int cmd_horizons(int argc, char **argv)
{
    static const char *operands[MAX_GRIDS];
    int count;
    int code = parse_options(&horizons, argc, argv, operands, &count);
    if (code >= 0)
        return code;
    code = check();
    for (int i = 0; i < count && !code; ++i)
        code = add_sources(operands[i]);
    if (!code)
        code = made_check(&making);
    if (code) {
        made_free(&making);
        return code;
    }
    desc.colors = (gtx_colors)colors;
    desc.depths = depths;
    desc.one_surface = one_surface;
    desc.lod_levels = lod_levels ? lod_levels : GTX_LOD_LEVELS_NONE;
    desc.unit = (float)unit;
    desc.progress = show_progress;
    desc.limits = reading.limits = reading_property.limits = cli_limits;
    reading.has_missing = !isnan(missing);
    reading.missing = reading.has_missing ? missing : 0;
    reading_property.has_missing = reading.has_missing;
    reading_property.missing = reading.missing;

    gtx_height_grid *grids = calloc((size_t)count, sizeof *grids);
    if (!grids)
        code = report_no_memory("gtx horizons");
    for (int i = 0; i < count && !code; ++i)
        code = read_operand(operands[i], &grids[i]);
    if (!code)
        code = make(grids, count);
    for (int i = 0; i < count && grids; ++i) {
        free((void *)grids[i].property);
        gtx_height_grid_free(&grids[i]);
    }
    free(grids);
    made_free(&making);
    return code;
}
