/* The report of cooking folders. */
#include "cli/folder/folder.hpp"

#include "base/json.h"

#include <new>

namespace gtx {

FolderCounts count_models(const Folders &folders)
{
    FolderCounts out;
    for (const FolderModel &m : folders.models)
        ++(!m.tried ? out.untried
           : m.code ? out.failed
           : m.cached ? out.cached
           : m.unchanged ? out.unchanged
                         : out.cooked);
    return out;
}

static const char *outcome_of(const FolderModel &m)
{
    return !m.tried      ? "untried"
           : m.code      ? "failed"
           : m.cached    ? "cached"
           : m.unchanged ? "unchanged"
                         : "cooked";
}

static std::string text_of(const gtx_json &json)
{
    if (json.failed)
        throw std::bad_alloc();
    return std::string(json.text, json.size);
}

namespace {
struct Writer : gtx_json {
    Writer() : gtx_json{} {}
    ~Writer() { gtx_json_free(this); }
    Writer(const Writer &) = delete;
    Writer &operator=(const Writer &) = delete;
};
} // namespace

/* One model on a few lines; the cook's own report as it is. */
static std::string model_text(const FolderModel &m)
{
    Writer json;
    gtx_json_begin_object(&json, nullptr);
    gtx_json_string(&json, "model", m.model.c_str());
    gtx_json_string(&json, "asset", m.asset.c_str());
    gtx_json_string(&json, "outcome", outcome_of(m));
    gtx_json_integer(&json, "exit_code", uint64_t(m.code));
    if (m.code)
        gtx_json_string(&json, "error", m.failure.c_str());
    gtx_json_end_object(&json);
    std::string text = text_of(json);
    text.erase(text.find_last_not_of("\n}") + 1);
    return text + ", \"report\": " + (m.report.empty() ? "null" : m.report) + "}";
}

std::string write_folder_report(const Folders &folders, const folder_cook &job, int code,
                                double seconds)
{
    const FolderCounts counts = count_models(folders);
    Writer json;
    gtx_json_begin_object(&json, nullptr);
    gtx_json_integer(&json, "exit_code", uint64_t(code));
    gtx_json_integer(&json, "shard", job.shard);
    gtx_json_integer(&json, "shards", job.shards);
    gtx_json_number(&json, "seconds", seconds);
    gtx_json_integer(&json, "cooked", counts.cooked);
    gtx_json_integer(&json, "unchanged", counts.unchanged);
    gtx_json_integer(&json, "cached", counts.cached);
    gtx_json_integer(&json, "failed", counts.failed);
    gtx_json_integer(&json, "untried", counts.untried);
    gtx_json_begin_array(&json, "unreadable");
    for (const FolderFault &fault : folders.faults) {
        gtx_json_begin_object(&json, nullptr);
        gtx_json_string(&json, "path", fault.path.c_str());
        gtx_json_string(&json, "error", fault.sentence.c_str());
        gtx_json_end_object(&json);
    }
    gtx_json_end_array(&json);
    gtx_json_end_object(&json);
    std::string text = text_of(json);
    text.erase(text.find_last_not_of("\n}") + 1);
    text += ",\n\"models\": [";
    const char *before = "\n";
    for (const FolderModel &m : folders.models) {
        text += before + model_text(m);
        before = ",\n";
    }
    return text + "\n]}\n";
}

} // namespace gtx
