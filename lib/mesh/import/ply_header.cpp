/* The header of a PLY file: its encoding, its elements and their properties. */
#include "mesh/import/ply.hpp"

#include <algorithm>
#include <charconv>

namespace gtx {

static constexpr struct {
    const char *name, *alias;
    unsigned size;
    double full;
} types[] = {
    /* in the order of PlyType */
    {"char", "int8", 1, 127},       {"uchar", "uint8", 1, 255},  {"short", "int16", 2, 32767},
    {"ushort", "uint16", 2, 65535}, {"int", "int32", 4, 255},    {"uint", "uint32", 4, 255},
    {"float", "float32", 4, 1},     {"double", "float64", 8, 1},
};

unsigned ply_size(PlyType type)
{
    return types[int(type)].size;
}

double ply_full(PlyType type)
{
    return types[int(type)].full;
}

namespace {

class HeaderReader {
public:
    explicit HeaderReader(std::string_view bytes)
        : begin_(bytes.data()), at_(begin_), end_(begin_ + bytes.size())
    {
    }
    PlyHeader read();

private:
    using Words = Vector<std::string_view>;
    Words next_line();
    PlyType type_named(std::string_view name);
    void element(const Words &words);
    void property(const Words &words);

    const char *begin_, *at_, *end_;
    size_t line_ = 0;
    PlyHeader out_;
};

HeaderReader::Words HeaderReader::next_line()
{
    const char *stop = std::find_if(at_, end_, [](char c) { return c == '\n' || c == '\r'; });
    ++line_;
    if (stop == end_)
        fail(GTX_ERROR_INPUT, "line %zu: the header has no end_header", line_);
    Words words;
    for (const char *p = at_; p < stop;) {
        const char *word = p;
        while (p < stop && *p != ' ' && *p != '\t')
            ++p;
        if (p > word)
            words.push_back({word, size_t(p - word)});
        while (p < stop && (*p == ' ' || *p == '\t'))
            ++p;
    }
    at_ = stop + (*stop == '\r' && stop + 1 < end_ && stop[1] == '\n' ? 2 : 1);
    return words;
}

PlyType HeaderReader::type_named(std::string_view name)
{
    for (size_t i = 0; i < std::size(types); ++i)
        if (name == types[i].name || name == types[i].alias)
            return PlyType(i);
    fail(GTX_ERROR_INPUT, "line %zu: '%s' is not a PLY type", line_, printable(name).c_str());
}

void HeaderReader::element(const Words &words)
{
    PlyElement to;
    bool good = words.size() == 3;
    if (good) {
        to.name = words[1];
        const char *end = words[2].data() + words[2].size();
        auto [stop, error] = std::from_chars(words[2].data(), end, to.count);
        good = error == std::errc() && stop == end;
    }
    if (!good)
        fail(GTX_ERROR_INPUT, "line %zu: an element needs a name and a count", line_);
    out_.elements.push_back(std::move(to));
}

void HeaderReader::property(const Words &words)
{
    bool is_list = words.size() == 5 && words[1] == "list";
    if (out_.elements.empty() || (words.size() != 3 && !is_list))
        fail(GTX_ERROR_INPUT, "line %zu: this is not a property of an element", line_);
    PlyProperty to;
    to.name = words.back();
    to.is_list = is_list;
    to.type = type_named(words[words.size() - 2]);
    to.count_type = is_list ? type_named(words[2]) : PlyType::u8;
    if (to.count_type == PlyType::f32 || to.count_type == PlyType::f64)
        fail(GTX_ERROR_INPUT, "line %zu: the length of a list is not an integer", line_);
    out_.elements.back().properties.push_back(std::move(to));
}

PlyHeader HeaderReader::read()
{
    auto first = next_line();
    if (first.size() != 1 || first[0] != "ply")
        fail(GTX_ERROR_INPUT, "the file does not start with 'ply'");
    bool has_format = false;
    for (;;) {
        auto words = next_line();
        std::string_view word = words.empty() ? "comment" : words[0];
        if (word == "end_header")
            break;
        if (word == "format" && words.size() == 3) {
            has_format = true;
            out_.ascii = words[1] == "ascii";
            out_.big_endian = words[1] == "binary_big_endian";
            if (!out_.ascii && !out_.big_endian && words[1] != "binary_little_endian")
                fail(GTX_ERROR_INPUT, "line %zu: '%s' is not a PLY format", line_,
                     printable(words[1]).c_str());
        } else if (word == "element") {
            element(words);
        } else if (word == "property") {
            property(words);
        } else if (word != "comment" && word != "obj_info") {
            fail(GTX_ERROR_INPUT, "line %zu: '%s' is not a PLY header line", line_,
                 printable(word).c_str());
        }
    }
    if (!has_format)
        fail(GTX_ERROR_INPUT, "the header has no format line");
    out_.size = size_t(at_ - begin_);
    out_.lines = line_;
    return std::move(out_);
}

} // namespace

PlyHeader read_ply_header(std::string_view bytes)
{
    return HeaderReader(bytes).read();
}

} // namespace gtx
