/* Streams: an index that anyone may have made, and a source and views that do what they like. */
#include "fuzz/fuzz.hpp"

#include "base/hash.h"
#include "stream/index.h"

#include <geotex/stream.h>

#include <algorithm>
#include <cmath>
#include <cstring>

namespace fuzz {

constexpr uint64_t BUDGET = 1 << 20; /* of either kind */
constexpr int UPDATES = 40;
constexpr uint32_t MAX_TILES = 200;

namespace {

/* A host that keeps books; a payload is a number of its own. */
struct Host {
    gtx_stream *stream = nullptr;
    gtx_stream_frame frame = {};
    Random random;
    std::vector<uint64_t> cpu, gpu;  /* by payload; 0 once released */
    std::vector<uint32_t> tiles;
    std::vector<gtx_stream_request> asked;

    explicit Host(uint64_t seed) : random(seed), cpu(1), gpu(1), tiles(1) {}
    static void release(void *payload, void *user);
    void answer(const gtx_stream_request &request);
    void check();
    void update();
};

void Host::release(void *payload, void *user)
{
    auto *host = static_cast<Host *>(user);
    const auto number = reinterpret_cast<uintptr_t>(payload);
    REQUIRE(number < host->cpu.size() && host->cpu[number], "a payload is released twice");
    host->cpu[number] = host->gpu[number] = 0;
}

void Host::answer(const gtx_stream_request &request)
{
    gtx_error error = {};
    if (random.chance(4)) {
        const gtx_result result = gtx_stream_fail(stream, request.id, nullptr);
        REQUIRE(result == GTX_OK || result == GTX_CANCELLED, "fail: %d", result);
        return;
    }
    if (random.chance(3)) { /* bytes that are none */
        gtx_asset *asset = nullptr;
        const uint8_t bytes[64] = {1, 2, 3};
        REQUIRE(gtx_stream_open(&request, bytes, std::min<size_t>(sizeof bytes, request.bytes),
                                nullptr, &asset, nullptr, &error) && !asset && *error.message,
                "a tile of nothing opens");
    }
    const uint64_t most = random.chance(8) ? BUDGET : BUDGET / 16;
    cpu.push_back(1 + random.below(uint32_t(most)));
    gpu.push_back(random.chance(5) ? 0 : random.below(uint32_t(most)));
    tiles.push_back(request.tile);
    void *payload = reinterpret_cast<void *>(uintptr_t(cpu.size() - 1));
    const gtx_result result =
        gtx_stream_deliver(stream, request.id, payload, cpu.back(), gpu.back());
    REQUIRE(result == GTX_OK || result == GTX_CANCELLED || result == GTX_ERROR_LIMIT,
            "deliver: %d", result);
    REQUIRE((result == GTX_OK) == (cpu.back() > 0), "a refused payload is kept");
}

void Host::check()
{
    uint64_t sum[2] = {0, 0}, sent = 0;
    for (size_t i = 0; i < cpu.size(); ++i) {
        sum[0] += cpu[i];
        sum[1] += gpu[i];
    }
    for (uint32_t i = 0; i < frame.upload_count; ++i)
        sent += frame.uploads[i].bytes;
    REQUIRE(sum[0] <= frame.cpu_bytes && frame.cpu_bytes <= BUDGET && sum[1] <= BUDGET &&
                frame.gpu_bytes <= BUDGET && sent <= BUDGET / 8,
            "budgets: %llu %llu", (unsigned long long)frame.cpu_bytes,
            (unsigned long long)frame.gpu_bytes);
    REQUIRE(frame.requested == frame.delivered + frame.failed + frame.refused + frame.under_way,
            "a request is lost");
    for (uint32_t i = 0; i < frame.draw_count; ++i) {
        const auto number = reinterpret_cast<uintptr_t>(frame.draws[i].payload);
        REQUIRE(number < cpu.size() && cpu[number] && tiles[number] == frame.draws[i].tile,
                "what is drawn is not there");
    }
}

/* Eyes and fields of any numbers; most are refused, and change nothing. */
gtx_stream_view any_view(Random &random, const gtx_stream_info &info)
{
    gtx_stream_view view = {};
    for (int k = 0; k < 3; ++k)
        view.origin[k] = info.low[k] + double(random.unit()) * (info.high[k] - info.low[k]);
    for (int k = 0; k < 16; k += 5)
        view.view[k] = 1;
    view.projection[0] = view.projection[5] = 1;
    view.projection[10] = view.projection[11] = -1;
    view.projection[14] = -0.1f;
    view.viewport_height = 1 + random.below(2000);
    for (int n = random.chance(3) ? 4 : 0; n > 0; --n)
        (n % 2 ? view.view : view.projection)[random.below(16)] = random.number();
    if (random.chance(8))
        view.origin[random.below(3)] = double(random.number());
    return view;
}

void Host::update()
{
    gtx_stream_info info;
    gtx_stream_view views[2];
    gtx_error error = {};
    gtx_stream_get_info(stream, &info);
    for (gtx_stream_view &view : views)
        view = any_view(random, info);
    const gtx_result result =
        gtx_stream_update(stream, views, 1 + random.below(2), &frame, &error);
    REQUIRE(result == GTX_OK || (result == GTX_ERROR_ARGUMENT && *error.message), "update: %d",
            result);
    if (result)
        return;
    check();
    for (uint32_t i = 0; i < frame.request_count; ++i) {
        const gtx_stream_request &r = frame.requests[i];
        const auto number = reinterpret_cast<uintptr_t>(r.beginning);
        REQUIRE(r.from < r.bytes && r.bytes <= r.file_bytes && !r.from == !r.beginning,
                "a request of nothing");
        REQUIRE(number < cpu.size() && (!number || (cpu[number] && tiles[number] == r.tile)),
                "a rest without its beginning");
    }
    asked.insert(asked.end(), frame.requests, frame.requests + frame.request_count);
    for (uint32_t i = 0; i < frame.upload_count; ++i)
        if (random.chance(2)) {
            const auto number = reinterpret_cast<uintptr_t>(frame.uploads[i].payload);
            cpu[number] = 1 + random.below(uint32_t(cpu[number]));
            REQUIRE(!gtx_stream_ready(stream, frame.uploads[i].tile, cpu[number]), "ready");
        }
    for (size_t n = random.below(8); n > 0 && !asked.empty(); --n) {
        const size_t at = random.below(uint32_t(asked.size()));
        answer(asked[at]); /* now and then again, or never */
        if (!random.chance(10))
            asked.erase(asked.begin() + std::ptrdiff_t(at));
    }
    if (random.chance(20))
        gtx_stream_retry(stream);
}

/* Whole records, in a header that is right. */
Bytes index_of(const uint8_t *data, size_t size)
{
    const uint32_t count = uint32_t(std::min<size_t>(size / GTX_INDEX_RECORD, MAX_TILES));
    Bytes out(GTX_INDEX_HEADER + size_t(count) * GTX_INDEX_RECORD);
    gtx_index_write(nullptr, 0, 1, out.data());
    std::copy_n(data, size_t(count) * GTX_INDEX_RECORD, out.begin() + GTX_INDEX_HEADER);
    std::memcpy(&out[16], &count, sizeof count);
    gtx_hash hash;
    gtx_hash_begin(&hash);
    gtx_hash_add(&hash, out.data(), GTX_INDEX_HEADER - 8);
    gtx_hash_add(&hash, out.data() + GTX_INDEX_HEADER, out.size() - GTX_INDEX_HEADER);
    const uint64_t sum = gtx_hash_end(&hash);
    std::memcpy(&out[32], &sum, sizeof sum);
    return out;
}

} // namespace

void run_stream(const uint8_t *data, size_t size)
{
    const uint64_t how = choices(data, size);
    const bool whole = size >= 4 && !std::memcmp(data, "\xabGTW", 4);
    const Bytes index = whole ? Bytes(data, data + size) : index_of(data, size);
    Counted memory;
    const gtx_allocator hooks = memory.hooks();
    Host host(how);
    gtx_stream_desc desc = {};
    gtx_error error = {};
    desc.index = index.data();
    desc.index_size = index.size();
    desc.cpu_bytes = desc.gpu_bytes = BUDGET;
    desc.upload_bytes = BUDGET / 8;
    desc.retry_updates = 1;
    desc.patience_updates = 10;
    desc.max_requests = 1 + uint32_t(how % 9);
    desc.release = Host::release;
    desc.user = &host;
    desc.allocator = &hooks;
    const gtx_result result = gtx_stream_create(&desc, &host.stream, &error);
    if (result) {
        REQUIRE(!host.stream && *error.message && memory.blocks == 0 &&
                    (result == GTX_ERROR_NOT_GTX || result == GTX_ERROR_VERSION ||
                     result == GTX_ERROR_TRUNCATED || result == GTX_ERROR_CORRUPT ||
                     result == GTX_ERROR_LIMIT),
                "create: %d %s", result, error.message);
        return;
    }
    for (int i = 0; i < UPDATES; ++i)
        host.update();
    gtx_stream_destroy(host.stream);
    for (uint64_t bytes : host.cpu)
        REQUIRE(!bytes, "a payload is never released");
}

} // namespace fuzz
