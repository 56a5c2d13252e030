/* CPS-3 text grids (Schlumberger): lines of a header that start with a word of six letters,
 *   FSASCI 0 1 COMPUTED 0 1E30            the fifth marks a node without a value; more may follow
 *   FSATTR 0 0
 *   FSLIMI least x, greatest x, least y, greatest y, least and greatest value
 *   FSNROW rows, columns
 *   FSXINC steps in x and y               may be left out
 *   ->name
 * and then columns of nodes from the least x on, each from the greatest y down, as Petrel writes
 * them. Lines may be comments after '!', the first ones too. */
#include "grid/text.hpp"

namespace gtx {

/* Cuts off the first line. */
static std::string_view take_line(std::string_view &text)
{
    const size_t size = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, size);
    text.remove_prefix(std::min(size + 1, text.size()));
    return line;
}

bool is_cps3(std::string_view bytes)
{
    while (bytes.substr(0, 1) == "!")
        take_line(bytes);
    return bytes.substr(0, 6) == "FSASCI";
}

namespace {

/* A word, or all up to the next quotation mark. */
std::string_view take_item(Words &words)
{
    const std::string_view first = words.next();
    if (first.substr(0, 1) == "\"" && (first.size() == 1 || first.back() != '"'))
        for (auto word = words.next(); !word.empty() && word.back() != '"'; word = words.next())
            ;
    return first;
}

struct Header {
    double side[4] = {0, 0, 0, 0}, rows = 0, columns = 0;
    std::string_view missing;
    bool has_limits = false;
};

/* Up to the first line of nodes. */
Header read_header(std::string_view &text)
{
    Header out;
    for (std::string_view from = text; !text.empty(); from = text) {
        Words words(take_line(text));
        const std::string_view key = words.next();
        if (key == "FSASCI") {
            for (int k = 0; k < 5; ++k)
                out.missing = take_item(words);
        } else if (key == "FSLIMI") {
            for (double &side : out.side)
                side = words.number("the grid's extent");
            out.has_limits = true;
        } else if (key == "FSNROW") {
            out.rows = words.number("the number of rows");
            out.columns = words.number("the number of columns");
        } else if (key.substr(0, 2) != "FS" && key.substr(0, 2) != "->" && !key.empty() &&
                   key[0] != '!') {
            text = from;
            break;
        }
    }
    return out;
}

} // namespace

HeightGrid read_cps3(std::string_view bytes, const Limits &limits)
{
    const Header header = read_header(bytes);
    if (!header.has_limits)
        malformed("the header has no FSLIMI");
    double missing = 1e30;
    if (header.missing.find_first_of("0123456789") != header.missing.npos)
        missing = Words::parse(header.missing, "the missing value");
    HeightGrid grid;
    grid.ny = node_count(header.rows, "the number of rows");
    grid.nx = node_count(header.columns, "the number of columns");
    grid.origin[0] = header.side[0];
    grid.origin[1] = header.side[2];
    grid.step[0] = (header.side[1] - header.side[0]) / std::max(grid.nx - 1, 1u);
    grid.step[1] = (header.side[3] - header.side[2]) / std::max(grid.ny - 1, 1u);
    reserve_nodes(grid, bytes.size(), 2, limits);
    Words words(bytes);
    for (uint32_t i = 0; i < grid.nx; ++i)
        for (uint32_t j = grid.ny; j-- > 0;) {
            const double value = words.number("a node");
            if (value != missing && std::fabs(value) < 1e29)
                grid.values[size_t(j) * grid.nx + i] = float(value);
        }
    settle(grid);
    return grid;
}

} // namespace gtx
