/* A thread that opens assets and worlds, and cooks models. */
#include "cli/view/loader.hpp"

#include "grid/grid.hpp"

#include "cli/cli.h"
#include "host/jobs.h"

#include <geotex/cook.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <unistd.h>

namespace gtx {

/* A name for a file that nobody else has, and nobody has after this. */
struct TemporaryFile {
    std::string folder, path;
    TemporaryFile()
    {
        const char *where = std::getenv("TMPDIR");
        folder = std::string(where && *where ? where : "/tmp") + "/gtx-view-XXXXXX";
        if (!mkdtemp(folder.data()))
            throw Error(GTX_ERROR_WRITE, folder + ": " + std::strerror(errno));
        path = folder + "/model.gtx";
    }
    TemporaryFile(const TemporaryFile &) = delete;
    ~TemporaryFile()
    {
        unlink(path.c_str());
        rmdir(folder.c_str());
    }
};

int Loader::on_progress(const gtx_progress *progress, void *user)
{
    auto *loader = static_cast<Loader *>(user);
    loader->stage_ = progress->stage;
    loader->fraction_ = progress->fraction;
    return loader->cancelled_;
}

AssetPointer Loader::cook(const std::string &path)
{
    if (is_grid_file(path))
        return asset_of_grid(path, on_progress, this, [&](gtx_warning kind, const char *text) {
            result_.warnings.push_back({gtx_warning_name(kind), text});
        });
    TemporaryFile file;
    gtx_cook_desc desc = {};
    gtx_report report = {};
    gtx_error error;
    desc.progress = on_progress;
    desc.progress_user = this;
    require_ok(gtx_cook_file(path.c_str(), file.path.c_str(), &desc, &report, &error), error);
    for (size_t i = 0; i < report.warning_count; ++i)
        result_.warnings.push_back({report.warning_names[i], report.warnings[i]});
    gtx_report_free(&report);
    return open_asset(file.path);
}

void Loader::load(const std::string &path)
{
    result_.path = path;
    const std::string world = world_at(path);
    if (!world.empty()) {
        result_.scene.worlds.push_back(open_world(world));
        return;
    }
    const bool cooked = !is_asset(path);
    PlacedAsset placed = {cooked ? cook(path) : open_asset(path), identity_transform,
                          cooked ? path : std::string()};
    const gtx_jobs jobs = gtx_host_jobs(0);
    gtx_model_desc desc = {};
    desc.jobs = &jobs;
    desc.limits = cli_limits;
    gtx_model *model;
    gtx_error error;
    require_ok(gtx_model_prepare(placed.asset.get(), &desc, &model, &error), error);
    result_.models.push_back(model);
    result_.scene.assets.push_back(std::move(placed));
}

void Loader::run(const Vector<std::string> &paths)
{
    try {
        for (const std::string &path : paths)
            load(path);
        measure_bounds(result_.scene);
        if (cancelled_)
            throw Error(GTX_CANCELLED, "cancelled");
    } catch (...) {
        result_.error = caught_error();
    }
    finished_ = true;
}

void Loader::start(Vector<std::string> paths)
{
    stop();
    cancelled_ = finished_ = false;
    fraction_ = 0;
    stage_ = "open";
    thread_ = std::thread([this, paths = std::move(paths)] { run(paths); });
}

Loader::Result Loader::join()
{
    thread_.join();
    finished_ = false;
    Result result = std::move(result_);
    result_ = Result();
    return result;
}

void Loader::stop()
{
    if (!busy())
        return;
    cancel();
    for (gtx_model *model : join().models)
        gtx_model_destroy(nullptr, model);
}

} // namespace gtx
