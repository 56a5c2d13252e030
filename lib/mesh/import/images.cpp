/* The images of a model: decoded once each, on the task's threads, within limits. */
#include "mesh/import/images.hpp"

#include "mesh/import/image_use.hpp"

#include "image/image.h"

#include <algorithm>
#include <memory>

namespace gtx {

EncodedImage read_image_file(const ModelFile &file, std::string name, const std::string &path,
                             Task &task)
{
    EncodedImage out;
    out.name = std::move(name);
    try {
        out.bytes = read_file_beside(path, task);
        if (file.sources)
            file.sources->push_back(path);
    } catch (const Error &e) {
        if (e.result == GTX_ERROR_LIMIT)
            throw;
        out.problem = e.message;
    }
    return out;
}

namespace {
/* What becomes of one encoded image. */
struct Load {
    bool needed[2] = {false, false}; /* by Texels */
    uint32_t number[2] = {Texture::NONE, Texture::NONE}; /* in the appearance */
    size_t pixels = 0;
    std::string problem;
    Image images[2];
};
} // namespace

static Texels kind_of(Texture Material::*map)
{
    return map == &Material::color_map || map == &Material::emission_map ? Texels::COLOR
                                                                         : Texels::DATA;
}

/* Libraries may fail without a word. */
static std::string reason_of(const gtx_error &error)
{
    return error.message[0] ? error.message : "it cannot be decoded";
}

static void measure(const EncodedImage &from, const Limits &limits, Load &load)
{
    uint32_t width = 0, height = 0;
    gtx_error error = {};
    load.problem = from.problem;
    if (!load.problem.empty())
        return;
    if (gtx_image_measure(from.bytes.data(), from.bytes.size(), &width, &height, &error))
        load.problem = reason_of(error);
    load.pixels = size_t(width) * height;
    limits.require(GTX_LIMITED_PIXELS, from.name.c_str(), load.pixels);
}

static void decode(const EncodedImage &from, Load &load)
{
    constexpr size_t TURNS = 8; /* of a short loop, that take as long as a pixel */
    cancel_point(TURNS * load.pixels);
    gtx_image decoded = {};
    gtx_error error = {};
    TakenMemory taken(2 * sizeof(Rgba8) * load.pixels); /* as decoded, and as RGBA */
    if (gtx_image_decode(from.bytes.data(), from.bytes.size(), &decoded, &error)) {
        load.problem = reason_of(error);
        return;
    }
    std::unique_ptr<gtx_image, void (*)(gtx_image *)> guard(&decoded, gtx_image_free);
    const uint32_t width = decoded.width, height = decoded.height;
    Vector<Rgba8> texels(size_t(width) * height);
    for (size_t i = 0; i < texels.size(); ++i) {
        const uint8_t *p = decoded.pixels + 4 * i;
        texels[i] = {p[0], p[1], p[2], p[3]};
    }
    guard.reset();
    if (from.glossiness >= 0)
        make_rough(from.glossiness, texels);
    if (from.bump > 0)
        make_normals(from.bump, width, height, texels);
    if (from.opacity)
        make_opacity(texels);
    for (Texels kind : {Texels::COLOR, Texels::DATA})
        if (load.needed[int(kind)])
            load.images[int(kind)] = make_image(width, height, texels, kind);
}

static void drop_texture(Texture Material::*map, Material &material)
{
    (material.*map).image = Texture::NONE;
    if (map == &Material::emission_map)
        std::fill_n(material.emission, 3, 0.f);
    if (map == &Material::metal_map)
        material.metallic = 0;
    if (map == &Material::opacity_map)
        material.alpha_cutoff = -1;
}

/* Coordinates and tangents that no texture looks at. */
static void drop_unseen(Appearance &look)
{
    bool set[2] = {false, false}, bent = false;
    for (const Material &m : look.materials) {
        for (Texture Material::*map : MATERIAL_TEXTURES)
            if ((m.*map).used())
                set[(m.*map).set] = true;
        bent |= m.normal_map.used();
    }
    for (int k = 0; k < 2; ++k)
        if (!set[k])
            Vector<std::array<float, 2>>().swap(look.uv[k]);
    if (!bent)
        Vector<std::array<float, 4>>().swap(look.tangents);
}

static bool is_readable(const EncodedImage &image)
{
    uint32_t width, height;
    gtx_error error;
    return image.problem.empty() && gtx_image_measure(image.bytes.data(), image.bytes.size(),
                                                      &width, &height, &error) == GTX_OK;
}

void add_base_color(const ModelFile &file, Appearance &look, Vector<EncodedImage> &encoded,
                    Task &task)
{
    const std::string &path = file.textures.base_color;
    if (path.empty() || look.uv[0].empty())
        return;
    const uint32_t image = uint32_t(encoded.size());
    encoded.push_back(read_image_file(file, "the base colour", path, task));
    encoded.back().required = true;
    if (look.materials.empty()) {
        look.materials.emplace_back();
        look.material.assign(look.uv[0].size() / 3, 0);
    }
    for (Material &m : look.materials)
        if (!m.color_map.used() || !is_readable(encoded[m.color_map.image]))
            m.color_map.image = image;
}

static Vector<Load> find_needed(const Appearance &look, size_t count)
{
    Vector<Load> loads(count);
    for (const Material &m : look.materials)
        for (Texture Material::*map : MATERIAL_TEXTURES)
            if ((m.*map).used())
                loads[(m.*map).image].needed[int(kind_of(map))] = true;
    return loads;
}

/* Numbers what was decoded, and gives it away. */
static void take(const EncodedImage &from, Load &load, uint32_t &count,
                 const std::function<void(Image)> &sink, Task &task)
{
    if (from.required && !load.problem.empty())
        fail(GTX_ERROR_READ, "%s: %s", from.name.c_str(), load.problem.c_str());
    if (!load.problem.empty())
        task.warn(GTX_WARNING_UNREAD_IMAGE, from.name + " was ignored: " + load.problem);
    for (int kind = 0; kind < 2 && load.problem.empty(); ++kind)
        if (load.needed[kind]) {
            load.number[kind] = count++;
            sink(std::move(load.images[kind]));
        }
}

static void name_images(const Vector<Load> &loads, Appearance &look)
{
    for (Material &m : look.materials)
        for (Texture Material::*map : MATERIAL_TEXTURES) {
            Texture &t = m.*map;
            if (!t.used())
                continue;
            t.image = loads[t.image].number[int(kind_of(map))];
            if (!t.used())
                drop_texture(map, m);
        }
    drop_unseen(look);
}

void load_images(const Vector<EncodedImage> &encoded, Appearance &look, Task &task)
{
    Vector<Load> loads = find_needed(look, encoded.size());
    Vector<size_t> work;
    uint32_t count = 0;
    for (size_t i = 0; i < loads.size(); ++i) {
        if (!loads[i].needed[0] && !loads[i].needed[1])
            continue;
        measure(encoded[i], task.limits, loads[i]);
        work.push_back(i);
    }
    task.parallel(work.size(), [&](size_t k) {
        if (loads[work[k]].problem.empty())
            decode(encoded[work[k]], loads[work[k]]);
    }, 0.9, 1);
    for (size_t i : work)
        take(encoded[i], loads[i], count,
             [&](Image image) { look.images.push_back(std::move(image)); }, task);
    name_images(loads, look);
}

void stream_images(size_t count, const std::function<EncodedImage(size_t)> &encoded,
                   const std::function<void(Image)> &sink, Appearance &look, Task &task)
{
    Vector<Load> loads = find_needed(look, count);
    uint32_t numbered = 0;
    for (size_t i = 0; i < loads.size(); ++i) {
        if (!loads[i].needed[0] && !loads[i].needed[1])
            continue;
        const EncodedImage from = encoded(i);
        measure(from, task.limits, loads[i]);
        if (loads[i].problem.empty())
            decode(from, loads[i]);
        take(from, loads[i], numbered, sink, task);
    }
    name_images(loads, look);
}

} // namespace gtx
