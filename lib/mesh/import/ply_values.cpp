/* The values of a PLY file: ascii and binary, in any order of bytes. */
#include "mesh/import/ply.hpp"

#include <algorithm>
#include <cstring>

namespace gtx {

namespace {

template <class T> double as(const unsigned char *bytes)
{
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return double(value);
}

bool host_is_big_endian()
{
    const uint16_t one = 1;
    unsigned char first;
    std::memcpy(&first, &one, 1);
    return first == 0;
}

} // namespace

double PlyValues::ascii_value()
{
    for (; at_ < end_ && (*at_ == ' ' || (*at_ >= '\t' && *at_ <= '\r')); ++at_)
        lines_ += *at_ == '\n';
    if (at_ == end_)
        fail(GTX_ERROR_INPUT, "the file ends in %s %llu of %llu", printable(element_->name).c_str(),
             (unsigned long long)row_, (unsigned long long)element_->count);
    double value = 0;
    if (!parse_number(at_, end_, value))
        fail(GTX_ERROR_INPUT, "line %zu: '%s' is not a number", lines_ + 1,
             printable({at_, std::min<size_t>(left(), 12)}).c_str());
    return value;
}

double PlyValues::value(PlyType type)
{
    if (ascii_)
        return ascii_value();
    unsigned size = ply_size(type);
    if (left() < size)
        fail(GTX_ERROR_INPUT, "the file ends in %s %llu of %llu", printable(element_->name).c_str(),
             (unsigned long long)row_, (unsigned long long)element_->count);
    unsigned char bytes[8];
    std::memcpy(bytes, at_, size);
    at_ += size;
    if (big_endian_ != host_is_big_endian())
        std::reverse(bytes, bytes + size);
    switch (type) {
    case PlyType::i8: return as<int8_t>(bytes);
    case PlyType::u8: return as<uint8_t>(bytes);
    case PlyType::i16: return as<int16_t>(bytes);
    case PlyType::u16: return as<uint16_t>(bytes);
    case PlyType::i32: return as<int32_t>(bytes);
    case PlyType::u32: return as<uint32_t>(bytes);
    case PlyType::f32: return as<float>(bytes);
    case PlyType::f64: return as<double>(bytes);
    }
    return 0;
}

uint64_t PlyValues::list_length(const PlyProperty &property)
{
    double length = value(property.count_type);
    size_t item = ascii_ ? 1 : ply_size(property.type);
    if (!(length >= 0) || length > double(left() / item))
        fail(GTX_ERROR_INPUT, "%s %llu: a list of %.0f items does not fit the file",
             printable(element_->name).c_str(), (unsigned long long)row_, length);
    return uint64_t(length);
}

void PlyValues::skip(const PlyProperty &property)
{
    for (uint64_t n = property.is_list ? list_length(property) : 1; n > 0; --n)
        value(property.type);
}

void PlyValues::begin(const PlyElement &element)
{
    element_ = &element;
    uint64_t row = 0;
    for (const PlyProperty &p : element.properties)
        row += ascii_ ? 2 : ply_size(p.is_list ? p.count_type : p.type);
    /* The last value of an ascii file needs no blank behind it. */
    if (row && element.count > (left() + (ascii_ ? 1 : 0)) / row)
        fail(GTX_ERROR_INPUT, "%llu rows of element '%s' do not fit the file",
             (unsigned long long)element.count, printable(element.name).c_str());
}

void PlyValues::begin_row(uint64_t row)
{
    row_ = row;
    if (row % 0x8000 == 0)
        task_.advance(double(at_ - begin_) / double(end_ - begin_));
}

} // namespace gtx
