/* The JSON of an export. */
#include "export/document.hpp"

#include "mesh/material/srgb.hpp"

#include <algorithm>
#include <cmath>

namespace gtx {

template <class Write> static void write_object(Json &out, const char *name, Write write)
{
    gtx_json_begin_object(&out, name);
    write();
    gtx_json_end_object(&out);
}

template <class Write> static void write_array(Json &out, const char *name, Write write)
{
    gtx_json_begin_array(&out, name);
    write();
    gtx_json_end_array(&out);
}

static void write_numbers(Json &out, const char *name, std::initializer_list<double> numbers)
{
    write_array(out, name, [&] {
        for (double number : numbers)
            gtx_json_number(&out, nullptr, number);
    });
}

/* ---- materials ---- */

static void write_texture(Json &out, const char *name, unsigned image)
{
    write_object(out, name, [&] { gtx_json_integer(&out, "index", image); });
}

/* A map is an image, a constant, or not there. */
static bool is_image(const PageImages &map)
{
    return map.pages && !map.constant;
}

static double byte_share(uint8_t byte)
{
    return double(byte) / 255;
}

void Document::write_surface(Json &out, uint32_t page) const
{
    const PageImages &color = maps_.color, &material = maps_.material;
    if (is_image(color))
        write_texture(out, "baseColorTexture", color_image_ + page);
    else if (color.pages)
        write_numbers(out, "baseColorFactor",
                      {double(srgb_to_linear(color.first[0])),
                       double(srgb_to_linear(color.first[1])),
                       double(srgb_to_linear(color.first[2])), 1});
    if (is_image(material)) {
        write_texture(out, "metallicRoughnessTexture", material_image_ + page);
    } else { /* roughness 1 is the default */
        gtx_json_number(&out, "metallicFactor", material.pages ? byte_share(material.first[2]) : 0);
        if (material.pages)
            gtx_json_number(&out, "roughnessFactor", byte_share(material.first[1]));
    }
}

/* Factors are at most 1: what is brighter is a strength. */
void Document::write_emission(Json &out, uint32_t page) const
{
    const PageImages &map = maps_.emission;
    const double scale = double(info_.emission_scale), factor = std::min(scale, 1.);
    if (is_image(map))
        write_texture(out, "emissiveTexture", emission_image_ + page);
    double light[3];
    for (size_t k = 0; k < 3; ++k)
        light[k] = factor * (is_image(map) ? 1 : double(srgb_to_linear(map.first[k])));
    write_numbers(out, "emissiveFactor", {light[0], light[1], light[2]});
}

void Document::write_material(Json &out, const DocumentLevel &level,
                              const ExportPrimitive &p) const
{
    write_object(out, nullptr, [&] {
        gtx_json_string(&out, "name", ("level " + std::to_string(level.number) + " page " +
                                       std::to_string(p.page)).c_str());
        write_object(out, "pbrMetallicRoughness", [&] { write_surface(out, p.page); });
        write_texture(out, "normalTexture", level.first_normal_image + p.page);
        if (is_image(maps_.material))
            write_texture(out, "occlusionTexture", material_image_ + p.page);
        if (maps_.emission.pages)
            write_emission(out, p.page);
        if (p.two_sided)
            gtx_json_bool(&out, "doubleSided", true);
        if (maps_.unlit || is_bright())
            write_object(out, "extensions", [&] {
                if (maps_.unlit)
                    write_object(out, "KHR_materials_unlit", [] {});
                if (is_bright())
                    write_object(out, "KHR_materials_emissive_strength", [&] {
                        gtx_json_number(&out, "emissiveStrength", double(info_.emission_scale));
                    });
            });
    });
}

/* Textures and images are one to one, and all look in the same way: there is nothing beyond a
 * page. */
void Document::write_images(Json &out) const
{
    constexpr unsigned CLAMP = 33071, LINEAR = 9729, LINEAR_MIPMAP_LINEAR = 9987;
    write_array(out, "samplers", [&] {
        write_object(out, nullptr, [&] {
            gtx_json_integer(&out, "magFilter", LINEAR);
            gtx_json_integer(&out, "minFilter", LINEAR_MIPMAP_LINEAR);
            gtx_json_integer(&out, "wrapS", CLAMP);
            gtx_json_integer(&out, "wrapT", CLAMP);
        });
    });
    write_array(out, "textures", [&] {
        for (unsigned i = 0; i < image_views_.size(); ++i)
            write_object(out, nullptr, [&] {
                gtx_json_integer(&out, "sampler", 0);
                if (!ktx2_) {
                    gtx_json_integer(&out, "source", i);
                    return;
                }
                write_object(out, "extensions", [&] {
                    write_object(out, "KHR_texture_basisu",
                                 [&] { gtx_json_integer(&out, "source", i); });
                });
            });
    });
    write_array(out, "images", [&] {
        for (unsigned view : image_views_)
            write_object(out, nullptr, [&] {
                gtx_json_integer(&out, "bufferView", view);
                gtx_json_string(&out, "mimeType", ktx2_ ? "image/ktx2" : "image/png");
            });
    });
}

void Document::write_materials(Json &out) const
{
    write_array(out, "materials", [&] {
        for (const DocumentLevel &level : levels_)
            for (const ExportPrimitive &p : level.primitives)
                write_material(out, level, p);
    });
    write_images(out);
}

/* ---- meshes and nodes ---- */

static const char *const attribute_names[] = {"POSITION", "NORMAL", "TANGENT", "TEXCOORD_0"};

static void write_stream(Json &out, const ExportPrimitive &p, size_t attributes)
{
    write_object(out, "extensions", [&] {
        write_object(out, "KHR_draco_mesh_compression", [&] {
            gtx_json_integer(&out, "bufferView", p.stream);
            write_object(out, "attributes", [&] {
                for (size_t i = 0; i < attributes; ++i)
                    gtx_json_integer(&out, attribute_names[i], i);
            });
        });
    });
}

void Document::write_meshes(Json &out) const
{
    unsigned material = 0;
    write_array(out, "meshes", [&] {
        for (const DocumentLevel &level : levels_)
            write_object(out, nullptr, [&] {
                gtx_json_string(&out, "name",
                                ("level " + std::to_string(level.number)).c_str());
                write_array(out, "primitives", [&] {
                    for (const ExportPrimitive &p : level.primitives)
                        write_object(out, nullptr, [&] {
                            write_object(out, "attributes", [&] {
                                for (size_t i = 0; i < (is_collision_ ? 1 : 4); ++i)
                                    gtx_json_integer(&out, attribute_names[i],
                                                     p.attributes[i]);
                            });
                            gtx_json_integer(&out, "indices", p.indices);
                            if (!is_collision_)
                                gtx_json_integer(&out, "material", material++);
                            if (p.stream != GlbBuffer::NO_VIEW)
                                write_stream(out, p, is_collision_ ? 1 : 4);
                        });
                });
            });
    });
}

/* The least share of the screen that a level is for: that at which the error of the next one is
 * half a pixel of a screen of 1080 lines, as gtx_view.max_error has it. */
double Document::screen_coverage(size_t level) const
{
    constexpr double PIXELS = 0.5, LINES = 1080;
    if (level + 1 >= levels_.size())
        return 0;
    double diagonal = 0;
    for (int k = 0; k < 3; ++k) {
        const double side = double(info_.bounds_max[k]) - double(info_.bounds_min[k]);
        diagonal += side * side;
    }
    const double error = levels_[level + 1].error;
    const double share = error > 0 ? PIXELS * std::sqrt(diagonal) / (LINES * error) : 1;
    return std::min(share * share, 1.);
}

/* The first node is the finest level, and the asset; MSFT_lod names the others. */
void Document::write_nodes(Json &out) const
{
    const bool several = levels_.size() > 1;
    const double unit = double(info_.unit), *anchor = info_.anchor;
    write_array(out, "nodes", [&] {
        for (size_t i = 0; i < levels_.size(); ++i)
            write_object(out, nullptr, [&] {
                gtx_json_integer(&out, "mesh", i);
                if (anchor[0] != 0 || anchor[1] != 0 || anchor[2] != 0)
                    write_numbers(out, "translation",
                                  {unit * anchor[0], unit * anchor[1], unit * anchor[2]});
                if (unit != 1)
                    write_numbers(out, "scale", {unit, unit, unit});
                if (i || (!several && !has_asset_))
                    return;
                write_object(out, "extensions", [&] {
                    if (has_asset_)
                        write_object(out, "GTX_geometry_texture",
                                     [&] { gtx_json_integer(&out, "asset", 0); });
                    if (several)
                        write_object(out, "MSFT_lod", [&] {
                            write_array(out, "ids", [&] {
                                for (size_t k = 1; k < levels_.size(); ++k)
                                    gtx_json_integer(&out, nullptr, k);
                            });
                        });
                });
                if (several)
                    write_object(out, "extras", [&] {
                        write_array(out, "MSFT_screencoverage", [&] {
                            for (size_t k = 0; k < levels_.size(); ++k)
                                gtx_json_number(&out, nullptr, screen_coverage(k));
                        });
                    });
            });
    });
}

void Document::write_extensions(Json &out) const
{
    const struct {
        const char *name;
        bool used, required = false;
    } extensions[] = {{"GTX_geometry_texture", has_asset_},
                      {"MSFT_lod", levels_.size() > 1},
                      {"KHR_materials_unlit", maps_.unlit},
                      {"KHR_materials_emissive_strength", is_bright()},
                      {"KHR_mesh_quantization", meshopt_ && !is_collision_, true},
                      {"EXT_meshopt_compression", meshopt_, true},
                      {"KHR_draco_mesh_compression", draco_, true},
                      {"KHR_texture_basisu", ktx2_ && !is_collision_, true}};
    if (std::any_of(std::begin(extensions), std::end(extensions),
                    [](const auto &e) { return e.used; }))
        write_array(out, "extensionsUsed", [&] {
            for (const auto &e : extensions)
                if (e.used)
                    gtx_json_string(&out, nullptr, e.name);
        });
    if (std::any_of(std::begin(extensions), std::end(extensions),
                    [](const auto &e) { return e.used && e.required; }))
        write_array(out, "extensionsRequired", [&] {
            for (const auto &e : extensions)
                if (e.used && e.required)
                    gtx_json_string(&out, nullptr, e.name);
        });
    if (has_asset_)
        write_object(out, "extensions", [&] {
            write_object(out, "GTX_geometry_texture", [&] {
                write_array(out, "assets", [&] {
                    write_object(out, nullptr,
                                 [&] { gtx_json_integer(&out, "bufferView", asset_view_); });
                });
            });
        });
}

Bytes Document::file()
{
    Json out(gtx_allocator{});
    write_object(out, nullptr, [&] {
        write_object(out, "asset", [&] {
            gtx_json_string(&out, "version", "2.0");
            gtx_json_string(&out, "generator", "geotex");
        });
        write_extensions(out);
        gtx_json_integer(&out, "scene", 0);
        write_array(out, "scenes", [&] {
            write_object(out, nullptr, [&] {
                write_array(out, "nodes", [&] { gtx_json_integer(&out, nullptr, 0); });
            });
        });
        write_nodes(out);
        write_meshes(out);
        if (!is_collision_)
            write_materials(out);
        buffer_.describe(out);
    });
    return buffer_.file(out);
}

} // namespace gtx
