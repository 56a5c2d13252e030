/* NetCDF of the classic kinds (CDF-1, CDF-2, CDF-5), as "The NetCDF Classic Format Specification"
 * has them: big-endian lists of dimensions, attributes and variables, and then the values. A grid
 * is a variable of two dimensions, or of more whose others have one entry; by CF and COARDS the
 * variables called as its dimensions tell where nodes lie. */
#include "grid/text.hpp"

#include <algorithm>
#include <cctype>
#include <cstring>

namespace gtx {

bool is_netcdf(std::string_view bytes)
{
    return bytes.size() > 4 && bytes.substr(0, 3) == "CDF" &&
           (bytes[3] == 1 || bytes[3] == 2 || bytes[3] == 5);
}

bool is_netcdf4(std::string_view bytes)
{
    return bytes.substr(0, 8) == "\x89HDF\r\n\x1a\n";
}

namespace {

constexpr uint64_t MAX_ENTRIES = 1 << 16; /* of a list, each of which takes some bytes */
enum : uint32_t { DIMENSIONS = 10, VARIABLES = 11, ATTRIBUTES = 12, CHARACTERS = 2 };
constexpr size_t SIZES[] = {0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8};

/* A number of a type, at least SIZES[type] bytes. */
double number_at(const char *from, uint32_t type)
{
    const size_t size = SIZES[type];
    uint64_t bits = 0;
    for (size_t k = 0; k < size; ++k)
        bits = bits << 8 | uint8_t(from[k]);
    float single;
    double twice;
    const uint32_t low = uint32_t(bits);
    switch (type) {
    case 1: return int8_t(bits);
    case 3: return int16_t(bits);
    case 4: return int32_t(low);
    case 5: std::memcpy(&single, &low, sizeof single); return double(single);
    case 6: std::memcpy(&twice, &bits, sizeof twice); return twice;
    case 10: return double(int64_t(bits));
    default: return double(bits);
    }
}

struct Attribute {
    std::string name;
    uint32_t type;
    std::string_view raw;
};

struct Variable {
    std::string name;
    Vector<uint64_t> dimensions;
    Vector<Attribute> attributes;
    uint32_t type = 0;
    uint64_t begin = 0;

    const Attribute *attribute(const char *wanted) const
    {
        for (const Attribute &a : attributes)
            if (a.name == wanted)
                return &a;
        return nullptr;
    }
    double number(const char *wanted, double otherwise) const
    {
        const Attribute *a = attribute(wanted);
        return a && a->type != CHARACTERS && a->raw.size() >= SIZES[a->type]
                   ? number_at(a->raw.data(), a->type) : otherwise;
    }
    std::string text(const char *wanted) const
    {
        const Attribute *a = attribute(wanted);
        std::string out(a && a->type == CHARACTERS ? a->raw : std::string_view());
        for (char &letter : out)
            letter = char(std::tolower(static_cast<unsigned char>(letter)));
        return out.substr(0, out.find('\0'));
    }
};

struct Dimension {
    std::string name;
    uint64_t size;
};

/* The header, entry by entry; every count is no more than there are bytes for. */
class Header {
public:
    explicit Header(std::string_view bytes) : bytes_(bytes), wide_(bytes[3] == 5)
    {
        at_ = 4;
        const uint64_t records = count();
        for (uint64_t left = list(DIMENSIONS); left > 0; --left) {
            std::string name = word();
            const uint64_t size = count();
            dimensions.push_back({std::move(name), size ? size : records});
        }
        attributes();
        for (uint64_t left = list(VARIABLES); left > 0; --left)
            variables.push_back(variable(uint8_t(bytes[3])));
    }
    Vector<Dimension> dimensions;
    Vector<Variable> variables;

private:
    std::string_view take(uint64_t size)
    {
        if (size > bytes_.size() - at_)
            malformed("the header ends too early");
        const std::string_view out = bytes_.substr(at_, size);
        at_ = std::min<size_t>(bytes_.size(), at_ + (size + 3) / 4 * 4);
        return out;
    }
    uint64_t number(size_t size)
    {
        uint64_t value = 0;
        for (char byte : take(size))
            value = value << 8 | uint8_t(byte);
        return value;
    }
    uint64_t count() { return number(wide_ ? 8 : 4); }
    std::string word() { return std::string(take(count())); }
    uint64_t list(uint32_t kind)
    {
        const uint64_t tag = number(4), entries = count();
        if ((tag != 0 || entries != 0) && tag != kind)
            malformed("a list of its header is of another kind");
        if (entries > MAX_ENTRIES)
            malformed("a list of its header is too long");
        return entries;
    }
    uint32_t type()
    {
        const uint64_t code = number(4);
        if (code < 1 || code >= std::size(SIZES))
            malformed("a type of its header is unknown");
        return uint32_t(code);
    }
    Vector<Attribute> attributes()
    {
        Vector<Attribute> out;
        for (uint64_t left = list(ATTRIBUTES); left > 0; --left) {
            std::string name = word();
            const uint32_t kind = type();
            const uint64_t items = count();
            if (items > bytes_.size())
                malformed("the header ends too early");
            out.push_back({std::move(name), kind, take(items * SIZES[kind])});
        }
        return out;
    }
    Variable variable(int version)
    {
        Variable out;
        out.name = word();
        const uint64_t sides = count();
        if (sides > MAX_ENTRIES)
            malformed("a list of its header is too long");
        for (uint64_t k = 0; k < sides; ++k) {
            out.dimensions.push_back(count());
            if (out.dimensions.back() >= dimensions.size())
                malformed("a variable has a dimension that is not there");
        }
        out.attributes = attributes();
        out.type = type();
        count(); /* bytes, which the dimensions tell too */
        out.begin = number(version == 1 ? 4 : 8);
        return out;
    }

