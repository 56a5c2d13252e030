/* Reads files of camera keys, interpolates between keys, and chooses random viewpoints. */
#include "cli/bench/path.hpp"

#include <algorithm>
#include <charconv>
#include <cstdio>

namespace gtx {

constexpr size_t MAX_KEYS = 100000;
constexpr double MAX_COORDINATE = 1e15, MIN_FIELD = 1, MAX_FIELD = 170;

namespace {

[[noreturn]] void malformed(size_t line, const char *why)
{
    throw Error(GTX_ERROR_INPUT, "line " + std::to_string(line) + ": " + why);
}

/* The words of a line, without its comment. */
Vector<std::string_view> words_of(std::string_view line)
{
    constexpr const char *BLANKS = " \t\r\f\v";
    Vector<std::string_view> out;
    line = line.substr(0, line.find('#'));
    for (;;) {
        line.remove_prefix(std::min(line.find_first_not_of(BLANKS), line.size()));
        if (line.empty())
            return out;
        const size_t size = std::min(line.find_first_of(BLANKS), line.size());
        out.push_back(line.substr(0, size));
        line.remove_prefix(size);
    }
}

double number(std::string_view word, size_t line)
{
    double value = 0;
    const char *end = word.data() + word.size();
    const auto [stop, error] = std::from_chars(word.data(), end, value);
    if (error != std::errc() || stop != end || !(std::fabs(value) <= MAX_COORDINATE))
        malformed(line, "what should be a number is none, or too large");
    return value;
}

Vec3d point(const Vector<std::string_view> &words, size_t first, size_t line)
{
    return {number(words[first], line), number(words[first + 1], line),
            number(words[first + 2], line)};
}

void add_line(ViewPath &path, const Vector<std::string_view> &words, size_t line)
{
    const bool up = words[0] == "up", field = words[0] == "fov";
    if ((up || field) && !path.views.empty())
        malformed(line, "'up' and 'fov' come before the first key");
    if (up) {
        if (words.size() != 4)
            malformed(line, "'up' takes x y z");
        path.up = normalize(point(words, 1, line));
        if (!(length(path.up) > 0))
            malformed(line, "'up' has no direction");
    } else if (field) {
        if (words.size() != 2)
            malformed(line, "'fov' takes degrees");
        path.field = number(words[1], line);
        if (!(path.field >= MIN_FIELD && path.field <= MAX_FIELD))
            malformed(line, "'fov' is from 1 to 170 degrees");
    } else {
        if (words.size() != 6)
            malformed(line, "a key is six numbers, the eye and what it looks at");
        path.views.push_back({point(words, 0, line), point(words, 3, line)});
        if (path.views.back().eye == path.views.back().target)
            malformed(line, "the eye looks at itself");
        if (path.views.size() > MAX_KEYS)
            malformed(line, "more than 100000 keys");
    }
}

Vec3d between(const Vec3d &a, const Vec3d &b, double share)
{
    return share > 0 ? a + (b - a) * share : a;
}

/* From key to key in straight lines. */
Vector<Viewpoint> spread(const Vector<Viewpoint> &keys, uint32_t count)
{
    Vector<Viewpoint> out(count);
    for (uint32_t i = 0; i < count; ++i) {
        const double at = count > 1 ? double(i) * double(keys.size() - 1) / (count - 1) : 0;
        const size_t k = size_t(at), next = std::min(k + 1, keys.size() - 1);
        out[i] = {between(keys[k].eye, keys[next].eye, at - double(k)),
                  between(keys[k].target, keys[next].target, at - double(k))};
        if (out[i].eye == out[i].target)
            throw Error(GTX_ERROR_INPUT, "between two keys the eye looks at itself");
    }
    return out;
}

} // namespace

ViewPath read_path(const std::string &file, uint32_t count, Task &task)
{
    const auto any = [](const uint8_t *, size_t, uint64_t, void *, gtx_error *) { return GTX_OK; };
    const ModelFile text = read_packed_file(file, task, any);
    ViewPath path;
    std::string_view rest(text.bytes.data(), text.bytes.size());
    for (size_t line = 1; !rest.empty(); ++line) {
        const std::string_view here = rest.substr(0, rest.find('\n'));
        rest.remove_prefix(std::min(here.size() + 1, rest.size()));
        const Vector<std::string_view> words = words_of(here);
        if (!words.empty())
            add_line(path, words, line);
    }
    if (path.views.empty())
        throw Error(GTX_ERROR_INPUT, "the path has no key");
    if (count)
        path.views = spread(path.views, count);
    return path;
}

/* ---- by chance ---- */

namespace {

/* The same numbers everywhere (splitmix64, Steele et al. 2014). */
struct Chance {
    uint64_t state;

