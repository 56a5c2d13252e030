/* Words and numbers of a Wavefront file. Internal to lib/mesh. */
#pragma once

#include "mesh/import/import.hpp"

namespace gtx {

/* A place in the text of an OBJ file, whose lines go on behind a backslash. */
class ObjText {
public:
    explicit ObjText(std::string_view text);

    /* Skips blanks, and line ends behind a backslash. */
    bool at_line_end();
    /* Skips blanks; false inside a word. */
    bool at_word_end();
    void next_line(bool continued);
    bool at_end() const { return at_ == end_; }
    bool at_comment() const { return at_ < end_ && *at_ == '#'; }

    std::string_view word();
    std::string_view rest_of_line();
    bool take(char c);
    /* False at the end of the line. */
    bool number(double &value);
    void numbers(double *values, int count, const char *what);
    /* A number from 1 to `count`, or from -1 backwards, and from 0 in `out`; false when there is
     * none. */
    bool index(size_t count, const char *what, uint32_t &out);
    /* The same, but what is out of range is lost: false then. */
    bool optional_index(size_t count, uint32_t &out);

    size_t line() const { return line_; }
    double share_read() const { return double(at_ - begin_) / double(end_ - begin_); }

private:
    const char *begin_, *at_, *end_;
    size_t line_ = 1;
};

} // namespace gtx
