/* ZMAP+ text grids (Landmark): comments after '!', a header between two '@', then columns of nodes,
 * each from the greatest y down, a column starting a line. The header tells
 *   @name HEADER, GRID, nodes a line
 *   width of a field, missing value, or its text, decimals, first column of text
 *   rows, columns, least x, greatest x, least y, greatest y */
#include "grid/text.hpp"

#include <algorithm>

namespace gtx {

namespace {

class Lines {
public:
    explicit Lines(std::string_view text) : text_(text) {}
    bool next(std::string_view &line)
    {
        if (text_.empty())
            return false;
        const size_t size = std::min(text_.find('\n'), text_.size());
        line = text_.substr(0, size);
        text_.remove_prefix(std::min(size + 1, text_.size()));
        while (!line.empty() && (line.back() == '\r' || line.back() == ' '))
            line.remove_suffix(1);
        return true;
    }
    std::string_view left() const { return text_; }

private:
    std::string_view text_;
};

} // namespace

static std::string_view trimmed(std::string_view text)
{
    text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
    return text.substr(0, text.find_last_not_of(" \t") + 1);
}

static Vector<std::string_view> split(std::string_view line)
{
    Vector<std::string_view> fields;
    for (size_t comma = 0; comma != line.npos; line.remove_prefix(comma + 1)) {
        comma = line.find(',');
        fields.push_back(trimmed(line.substr(0, comma)));
        if (comma == line.npos)
            break;
    }
    return fields;
}

bool is_zmap(std::string_view bytes)
{
    Lines lines(bytes.substr(0, 1 << 16));
    std::string_view line;
    while (lines.next(line))
        if (!line.empty() && line[0] != '!')
            return line[0] == '@' && line.find("GRID") != line.npos;
    return false;
}

/* The next line that is no comment, cut into at least so many fields. */
static Vector<std::string_view> header_line(Lines &lines, size_t fields)
{
    std::string_view line;
    while (lines.next(line))
        if (!line.empty() && line[0] != '!') {
            Vector<std::string_view> found = split(line);
            if (found.size() < fields)
                malformed("a line of the header is too short");
            return found;
        }
    malformed("the header ends too early");
}

HeightGrid read_zmap(std::string_view bytes, const Limits &limits)
{
    Lines lines(bytes);
    header_line(lines, 2); /* what it is called */
    const Vector<std::string_view> field = header_line(lines, 3), size = header_line(lines, 6);
    const std::string_view missing = field[1].empty() ? field[2] : field[1];
    double missing_value = NAN;
    if (missing.find_first_not_of("+-.0123456789eE") == missing.npos && !missing.empty())
        missing_value = Words::parse(missing, "the missing value");
    HeightGrid grid;
    grid.ny = node_count(Words::parse(size[0], "the number of rows"), "the number of rows");
    grid.nx = node_count(Words::parse(size[1], "the number of columns"), "the number of columns");
    double side[4];
    for (int k = 0; k < 4; ++k)
        side[k] = Words::parse(size[2 + k], "the grid's extent");
    grid.origin[0] = side[0];
    grid.origin[1] = side[2];
    grid.step[0] = (side[1] - side[0]) / std::max(grid.nx - 1, 1u);
    grid.step[1] = (side[3] - side[2]) / std::max(grid.ny - 1, 1u);
    std::string_view line;
    do {
        if (!lines.next(line))
            malformed("the header has no end");
    } while (line.empty() || line[0] != '@');
    while (!lines.left().empty() && (lines.left()[0] == '+' || lines.left()[0] == '!') &&
           lines.left().find('\n') != std::string_view::npos && lines.next(line)) {
    }
    Words words(lines.left());
    reserve_nodes(grid, words.left(), 2, limits);
    for (uint32_t i = 0; i < grid.nx; ++i)
        for (uint32_t j = grid.ny; j-- > 0;) {
            const std::string_view word = words.next();
            if (word.empty())
                malformed("it ends where a node is to follow");
            if (word == missing)
                continue;
            const double value = Words::parse(word, "a node");
            if (value != missing_value)
                grid.values[size_t(j) * grid.nx + i] = float(value);
        }
    settle(grid);
    return grid;
}

} // namespace gtx
