/* Binary PLY in pieces: vertices are looked up where they lie, faces come one after another. */
#include "mesh/import/ply.hpp"
#include "mesh/stream/paged.hpp"

#include "base/bytes.h"

#include <algorithm>
#include <cmath>

namespace gtx {

namespace {

/* A header is longer than this in no file that was ever seen. */
constexpr size_t MAX_HEADER = 1 << 16;

/* The values of a row that a corner is made of; type and place, or `has` is false. */
struct Field {
    bool has = false;
    PlyType type = PlyType::f32;
    unsigned offset = 0;
};
enum { X, Y, Z, NX, NY, NZ, RED, GREEN, BLUE, ALPHA, FIELDS };
constexpr const char *NAMES[FIELDS][2] = {
    {"x", "x"}, {"y", "y"}, {"z", "z"},
    {"nx", "normal_x"}, {"ny", "normal_y"}, {"nz", "normal_z"},
    {"red", "diffuse_red"}, {"green", "diffuse_green"}, {"blue", "diffuse_blue"},
    {"alpha", "diffuse_alpha"},
};

double number(const uint8_t *bytes, PlyType type, bool big_endian)
{
    uint8_t turned[8];
    if (big_endian) {
        std::reverse_copy(bytes, bytes + ply_size(type), turned);
        bytes = turned;
    }
    switch (type) {
    case PlyType::i8: return int8_t(bytes[0]);
    case PlyType::u8: return bytes[0];
    case PlyType::i16: return int16_t(gtx_load_u16(bytes));
    case PlyType::u16: return gtx_load_u16(bytes);
    case PlyType::i32: return int32_t(gtx_load_u32(bytes));
    case PlyType::u32: return gtx_load_u32(bytes);
    case PlyType::f32: return double(gtx_load_f32(bytes));
    case PlyType::f64: return gtx_load_f64(bytes);
    }
    return 0;
}

bool is_corner_list(const PlyProperty &p)
{
    return p.is_list && (p.name == "vertex_indices" || p.name == "vertex_index");
}

class PlyStream : public TriangleStream {
public:
    PlyStream(const std::string &path, Task &task) : file_(path, task), task_(task)
    {
        Bytes head(size_t(std::min<uint64_t>(file_.size(), MAX_HEADER)), 0);
        file_.read(0, &head[0], head.size());
        header_ = read_ply_header(head);
    }
    /* Whether rows of vertices are all alike, and nothing but faces follows that counts. */
    bool suits();
    CornerTraits traits() const override
    {
        CornerTraits traits;
        for (int k = X; k <= Z; ++k)
            traits.doubles |= field_[k].type == PlyType::f64 || field_[k].type == PlyType::i32 ||
                              field_[k].type == PlyType::u32;
        traits.normals = field_[NX].has && field_[NY].has && field_[NZ].has;
        traits.colors = field_[RED].has && field_[GREEN].has && field_[BLUE].has;
        return traits;
    }
    void read(const TriangleSink &sink) override;

private:
    void find_fields(const PlyElement &element);
    double value(uint64_t &at, PlyType type);
    Corner corner(uint64_t vertex);
    void face(uint64_t row, uint64_t &at, const TriangleSink &sink);

