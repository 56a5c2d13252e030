/* Numbers in a text, and sizes that must not be believed. Internal to lib/grid. */
#pragma once

#include "grid/grid.hpp"
#include "mesh/number.hpp"

namespace gtx {

[[noreturn]] inline void malformed(const std::string &sentence)
{
    throw Error(GTX_ERROR_INPUT, sentence);
}

/* Words of a text, separated by blanks and ends of lines. */
class Words {
public:
    explicit Words(std::string_view text) : text_(text) {}

    std::string_view next()
    {
        constexpr const char *BLANKS = " \t\r\n\f\v";
        text_.remove_prefix(std::min(text_.find_first_not_of(BLANKS), text_.size()));
        const size_t size = std::min(text_.find_first_of(BLANKS), text_.size());
        const std::string_view word = text_.substr(0, size);
        text_.remove_prefix(size);
        return word;
    }
    double number(const char *what)
    {
        const std::string_view word = next();
        if (word.empty())
            malformed(std::string("it ends where ") + what + " is to follow");
        return parse(word, what);
    }
    size_t left() const { return text_.size(); }

    static double parse(std::string_view word, const char *what)
    {
        double value = 0;
        const char *from = word.data() + (!word.empty() && word[0] == '+');
        const char *end = word.data() + word.size();
        const auto [stop, error] = number_from(from, end, value);
        if (error != std::errc() || stop != end)
            malformed(std::string(what) + " is not a number");
        return value;
    }

private:
    std::string_view text_;
};

/* A count of nodes along a side, and of all of them: no more than the file has bytes for. */
inline uint32_t node_count(double value, const char *what)
{
    if (!(value >= 1 && value <= MAX_SIDE && value == std::floor(value)))
        malformed(std::string(what) + " is not a whole number from 1 to 2^24");
    return uint32_t(value);
}
inline void reserve_nodes(HeightGrid &grid, size_t bytes_left, size_t least_bytes,
                          const Limits &limits)
{
    limits.require(GTX_LIMITED_TEXELS, "the grid", grid.count());
    if (grid.count() > bytes_left / least_bytes + 1)
        malformed("the grid ends before its " + std::to_string(grid.nx) + " x " +
                  std::to_string(grid.ny) + " nodes do");
    grid.values.assign(grid.count(), NAN);
}

/* Checks the numbers of a header, and turns a grid with negative steps round. */
void settle(HeightGrid &grid);

} // namespace gtx
