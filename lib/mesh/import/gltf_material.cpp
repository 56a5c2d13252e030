/* glTF materials: metal and roughness, and of the extensions those that a surface can show. */
#include "mesh/import/gltf_material.hpp"
#include "base/exact.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace gtx {

using nlohmann::json;

/* ---- checked members ---- */

namespace {
/* An object of the document and its place, for messages; null where it is absent. */
struct Item {
    const json *object = nullptr;
    std::string where;

    explicit operator bool() const { return object != nullptr; }
    [[noreturn]] void complain(const char *name, const char *what) const
    {
        fail(GTX_ERROR_INPUT, "%.150s.%s is not %s", where.c_str(), name, what);
    }
    const json *find(const char *name) const
    {
        if (!object)
            return nullptr;
        auto found = object->find(name);
        return found == object->end() ? nullptr : &*found;
    }
    Item member(const char *name) const
    {
        const json *found = find(name);
        if (found && !found->is_object())
            complain(name, "an object");
        return {found, where + "." + name};
    }
    Item extension(const char *name) const { return member("extensions").member(name); }
    float number(const char *name, float otherwise, float low, float high) const
    {
        const json *found = find(name);
        if (found && !found->is_number())
            complain(name, "a number");
        return found ? float(std::clamp(found->get<double>(), double(low), double(high)))
                     : otherwise;
    }
    int index(const char *name, int otherwise) const
    {
        const json *found = find(name);
        if (found && (!found->is_number_unsigned() || found->get<uint64_t>() > 0x7fffffff))
            complain(name, "an index");
        return found ? found->get<int>() : otherwise;
    }
    bool flag(const char *name) const
    {
        const json *found = find(name);
        if (found && !found->is_boolean())
            complain(name, "a boolean");
        return found && found->get<bool>();
    }
    std::string text(const char *name) const
    {
        const json *found = find(name);
        if (found && !found->is_string())
            complain(name, "a string");
        return found ? found->get<std::string>() : std::string();
    }
    /* Leaves `out` as it is where the member is absent. */
    void numbers(const char *name, size_t count, float low, float high, float *out) const
    {
        const json *found = find(name);
        if (!found)
            return;
        if (!found->is_array() || found->size() != count)
            complain(name, ("an array of " + std::to_string(count)).c_str());
        for (size_t i = 0; i < count; ++i) {
            if (!(*found)[i].is_number())
                complain(name, "an array of numbers");
            out[i] = float(std::clamp((*found)[i].get<double>(), double(low), double(high)));
        }
    }
};

/* The objects of one of the document's arrays. */
struct List {
    const json *array = nullptr;
    const char *name;

    List(const json &root, const char *name) : name(name)
    {
        auto found = root.find(name);
        if (found == root.end())
            return;
        if (!found->is_array())
            fail(GTX_ERROR_INPUT, "%s is not an array", name);
        array = &*found;
    }
    size_t size() const { return array ? array->size() : 0; }
    Item at(size_t i, const std::string &user) const
    {
        if (i >= size())
            fail(GTX_ERROR_INPUT, "%.150s: there is no %s[%zu]", user.c_str(), name, i);
        Item out = {&(*array)[i], std::string(name) + "[" + std::to_string(i) + "]"};
        if (!out.object->is_object())
            fail(GTX_ERROR_INPUT, "%s is not an object", out.where.c_str());
        return out;
    }
};

struct Reader {
    List materials, textures, samplers, images;
    GltfMaterials out;

    explicit Reader(const json &root)
        : materials(root, "materials"), textures(root, "textures"), samplers(root, "samplers"),
          images(root, "images") {}

    int image_of(const Item &texture) const;
    Texture texture(const Item &info, GltfMaterial &material, float glossiness = -1);
    void metal_rough(const Item &from, GltfMaterial &to);
    void specular_gloss(const Item &from, GltfMaterial &to);
    GltfMaterial material(const Item &from);
};
} // namespace

/* ---- textures ---- */

static const float FAR = 1e6f; /* beyond it, texture coordinates have no digits left */

static Wrap wrap_of(int mode)
{
    return mode == 33071 ? Wrap::CLAMP : mode == 33648 ? Wrap::MIRROR : Wrap::REPEAT;
}

/* The plain image where there is one: what extensions offer beside it is the same, packed. */
int Reader::image_of(const Item &texture) const
{
    int image = texture.index("source", -1);
    for (const char *name : {"EXT_texture_webp", "EXT_texture_avif", "KHR_texture_basisu"})
        if (image < 0)
            image = texture.extension(name).index("source", -1);
    if (image >= 0)
        images.at(size_t(image), texture.where);
    return image;
}

/* KHR_texture_transform: uv' = T R S uv; R turns clockwise, as v points down. */
static int transform_of(const Item &info, Texture &out)
{
    const Item from = info.extension("KHR_texture_transform");
    float offset[2] = {0, 0}, scale[2] = {1, 1};
    from.numbers("offset", 2, -FAR, FAR, offset);
    from.numbers("scale", 2, -FAR, FAR, scale);
    const double angle = from.number("rotation", 0, -FAR, FAR);
    const float c = float(gtx_cos(angle)), s = float(gtx_sin(angle));
    const float rows[6] = {c * scale[0], s * scale[1], offset[0],
                           -s * scale[0], c * scale[1], offset[1]};
    std::copy_n(rows, 6, out.transform);
    return from.index("texCoord", info.index("texCoord", 0));
}

