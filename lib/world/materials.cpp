/* Materials and images of a world, in files beside its cell files. */
#include "world/materials.hpp"

#include "base/bytes.h"

#include <algorithm>
#include <cstring>
#include <filesystem>

namespace gtx {

namespace {

/* Each number of a material, in the order of the file. */
template <class To> void visit(Material &m, To to)
{
    for (float *x : {&m.color[0], &m.color[1], &m.color[2], &m.color[3], &m.emission[0],
                     &m.emission[1], &m.emission[2], &m.metallic, &m.roughness, &m.normal_scale,
                     &m.occlusion_strength, &m.alpha_cutoff})
        to(*x);
    to(m.unlit);
    for (Texture Material::*map : MATERIAL_TEXTURES) {
        Texture &t = m.*map;
        to(t.image);
        to(t.set);
        to(t.channel);
        to(t.wrap[0]);
        to(t.wrap[1]);
        for (float &x : t.transform)
            to(x);
    }
}

struct ToWords {
    Vector<uint32_t> &words;
    void operator()(float x) const
    {
        words.push_back(0);
        std::memcpy(&words.back(), &x, 4);
    }
    template <class T> void operator()(T x) const { words.push_back(uint32_t(x)); }
};

struct FromWords {
    const uint32_t *&at;
    void operator()(float &x) const { std::memcpy(&x, at++, 4); }
    template <class T> void operator()(T &x) const { x = T(*at++); }
};

Vector<uint32_t> words_of(Material m)
{
    Vector<uint32_t> words;
    visit(m, ToWords{words});
    return words;
}

/* Level by level, the finest first. */
struct ImageHeader {
    uint32_t levels = 0;
    Vector<std::array<uint32_t, 2>> sizes;
};

constexpr char MAGIC[] = "gtxlook1";
constexpr uint32_t MAX_LEVELS = 32, MAX_SIDE = 1 << 20;

std::string image_path(const std::string &folder, uint32_t number)
{
    return folder + "/image-" + std::to_string(number);
}

std::string bytes_of(const Vector<uint32_t> &words)
{
    std::string out(4 * words.size(), 0);
    for (size_t i = 0; i < words.size(); ++i)
        gtx_store_u32(reinterpret_cast<uint8_t *>(&out[4 * i]), words[i]);
    return out;
}

} // namespace

void hash_appearance(gtx_hash &hash, const Appearance &look)
{
    for (const Material &m : look.materials) {
        const std::string bytes = bytes_of(words_of(m));
        gtx_hash_add(&hash, bytes.data(), bytes.size());
    }
    for (const Image &image : look.images) {
        const Image::Level &finest = image.levels[0];
        gtx_hash_add(&hash, &finest.width, sizeof finest.width);
        gtx_hash_add(&hash, finest.texels.data(), 4 * finest.texels.size());
    }
}

/* ---- writing ---- */

static void write_image(const std::string &path, const Image &image)
{
    Vector<uint32_t> head = {uint32_t(image.levels.size())};
    for (const Image::Level &level : image.levels) {
        head.push_back(level.width);
        head.push_back(level.height);
    }
    std::ofstream out(path, std::ios::binary);
    out << bytes_of(head);
    for (const Image::Level &level : image.levels)
        out.write(reinterpret_cast<const char *>(level.texels.data()),
                  std::streamsize(4 * level.texels.size()));
    if (!out.flush())
        throw Error(GTX_ERROR_WRITE, "cannot write " + path);
}

void MaterialWriter::add(const Appearance &look)
{
    for (const Image &image : look.images)
        write_image(image_path(folder_, images_++), image);
    for (Material m : look.materials) {
        for (Texture Material::*map : MATERIAL_TEXTURES)
            if ((m.*map).used())
                (m.*map).image += first_;
        const Vector<uint32_t> words = words_of(m);
        words_.insert(words_.end(), words.begin(), words.end());
    }
    if (!look.materials.empty())
        first_ = images_;
}

void MaterialWriter::finish()
{
    if (!words_.empty())
        write_whole(folder_ + "/look", MAGIC + bytes_of({images_}) + bytes_of(words_));
}

/* ---- reading ---- */

static void require_look(bool fine)
{
    if (!fine)
        throw Error(GTX_ERROR_INPUT, "the materials of the world are none that gtx world split "
                                     "wrote");
}

static Vector<Material> read_materials(const std::string &folder)
{
    const std::string path = folder + "/look";
    std::ifstream file(path, std::ios::binary);
    if (!file)
        throw Error(GTX_ERROR_READ, "cannot read " + path + ": the step that makes it has not run");
    const std::string bytes{std::istreambuf_iterator<char>(file), {}};
    const size_t head = sizeof MAGIC - 1 + 4, each = 4 * words_of({}).size();
    require_look(bytes.size() >= head && (bytes.size() - head) % each == 0 &&
                 std::memcmp(bytes.data(), MAGIC, sizeof MAGIC - 1) == 0);
    Vector<uint32_t> words;
    for (size_t at = head - 4; at < bytes.size(); at += 4)
        words.push_back(gtx_load_u32(reinterpret_cast<const uint8_t *>(&bytes[at])));
    Vector<Material> out((bytes.size() - head) / each);
    const uint32_t *at = words.data() + 1;
    for (Material &m : out) {
        visit(m, FromWords{at});
        for (Texture Material::*map : MATERIAL_TEXTURES) {
            const Texture &t = m.*map;
            require_look((!t.used() || t.image < words[0]) && t.set < 2 && t.channel < 4 &&
                         t.wrap[0] <= Wrap::CLAMP && t.wrap[1] <= Wrap::CLAMP);
        }
    }
    return out;
}

static ImageHeader read_header(std::ifstream &file)
{
    uint8_t word[8];
    ImageHeader out;
    require_look(bool(file.read(reinterpret_cast<char *>(word), 4)));
    out.levels = gtx_load_u32(word);
    require_look(out.levels > 0 && out.levels <= MAX_LEVELS);
    for (uint32_t k = 0; k < out.levels; ++k) {
        require_look(bool(file.read(reinterpret_cast<char *>(word), 8)));
        out.sizes.push_back({gtx_load_u32(word), gtx_load_u32(word + 4)});
        for (uint32_t side : out.sizes.back())
            require_look(side > 0 && side <= MAX_SIDE);
    }
    return out;
}

static uint64_t texels_of(const ImageHeader &head, uint32_t skipped)
{
    uint64_t sum = 0;
    for (uint32_t k = std::min(skipped, head.levels - 1); k < head.levels; ++k)
        sum += uint64_t(head.sizes[k][0]) * head.sizes[k][1];
    return sum;
}

static Image read_image(const std::string &path, uint32_t skipped)
{
    std::ifstream file(path, std::ios::binary);
    const ImageHeader head = read_header(file);
    Image out;
    const uint32_t first = std::min(skipped, head.levels - 1);
    file.seekg(std::streamoff(4 * (texels_of(head, 0) - texels_of(head, first))), std::ios::cur);
    for (uint32_t k = first; k < head.levels; ++k) {
        cancel_point();
        Image::Level level;
        level.width = head.sizes[k][0];
        level.height = head.sizes[k][1];
        level.texels.resize(size_t(level.width) * level.height);
        require_look(bool(file.read(reinterpret_cast<char *>(level.texels.data()),
                                    std::streamsize(4 * level.texels.size()))));
        out.levels.push_back(std::move(level));
    }
    return out;
}

/* How many of the finest levels have no room. */
static uint32_t levels_to_skip(const Vector<ImageHeader> &heads, uint64_t most)
{
    for (uint32_t skipped = 0; skipped < MAX_LEVELS; ++skipped) {
        uint64_t sum = 0;
        for (const ImageHeader &head : heads)
            sum += texels_of(head, skipped);
        if (sum <= most)
            return skipped;
    }
    throw Error(GTX_ERROR_LIMIT, "the tile looks at more images than a worker has memory for");
}

/* The images of materials that the surface uses, renumbered; other materials lose theirs. */
static Vector<uint32_t> images_used(Appearance &look, const TileSurface &surface)
{
    Vector<uint8_t> is_used(look.materials.size(), 0);
    for (const auto &t : surface.triangles) {
        const uint32_t m = surface.looks[t[0]].material;
        require_look(m == CornerLook::NO_MATERIAL || m < is_used.size());
        if (m != CornerLook::NO_MATERIAL)
            is_used[m] = 1;
    }
    Vector<uint32_t> images;
    for (size_t m = 0; m < look.materials.size(); ++m)
        for (Texture Material::*map : MATERIAL_TEXTURES) {
            uint32_t &image = (look.materials[m].*map).image;
            if (!is_used[m])
                image = Texture::NONE;
            if (image == Texture::NONE)
                continue;
            const auto at = std::find(images.begin(), images.end(), image);
            const uint32_t number = uint32_t(at - images.begin());
            if (at == images.end())
                images.push_back(image);
            image = number;
        }
    return images;
}

Appearance read_appearance(const Plan &plan, const TileSurface &surface, Task &task)
{
    const std::string folder = std::filesystem::path(cell_path(plan, plan.tiles.back()))
                                   .parent_path().native(); /* the last tile is a leaf */
    Appearance look;
    look.materials = read_materials(folder);
    const Vector<uint32_t> images = images_used(look, surface);
    look.materials.emplace_back();
    Vector<ImageHeader> heads;
    for (uint32_t number : images) {
        const std::string path = image_path(folder, number);
        std::ifstream file(path, std::ios::binary);
        if (!file)
            throw Error(GTX_ERROR_READ, "cannot read " + path);
        heads.push_back(read_header(file));
    }
    const uint32_t skipped = levels_to_skip(heads, plan.memory / 16);
    for (size_t i = 0; i < images.size(); ++i) {
        task.advance(double(i) / double(images.size()));
        look.images.push_back(read_image(image_path(folder, images[i]), skipped));
    }
    return look;
}

} // namespace gtx