    double next() /* in 0..1, without 1 */
    {
        uint64_t z = state += 0x9e3779b97f4a7c15u;
        z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
        z = (z ^ z >> 27) * 0x94d049bb133111ebu;
        return double((z ^ z >> 31) >> 11) * 0x1p-53;
    }
    double within(double low, double high) { return low + (high - low) * next(); }
    Vec3d direction() /* unit, each as likely */
    {
        const double z = within(-1, 1), turn = within(0, 6.283185307179586);
        const double r = std::sqrt(1 - z * z);
        return {r * std::cos(turn), r * std::sin(turn), z};
    }
};

struct RandomViews {
    const Mesh &mesh;
    Vec3d low, high;
    Chance chance;
    Vector<double> areas;     /* up to each triangle, all together */

    double diagonal() const { return length(high - low); }

    Vec3d in_box()
    {
        Vec3d p;
        for (int k = 0; k < 3; ++k)
            p[k] = chance.within(low[k], high[k]);
        return p;
    }
    /* On the surface, each place as likely, and the unit normal there. */
    Vec3d on_surface(Vec3d &normal)
    {
        const double wanted = chance.next() * areas.back();
        const auto found = std::upper_bound(areas.begin(), areas.end(), wanted);
        const size_t t = std::min(size_t(found - areas.begin()), areas.size() - 1);
        const double r = std::sqrt(chance.next()), s = chance.next();
        normal = normalize(mesh.area_vector(t));
        return mesh.position(t, 0) * (1 - r) + mesh.position(t, 1) * (r * (1 - s)) +
               mesh.position(t, 2) * (r * s);
    }
    /* 0.6 to 3 radii from the middle, looking at a place in the inner half of the box. */
    Viewpoint outside()
    {
        const Vec3d middle = (low + high) * 0.5;
        const double far = chance.within(0.6, 3) * diagonal() / 2;
        const Vec3d eye = middle + chance.direction() * far;
        return {eye, middle + (in_box() - middle) * 0.5};
    }
    /* 0.2 to 2 % of the diagonal above the surface, looking along it, every other time up to 60
     * degrees up or down from that. */
    Viewpoint above(bool level)
    {
        Vec3d normal;
        const Vec3d place = on_surface(normal);
        const Vec3d eye = place + normal * (chance.within(0.002, 0.02) * diagonal());
        Vec3d along = chance.direction();
        along = normalize(along - normal * dot(along, normal));
        const double tilt = chance.within(-60, 60) * 3.141592653589793 / 180;
        const Vec3d ray = level ? along : along * std::cos(tilt) + normal * std::sin(tilt);
        return {eye, eye + ray * (diagonal() / 10)};
    }
    Viewpoint inside()
    {
        const Vec3d eye = in_box();
        return {eye, eye + chance.direction() * (diagonal() / 10)};
    }
};

} // namespace

ViewPath random_path(const Mesh &mesh, uint32_t count, uint32_t seed)
{
    Vec3d low = mesh.positions[0], high = low;
    for (const Vec3d &p : mesh.positions)
        for (int k = 0; k < 3; ++k) {
            low[k] = std::min(low[k], p[k]);
            high[k] = std::max(high[k], p[k]);
        }
    RandomViews random = {mesh, low, high, {seed}, Vector<double>(mesh.triangle_count())};
    double area = 0;
    for (size_t t = 0; t < mesh.triangle_count(); ++t)
        random.areas[t] = area += length(mesh.area_vector(t));
    ViewPath path;
    for (uint32_t i = 0; i < count; ++i)
        path.views.push_back(i % 3 == 0   ? random.outside()
                             : i % 3 == 1 ? random.above(i / 3 % 2 == 0)
                                          : random.inside());
    for (Viewpoint &view : path.views)
        if (view.eye == view.target) /* in a box of no size */
            view.target.z -= 1;
    return path;
}

/* ---- as text ---- */

static std::string text_of(const Vec3d &v)
{
    char text[96];
    std::snprintf(text, sizeof text, "%.12g %.12g %.12g", v.x, v.y, v.z);
    return text;
}

std::string path_head(const ViewPath &path)
{
    char field[32];
    std::snprintf(field, sizeof field, "fov %.12g", path.field);
    return "up " + text_of(path.up) + "\n" + field;
}

std::string path_key(const Viewpoint &view)
{
    return text_of(view.eye) + "  " + text_of(view.target);
}

} // namespace gtx
