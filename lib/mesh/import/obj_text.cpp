/* Words and numbers of a Wavefront file. */
#include "mesh/import/obj_text.hpp"

#include <algorithm>
#include <charconv>
#include <cstring>

namespace gtx {

ObjText::ObjText(std::string_view text)
    : begin_(text.data()), at_(begin_), end_(begin_ + text.size())
{
    if (text.substr(0, 3) == "\xef\xbb\xbf") /* a byte-order mark */
        at_ += 3;
}

bool ObjText::at_line_end()
{
    for (; at_ < end_; ++at_) {
        if (*at_ == ' ' || *at_ == '\t')
            continue;
        if (*at_ != '\\' || at_ + 1 == end_ || (at_[1] != '\n' && at_[1] != '\r'))
            return *at_ == '\n' || *at_ == '\r' || *at_ == '#';
        at_ += at_[1] == '\r' && at_ + 2 < end_ && at_[2] == '\n' ? 2 : 1;
        ++line_;
    }
    return true;
}

bool ObjText::at_word_end()
{
    const char *before = at_;
    return at_line_end() || at_ != before;
}

void ObjText::next_line(bool continued)
{
    while (at_ < end_ && *at_ != '\n' && *at_ != '\r') {
        if (continued && *at_ == '\\' && at_ + 1 < end_ && (at_[1] == '\n' || at_[1] == '\r'))
            at_line_end();
        else
            ++at_;
    }
    if (at_ < end_)
        at_ += *at_ == '\r' && at_ + 1 < end_ && at_[1] == '\n' ? 2 : 1;
    ++line_;
}

bool ObjText::number(double &value)
{
    if (at_line_end())
        return false;
    if (!parse_number(at_, end_, value))
        fail(GTX_ERROR_INPUT, "line %zu: '%s' is not a number", line_,
             printable({at_, std::min<size_t>(size_t(end_ - at_), 12)}).c_str());
    return true;
}

void ObjText::numbers(double *values, int count, const char *what)
{
    for (int i = 0; i < count; ++i)
        if (!number(values[i]))
            fail(GTX_ERROR_INPUT, "line %zu: a %s needs %d numbers", line_, what, count);
}

bool ObjText::index(size_t count, const char *what, uint32_t &out)
{
    int64_t value = 0;
    auto [stop, error] = std::from_chars(at_, end_, value);
    if (error == std::errc::invalid_argument)
        return false;
    bool beyond =
        error != std::errc() || value == 0 || value > int64_t(count) || value < -int64_t(count);
    if (beyond)
        fail(GTX_ERROR_INPUT, "line %zu: %s %s, but %zu are defined before it", line_, what,
             printable({at_, size_t(stop - at_)}).c_str(), count);
    out = uint32_t(value > 0 ? value - 1 : int64_t(count) + value);
    at_ = stop;
    return true;
}

bool ObjText::optional_index(size_t count, uint32_t &out)
{
    int64_t value = 0, most = int64_t(count);
    at_ = std::from_chars(at_, end_, value).ptr;
    if (value && value <= most && value >= -most)
        out = uint32_t(value > 0 ? value - 1 : most + value);
    return value == 0 || out < count;
}

bool ObjText::take(char c)
{
    const bool here = at_ < end_ && *at_ == c;
    at_ += here;
    return here;
}

std::string_view ObjText::word()
{
    const char *start = at_;
    while (at_ < end_ && !std::strchr(" \t\r\n\\#", *at_))
        ++at_;
    return {start, size_t(at_ - start)};
}

/* Names may have blanks in them. */
std::string_view ObjText::rest_of_line()
{
    at_line_end();
    const char *stop = at_;
    while (stop < end_ && *stop != '\n' && *stop != '\r')
        ++stop;
    std::string_view rest(at_, size_t(stop - at_));
    at_ = stop;
    return rest.substr(0, rest.find_last_not_of(" \t") + 1);
}

} // namespace gtx
