/* The glTF document of an export: one mesh a level, a material for each page and kind of sides.
 * Inside of the room. */
#pragma once

#include "export/draco.hpp"
#include "export/export.hpp"
#include "export/glb.hpp"
#include "export/ktx2.hpp"

namespace gtx {

/* Triangles of one mesh that share a material. */
struct ExportPrimitive {
    uint32_t page;
    bool two_sided;
    unsigned attributes[4], indices; /* POSITION, NORMAL, TANGENT, TEXCOORD_0 */
    unsigned stream = GlbBuffer::NO_VIEW; /* of Draco, whose attributes have these numbers */
};

/* A level of the document. */
struct DocumentLevel {
    uint32_t number;               /* of the LOD mesh */
    double error;
    Vector<ExportPrimitive> primitives;
    unsigned first_normal_image;   /* of its pages */
};

class Document {
public:
    Document(const gtx_asset *asset, const ExportOptions &options, Task &task)
        : asset_(asset), task_(task), meshopt_(options.meshopt), draco_(options.draco),
          ktx2_(options.ktx2), buffer_(options.meshopt)
    {
        gtx_get_info(asset, &info_);
    }
    void add_level(uint32_t number, const ExportMesh &mesh, unsigned coarser);
    void add_collision(uint32_t number, const gtx_lod_mesh &lod);
    void add_maps();
    void set_asset(std::string_view bytes);
    Bytes file();
    size_t images() const { return image_views_.size(); }

private:
    unsigned add_images(PageImages &pages, TexelKind kind);
    unsigned add_image(const PageImages &pages, const uint8_t *texels, TexelKind kind);
    Vector<uint8_t> vertex_bytes(const ExportMesh &mesh) const;
    ExportPrimitive add_primitive(const ExportMesh &mesh, size_t first, size_t last, unsigned view);
    void add_stream(ExportPrimitive &to, const gtx_lod_mesh &lod, Vector<DracoValues> &attributes,
                    size_t vertices, const Vector<std::array<uint32_t, 3>> &triangles);
    ExportPrimitive add_draco(const ExportMesh &mesh, size_t first, size_t last);
    double screen_coverage(size_t level) const;
    bool is_bright() const { return maps_.emission.pages && info_.emission_scale > 1; }
    void write_surface(Json &out, uint32_t page) const;
    void write_emission(Json &out, uint32_t page) const;
    void write_material(Json &out, const DocumentLevel &level, const ExportPrimitive &p) const;
    void write_materials(Json &out) const;
    void write_images(Json &out) const;
    void write_meshes(Json &out) const;
    void write_nodes(Json &out) const;
    void write_extensions(Json &out) const;

    const gtx_asset *asset_;
    gtx_info info_;
    Task &task_;
    const bool meshopt_, draco_, ktx2_;
    GlbBuffer buffer_;
    Vector<DocumentLevel> levels_;
    Vector<unsigned> image_views_;
    SurfaceImages maps_;
    unsigned color_image_ = 0, material_image_ = 0, emission_image_ = 0; /* of the first page */
    bool has_asset_ = false, is_collision_ = false;
    unsigned asset_view_ = 0;
};

} // namespace gtx
