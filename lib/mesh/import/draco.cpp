/* Draco streams. Damaged ones often decode without complaint, so all of the result is checked. */
#include "mesh/import/draco.hpp"

#include <draco/attributes/attribute_octahedron_transform.h>
#include <draco/attributes/attribute_quantization_transform.h>
#include <draco/compression/attributes/normal_compression_utils.h>
#include <draco/compression/decode.h>
#include <draco/mesh/mesh.h>

namespace gtx {

/* What the decoder takes, with positions and normals: measured on meshes of 10^5 faces and more. */
constexpr uint64_t BYTES_PER_FACE = 64, BYTES_PER_POINT = 64;

static DracoRole role_of(draco::GeometryAttribute::Type type)
{
    switch (type) {
    case draco::GeometryAttribute::POSITION: return DracoRole::position;
    case draco::GeometryAttribute::NORMAL: return DracoRole::normal;
    case draco::GeometryAttribute::COLOR: return DracoRole::color;
    default: return DracoRole::other;
    }
}

static double full_value(draco::DataType type)
{
    switch (type) {
    case draco::DT_INT8: return 127;
    case draco::DT_UINT8: return 255;
    case draco::DT_INT16: return 32767;
    case draco::DT_UINT16: return 65535;
    default: return 1;
    }
}

/* Draco would take any byte of a damaged stream for a bool. */
static bool convert(const draco::PointAttribute &from, draco::AttributeValueIndex at, int count,
                    double values[4])
{
    if (from.data_type() != draco::DT_BOOL)
        return from.ConvertValue<double>(at, int8_t(count), values);
    for (int k = 0; k < count; ++k)
        values[k] = from.GetAddress(at)[k] != 0;
    return true;
}

static draco::AttributeTransformType transform_of(const draco::PointAttribute &from)
{
    const draco::AttributeTransformData *data = from.GetAttributeTransformData();
    return data ? data->transform_type() : draco::ATTRIBUTE_INVALID_TRANSFORM;
}

/* Whole steps become lengths, and folded squares directions, in floats as Draco does it; but here,
 * where no processor multiplies and adds at once, so that the bits are the same on all. */
static void dequantize(const draco::PointAttribute &from, DracoAttribute &to)
{
    draco::AttributeQuantizationTransform steps;
    if (!steps.InitFromAttribute(from) || steps.quantization_bits() < 1 ||
        steps.quantization_bits() > 30 || steps.min_values().size() < size_t(to.components))
        fail(GTX_ERROR_INPUT, "Draco attribute %u has no sound quantization", to.id);
    const float step = steps.range() / float((1u << steps.quantization_bits()) - 1);
    for (size_t i = 0; i < to.values.size(); ++i)
        to.values[i] = float(to.values[i]) * step + steps.min_value(int(i % to.components));
}

static void unfold(const draco::PointAttribute &from, DracoAttribute &to)
{
    draco::AttributeOctahedronTransform folds;
    draco::OctahedronToolBox square;
    if (!folds.InitFromAttribute(from) || to.components != 2 ||
        !square.SetQuantizationBits(folds.quantization_bits()))
        fail(GTX_ERROR_INPUT, "Draco attribute %u has no sound quantization", to.id);
    Vector<double> directions;
    for (size_t i = 0; i < to.values.size(); i += 2) {
        float direction[3];
        square.QuantizedOctahedralCoordsToUnitVector(int32_t(to.values[i]),
                                                     int32_t(to.values[i + 1]), direction);
        directions.insert(directions.end(), direction, direction + 3);
    }
    to.values = std::move(directions);
    to.components = 3;
}

static DracoAttribute read_attribute(const draco::Mesh &mesh, const draco::PointAttribute &from)
{
    DracoAttribute to;
    to.id = from.unique_id();
    to.role = role_of(from.attribute_type());
    to.components = from.num_components();
    to.full = full_value(from.data_type());
    int64_t item = int64_t(draco::DataTypeLength(from.data_type())) * to.components;
    bool sound = from.buffer() && item > 0 && from.byte_stride() >= item && from.byte_offset() >= 0;
    to.values.reserve(size_t(to.components) * mesh.num_points());
    for (draco::PointIndex p(0); sound && p < mesh.num_points(); ++p) {
        if (!from.is_mapping_identity() && p.value() >= from.indices_map_size()) {
            sound = false;
            break;
        }
        draco::AttributeValueIndex v = from.mapped_index(p);
        uint64_t at =
            uint64_t(from.byte_offset()) + uint64_t(v.value()) * uint64_t(from.byte_stride());
        double values[4];
        sound = at + uint64_t(item) <= from.buffer()->data_size() &&
                convert(from, v, to.components, values);
        /* Draco has divided normalised integers by their full value: callers want them raw. */
        for (int k = 0; k < to.components; ++k)
            to.values.push_back(from.normalized() ? values[k] * to.full : values[k]);
    }
    if (!sound)
        fail(GTX_ERROR_INPUT, "Draco attribute %u refers to values that are not there", to.id);
    switch (transform_of(from)) {
    case draco::ATTRIBUTE_QUANTIZATION_TRANSFORM: dequantize(from, to); break;
    case draco::ATTRIBUTE_OCTAHEDRON_TRANSFORM: unfold(from, to); break;
    default: break;
    }
    return to;
}

static DracoMesh checked(const draco::Mesh &mesh, bool with_uv, Task &task)
{
    DracoMesh out;
    out.points = mesh.num_points();
    out.triangles.reserve(mesh.num_faces());
    for (draco::FaceIndex f(0); f < mesh.num_faces(); ++f) {
        std::array<uint32_t, 3> corners;
        for (int k = 0; k < 3; ++k) {
            corners[k] = mesh.face(f)[k].value();
            if (corners[k] >= out.points)
                fail(GTX_ERROR_INPUT, "Draco face %u: point %u of %zu", f.value(), corners[k],
                     out.points);
        }
        out.triangles.push_back(corners);
    }
    for (int i = 0; i < mesh.num_attributes(); ++i) {
        const draco::PointAttribute *attribute = mesh.attribute(i);
        task.advance(0.5 + 0.5 * i / mesh.num_attributes());
        bool uv = attribute->attribute_type() == draco::GeometryAttribute::TEX_COORD;
        if ((!uv || with_uv) && attribute->num_components() <= 4)
            out.attributes.push_back(read_attribute(mesh, *attribute));
    }
    return out;
}

/* What may be left as the whole numbers that the stream has. */
static const draco::GeometryAttribute::Type left[] = {
    draco::GeometryAttribute::POSITION, draco::GeometryAttribute::NORMAL,
    draco::GeometryAttribute::TEX_COORD};

static std::unique_ptr<draco::Mesh> decode(std::string_view bytes, bool are_left)
{
    draco::DecoderBuffer buffer;
    buffer.Init(bytes.data(), bytes.size());
    draco::Decoder decoder;
    for (size_t i = 0; are_left && i < std::size(left); ++i)
        decoder.SetSkipAttributeTransform(left[i]);
    auto mesh = decoder.DecodeMeshFromBuffer(&buffer);
    if (!mesh.ok() || !mesh.value())
        fail(GTX_ERROR_INPUT, "the Draco data is damaged: %s",
             printable(mesh.status().error_msg_string()).c_str());
    return std::move(mesh).value();
}

/* Numbers that were whole before they were written had a type of their own, which is lost where
 * they are left. */
static bool has_lost_types(const draco::Mesh &mesh)
{
    for (int i = 0; i < mesh.num_attributes(); ++i) {
        const draco::PointAttribute &a = *mesh.attribute(i);
        if (std::count(std::begin(left), std::end(left), a.attribute_type()) &&
            transform_of(a) == draco::ATTRIBUTE_INVALID_TRANSFORM &&
            draco::IsDataTypeIntegral(a.data_type()))
            return true;
    }
    return false;
}

DracoMesh decode_draco(std::string_view bytes, bool with_uv, Task &task)
{
    draco::DecoderBuffer buffer;
    buffer.Init(bytes.data(), bytes.size());
    auto type = draco::Decoder::GetEncodedGeometryType(&buffer);
    if (type.ok() && type.value() == draco::POINT_CLOUD)
        fail(GTX_ERROR_UNSUPPORTED, "the Draco data is a point cloud: it has no faces");
    if (!type.ok() || type.value() != draco::TRIANGULAR_MESH)
        fail(GTX_ERROR_INPUT, "the Draco header is damaged");

    const DracoClaims claims = draco_claims(bytes);
    const uint64_t most = std::max(claims.faces, claims.points / 3);
    task.limits.require(GTX_LIMITED_TRIANGLES, "the Draco data", most);
    TakenMemory taken(size_t(BYTES_PER_FACE * claims.faces + BYTES_PER_POINT * claims.points));
    std::unique_ptr<draco::Mesh> mesh = decode(bytes, true);
    if (has_lost_types(*mesh)) {
        mesh.reset();
        mesh = decode(bytes, false);
    }
    return checked(*mesh, with_uv, task);
}

Mesh import_draco(const ModelFile &file, Task &task)
{
    DracoMesh draco = decode_draco(file.bytes, false, task);
    const DracoAttribute *by_role[3] = {};
    for (const DracoAttribute &a : draco.attributes)
        if (a.role != DracoRole::other && !by_role[int(a.role)])
            by_role[int(a.role)] = &a;
    const DracoAttribute *position = by_role[0], *normal = by_role[1], *color = by_role[2];
    if (!position || position->components != 3)
        fail(GTX_ERROR_INPUT, "the Draco data has no positions of three components");

    VertexMesh mesh;
    mesh.triangles = std::move(draco.triangles);
    mesh.positions.reserve(draco.points);
    for (size_t i = 0; i < draco.points; ++i) {
        const double *p = &position->values[3 * i];
        mesh.positions.push_back({p[0], p[1], p[2]});
        if (normal && normal->components == 3) {
            const double *n = &normal->values[3 * i];
            mesh.normals.push_back(Vec3f(Vec3d(n[0], n[1], n[2])));
        }
        if (color && color->components >= 3) {
            const double *c = &color->values[size_t(color->components) * i];
            double alpha = color->components == 4 ? c[3] / color->full : 1;
            mesh.colors.push_back({to_byte(c[0] / color->full), to_byte(c[1] / color->full),
                                   to_byte(c[2] / color->full), to_byte(alpha)});
        }
    }
    return by_corner(std::move(mesh));
}

} // namespace gtx
