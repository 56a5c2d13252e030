/* gtx world: models of any size -> a tree of tiles, in steps that are processes of their own. */
#include "cli/guard.hpp"
#include "world/world.hpp"

#include <cstring>
#include <filesystem>

static const char *folder;
static uint32_t engine, threads, up, sides;
static uint64_t triangles = gtx::MAX_TILE, memory = gtx::WORKER_MEMORY;
static double unit = 1;
static bool glb, depths, local_metres;

static const option plan_options[] = {
    {"output", 'o', OPTION_STRING, &folder, "DIR", "the world's folder (required)", 0, 0},
    {"triangles", 0, OPTION_AMOUNT, &triangles, "N", "most triangles of a tile [1M]",
     gtx::MIN_TILE, gtx::MAX_TILE},
    {"engine", 0, OPTION_CHOICE, &engine, "ninja|shell|slurm",
     "who runs the steps: DIR/build.ninja, DIR/build.sh, or DIR/slurm/submit.sh [ninja]", 0, 0},
    {"worker-memory", 0, OPTION_AMOUNT, &memory, "BYTES", "memory limit of each worker [1G]", 1e8,
     1e15},
    {"glb", 0, OPTION_FLAG, &glb, nullptr,
     "also write each tile's finest LOD mesh as GLB, for any viewer of 3D Tiles", 0, 0},
    {"sides", 0, OPTION_CHOICE, &sides, "auto|front|both",
     "visible sides; auto: front of closed surfaces, both of others [auto]", 0, 0},
    {"up", 0, OPTION_CHOICE, &up, "y|z", "the models' up axis; z: +Z becomes +Y [y]", 0, 0},
    {"depths", 0, OPTION_FLAG, &depths, nullptr, "values of grids are depths: positive is down", 0,
     0},
    {"local-metres", 0, OPTION_FLAG, &local_metres, nullptr,
     "convert grids in degrees to metres, by the latitude of the first one's middle", 0, 0},
    {"unit", 0, OPTION_NUMBER, &unit, "M", "metres per unit of the models [1]", 1e-30, 1e30},
    PROGRESS_OPTION,
    {nullptr, 0, OPTION_FLAG, nullptr, nullptr, nullptr, 0, 0}};

static const option step_options[] = {
    THREADS_OPTION(&threads),
    PROGRESS_OPTION,
    {nullptr, 0, OPTION_FLAG, nullptr, nullptr, nullptr, 0, 0}};

enum { MAX_MODELS = 4096 };

enum {
    OWN_LIMITS = 1 << GTX_LIMITED_MEMORY | 1 << GTX_LIMITED_WORK, /* files of its own making */
    READING_LIMITS = MODEL_LIMITS & ~(1 << GTX_LIMITED_PATCHES)
};

static const verb steps_of_world[] = {
    {"world plan", "MODEL... -o DIR",
     "Counts the models' triangles and plans a tree of tiles: DIR/plan.json, and a build file\n"
     "that runs the steps below. Models of binary PLY, binary STL and GLB with plain accessors\n"
     "may have any size; other models and grids (as for horizons) are read one at a time. Folders\n"
     "are read file by file; - reads triangles of nine little-endian floats from stdin.\n"
     "Leaf tiles keep all maps of textured models, coarser tiles have averaged colours.\n"
     "`ninja -C DIR` then makes DIR/tileset.json (OGC 3D Tiles 1.1).",
     1, MAX_MODELS, plan_options, READING_LIMITS},
    {"world split", "DIR",
     "Reads the planned models again and sorts their triangles into leaf tiles: DIR/work/split.",
     1, 1, step_options, READING_LIMITS},
    {"world cook", "DIR TILE",
     "Cooks one tile: DIR/tiles/TILE.gtx, and a simplified surface for its parent.",
     2, 2, step_options, MAKING_LIMITS},
    {"world merge", "DIR TILE",
     "Makes a tile's surface from the simplified ones of its children: DIR/work/merge/TILE.",
     2, 2, step_options, OWN_LIMITS},
    {"world index", "DIR",
     "Writes DIR/tileset.json, and DIR/tiles.gtw for gtx_stream_create, once all tiles are\n"
     "cooked. A step whose result exists does nothing. Steps may be killed and run again, and any\n"
     "number of them may run at once: the bytes are the same.",
     1, 1, step_options, OWN_LIMITS},
};
enum { PLAN, SPLIT, COOK, MERGE, INDEX, STEPS };

