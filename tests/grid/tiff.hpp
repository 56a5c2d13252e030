/* GeoTIFFs as text, with the tags that a test wants. */
#pragma once

#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <string>
#include <vector>

template <class T> inline void put(std::string &to, T value)
{
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    to.append(raw, sizeof raw);
}

struct Tag {
    uint16_t number, type;
    uint32_t count;
    std::string value;
};
template <class T> inline std::string list(std::initializer_list<T> values)
{
    std::string out;
    for (T value : values)
        put(out, value);
    return out;
}

/* One strip of floats, and what more tags tell. Tags in order. */
inline std::string tiff(const std::vector<Tag> &more, uint32_t nx = 3, uint32_t ny = 2)
{
    enum : uint16_t { ASCII = 2, SHORT = 3, LONG = 4 };
    const std::string nodes = list<float>({1.5, 2, 3, 4, -9999, 6});
    std::vector<Tag> tags = {{256, LONG, 1, list<uint32_t>({nx})},
                             {257, LONG, 1, list<uint32_t>({ny})},
                             {258, SHORT, 1, list<uint32_t>({32})},
                             {259, SHORT, 1, list<uint32_t>({1})},
                             {262, SHORT, 1, list<uint32_t>({1})},
                             {273, LONG, 1, list<uint32_t>({8})},
                             {277, SHORT, 1, list<uint32_t>({1})},
                             {278, LONG, 1, list<uint32_t>({ny})},
                             {279, LONG, 1, list<uint32_t>({uint32_t(nodes.size())})},
                             {339, SHORT, 1, list<uint32_t>({3})}};
    tags.insert(tags.end(), more.begin(), more.end());
    const uint32_t directory = uint32_t(8 + nodes.size());
    uint32_t behind = directory + 2 + 12 * uint32_t(tags.size()) + 4;
    std::string out = "II*", entries, values;
    put(out, uint8_t(0));
    put(out, directory);
    out += nodes;
    put(entries, uint16_t(tags.size()));
    for (const Tag &tag : tags) {
        put(entries, tag.number);
        put(entries, tag.type);
        put(entries, tag.count);
        if (tag.value.size() == 4) {
            entries += tag.value;
            continue;
        }
        put(entries, behind + uint32_t(values.size()));
        values += tag.value;
    }
    put(entries, uint32_t(0));
    return out + entries + values;
}

enum : uint16_t { ASCII = 2, SHORT = 3, DOUBLE = 12 };
inline const Tag SCALE = {33550, DOUBLE, 3, list<double>({30, 30, 0})};
inline const Tag PLACE = {33922, DOUBLE, 6, list<double>({0, 0, 0, 600000, 5000060, 0})};
inline const Tag MISSING = {42113, ASCII, 6, std::string("-9999\0", 6)};
/* A model type (1 metres, 2 degrees) of pixels that are areas. */
inline Tag keys(uint16_t model, uint16_t key, uint16_t system)
{
    return {34735, SHORT, 16, list<uint16_t>({1, 1, 0, 3, 1024, 0, 1, model, 1025, 0, 1, 1, key, 0,
                                              1, system})};
}
inline const Tag UTM = keys(1, 3072, 32632), WGS84 = keys(2, 2048, 4326);