Texture Reader::texture(const Item &info, GltfMaterial &material, float glossiness)
{
    constexpr size_t MAX_SETS = 2;
    Texture made;
    if (!info)
        return made;
    const int number = info.index("index", -1);
    if (number < 0)
        fail(GTX_ERROR_INPUT, "%.150s has no index", info.where.c_str());
    const Item texture = textures.at(size_t(number), info.where);
    const int set = transform_of(info, made), sampler = texture.index("sampler", -1);
    const GltfImage image = {image_of(texture), glossiness};
    if (sampler >= 0) {
        const Item modes = samplers.at(size_t(sampler), texture.where);
        made.wrap[0] = wrap_of(modes.index("wrapS", 0));
        made.wrap[1] = wrap_of(modes.index("wrapT", 0));
    }
    auto &sets = material.sets;
    size_t slot = size_t(std::find(sets.begin(), sets.end(), set) - sets.begin());
    if (image.number < 0) {
        material.warnings.insert({GTX_WARNING_IGNORED_TEXTURE,
                                  texture.where + " has no image: ignored"});
    } else if (slot == sets.size() && slot == MAX_SETS) {
        material.warnings.insert({GTX_WARNING_IGNORED_TEXTURE,
                                  info.where + " needs a third set of coordinates: ignored"});
    } else {
        if (slot == sets.size())
            sets.push_back(set);
        auto found = std::find(out.images.begin(), out.images.end(), image);
        made.image = uint32_t(found - out.images.begin());
        if (found == out.images.end())
            out.images.push_back(image);
        made.set = uint8_t(slot);
    }
    return made;
}

/* ---- materials ---- */

void Reader::metal_rough(const Item &from, GltfMaterial &to)
{
    from.numbers("baseColorFactor", 4, 0, 1, to.look.color);
    to.look.color_map = texture(from.member("baseColorTexture"), to);
    to.look.metallic = from.number("metallicFactor", 1, 0, 1);
    to.look.roughness = from.number("roughnessFactor", 1, 0, 1);
    to.look.metal_rough_map = texture(from.member("metallicRoughnessTexture"), to);
}

/* KHR_materials_pbrSpecularGlossiness. Its specular colour has no place here. */
void Reader::specular_gloss(const Item &from, GltfMaterial &to)
{
    const float glossiness = from.number("glossinessFactor", 1, 0, 1);
    from.numbers("diffuseFactor", 4, 0, 1, to.look.color);
    to.look.color_map = texture(from.member("diffuseTexture"), to);
    to.look.metal_rough_map = texture(from.member("specularGlossinessTexture"), to, glossiness);
    to.look.metallic = 0;
    to.look.roughness = to.look.metal_rough_map.used() ? 1 : 1 - glossiness;
    to.warnings.insert({GTX_WARNING_APPROXIMATED, "specular-glossiness materials are approximated: "
                                                  "diffuse colour and roughness"});
}

/* Extensions of a material that are read, or change nothing where they are not. */
static bool is_read(const std::string &extension)
{
    for (const char *name : {"KHR_materials_emissive_strength", "KHR_materials_unlit",
                             "KHR_materials_pbrSpecularGlossiness"})
        if (extension == name)
            return true;
    return false;
}

GltfMaterial Reader::material(const Item &from)
{
    GltfMaterial to;
    Material &look = to.look;
    if (const Item glossy = from.extension("KHR_materials_pbrSpecularGlossiness"))
        specular_gloss(glossy, to);
    else
        metal_rough(from.member("pbrMetallicRoughness"), to);

    const Item normal = from.member("normalTexture"), occlusion = from.member("occlusionTexture");
    look.normal_map = texture(normal, to);
    look.normal_scale = normal.number("scale", 1, -1000, 1000);
    look.occlusion_map = texture(occlusion, to);
    look.occlusion_strength = occlusion.number("strength", 1, 0, 1);

    const float strength = from.extension("KHR_materials_emissive_strength")
                               .number("emissiveStrength", 1, 0, 65504);
    from.numbers("emissiveFactor", 3, 0, 1, look.emission);
    const float *e = look.emission;
    if (e[0] > 0 || e[1] > 0 || e[2] > 0)
        look.emission_map = texture(from.member("emissiveTexture"), to);
    for (float &channel : look.emission)
        channel *= strength;

    const std::string alpha = from.text("alphaMode");
    if (alpha == "MASK")
        look.alpha_cutoff = from.number("alphaCutoff", 0.5f, 0, FAR);
    if (alpha == "BLEND")
        to.warnings.insert({GTX_WARNING_APPROXIMATED, "blended materials are drawn opaque"});
    look.unlit = bool(from.extension("KHR_materials_unlit"));
    to.two_sided = from.flag("doubleSided");
    if (const Item extensions = from.member("extensions"))
        for (const auto &item : extensions.object->items())
            if (!is_read(item.key()))
                to.warnings.insert({GTX_WARNING_IGNORED_MATERIAL,
                                    "of materials, " + printable(item.key()) + " was ignored"});
    return to;
}

GltfMaterials read_gltf_materials(const json &root)
{
    Reader reader(root);
    for (size_t i = 0; i < reader.materials.size(); ++i) {
        GltfMaterial material = reader.material(reader.materials.at(i, "materials"));
        reader.out.materials.push_back(std::move(material));
    }
    return std::move(reader.out);
}

} // namespace gtx