/* The command itself, wherever it is called from. */
static std::string own_path()
{
    std::error_code error;
    const std::filesystem::path path = std::filesystem::read_symlink("/proc/self/exe", error);
    return error ? "gtx" : path.native();
}

static gtx::StepReport run_plan(const char *const *operands, int count, gtx::Task &task)
{
    gtx::PlanOptions options;
    for (int i = 0; i < count; ++i)
        options.models.push_back(operands[i]);
    options.folder = folder;
    options.triangles = uint32_t(triangles);
    options.memory = memory;
    options.work = cli_limits.work;
    options.engine = gtx::Engine(engine);
    options.glb = glb;
    options.sides = gtx::Sides(sides);
    options.z_up = up == 1;
    options.depths = depths;
    options.local_metres = local_metres;
    options.unit = unit;
    options.command = own_path();
    return gtx::plan_world(options, task);
}

static gtx::StepReport run_step(int step, const char *const *operands, gtx::Task &task)
{
    switch (step) {
    case SPLIT: return gtx::split_world(operands[0], task);
    case COOK: return gtx::cook_tile(operands[0], operands[1], task);
    case MERGE: return gtx::merge_tile(operands[0], operands[1], task);
    default: return gtx::index_world(operands[0], task);
    }
}

static int usage(const char *sentence)
{
    print_message("gtx world: error[usage]: %s (see gtx world --help)", sentence);
    return EXIT_CODE_USAGE;
}

static int run(int step, const char *const *operands, int count)
{
    const char *const about = step == PLAN ? folder : operands[0];
    return gtx::guarded(about, [&](std::string &) {
        catch_interrupt();
        if (step != PLAN && !cli_limits.triangles)
            cli_limits.triangles = UINT64_MAX; /* the plan counted them */
        gtx::Task task(threads, show_progress, nullptr, {"read", "cook", "simplify"}, {40, 50, 10},
                       cli_limits);
        if (step != PLAN) /* files of its own making: the workers' limit is that of memory */
            task.limits.allow_work(1e6);
        const gtx::StepReport report =
            step == PLAN ? run_plan(operands, count, task) : run_step(step, operands, task);
        end_progress();
        gtx::report_warnings(about, task.warnings);
        if (!cli_quiet)
            print_message("%s%s%s: %s%s", about, step == COOK || step == MERGE ? " " : "",
                          step == COOK || step == MERGE ? operands[1] : "",
                          report.summary.c_str(), report.unchanged ? ", unchanged" : "");
        return int(EXIT_CODE_OK);
    });
}

/* All steps' help, one after another. */
static int print_all_help()
{
    char help[] = "--help";
    for (const verb &step : steps_of_world) {
        char *arguments[] = {const_cast<char *>(step.name), help};
        const char *operands[2];
        int count;
        parse_options(&step, 2, arguments, operands, &count);
    }
    return EXIT_CODE_OK;
}

int cmd_world(int argc, char **argv)
{
    static const char *operands[MAX_MODELS];
    int step = 0, count;
    if (argc < 2)
        return usage("a step is missing: plan, split, cook, merge or index");
    if (!std::strcmp(argv[1], "--help") || !std::strcmp(argv[1], "-h"))
        return print_all_help();
    while (step < STEPS && std::strcmp(steps_of_world[step].name + std::strlen("world "), argv[1]))
        ++step;
    if (step == STEPS)
        return usage("the steps are plan, split, cook, merge and index");
    const int code = parse_options(&steps_of_world[step], argc - 1, argv + 1, operands, &count);
    if (code >= 0)
        return code;
    if (step == PLAN && !folder)
        return usage("-o DIR is missing");
    int streams = 0;
    for (int i = 0; i < count; ++i)
        streams += !std::strcmp(operands[i], "-");
    if (streams > 1)
        return usage("standard input is read once");
    return run(step, operands, count);
}
