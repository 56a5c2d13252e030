/* Cooking the models of folders, some at a time. */
#include "cli/folder/folder.hpp"
#include "cli/guard.hpp"

#include "base/output.h"

#include <atomic>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <thread>

namespace fs = std::filesystem;

namespace gtx {

namespace {

int go_on(const gtx_progress *, void *)
{
    return was_interrupted();
}

/* What was cooked does not go over the report that is to come. */
gtx_result refuse_report(const char *const *paths, size_t count, void *user, gtx_error *error)
{
    const output_file outputs[] = {{"--report", static_cast<const char *>(user)},
                                   {nullptr, nullptr}};
    return refuse_inputs(outputs, paths, count, error);
}

/* All models at a time share the memory that is allowed: each gets its part, and those for which
 * that is too little are cooked again, alone, with all of it. */
class Run {
public:
    Run(Folders &folders, const folder_cook &job) : folders_(folders), job_(job)
    {
        processors_ = std::max(1u, std::thread::hardware_concurrency());
        const uint32_t wanted = job.jobs ? job.jobs : processors_;
        jobs_ = uint32_t(std::min<uint64_t>(wanted, std::max<size_t>(1, folders.models.size())));
    }

    void run()
    {
        std::vector<std::thread> helpers;
        try {
            while (helpers.size() + 1 < jobs_)
                helpers.emplace_back([this] { work(); });
        } catch (const std::system_error &) { /* fewer will do */
        }
        work();
        for (std::thread &helper : helpers)
            helper.join();
        for (const size_t i : large_)
            cook(folders_.models[i], i, true);
    }

private:
    void work()
    {
        for (size_t i; (i = next_++) < folders_.models.size();)
            cook(folders_.models[i], i, jobs_ == 1);
    }
    gtx_cook_desc desc_of(bool alone) const
    {
        gtx_cook_desc desc = *job_.desc;
        const uint32_t share = alone ? 1 : jobs_;
        if (!desc.threads)
            desc.threads = std::max(1u, processors_ / share);
        if (desc.limits.memory)
            desc.limits.memory = std::max<uint64_t>(1, desc.limits.memory / share);
        desc.progress = go_on;
        desc.sources_fn = refuse_report;
        desc.sources_user = const_cast<char *>(job_.report_path);
        return desc;
    }
    void cook(FolderModel &model, size_t index, bool alone)
    {
        if (was_interrupted())
            return;
        const gtx_cook_desc desc = desc_of(alone);
        gtx_report report;
        std::memset(&report, 0, sizeof report);
        gtx_error error = {};
        try {
            fs::create_directories(fs::path(model.asset).parent_path());
            model.result = gtx_cook_file(model.model.c_str(), model.asset.c_str(), &desc, &report,
                                         &error);
        } catch (const fs::filesystem_error &e) {
            error.result = model.result = GTX_ERROR_WRITE;
            snprintf(error.message, sizeof error.message, "cannot make the folder of the asset: %s",
                     e.code().message().c_str());
        }
        const std::lock_guard<std::mutex> only(mutex_);
        const bool for_memory = model.result == GTX_ERROR_LIMIT && error.limit &&
                                !std::strcmp(error.limit, "memory");
        if (for_memory && !alone && job_.desc->limits.memory)
            large_.push_back(index);
        else if (model.result != GTX_CANCELLED)
            tell(model, report, error);
        gtx_report_free(&report);
    }
    void tell(FolderModel &model, const gtx_report &report, const gtx_error &error)
    {
        model.tried = true;
        model.unchanged = report.unchanged;
        model.cached = report.cached;
        if (model.result) {
            model.failure = error.message;
            model.code = report_error(model.model.c_str(), &error);
            ++failed_;
        } else if (job_.report_path) {
            model.report = std::string(report.json, report.size);
        }
        for (size_t i = 0; i < report.warning_count; ++i)
            report_warning(model.model.c_str(), report.warning_names[i], report.warnings[i]);
        show_count(++done_, folders_.models.size(), failed_);
    }

    Folders &folders_;
    const folder_cook &job_;
    uint32_t processors_, jobs_;
    std::atomic<size_t> next_{0};
    std::mutex mutex_; /* of what follows, and of what is printed */
    Vector<size_t> large_;
    uint64_t done_ = 0, failed_ = 0;
};

int code_of(const Folders &folders)
{
    int code = folders.faults.empty() ? EXIT_CODE_OK : EXIT_CODE_FILE;
    for (const FolderModel &model : folders.models)
        code = std::max(code, model.code);
    return was_interrupted() ? int(EXIT_CODE_CANCELLED) : code;
}

/* No asset goes over a model or the report. */
int check_assets(const Folders &folders, const folder_cook &job)
{
    if (!job.report_path)
        return EXIT_CODE_OK;
    for (const FolderModel &model : folders.models) {
        const output_file outputs[] = {{"-o", model.asset.c_str()}, {"--report", job.report_path},
                                       {nullptr, nullptr}};
        const char *source = model.model.c_str();
        if (const int code = check_outputs("gtx cook", outputs, &source, 1))
            return code;
    }
    return EXIT_CODE_OK;
}

int cook_all(const folder_cook &job, std::string &about)
{
    const auto start = std::chrono::steady_clock::now();
    const fs::path output = job.output;
    if (output.extension() == ".gtx" && !fs::is_directory(output))
        throw Error(GTX_ERROR_ARGUMENT, "a folder is cooked into a folder, which no .gtx file is");
    catch_interrupt();
    Folders folders = find_models(job.operands, job.count, job.output);
    about = job.output;
    for (const FolderFault &fault : folders.faults)
        print_message("%s: error[read]: %s", fault.path.c_str(), fault.sentence.c_str());
    if (folders.models.empty() && folders.faults.empty())
        throw Error(GTX_ERROR_EMPTY, "there is no model to cook");
    if (const int code = check_assets(folders, job))
        return code;
    keep_shard(folders, job.shard, job.shards);
    Run(folders, job).run();

    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    int code = code_of(folders);
    if (job.report_path) {
        const std::string text = write_folder_report(folders, job, code, seconds);
        code = std::max(code, write_text_file(job.report_path, text.data(), text.size()));
    }
    const FolderCounts n = count_models(folders);
    if (!cli_quiet)
        print_message("%s: %zu models: %llu cooked, %llu from the cache, %llu unchanged, %llu "
                      "failed, %llu not tried, %.2f s", job.output, folders.models.size(),
                      (unsigned long long)n.cooked, (unsigned long long)n.cached,
                      (unsigned long long)n.unchanged, (unsigned long long)n.failed,
                      (unsigned long long)n.untried, seconds);
    return code;
}

} // namespace

} // namespace gtx

bool is_folder_cook(const char *const *operands, int count, const char *output)
{
    std::error_code ignored;
    const bool is_stream = !std::strcmp(operands[0], "-");
    bool folder = output[std::strlen(output) - 1] == '/' ||
                  (!is_stream && fs::is_directory(output, ignored));
    for (int i = 0; i < count; ++i)
        folder = folder || fs::is_directory(operands[i], ignored);
    return folder;
}

int cook_folders(const folder_cook *job)
{
    return gtx::guarded("gtx cook",
                        [&](std::string &about) { return gtx::cook_all(*job, about); });
}