    std::string_view bytes_;
    bool wide_;
    size_t at_;
};

/* Metres in a unit of length; 0 for others. */
double metres_in(const std::string &unit)
{
    static const struct {
        const char *unit;
        double metres;
    } units[] = {{"m", 1}, {"metre", 1}, {"metres", 1}, {"meter", 1}, {"meters", 1}, {"km", 1000},
                 {"kilometers", 1000}, {"ft", 0.3048}, {"feet", 0.3048}};
    for (const auto &known : units)
        if (unit == known.unit)
            return known.metres;
    return 0;
}

class Reader {
public:
    explicit Reader(std::string_view bytes) : bytes_(bytes), header_(bytes) {}

    HeightGrid read(const Limits &limits)
    {
        const Variable &z = find_grid();
        const uint64_t x = z.dimensions.back(), y = z.dimensions[z.dimensions.size() - 2];
        HeightGrid grid;
        grid.nx = node_count(double(header_.dimensions[x].size), "the number of columns");
        grid.ny = node_count(double(header_.dimensions[y].size), "the number of rows");
        const char *from = values_of(z, grid.count());
        reserve_nodes(grid, bytes_.size() - z.begin, SIZES[z.type], limits);
        const double fill = z.number("_FillValue", NAN), missing = z.number("missing_value", NAN);
        const double scale = z.number("scale_factor", 1), offset = z.number("add_offset", 0);
        for (size_t k = 0; k < grid.count(); ++k) {
            const double code = number_at(from + SIZES[z.type] * k, z.type);
            const double value = code * scale + offset;
            if (code != fill && code != missing && std::fabs(value) < 1e30)
                grid.values[k] = float(value);
        }
        place(grid, 0, x, metres_in(z.text("units")));
        place(grid, 1, y, metres_in(z.text("units")));
        settle(grid);
        return grid;
    }

private:
    /* The last two dimensions have nodes, the others one entry each. */
    bool is_grid(const Variable &v) const
    {
        const size_t sides = v.dimensions.size();
        for (size_t k = 0; k < sides; ++k)
            if ((header_.dimensions[v.dimensions[k]].size > 1) != (k + 2 >= sides))
                return false;
        return sides >= 2 && v.type != CHARACTERS;
    }
    /* By CF the edges of cells, two beside each other. */
    bool is_bounds(const Variable &v) const
    {
        for (const Variable &other : header_.variables)
            if (const Attribute *a = other.attribute("bounds"))
                if (a->type == CHARACTERS && a->raw == v.name)
                    return true;
        return false;
    }
    const Variable &find_grid() const
    {
        const Variable *found = nullptr;
        for (const Variable &v : header_.variables) {
            if (!is_grid(v) || is_bounds(v))
                continue;
            if (found)
                malformed("it holds several grids, such as " + found->name + " and " + v.name +
                          ": gdal_translate NETCDF:FILE:" + found->name + " takes one out");
            found = &v;
        }
        if (!found)
            malformed("it holds no grid: no variable has two dimensions, or several have more");
        return *found;
    }
    const char *values_of(const Variable &v, uint64_t count) const
    {
        if (v.begin > bytes_.size() || (bytes_.size() - v.begin) / SIZES[v.type] < count)
            malformed("the grid ends before its nodes do");
        return bytes_.data() + v.begin;
    }

    /* By the variable called as the dimension, whose steps are alike; without it, as an image. */
    void place(HeightGrid &grid, int axis, uint64_t dimension, double metres_of_values)
    {
        constexpr double ALIKE = 0.01; /* of a step: longitudes may be of single precision */
        const Dimension &d = header_.dimensions[dimension];
        const auto named = [&](const Variable &v) {
            return v.name == d.name && v.dimensions.size() == 1 && v.dimensions[0] == dimension &&
                   v.type != CHARACTERS;
        };
        const auto &all = header_.variables;
        const auto c = std::find_if(all.begin(), all.end(), named);
        if (c == all.end()) {
            grid.is_unplaced = true;
            return;
        }
        const char *from = values_of(*c, d.size);
        const auto at = [&](uint64_t k) { return number_at(from + SIZES[c->type] * k, c->type); };
        const double first = at(0), step = (at(d.size - 1) - first) / double(d.size - 1);
        for (uint64_t k = 0; k < d.size; ++k)
            if (!(std::fabs(at(k) - first - step * double(k)) <= ALIKE * std::fabs(step)))
                malformed("steps of its " + c->name + " are not alike");
        const std::string unit = c->text("units");
        const double metres = metres_in(unit);
        const double scale = metres > 0 && metres_of_values > 0 ? metres / metres_of_values : 1;
        grid.origin[axis] = first * scale;
        grid.step[axis] = step * scale;
        grid.in_degrees = grid.in_degrees || unit.substr(0, 6) == "degree";
    }

    std::string_view bytes_;
    Header header_;
};

} // namespace

HeightGrid read_netcdf(std::string_view bytes, const Limits &limits)
{
    return Reader(bytes).read(limits);
}

} // namespace gtx
