/* Finding the models of folders, and naming their assets. */
#include "cli/folder/folder.hpp"

#include "base/hash.h"
#include "mesh/mesh.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>
#include <set>

#include <dirent.h>
#include <sys/stat.h>

namespace fs = std::filesystem;

namespace gtx {

namespace {

bool is_model(const std::string &name)
{
    static const char *const known[] = {".glb", ".gltf", ".drc", ".ply", ".off", ".stl", ".obj"};
    const std::string extension = model_extension(name);
    return std::any_of(std::begin(known), std::end(known),
                       [&](const char *k) { return extension == k; });
}

/* "sub/ball.obj.gz" -> "sub/ball.gtx". */
std::string asset_name(const std::string &name)
{
    fs::path path = name;
    if (path.extension() == ".gz")
        path.replace_extension();
    return path.replace_extension(".gtx").native();
}

/* A folder to look into: its path, and its assets' below the output. */
struct Place {
    std::string path, name;
};

class Walk {
public:
    Walk(Folders &out, const std::string &output) : out_(out), output_(output) {}

    void add_folder(const std::string &path)
    {
        places_.push_back({path, ""});
        while (!places_.empty() || !links_.empty()) { /* what is no link keeps its own name */
            Vector<Place> &from = places_.empty() ? links_ : places_;
            const Place place = from.back();
            from.pop_back();
            look_into(place);
        }
    }
    void add_model(const std::string &path, const std::string &name)
    {
        FolderModel model;
        model.model = path;
        model.name = asset_name(name);
        model.asset = (fs::path(output_) / model.name).native();
        out_.models.push_back(std::move(model));
    }

private:
    /* False where it has been entered under another name, as where links lead in a circle. */
    bool enter(const Place &place)
    {
        struct stat info;
        if (stat(place.path.c_str(), &info) == 0)
            return entered_.insert({info.st_dev, info.st_ino}).second;
        out_.faults.push_back({place.path, std::strerror(errno)});
        return false;
    }
    void look_into(const Place &place)
    {
        if (was_interrupted() || !enter(place))
            return;
        const std::unique_ptr<DIR, int (*)(DIR *)> listing(opendir(place.path.c_str()), closedir);
        if (!listing) {
            out_.faults.push_back({place.path, std::strerror(errno)});
            return;
        }
        Vector<std::string> names;
        errno = 0;
        while (const dirent *entry = readdir(listing.get())) {
            if (entry->d_name[0] != '.')
                names.push_back(entry->d_name);
            errno = 0;
        }
        if (errno)
            out_.faults.push_back({place.path, std::strerror(errno)});
        std::sort(names.begin(), names.end(), std::greater<>()); /* the last is taken first */
        for (const std::string &name : names)
            look_at((fs::path(place.path) / name).native(),
                    (fs::path(place.name) / name).native());
    }
    void look_at(const std::string &path, const std::string &name)
    {
        struct stat info, itself;
        const bool is_there = stat(path.c_str(), &info) == 0;
        if (is_there && S_ISDIR(info.st_mode)) {
            const bool is_link = lstat(path.c_str(), &itself) == 0 && S_ISLNK(itself.st_mode);
            (is_link ? links_ : places_).push_back({path, name});
        } else if (is_model(name)) {
            if (!is_there || S_ISREG(info.st_mode)) /* cooking will say what is wrong */
                add_model(path, name);
            else
                out_.faults.push_back({path, "it is no regular file"});
        }
    }

    Folders &out_;
    const std::string output_;
    Vector<Place> places_, links_;
    std::set<std::pair<dev_t, ino_t>> entered_;
};

/* Both models are named: whoever put them there knows which is meant. */
void refuse_one_asset(const Folders &folders)
{
    for (size_t i = 1; i < folders.models.size(); ++i) {
        const FolderModel &a = folders.models[i - 1], &b = folders.models[i];
        if (a.name == b.name)
            throw Error(GTX_ERROR_ARGUMENT,
                        a.model + " and " + b.model + " would give one asset: " + a.asset);
    }
}

} // namespace

Folders find_models(const char *const *operands, int count, const std::string &output)
{
    Folders out;
    for (int i = 0; i < count; ++i) {
        std::error_code error;
        Walk walk(out, output);
        if (fs::is_directory(operands[i], error))
            walk.add_folder(operands[i]);
        else
            walk.add_model(operands[i], fs::path(operands[i]).filename().native());
    }
    std::sort(out.models.begin(), out.models.end(), [](const auto &a, const auto &b) {
        return a.name != b.name ? a.name < b.name : a.model < b.model;
    });
    refuse_one_asset(out);
    return out;
}

void keep_shard(Folders &folders, uint32_t shard, uint32_t shards)
{
    auto is_elsewhere = [&](const FolderModel &model) {
        return gtx_hash_bytes(model.name.data(), model.name.size()) % shards + 1 != shard;
    };
    folders.models.erase(
        std::remove_if(folders.models.begin(), folders.models.end(), is_elsewhere),
        folders.models.end());
}

} // namespace gtx