    PagedFile file_;
    Task &task_;
    PlyHeader header_;
    const PlyElement *vertices_ = nullptr, *faces_ = nullptr;
    uint64_t first_vertex_ = 0, first_face_ = 0;
    unsigned row_ = 0;           /* bytes of a vertex */
    Field field_[FIELDS];
    Vector<uint64_t> indices_;
    Vector<Vec3d> polygon_;
    Vector<std::array<uint32_t, 3>> cut_;
};

void PlyStream::find_fields(const PlyElement &element)
{
    for (const PlyProperty &p : element.properties) {
        for (int f = 0; f < FIELDS; ++f)
            if (p.name == NAMES[f][0] || p.name == NAMES[f][1])
                field_[f] = {true, p.type, row_};
        row_ += ply_size(p.type);
    }
}

bool PlyStream::suits()
{
    uint64_t at = header_.size;
    if (header_.ascii)
        return false;
    for (const PlyElement &e : header_.elements) {
        const bool lists = std::any_of(e.properties.begin(), e.properties.end(),
                                       [](const PlyProperty &p) { return p.is_list; });
        uint64_t row = 0;
        for (const PlyProperty &p : e.properties)
            row += ply_size(p.is_list ? p.count_type : p.type);
        if (row && e.count > (file_.size() - at) / row)
            fail(GTX_ERROR_INPUT, "%llu rows of element '%s' do not fit the file",
                 (unsigned long long)e.count, printable(e.name).c_str());
        if (e.name == "vertex" && !vertices_ && !lists) {
            vertices_ = &e;
            first_vertex_ = at;
            find_fields(e);
        } else if (e.name == "face" && vertices_ &&
                   std::any_of(e.properties.begin(), e.properties.end(), is_corner_list)) {
            faces_ = &e;
            first_face_ = at;
            break;
        } else if (lists) {
            return false;
        }
        at += e.count * row;
    }
    return vertices_ && faces_ && field_[X].has && field_[Y].has && field_[Z].has;
}

double PlyStream::value(uint64_t &at, PlyType type)
{
    uint8_t bytes[8];
    file_.read(at, bytes, ply_size(type));
    at += ply_size(type);
    return number(bytes, type, header_.big_endian);
}

Corner PlyStream::corner(uint64_t vertex)
{
    constexpr size_t FEW = 256;
    uint8_t bytes[FEW];
    double v[FIELDS] = {};
    const uint64_t at = first_vertex_ + vertex * row_;
    if (row_ <= FEW)
        file_.read(at, bytes, row_);
    for (int f = 0; f < FIELDS; ++f) {
        if (!field_[f].has)
            continue;
        if (row_ > FEW)
            file_.read(at + field_[f].offset, bytes, ply_size(field_[f].type));
        v[f] = number(bytes + (row_ > FEW ? 0 : field_[f].offset), field_[f].type,
                      header_.big_endian);
    }
    auto channel = [&](int f) { return to_byte(v[f] / ply_full(field_[f].type)); };
    return {{v[X], v[Y], v[Z]},
            {float(v[NX]), float(v[NY]), float(v[NZ])},
            {channel(RED), channel(GREEN), channel(BLUE),
             field_[ALPHA].has ? channel(ALPHA) : uint8_t(255)}};
}

/* Polygons are cut as the importer cuts them. */
void PlyStream::face(uint64_t row, uint64_t &at, const TriangleSink &sink)
{
    for (const PlyProperty &p : faces_->properties) {
        const double length = p.is_list ? value(at, p.count_type) : 1;
        if (!(length >= 0) || length > double(file_.size() - at) / ply_size(p.type))
            fail(GTX_ERROR_INPUT, "face %llu: a list of %.0f items does not fit the file",
                 (unsigned long long)row, length);
        if (!is_corner_list(p)) {
            at += uint64_t(length) * ply_size(p.type);
            continue;
        }
        indices_.clear();
        for (uint64_t n = uint64_t(length); n > 0; --n) {
            const double index = value(at, p.type);
            if (!(index >= 0 && index < double(vertices_->count) && index == std::floor(index)))
                fail(GTX_ERROR_INPUT, "face %llu: index %.17g of %llu vertices",
                     (unsigned long long)row, index, (unsigned long long)vertices_->count);
            indices_.push_back(uint64_t(index));
        }
    }
    cut_.assign(indices_.size() == 3 ? 1 : 0, {0, 1, 2});
    if (indices_.size() > 3) {
        polygon_.clear();
        for (uint64_t v : indices_)
            polygon_.push_back(corner(v).position);
        triangulate(polygon_, cut_);
    }
    for (const auto &t : cut_)
        sink({corner(indices_[t[0]]), corner(indices_[t[1]]), corner(indices_[t[2]])});
}

void PlyStream::read(const TriangleSink &sink)
{
    uint64_t at = first_face_;
    for (uint64_t row = 0; row < faces_->count; ++row) {
        if (row % 0x8000 == 0)
            task_.advance(double(row) / double(faces_->count));
        face(row, at, sink);
    }
}

} // namespace

std::unique_ptr<TriangleStream> open_ply_stream(const std::string &path, Task &task)
{
    std::ifstream file(path, std::ios::binary);
    char magic[4] = {};
    file.read(magic, sizeof magic);
    const std::string_view head(magic, sizeof magic);
    if (head != "ply\n" && head != "ply\r")
        return nullptr;
    auto stream = std::make_unique<PlyStream>(path, task);
    return stream->suits() ? std::move(stream) : nullptr;
}

} // namespace gtx
