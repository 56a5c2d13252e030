/* IRAP grids (Roxar, RMS): the classic text and its binary sibling. Both start with the number 996,
 * negative, then
 *   rows, steps | first and last x, first and last y | columns, rotation, its centre | seven zeros
 * in an order that differs a little, and go on with the nodes, row by row from the first y. */
#include "grid/text.hpp"

#include <algorithm>
#include <cstring>

namespace gtx {

constexpr float CLASSIC_MISSING = 9999900, BINARY_MISSING = 1e30f;

/* The lattice is turned around a centre that is its first node as a rule. */
static void turn(HeightGrid &grid, double centre_x, double centre_y)
{
    const double x = grid.origin[0] - centre_x, y = grid.origin[1] - centre_y;
    grid.origin[0] = centre_x;
    grid.origin[1] = centre_y;
    const std::array<double, 2> moved = grid.place(x / grid.step[0], y / grid.step[1]);
    grid.origin[0] = moved[0];
    grid.origin[1] = moved[1];
}

/* ---- classic ---- */

bool is_irap_classic(std::string_view bytes)
{
    return Words(bytes.substr(0, 64)).next() == "-996";
}

HeightGrid read_irap_classic(std::string_view bytes, const Limits &limits)
{
    Words words(bytes);
    HeightGrid grid;
    words.next(); /* -996 */
    grid.ny = node_count(words.number("the number of rows"), "the number of rows");
    for (double &step : grid.step)
        step = words.number("a step");
    grid.origin[0] = words.number("the least x");
    words.number("the greatest x");
    grid.origin[1] = words.number("the least y");
    words.number("the greatest y");
    grid.nx = node_count(words.number("the number of columns"), "the number of columns");
    grid.rotation = words.number("the rotation");
    const double x = words.number("the centre of rotation");
    turn(grid, x, words.number("the centre of rotation"));
    for (int k = 0; k < 7; ++k)
        words.number("the header's last row");
    reserve_nodes(grid, words.left(), 2, limits);
    for (float &value : grid.values) {
        const double number = words.number("a node");
        value = number >= CLASSIC_MISSING ? NAN : float(number);
    }
    settle(grid);
    return grid;
}

/* ---- binary: big-endian records between two copies of their size, as Fortran writes them ---- */

static uint32_t load_big(const char *at)
{
    uint32_t value = 0;
    for (int k = 0; k < 4; ++k)
        value = value << 8 | uint8_t(at[k]);
    return value;
}

static float load_float(const char *at)
{
    const uint32_t bits = load_big(at);
    float value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
}

bool is_irap_binary(std::string_view bytes)
{
    return bytes.size() >= 8 && load_big(bytes.data()) == 32 &&
           int32_t(load_big(bytes.data() + 4)) == -996;
}

/* The next record; `bytes` goes behind it. */
static std::string_view take_record(std::string_view &bytes)
{
    if (bytes.size() < 8)
        malformed("the file ends too early");
    const size_t size = load_big(bytes.data());
    if (size > bytes.size() - 8 || size % 4)
        malformed("a record is longer than the file");
    if (load_big(bytes.data() + 4 + size) != size)
        malformed("a record does not end as it starts");
    const std::string_view record = bytes.substr(4, size);
    bytes.remove_prefix(size + 8);
    return record;
}

static std::string_view header_record(std::string_view &bytes, size_t size)
{
    const std::string_view record = take_record(bytes);
    if (record.size() != size)
        malformed("a record of the header has another size");
    return record;
}

HeightGrid read_irap_binary(std::string_view bytes, const Limits &limits)
{
    const std::string_view first = header_record(bytes, 32), second = header_record(bytes, 16);
    header_record(bytes, 28);
    HeightGrid grid;
    grid.ny = node_count(load_big(first.data() + 4), "the number of rows");
    grid.origin[0] = load_float(first.data() + 8);
    grid.origin[1] = load_float(first.data() + 16);
    grid.step[0] = load_float(first.data() + 24);
    grid.step[1] = load_float(first.data() + 28);
    grid.nx = node_count(load_big(second.data()), "the number of columns");
    grid.rotation = load_float(second.data() + 4);
    turn(grid, load_float(second.data() + 8), load_float(second.data() + 12));
    reserve_nodes(grid, bytes.size(), 4, limits);
    for (size_t at = 0; at < grid.count();) {
        const std::string_view record = take_record(bytes);
        if (record.empty() || record.size() / 4 > grid.count() - at)
            malformed("a record has more nodes than are left, or none");
        for (size_t i = 0; i < record.size(); i += 4) {
            const float value = load_float(record.data() + i);
            grid.values[at++] = value >= BINARY_MISSING ? NAN : value;
        }
    }
    settle(grid);
    return grid;
}

} // namespace gtx
