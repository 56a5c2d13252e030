/* A glTF scene -> an asset for each mesh that suits, and the scene that places them. */
#include "cook/assemble.hpp"
#include "cook/guard.hpp"
#include "cook/report.hpp"
#include "mesh/scene/scene.hpp"

#include "base/alloc.h"
#include "base/output.h"

#include <geotex/export.h>

#include <chrono>
#include <filesystem>

namespace gtx {

namespace fs = std::filesystem;

namespace {

/* What became of one mesh. */
struct MeshFate {
    std::string file, reason;      /* one of them */
    uint64_t patches = 0, bytes = 0;
};

class SceneCook {
public:
    SceneCook(const char *input, const char *folder, const gtx_cook_desc &desc);
    void run(gtx_report *report);

private:
    MeshFate cook(size_t mesh, ScenePlacement &placement);
    std::string path_of(const std::string &name) const { return (folder_ / name).string(); }
    void refuse_outputs() const;
    std::string report_on(double seconds, Json &json) const;
    static int forward(const gtx_progress *progress, void *user);

    const char *input_;
    fs::path folder_;
    std::string scene_name_;
    gtx_cook_desc desc_;
    Task task_;
    std::unique_ptr<GltfScene> scene_;
    Vector<MeshFate> fates_;
    Vector<std::string> sources_;
    size_t current_ = 0;
    uint64_t scene_bytes_ = 0;
};

} // namespace

/* ---- names ---- */

/* Such as "03-left-wheel.gtx": in the order of the meshes, and fit for any system. */
static std::string asset_name(size_t number, size_t count, const std::string &mesh)
{
    constexpr size_t LONGEST = 40;
    const std::string digits = std::to_string(number);
    std::string out(std::to_string(count - 1).size() - digits.size(), '0');
    out += digits;
    std::string name;
    for (char c : mesh.substr(0, LONGEST)) {
        const bool plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') ||
                           (c >= 'A' && c <= 'Z') || c == '_';
        if (plain)
            name += c;
        else if (!name.empty() && name.back() != '-')
            name += '-';
    }
    while (!name.empty() && name.back() == '-')
        name.pop_back();
    return out + (name.empty() ? "" : "-" + name) + ".gtx";
}

static std::string stem_of(const std::string &path)
{
    fs::path name = fs::path(path).filename();
    if (name.extension() == ".gz")
        name = name.stem();
    return name.stem().string();
}

SceneCook::SceneCook(const char *input, const char *folder, const gtx_cook_desc &desc)
    : input_(input), folder_(folder), scene_name_(stem_of(input) + ".glb"), desc_(desc),
      task_(1, desc.progress, desc.progress_user, {"import", "cook", "write"}, {2, 96, 2},
            desc.limits)
{
    require_argument(!desc.more_count && !desc.charts_ply && !desc.z_up && !(desc.unit > 0) &&
                         !desc.kept_count && !desc.closed && !desc.strict && !desc.if_changed,
                     "more, charts_ply, z_up, unit, kept, closed, strict and if_changed do not go "
                     "with the meshes of a scene");
}

/* No file to write may be one that was read. */
void SceneCook::refuse_outputs() const
{
    Vector<std::string> outputs = {path_of(scene_name_)};
    for (size_t i = 0; i < scene_->meshes().size(); ++i)
        outputs.push_back(path_of(asset_name(i, scene_->meshes().size(),
                                             scene_->meshes()[i].name)));
    for (const std::string &output : outputs)
        for (const std::string &source : sources_)
            require_argument(!gtx_same_file(output.c_str(), source.c_str()),
                             "an output is one of the files that the scene is read from");
    Vector<const char *> paths;
    for (const std::string &source : sources_)
        paths.push_back(source.c_str());
    gtx_error error;
    if (desc_.sources_fn)
        require_ok(desc_.sources_fn(paths.data(), paths.size(), desc_.sources_user, &error),
                   error);
}

/* ---- cooking ---- */

/* Of one mesh's cook, as a share of all. */
int SceneCook::forward(const gtx_progress *progress, void *user)
{
    auto *self = static_cast<SceneCook *>(user);
    const double count = double(self->scene_->meshes().size());
    try {
        self->task_.advance((double(self->current_) + double(progress->fraction)) / count);
        return 0;
    } catch (const Error &) {
        return 1;
    }
}

/* What the technique is not for. */
static bool is_unsuitable(const char *warning)
{
    for (gtx_warning kind : {GTX_WARNING_FEW_TRIANGLES, GTX_WARNING_EMPTY_TEXELS,
                             GTX_WARNING_OUTLINE_LOSS, GTX_WARNING_UNSEEN})
        if (!strcmp(warning, gtx_warning_name(kind)))
            return true;
    return false;
}

/* Whether a mesh that fails so stays as it is, and the others go on. */
static bool is_of_mesh(gtx_result result)
{
    return result == GTX_ERROR_INPUT || result == GTX_ERROR_EMPTY ||
           result == GTX_ERROR_UNSUPPORTED || result == GTX_ERROR_LIMIT;
}

MeshFate SceneCook::cook(size_t mesh, ScenePlacement &placement)
{
    MeshFate out;
    const SceneMesh &about = scene_->meshes()[mesh];
    out.reason = about.unsuitable;
    if (!out.reason.empty())
        return out;
    gtx_cook_desc desc = desc_;
    desc.progress = forward;
    desc.progress_user = this;
    desc.sources_fn = nullptr;
    gtx_asset *made = nullptr;
    gtx_report report = {};
    gtx_error error;
    const Bytes glb = scene_->single(mesh, task_);
    const gtx_result result =
        gtx_cook_memory(glb.data(), glb.size(), "mesh.glb", &desc, &made, &report, &error);
    const Asset asset(made, gtx_close);
    if (result && !is_of_mesh(result))
        throw Error(error);
    if (result)
        out.reason = error.message;
    for (size_t i = 0; i < report.warning_count && !result; ++i)
        if (out.reason.empty() && is_unsuitable(report.warning_names[i]))
            out.reason = report.warnings[i];
    gtx_report_free(&report);
    if (!out.reason.empty())
        return out;
    gtx_info info;
    gtx_get_info(asset.get(), &info);
    out.file = asset_name(mesh, scene_->meshes().size(), about.name);
    out.patches = info.patch_count;
    placement = {mesh, out.file, {info.anchor[0], info.anchor[1], info.anchor[2]}};
    gtx_encode_desc encode = {};
    encode.allocator = desc_.allocator;
#ifdef GTX_ZSTD
    encode.zstd_level = desc_.zstd_level;
#endif
    require_ok(gtx_save_file(asset.get(), path_of(out.file).c_str(), &encode, &error), error);
    out.bytes = fs::file_size(path_of(out.file));
    return out;
}

std::string SceneCook::report_on(double seconds, Json &json) const
{
    size_t cooked = 0;
    uint64_t bytes = scene_bytes_;
    gtx_json_begin_object(&json, nullptr);
    gtx_json_string(&json, "scene", scene_name_.c_str());
    gtx_json_begin_array(&json, "meshes");
    for (size_t i = 0; i < fates_.size(); ++i) {
        const SceneMesh &mesh = scene_->meshes()[i];
        const MeshFate &fate = fates_[i];
        gtx_json_begin_object(&json, nullptr);
        gtx_json_string(&json, "name", mesh.name.c_str());
        gtx_json_integer(&json, "triangles", mesh.triangles);
        gtx_json_integer(&json, "nodes", mesh.nodes);
        if (fate.file.empty()) {
            gtx_json_string(&json, "kept", fate.reason.c_str());
        } else {
            gtx_json_string(&json, "asset", fate.file.c_str());
            gtx_json_integer(&json, "patches", fate.patches);
            gtx_json_integer(&json, "bytes", fate.bytes);
        }
        gtx_json_end_object(&json);
        cooked += !fate.file.empty();
        bytes += fate.bytes;
    }
    gtx_json_end_array(&json);
    gtx_json_integer(&json, "scene_bytes", scene_bytes_);
    gtx_json_number(&json, "seconds", seconds);
    write_warnings(json, task_.warnings);
    gtx_json_end_object(&json);
    check_written(json);
    return std::to_string(cooked) + " of " + std::to_string(fates_.size()) +
           " meshes are assets, the others as they were, " + std::to_string(bytes) + " bytes";
}

void SceneCook::run(gtx_report *report)
{
    const auto start = std::chrono::steady_clock::now();
    task_.begin("import");
    ModelFile file = read_model(input_, task_);
    file.textures.folder = desc_.texture_dir ? desc_.texture_dir : "";
    scene_ = std::make_unique<GltfScene>(file, task_);
    sources_.push_back(input_);
    sources_.insert(sources_.end(), scene_->sources().begin(), scene_->sources().end());
    refuse_outputs();
    std::error_code failed;
    fs::create_directories(folder_, failed);
    if (failed || !fs::is_directory(folder_, failed))
        throw Error(GTX_ERROR_WRITE, "the folder " + folder_.string() + " cannot be made");

    task_.begin("cook");
    Vector<ScenePlacement> placements;
    for (current_ = 0; current_ < scene_->meshes().size(); ++current_) {
        ScenePlacement placement;
        fates_.push_back(cook(current_, placement));
        if (!fates_.back().file.empty())
            placements.push_back(placement);
        task_.advance(double(current_ + 1) / double(scene_->meshes().size()));
    }
    task_.begin("write");
    const Bytes glb = scene_->placed(placements, task_);
    scene_bytes_ = glb.size();
    std::unique_ptr<Report> made;
    if (report) {
        Json json(gtx_allocator_or_default(desc_.allocator));
        const double seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        const std::string line = report_on(seconds, json);
        made = std::make_unique<Report>(json, line, sources_, task_.warnings);
    }
    gtx_error error;
    require_ok(gtx_write_file(path_of(scene_name_).c_str(), glb.data(), glb.size(), &error), error);
    if (report)
        made->hand_over(report);
}

} // namespace gtx

gtx_result gtx_cook_scene(const char *input, const char *folder, const gtx_cook_desc *desc,
                          gtx_report *report, gtx_error *error)
{
    return gtx::guard(error, [&] {
        gtx::require_argument(input && folder, "gtx_cook_scene needs a scene and a folder");
        gtx::SceneCook(input, folder, desc ? *desc : gtx_cook_desc{}).run(report);
    });
}
