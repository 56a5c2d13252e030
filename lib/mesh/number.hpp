/* Decimal numbers of text, to the nearest double: std::from_chars, or what stands in for it where
 * the library has it for whole numbers alone (libc++). */
#pragma once

#include <charconv>

#ifndef __cpp_lib_to_chars
#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <string>
#endif

namespace gtx {

#ifdef __cpp_lib_to_chars
inline std::from_chars_result number_from(const char *from, const char *end, double &value)
{
    return std::from_chars(from, end, value);
}
#else
/* strtod also takes blanks, a plus sign and hexadecimal digits, of which `from_chars` has none. The
 * process's locale must have a point. */
inline std::from_chars_result number_from(const char *from, const char *end, double &value)
{
    const char *to = from;
    while (to < end && ((*to >= '0' && *to <= '9') || (*to >= 'a' && *to <= 'w') ||
                        (*to >= 'A' && *to <= 'W') || (*to == 'y' || *to == 'Y') ||
                        *to == '.' || *to == '-' || (*to == '+' && to > from)))
        ++to;
    const std::string text(from, to);
    char *stop = nullptr;
    errno = 0;
    const double number = std::strtod(text.c_str(), &stop);
    if (stop == text.c_str())
        return {from, std::errc::invalid_argument};
    const bool outside = errno == ERANGE && (std::isinf(number) || number == 0);
    if (!outside)
        value = number;
    return {from + (stop - text.c_str()), outside ? std::errc::result_out_of_range : std::errc()};
}
#endif

} // namespace gtx
