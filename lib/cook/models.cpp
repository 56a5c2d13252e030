/* Reading models and putting them together. */
#include "cook/models.hpp"

#include "base/hash.h"
#include "grid/grid.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <set>

namespace gtx {

/* ---- one mesh ---- */

/* Appends attributes that either mesh may lack: `fill` stands for what is not there. */
template <class T>
static void append(Vector<T> &to, size_t before, Vector<T> &from, size_t count,
                   const T &fill = T())
{
    if (to.empty() && from.empty())
        return;
    to.resize(before, fill);
    to.insert(to.end(), from.begin(), from.end());
    to.resize(before + count, fill);
}

/* `before` and `count` are triangles. */
static void append(Appearance &to, size_t before, Appearance &&from, size_t count)
{
    bool has_materials = !to.material.empty() || !from.material.empty();
    for (Appearance *a : {&to, &from})
        if (has_materials && a->material.empty()) {
            a->material.assign(a == &to ? before : count, uint32_t(a->materials.size()));
            a->materials.emplace_back();
        }
    uint32_t images = uint32_t(to.images.size()), materials = uint32_t(to.materials.size());
    for (Material &m : from.materials) {
        for (Texture Material::*map : MATERIAL_TEXTURES)
            if ((m.*map).used())
                (m.*map).image += images;
        to.materials.push_back(m);
    }
    for (Image &image : from.images)
        to.images.push_back(std::move(image));
    for (uint32_t m : from.material)
        to.material.push_back(materials + m);
    for (int set = 0; set < 2; ++set)
        append(to.uv[set], 3 * before, from.uv[set], 3 * count);
    append(to.tangents, 3 * before, from.tangents, 3 * count);
}

static void append(Mesh &to, Mesh &&from)
{
    size_t vertices = to.positions.size(), before = to.triangle_count();
    size_t count = from.triangle_count();
    if (vertices + from.positions.size() >= NO_TRIANGLE || before + count >= NO_TRIANGLE)
        throw Error(GTX_ERROR_LIMIT, "more vertices or triangles than 32 bits can count");
    append(to.normals, 3 * before, from.normals, 3 * count);
    append(to.colors, 3 * before, from.colors, 3 * count);
    append(to.flags, before, from.flags, count);
    append(to.appearance, before, std::move(from.appearance), count);
    to.positions.insert(to.positions.end(), from.positions.begin(), from.positions.end());
    for (const auto &t : from.triangles)
        to.triangles.push_back({uint32_t(t[0] + vertices), uint32_t(t[1] + vertices),
                                uint32_t(t[2] + vertices)});
}

/* ---- reading ---- */

static void add_number(gtx_hash &hash, uint64_t number)
{
    uint8_t bytes[8];
    for (int i = 0; i < 8; ++i)
        bytes[i] = uint8_t(number >> (8 * i));
    gtx_hash_add(&hash, bytes, sizeof bytes);
}

static void add_bytes(gtx_hash &hash, std::string_view bytes)
{
    add_number(hash, bytes.size());
    gtx_hash_add(&hash, bytes.data(), bytes.size());
}

/* A file that is not there counts too: the content changes when it appears. */
static bool add_file(gtx_hash &hash, const std::string &path, Task &task)
{
    std::error_code ignored;
    std::unique_ptr<FILE, int (*)(FILE *)> file(nullptr, fclose);
    if (std::filesystem::is_regular_file(path, ignored))
        file.reset(fopen(path.c_str(), "rb"));
    if (!file) {
        add_number(hash, UINT64_MAX);
        return false;
    }
    Vector<char> block(1 << 18);
    uint64_t total = 0;
    while (size_t size = fread(block.data(), 1, block.size(), file.get())) {
        gtx_hash_add(&hash, block.data(), size);
        total += size;
        task.advance(0);
    }
    if (ferror(file.get()))
        throw Error(GTX_ERROR_READ, "cannot read " + path + ": " + std::strerror(errno));
    add_number(hash, total);
    return true;
}

/* What goes wrong, or is ignored, in one of several models names it. */
template <class Body>
static auto naming(const std::string &path, bool several, Task &task, Body body)
{
    size_t before = task.warnings.size();
    try {
        auto result = body();
        for (size_t i = before; several && i < task.warnings.size(); ++i)
            task.warnings[i].sentence.insert(0, path + ": ");
        return result;
    } catch (Error &e) {
        if (several && e.result != GTX_CANCELLED)
            e.message.insert(0, path + ": ");
        throw;
    }
}

Models read_models(const ModelInput &first, const char *const *more, uint32_t more_count,
                   const TextureFiles &textures, Task &task)
{
    if (first.make) {
        Models made;
        made.made = first.make();
        made.hash = first.hash;
        task.limits.read(first.path, bytes_of(made.made));
        return made;
    }
    Vector<ModelInput> inputs = {first};
    for (uint32_t i = 0; i < more_count; ++i)
        inputs.push_back({more[i]});

    Models models;
    gtx_hash hash;
    gtx_hash_begin(&hash);
    for (const ModelInput &input : inputs) {
        ModelFile file = naming(input.path, inputs.size() > 1, task, [&] {
            return input.data ? model_in_memory({static_cast<const char *>(input.data), input.size},
                                                input.path, task)
                              : read_model(input.path, task);
        });
        file.textures = textures;
        if (!input.data)
            models.sources.push_back(input.path);
        /* Where the bytes leave the format open, the name decides. */
        add_bytes(hash, model_extension(input.path));
        add_bytes(hash, file.bytes);
        for (const std::string &path : referenced_files(file, task))
            if (add_file(hash, path, task))
                models.sources.push_back(path);
        models.files.push_back(std::move(file));
    }
    if (!textures.base_color.empty() && add_file(hash, textures.base_color, task))
        models.sources.push_back(textures.base_color);
    models.hash = gtx_hash_end(&hash);
    return models;
}

/* What it cannot open is left to the importers, which say why. */
static bool is_grid(const char *path)
{
    std::error_code ignored;
    return std::filesystem::is_regular_file(path, ignored) && is_grid_file(path);
}

Models read_sources(const char *first, const char *const *more, uint32_t more_count,
                    const TextureFiles &textures, const GridSense &sense, Task &task)
{
    Vector<const char *> models, grids;
    for (uint32_t i = 0; i <= more_count; ++i) {
        const char *path = i ? more[i - 1] : first;
        (is_grid(path) ? grids : models).push_back(path);
    }
    Models out;
    if (!models.empty())
        out = read_models({models[0]}, models.data() + 1, uint32_t(models.size() - 1), textures,
                          task);
    double latitude = NAN;
    for (const char *path : grids) {
        append(out.grids, naming(path, more_count > 0, task, [&] {
            HeightGrid grid = read_grid(path, {}, task);
            if (sense.local_metres)
                use_common_metres(grid, latitude);
            if (sense.depths)
                use_depths(grid);
            return mesh_of(grid, task);
        }));
        out.sources.push_back(path);
        out.hash = 0; /* nothing is cooked from grids and models */
    }
    return out;
}

/* ---- importing ---- */

/* A quarter turn around x. */
static void turn_z_up(Mesh &mesh)
{
    for (Vec3d &p : mesh.positions)
        p = {p.x, p.z, -p.y};
    for (Vec3f &n : mesh.normals)
        n = {n.x, n.z, -n.y};
    for (auto &t : mesh.appearance.tangents)
        t = {t[0], t[2], -t[1], t[3]};
}

Mesh import_models(Models &models, bool z_up, Task &task)
{
    Mesh mesh = std::move(models.made);
    bool several = models.files.size() > 1;
    std::set<std::filesystem::path> known;
    auto is_new = [&known](const std::string &path) {
        return known.insert(std::filesystem::path(path).lexically_normal()).second;
    };
    for (const std::string &path : models.sources)
        is_new(path);
    for (ModelFile &kept : models.files) {
        ModelFile file = std::move(kept); /* freed as soon as it is imported */
        Vector<std::string> read;
        file.sources = &read;
        Mesh next = naming(file.path, several, task, [&] { return import_model(file, task); });
        if (mesh.triangles.empty())
            mesh = std::move(next);
        else
            append(mesh, std::move(next));
        for (const std::string &path : read)
            if (is_new(path)) {
                models.sources.push_back(path);
                models.foreseen = false;
            }
    }
    models.files.clear();
    if (z_up)
        turn_z_up(mesh);
    if (!models.grids.triangles.empty())
        append(mesh, std::move(models.grids));
    return mesh;
}

size_t bytes_of(const Mesh &mesh)
{
    size_t texels = 0;
    for (const Image &image : mesh.appearance.images)
        texels += image.levels[0].texels.size();
    return mesh.triangle_count() * 36 + texels / 4;
}

} // namespace gtx
