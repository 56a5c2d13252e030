/* Build files that run the steps: Ninja, a shell script, job arrays of Slurm. Nothing here
 * schedules. */
#include "world/plan.hpp"

#include <algorithm>
#include <filesystem>

namespace gtx {

namespace {

/* Tiles that may be cooked at the same time: all leaves, then a depth at a time, from below. */
struct Stage {
    const char *step;
    uint32_t depth;
    Vector<const Tile *> tiles;
};

/* In single quotes for a shell. */
std::string quoted(const std::string &text)
{
    std::string out = "'";
    for (char c : text)
        out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return out + "'";
}

} // namespace

static Vector<Stage> stages_of(const Plan &plan)
{
    Vector<Stage> stages = {{"cook", plan.depths(), {}}};
    for (const Tile &tile : plan.tiles)
        if (tile.is_leaf())
            stages[0].tiles.push_back(&tile);
    for (uint32_t depth = plan.depths() - 1; depth-- > 0;) {
        Stage stage = {"merge", depth, {}};
        for (const Tile &tile : plan.tiles)
            if (tile.depth == depth && !tile.is_leaf())
                stage.tiles.push_back(&tile);
        stages.push_back(stage);
        stage.step = "cook";
        stages.push_back(stage);
    }
    return stages;
}

/* GTX in the environment takes the place of the command that planned. */
static std::string command_line(const Plan &plan, const std::string &command)
{
    return "[ \"$GTX\" ] || GTX=" + quoted(command) + "; \"$GTX\" world \"$@\" -q --max-memory " +
           std::to_string(plan.memory) +
           (plan.work ? " --max-work " + std::to_string(plan.work) : "");
}

/* ---- Ninja ---- */

/* The root is cooked alone, after all others. Of 300,000 triangles it takes 30 MB more than with
 * one thread; 16 take 80. */
constexpr const char *ROOT_THREADS = "4";

static std::string escaped(const std::string &text)
{
    std::string out;
    for (char c : text)
        out += c == '$' ? std::string("$$") : std::string(1, c);
    return out;
}

static std::string facts_of(const Tile &tile)
{
    return " work/facts/" + tile.name + ".json";
}

static std::string ninja_cook(const Plan &plan, const Tile &tile)
{
    std::string out = "build" + facts_of(tile) + " | tiles/" + tile.name + ".gtx";
    if (plan.glb)
        out += " tiles/" + tile.name + ".glb";
    if (tile.depth)
        out += " work/low/" + tile.name;
    out += ": step work/" + (tile.is_leaf() ? "split/whole" : "merge/" + tile.name);
    if (!tile.is_leaf())
        for (const Tile *other : plan.low_neighbours(tile))
            out += facts_of(*other);
    return out + "\n  do = cook . " + tile.name + "\n" +
           (tile.depth ? "" : std::string("  threads = ") + ROOT_THREADS + "\n");
}

static std::string ninja_merge(const Plan &plan, const Tile &tile)
{
    std::string out = "build work/merge/" + tile.name + ": step";
    for (uint32_t child : tile.children)
        out += facts_of(plan.tiles[child]);
    return out + "\n  do = merge . " + tile.name + "\n";
}

static std::string ninja_text(const Plan &plan, const std::string &command)
{
    std::string out = "# Made by gtx world plan. ninja -C THIS_FOLDER cooks the world; a worker "
                      "takes at most\n# " + std::to_string(plan.memory / 1000000) +
                      " MB.\nninja_required_version = 1.5\n\n"
                      "threads = 1\nrule step\n"
                      "  command = set -- $do --threads $threads; " +
                      escaped(command_line(plan, command)) +
                      "\n  description = $do\n  restat = 1\n\n"
                      "build work/split/whole: step plan.json\n  do = split .\n";
    /* Of what it may do, Ninja does first what is first here: the deepest tiles, which most others
     * wait for. */
    for (size_t n = plan.tiles.size(); n-- > 0;) {
        const Tile &tile = plan.tiles[n];
        out += (tile.is_leaf() ? "" : ninja_merge(plan, tile)) + ninja_cook(plan, tile);
    }
    out += "build tileset.json: step";
    for (const Tile &tile : plan.tiles)
        out += facts_of(tile);
    return out + "\n  do = index .\ndefault tileset.json\n";
}

/* ---- the shell ---- */

static std::string shell_text(const Plan &plan, const std::string &command)
{
    std::string out = "#!/bin/sh\n# Made by gtx world plan: the steps one after another.\nset -e\n"
                      "cd \"$(dirname \"$0\")\"\nstep() { " + command_line(plan, command) +
                      " --threads 1; }\nstep split .\n";
    for (const Stage &stage : stages_of(plan))
        for (const Tile *tile : stage.tiles)
            out += std::string("step ") + stage.step + " . " + tile->name + "\n";
    return out + "step index .\n";
}

/* ---- Slurm ---- */

/* Of an array; each job takes every so many-th tile of its stage. Slurm's own limit is 1001. */
constexpr size_t MAX_JOBS = 1000;

static std::string slurm_job(const Plan &plan, const std::string &command)
{
    return "#!/bin/sh\n# Made by gtx world plan: job.sh STEP [LIST]. Of a list of tiles each job "
           "of an array takes its share.\nset -e\nstep() { " + command_line(plan, command) +
           " --threads 1; }\nif [ -z \"$2\" ]; then\n    step \"$1\" .\n    exit\nfi\n"
           "awk -v n=\"$SLURM_ARRAY_TASK_COUNT\" -v i=\"$SLURM_ARRAY_TASK_ID\" "
           "'NR % n == i % n' \"$2\" |\nwhile read -r tile; do\n"
           "    step \"$1\" . \"$tile\" </dev/null\ndone\n";
}

static void write_slurm(const Plan &plan, const std::string &command)
{
    const std::string folder = plan.folder + "/slurm/";
    write_whole(folder + "job.sh", slurm_job(plan, command));
    const std::string sbatch = "sbatch --parsable --kill-on-invalid-dep=yes --cpus-per-task=1 "
                               "--mem=" + std::to_string(plan.memory / 1000000 + 1) +
                               "M -o slurm/%A-%a.out ";
    std::string out = "#!/bin/sh\n# Made by gtx world plan: submits the steps; each waits for "
                      "those before it. Prints the last job.\nset -e\ncd \"$(dirname \"$0\")/..\"\n"
                      "job=$(" + sbatch + "slurm/job.sh split)\n";
    for (const Stage &stage : stages_of(plan)) {
        const std::string list = std::string("slurm/") + stage.step + "-" +
                                 std::to_string(stage.depth);
        std::string names;
        for (const Tile *tile : stage.tiles)
            names += tile->name + "\n";
        write_whole(plan.folder + "/" + list, names);
        out += "job=$(" + sbatch + "--dependency=afterok:$job --array=1-" +
               std::to_string(std::min(stage.tiles.size(), MAX_JOBS)) + " slurm/job.sh " +
               stage.step + " " + list + ")\n";
    }
    out += "job=$(" + sbatch + "--dependency=afterok:$job slurm/job.sh index)\necho \"$job\"\n";
    write_whole(folder + "submit.sh", out);
}

void write_engine(const Plan &plan, Engine engine, const std::string &command)
{
    switch (engine) {
    case Engine::NINJA:
        write_whole(plan.folder + "/build.ninja", ninja_text(plan, command));
        break;
    case Engine::SHELL:
        write_whole(plan.folder + "/build.sh", shell_text(plan, command));
        break;
    case Engine::SLURM: write_slurm(plan, command); break;
    }
}

} // namespace gtx
