/* Binary STL in pieces. */
#include "mesh/stream/paged.hpp"

#include "base/bytes.h"

#include <filesystem>

namespace gtx {

namespace {

/* As in import/stl.cpp. */
constexpr size_t HEADER = 80, PROLOGUE = HEADER + 4, FACET = 50;

class StlStream : public TriangleStream {
public:
    StlStream(const std::string &path, Task &task) : file_(path, task), task_(task)
    {
        uint8_t count[4];
        file_.read(HEADER, count, sizeof count);
        count_ = gtx_load_u32(count);
    }
    /* A text that begins with "solid" counts other than its length says. */
    bool suits() const { return file_.size() == PROLOGUE + FACET * count_; }
    CornerTraits traits() const override { return {}; }
    void read(const TriangleSink &sink) override
    {
        uint8_t bytes[FACET];
        Corners3 out;
        for (uint64_t t = 0; t < count_; ++t) {
            if (t % 0x8000 == 0)
                task_.advance(double(t) / double(count_));
            file_.read(PROLOGUE + FACET * t, bytes, FACET);
            for (unsigned i = 0; i < 9; ++i)
                out[i / 3].position[int(i % 3)] = double(gtx_load_f32(bytes + 12 + 4 * i));
            sink(out);
        }
    }

private:
    PagedFile file_;
    Task &task_;
    uint64_t count_ = 0;
};

} // namespace

/* One whose length is not that of its count is left to the importer, which says why. */
std::unique_ptr<TriangleStream> open_stl_stream(const std::string &path, Task &task)
{
    std::error_code error;
    if (model_extension(path) != ".stl" || std::filesystem::file_size(path, error) < PROLOGUE ||
        error)
        return nullptr;
    auto stream = std::make_unique<StlStream>(path, task);
    return stream->suits() ? std::move(stream) : nullptr;
}

} // namespace gtx
