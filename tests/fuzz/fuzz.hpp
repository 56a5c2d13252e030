/* Fuzz targets: what each does with bytes that anyone may have made, and what must hold then. */
#pragma once

#include <geotex/geotex.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace fuzz {

using Bytes = std::vector<uint8_t>;

/* `run` ends the program where something does not hold. `mutate`, which may be null, changes input
 * such that more of it stays right than if bytes were changed; it returns the new size. */
struct Target {
    const char *name;
    void (*run)(const uint8_t *data, size_t size);
    size_t (*mutate)(uint8_t *data, size_t size, size_t most, unsigned seed);
};
extern const Target targets[];
extern const size_t target_count;

void run_gtx(const uint8_t *data, size_t size);
void run_ply(const uint8_t *data, size_t size);
void run_obj(const uint8_t *data, size_t size);
void run_off(const uint8_t *data, size_t size);
void run_stl(const uint8_t *data, size_t size);
void run_gltf(const uint8_t *data, size_t size);
void run_draco(const uint8_t *data, size_t size);
void run_gzip(const uint8_t *data, size_t size);
void run_irap(const uint8_t *data, size_t size);
void run_zmap(const uint8_t *data, size_t size);
void run_cps3(const uint8_t *data, size_t size);
void run_netcdf(const uint8_t *data, size_t size);
void run_image(const uint8_t *data, size_t size);
void run_world(const uint8_t *data, size_t size);
void run_stream(const uint8_t *data, size_t size);
void run_prefix(const uint8_t *data, size_t size);
void run_pieces(const uint8_t *data, size_t size);

size_t mutate_gtx(uint8_t *data, size_t size, size_t most, unsigned seed);
size_t mutate_glb(uint8_t *data, size_t size, size_t most, unsigned seed);
size_t mutate_gzip(uint8_t *data, size_t size, size_t most, unsigned seed);

/* Says what did not hold, and ends the program. */
[[noreturn]] void found(const char *format, ...) __attribute__((format(printf, 1, 2)));
#define REQUIRE(condition, ...) ((condition) ? (void)0 : fuzz::found(__VA_ARGS__))

/* Memory hooks that count: what is taken comes back, with the size that it was taken with. */
struct Counted {
    size_t bytes = 0, most = 0;
    long blocks = 0;
    gtx_allocator hooks();
    ~Counted();
};

/* Small ones, so that no input takes long. */
gtx_limits small_limits();

/* What a call is to do follows from the bytes, so that a file always does the same. */
uint64_t choices(const uint8_t *data, size_t size);

/* The asset encodes, opens again with the same content, and encodes to the same bytes; `hashed`:
 * its content hash is known. */
void round_trip(const gtx_asset *asset, bool hashed, const char *who);

/* Casts, lights, prepares for drawing, edits and combines what was opened, as `how` chooses. */
void use_asset(const gtx_asset *asset, uint64_t how);
void edit_asset(const gtx_asset *asset, uint64_t how);
void combine_asset(const gtx_asset *asset, uint64_t how);
void export_asset(const gtx_asset *asset, uint64_t how);
/* An asset that a GLB holds. */
void find_embedded(const uint8_t *data, size_t size);

/* A folder of this process, gone with it; and a file in it. */
std::string scratch(const char *name);
void write_scratch(const char *name, const void *data, size_t size);

/* Bytes changed at random: libFuzzer's own mutations. */
size_t mutate_bytes(uint8_t *data, size_t size, size_t most);

/* Numbers for mutators. */
class Random {
public:
    explicit Random(uint64_t seed) : state_(seed * 0x9E3779B97F4A7C15u + 1) {}
    uint32_t below(uint32_t n);
    bool chance(uint32_t in) { return below(in) == 0; }
    float number(); /* of any size; now and then none */
    float unit() { return float(below(1 << 20)) / float(1 << 20); }

private:
    uint64_t state_;
};

} // namespace fuzz
