/* Cell files: the triangles of one tile, with all attributes of their corners. */
#include "world/cell.hpp"

#include "base/bytes.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>

namespace gtx {

static constexpr char MAGIC[] = "gtxcell1";
static constexpr size_t AT_ONCE = 4096; /* triangles */

std::string CellHeader::bytes() const
{
    uint8_t out[BYTES] = {};
    std::memcpy(out, MAGIC, 8);
    gtx_store_u32(out + 8, traits.doubles | traits.normals << 1 | traits.colors << 2 |
                               traits.textured << 3);
    gtx_store_u64(out + 16, count);
    gtx_store_u64(out + 24, hash);
    gtx_store_u64(out + 32, key);
    gtx_store_f64(out + 40, deviation);
    for (int k = 0; k < 3; ++k) {
        gtx_store_f64(out + 48 + 8 * k, low[k]);
        gtx_store_f64(out + 72 + 8 * k, high[k]);
    }
    return std::string(reinterpret_cast<char *>(out), BYTES);
}

void CellHeader::add(const Corners3 &corners)
{
    ++count;
    for (const Corner &c : corners)
        add(c.position);
}

void CellHeader::add(const Vec3d &p)
{
    for (int k = 0; k < 3; ++k) {
        low[k] = std::min(low[k], p[k]);
        high[k] = std::max(high[k], p[k]);
    }
}

bool CellHeader::touches(const CellHeader &other) const
{
    bool touch = true;
    for (int k = 0; k < 3; ++k)
        touch = touch && low[k] <= other.high[k] && other.low[k] <= high[k];
    return touch;
}

static bool is_near(const Vec3d &p) /* no NaN is */
{
    return std::abs(p.x) <= FARTHEST && std::abs(p.y) <= FARTHEST && std::abs(p.z) <= FARTHEST;
}

bool are_near(const Corners3 &corners)
{
    return is_near(corners[0].position) && is_near(corners[1].position) &&
           is_near(corners[2].position);
}

void CellWriter::add(const Corners3 &corners)
{
    const size_t at = bytes_.size();
    header.add(corners);
    bytes_.resize(at + 3 * header.traits.bytes());
    encode_triangle(header.traits, corners, reinterpret_cast<uint8_t *>(&bytes_[at]));
}

const std::string &CellWriter::finish()
{
    header.hash = gtx_hash_bytes(bytes_.data() + CellHeader::BYTES,
                                 bytes_.size() - CellHeader::BYTES);
    bytes_.replace(0, CellHeader::BYTES, header.bytes());
    return bytes_;
}

void encode_triangle(const CornerTraits &traits, const Corners3 &corners, uint8_t *out)
{
    for (const Corner &c : corners) {
        for (int k = 0; k < 3; ++k) {
            if (traits.doubles)
                gtx_store_f64(out, c.position[k]);
            else
                gtx_store_f32(out, float(c.position[k]));
            out += traits.doubles ? 8 : 4;
        }
        for (int k = 0; k < 3 && traits.normals; ++k, out += 4)
            gtx_store_f32(out, c.normal[k]);
        std::memcpy(out, &c.color, traits.colors ? 4 : 0);
        out += traits.colors ? 4 : 0;
        if (!traits.textured)
            continue;
        for (float x : {c.look.uv[0][0], c.look.uv[0][1], c.look.uv[1][0], c.look.uv[1][1],
                        c.look.tangent[0], c.look.tangent[1], c.look.tangent[2],
                        c.look.tangent[3]}) {
            gtx_store_f32(out, x);
            out += 4;
        }
        gtx_store_u32(out, c.look.material);
        out += 4;
    }
}

void decode_triangle(const CornerTraits &traits, const uint8_t *bytes, Corners3 &out)
{
    for (Corner &c : out) {
        for (int k = 0; k < 3; ++k) {
            c.position[k] = traits.doubles ? gtx_load_f64(bytes) : double(gtx_load_f32(bytes));
            bytes += traits.doubles ? 8 : 4;
        }
        for (int k = 0; k < 3 && traits.normals; ++k, bytes += 4)
            c.normal[k] = gtx_load_f32(bytes);
        std::memcpy(&c.color, bytes, traits.colors ? 4 : 0);
        bytes += traits.colors ? 4 : 0;
        if (!traits.textured)
            continue;
        for (float *x : {&c.look.uv[0][0], &c.look.uv[0][1], &c.look.uv[1][0], &c.look.uv[1][1],
                         &c.look.tangent[0], &c.look.tangent[1], &c.look.tangent[2],
                         &c.look.tangent[3]}) {
            *x = gtx_load_f32(bytes);
            bytes += 4;
        }
        c.look.material = gtx_load_u32(bytes);
        bytes += 4;
    }
}

CellReader::CellReader(const std::string &path) : file_(path, std::ios::binary), path_(path)
{
    uint8_t head[CellHeader::BYTES];
    if (!file_)
        throw Error(GTX_ERROR_READ, "cannot read " + path + ": the step that makes it has not run");
    if (!file_.read(reinterpret_cast<char *>(head), sizeof head) || std::memcmp(head, MAGIC, 8))
        throw Error(GTX_ERROR_INPUT, path + " is no cell file");
    const uint32_t flags = gtx_load_u32(head + 8);
    header_.traits = {(flags & 1) != 0, (flags & 2) != 0, (flags & 4) != 0,
                      (flags & 8) != 0};
    header_.count = left_ = gtx_load_u64(head + 16);
    header_.hash = gtx_load_u64(head + 24);
    header_.key = gtx_load_u64(head + 32);
    header_.deviation = gtx_load_f64(head + 40);
    for (int k = 0; k < 3; ++k) {
        header_.low[k] = gtx_load_f64(head + 48 + 8 * k);
        header_.high[k] = gtx_load_f64(head + 72 + 8 * k);
    }
    std::error_code error;
    const uint64_t size = std::filesystem::file_size(path, error) - CellHeader::BYTES;
    const uint64_t triangle = 3 * header_.traits.bytes();
    if (error || flags > 15 || size % triangle || size / triangle != left_ ||
        !(header_.deviation >= 0 && header_.deviation <= FARTHEST) ||
        (left_ && !(is_near(header_.low) && is_near(header_.high))))
        throw Error(GTX_ERROR_INPUT, path + " is not whole");
}

bool CellReader::next(Corners3 &out)
{
    const size_t triangle = 3 * header_.traits.bytes();
    if (at_ == end_) {
        const size_t count = size_t(std::min<uint64_t>(left_, AT_ONCE));
        if (!count)
            return false;
        cancel_point();
        block_.resize(count * triangle);
        if (!file_.read(reinterpret_cast<char *>(block_.data()), std::streamsize(block_.size())))
            throw Error(GTX_ERROR_READ, path_ + " cannot be read");
        at_ = 0;
        end_ = block_.size();
        left_ -= count;
    }
    decode_triangle(header_.traits, &block_[at_], out);
    at_ += triangle;
    if (!are_near(out))
        throw Error(GTX_ERROR_INPUT, path_ + " has corners that no step writes");
    return true;
}

} // namespace gtx
