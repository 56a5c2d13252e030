/* Words and numbers of a text file, with lines counted for messages. Internal to lib/mesh. */
#pragma once

#include "mesh/import/import.hpp"

#include <algorithm>
#include <charconv>

namespace gtx {

/* Blanks separate words; a '#' hides the rest of its line. */
class TextReader {
public:
    TextReader(std::string_view text, Task &task)
        : begin_(text.data()), at_(begin_), end_(begin_ + text.size()), task_(task)
    {
        if (text.substr(0, 3) == "\xef\xbb\xbf") /* a byte-order mark */
            at_ += 3;
    }

    /* Skips blanks of this line; true when no word is left on it. */
    bool at_line_end()
    {
        while (at_ < end_ && (*at_ == ' ' || *at_ == '\t'))
            ++at_;
        return at_ == end_ || *at_ == '\n' || *at_ == '\r' || *at_ == '#';
    }

    void next_line()
    {
        while (at_ < end_ && *at_ != '\n' && *at_ != '\r')
            ++at_;
        if (at_ < end_)
            at_ += *at_ == '\r' && at_ + 1 < end_ && at_[1] == '\n' ? 2 : 1;
        if (++line_ % 0x8000 == 0)
            task_.advance(double(at_ - begin_) / double(end_ - begin_));
    }

    /* Goes to the next word, on whichever line; false at the end of the text. */
    bool find_word()
    {
        while (at_line_end() && at_ < end_)
            next_line();
        return at_ < end_;
    }

    /* The word here, left where it is; empty at the end of the line. */
    std::string_view peek() const
    {
        const char *stop = at_;
        while (!is_word_end(stop))
            ++stop;
        return {at_, size_t(stop - at_)};
    }

    std::string_view word()
    {
        std::string_view here = peek();
        at_ += here.size();
        return here;
    }

    /* Over characters of the word here. */
    void skip(size_t count) { at_ += count; }

    double number(const char *what)
    {
        double value = 0;
        const char *start = at_;
        bool good = find_word() && parse_number(at_, end_, value) && is_word_end(at_);
        return good ? value : wrong(what, "a number", start);
    }

    uint64_t integer(const char *what)
    {
        uint64_t value = 0;
        const char *start = at_;
        if (find_word()) {
            auto [stop, error] = std::from_chars(at_, end_, value);
            at_ = stop;
            if (error == std::errc() && is_word_end(at_))
                return value;
        }
        wrong(what, "a whole number", start);
    }

    size_t line() const { return line_; }
    size_t left() const { return size_t(end_ - at_); }

private:
    bool is_word_end(const char *p) const
    {
        return p == end_ || *p == ' ' || (*p >= '\t' && *p <= '\r') || *p == '#';
    }

    [[noreturn]] double wrong(const char *what, const char *wanted, const char *start)
    {
        at_ = start;
        if (!find_word())
            fail(GTX_ERROR_INPUT, "the file ends where %s is to follow", what);
        fail(GTX_ERROR_INPUT, "line %zu: %s is %s, not '%s'", line_, what, wanted,
             printable(word(), 12).c_str());
    }

    const char *begin_, *at_, *end_;
    size_t line_ = 1;
    Task &task_;
};

} // namespace gtx
