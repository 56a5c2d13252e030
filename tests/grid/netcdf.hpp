/* A small NetCDF of the classic kinds, written by hand: 3 x 2 nodes of which one has no value. */
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

struct NetCdf {
    const char *unit = "m";     /* of x and y; heights are in metres */
    bool has_places = true;     /* variables x and y */
    bool is_packed = false;     /* heights as short codes of halves */
    int grids = 1;
    double last_x = 120;
};

class NetCdfText {
public:
    explicit NetCdfText(int version) : wide_(version == 5), far_(version != 1) {}
    std::string text;

    template <class Number> void put(Number value)
    {
        char raw[sizeof value];
        std::memcpy(raw, &value, sizeof value);
        for (size_t k = sizeof value; k-- > 0;)
            text += raw[k];
    }
    void count(uint64_t value)
    {
        if (wide_)
            put(value);
        else
            put(uint32_t(value));
    }
    void place(uint64_t value)
    {
        if (far_)
            put(value);
        else
            put(uint32_t(value));
    }
    void name(const std::string &word)
    {
        count(word.size());
        text += word;
        pad();
    }
    void list(uint32_t kind, uint64_t entries)
    {
        put(entries ? kind : 0);
        count(entries);
    }
    void pad() { text.resize((text.size() + 3) / 4 * 4); }

private:
    bool wide_, far_;
};

inline std::string netcdf(int version, const NetCdf &how = {})
{
    enum : uint32_t { CHAR = 2, SHORT = 3, FLOAT = 5, DOUBLE = 6 };
    NetCdfText data(version);
    uint64_t begins[4], variables = 0;
    const auto begin = [&] { begins[variables++] = data.text.size(); };
    begin();
    for (double x : {100.0, 110.0, how.last_x})
        data.put(x);
    begin();
    for (double y : {50.0, 70.0})
        data.put(y);
    for (int g = 0; g < how.grids; ++g) {
        begin();
        for (float z : {4.f, -9999.f, 6.f, 1.5f, 2.f, 3.f})
            if (how.is_packed)
                data.put(int16_t(z == -9999 ? -1 : 2 * z));
            else
                data.put(z);
    }
    std::string out;
    for (uint64_t start = 0;;) { /* twice: where values begin depends on the header's size */
        NetCdfText head(version);
        head.text = std::string("CDF") + char(version);
        head.count(0);
        head.list(10, 2);
        head.name("y");
        head.count(2);
        head.name("x");
        head.count(3);
        head.list(12, 0);
        head.list(11, (how.has_places ? 2 : 0) + uint64_t(how.grids));
        for (int axis = 0; axis < 2 && how.has_places; ++axis) {
            head.name(axis ? "y" : "x");
            head.count(1);
            head.count(axis ? 0 : 1);
            head.list(12, 1);
            head.name("units");
            head.put(uint32_t(CHAR));
            head.name(how.unit);
            head.put(uint32_t(DOUBLE));
            head.count(axis ? 16 : 24);
            head.place(start + begins[axis]);
        }
        for (int g = 0; g < how.grids; ++g) {
            head.name(g ? "w" : "z");
            head.count(2);
            head.count(0);
            head.count(1);
            head.list(12, how.is_packed ? 3 : 2);
            head.name("units");
            head.put(uint32_t(CHAR));
            head.name("m");
            head.name("_FillValue");
            head.put(uint32_t(how.is_packed ? SHORT : FLOAT));
            head.count(1);
            if (how.is_packed)
                head.put(int16_t(-1));
            else
                head.put(-9999.f);
            head.pad();
            if (how.is_packed) {
                head.name("scale_factor");
                head.put(uint32_t(DOUBLE));
                head.count(1);
                head.put(0.5);
            }
            head.put(uint32_t(how.is_packed ? SHORT : FLOAT));
            head.count(how.is_packed ? 12 : 24);
            head.place(start + begins[2 + g]);
        }
        if (start) {
            out = head.text + data.text;
            break;
        }
        start = head.text.size();
    }
    return out;
}
