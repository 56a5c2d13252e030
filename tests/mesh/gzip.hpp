/* Bytes as a gzip file holds them. */
#pragma once

#include <cstdlib>
#include <string>
#include <zlib.h>

inline std::string gzipped(const std::string &text)
{
    z_stream stream = {};
    if (deflateInit2(&stream, 9, Z_DEFLATED, 15 + 16, 9, Z_DEFAULT_STRATEGY) != Z_OK)
        abort();
    std::string out(deflateBound(&stream, uLong(text.size())), 0);
    stream.next_in = reinterpret_cast<Bytef *>(const_cast<char *>(text.data()));
    stream.avail_in = uInt(text.size());
    stream.next_out = reinterpret_cast<Bytef *>(out.data());
    stream.avail_out = uInt(out.size());
    if (deflate(&stream, Z_FINISH) != Z_STREAM_END)
        abort();
    out.resize(stream.total_out);
    deflateEnd(&stream);
    return out;
}
