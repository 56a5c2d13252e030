/* Small files that ask for much: what importing them takes stays within what is allowed, and what
 * would pass a limit is told of by its name. */
#include "mesh/gzip.hpp"
#include "mesh/test_import.hpp"

#include <atomic>
#include <malloc.h>
#include <new>
#include <sys/stat.h>
#include <zlib.h>

/* ---- what is really taken, by us and by the decoders ---- */

static std::atomic<size_t> held{0}, peak{0};

static void *take(size_t size)
{
    void *memory = std::malloc(size ? size : 1);
    if (!memory)
        throw std::bad_alloc();
    const size_t now = held += malloc_usable_size(memory);
    for (size_t most = peak; now > most && !peak.compare_exchange_weak(most, now);) {}
    return memory;
}

static void give(void *memory)
{
    held -= memory ? malloc_usable_size(memory) : 0;
    std::free(memory);
}

void *operator new(size_t size) { return take(size); }
void *operator new[](size_t size) { return take(size); }
void operator delete(void *memory) noexcept { give(memory); }
void operator delete[](void *memory) noexcept { give(memory); }
void operator delete(void *memory, size_t) noexcept { give(memory); }
void operator delete[](void *memory, size_t) noexcept { give(memory); }

/* ---- how an import ends ---- */

constexpr uint64_t MEGABYTE = 1 << 20;

static gtx_limits small_limits()
{
    gtx_limits limits = {};
    limits.memory = 16 * MEGABYTE;
    limits.triangles = 1000;
    limits.pixels = 10000;
    return limits;
}

/* A field of gtx_limits, or "" where the import comes to an end of its own. */
static std::string limit_passed(const std::string &path, const gtx_limits &limits,
                                uint64_t decoders = 4 * MEGABYTE)
{
    const size_t before = held;
    peak = before;
    std::string out, message;
    {
        Task task(1, nullptr, nullptr, {"import"}, {1}, limits);
        try {
            gtx::import_mesh(path, task);
        } catch (const gtx::Error &e) {
            out = e.limit ? e.limit : "";
            message = e.message;
            assert_int_equal(e.result == GTX_ERROR_LIMIT, e.limit != nullptr);
        }
    }
    if (peak - before > limits.memory + decoders)
        fail_msg("%s: %zu bytes of %llu: %s", path.c_str(), size_t(peak - before),
                 (unsigned long long)limits.memory, message.c_str());
    return out;
}

static void assert_passes(const std::string &name, const std::string &bytes, const char *limit)
{
    Folder folder;
    const std::string passed = limit_passed(folder.write(name, bytes), small_limits());
    if (passed != limit)
        fail_msg("%s passes '%s', not '%s'", name.c_str(), passed.c_str(), limit);
}

/* ---- files ---- */

static std::string gltf_of(const std::string &accessor, const std::string &primitives,
                           const std::string &nodes = "{\"mesh\":0}")
{
    return "{\"asset\":{\"version\":\"2.0\"},\"accessors\":[" + accessor +
           "],\"meshes\":[{\"primitives\":[" + primitives + "]}],\"nodes\":[" + nodes + "]}";
}

static std::string zeros(const char *count)
{
    return std::string("{\"componentType\":5126,\"type\":\"VEC3\",\"count\":") + count + "}";
}

static std::string repeated(const std::string &text, size_t count)
{
    std::string out;
    for (size_t i = 0; i < count; ++i)
        out += (i ? "," : "") + text;
    return out;
}

static std::string varint(uint32_t value)
{
    std::string out;
    for (; value >= 0x80; value >>= 7)
        out += char(value | 0x80);
    return out + char(value);
}

/* ---- the tests ---- */

static const std::string PRIMITIVE = "{\"attributes\":{\"POSITION\":0}}";

static void accessors_without_data(void **)
{
    assert_passes("a.gltf", gltf_of(zeros("16777216"), PRIMITIVE), "memory");
    assert_passes("b.gltf", gltf_of(zeros("4294967294"), PRIMITIVE), "memory");
    assert_passes("c.gltf", gltf_of(zeros("18446744073709551615"), PRIMITIVE), "");
    assert_passes("d.gltf", gltf_of(zeros("3000"), repeated(PRIMITIVE, 8)), "triangles");
}

static void instances(void **)
{
    assert_passes("a.gltf", gltf_of(zeros("300"), PRIMITIVE, repeated("{\"mesh\":0}", 11)),
                  "triangles");
    assert_passes("b.gltf", gltf_of(zeros("300"), PRIMITIVE, repeated("{\"mesh\":0}", 9)), "");
}

/* One file, however often it is named. */
static void buffers_that_name_the_document(void **)
{
    const std::string buffer = "{\"byteLength\":1,\"uri\":\"a.gltf\"}";
    std::string text = gltf_of(zeros("3"), PRIMITIVE);
    text.insert(1, "\"buffers\":[" + repeated(buffer, 3000) + "],");
    assert_passes("a.gltf", text, "");
}

static void what_gzip_has_packed(void **)
{
    const std::string zeros(64 * MEGABYTE, 0);
    assert_passes("a.ply.gz", gzipped(zeros), ""); /* no PLY begins so: the rest is not inflated */
    assert_passes("b.ply.gz", gzipped("ply\n" + zeros), "memory");
    std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    for (int i = 0; i < 1001; ++i)
        obj += "f 1 2 3\n";
    assert_passes("c.obj.gz", gzipped(obj), "triangles");
}

/* What a Draco stream claims is asked for before its decoder takes memory for it. */
static void draco_claims(void **)
{
    const std::string edgebreaker("DRACO\2\2\1\1\0\0\0", 12), sequential("DRACO\2\2\1\0\0\0", 11);
    const std::string rest(60, 0);
    assert_passes("faces.drc", edgebreaker + varint(500) + varint(1000000000) + rest, "triangles");
    assert_passes("points.drc", edgebreaker + varint(1000000000) + varint(500) + rest, "triangles");
    assert_passes("splits.drc", edgebreaker + varint(9) + varint(9) + "\1" + varint(9) +
                                    varint(1000000000) + rest, "triangles");
    assert_passes("sequential.drc", sequential + varint(1) + varint(1000000000) + rest,
                  "triangles");
    assert_passes("ends.drc", edgebreaker, "");
}

static void big_endian(std::string &to, uint32_t value)
{
    for (int shift = 24; shift >= 0; shift -= 8)
        to += char(value >> shift);
}

static std::string chunk(const std::string &type, const std::string &bytes)
{
    std::string out;
    big_endian(out, uint32_t(bytes.size()));
    const std::string body = type + bytes;
    out += body;
    big_endian(out, uint32_t(crc32(0, reinterpret_cast<const Bytef *>(body.data()),
                                   uInt(body.size()))));
    return out;
}

/* Grey, all black; the pixels may be missing. */
static std::string png(uint32_t side, bool whole)
{
    std::string header, rows(size_t(side) * (side + 1) * whole, 0);
    big_endian(header, side);
    big_endian(header, side);
    header += std::string("\10\0\0\0\0", 5);
    uLongf size = compressBound(uLong(rows.size()));
    std::string packed(size, 0);
    compress(reinterpret_cast<Bytef *>(packed.data()), &size,
             reinterpret_cast<const Bytef *>(rows.data()), uLong(rows.size()));
    packed.resize(size);
    return "\x89PNG\r\n\x1a\n" + chunk("IHDR", header) + chunk("IDAT", packed) + chunk("IEND", "");
}

static std::string write_textured(const Folder &folder, uint32_t side, bool whole)
{
    folder.write("a.png", png(side, whole));
    folder.write("a.mtl", "newmtl m\nmap_Kd a.png\n");
    return folder.write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\n"
                                 "f 1/1 2/1 3/1\n");
}

/* OpenImageIO takes 64 MB to open any image. */
static std::string image_passes(uint32_t side, bool whole, uint64_t pixels)
{
    Folder folder;
    gtx_limits limits = small_limits();
    limits.pixels = pixels;
    return limit_passed(write_textured(folder, side, whole), limits, 68 * MEGABYTE);
}

static void images(void **)
{
    assert_string_equal(image_passes(20000, false, 10000).c_str(), "pixels");
    assert_string_equal(image_passes(101, true, 10000).c_str(), "pixels");
    assert_string_equal(image_passes(100, true, 10000).c_str(), "");
    assert_string_equal(image_passes(2000, true, UINT64_MAX).c_str(), "memory");
}

/* What would never end is no part of a model. */
static void pipes_are_not_waited_for(void **)
{
    Folder folder;
    const std::string pipe = (folder.path / "a.bin").string();
    assert_int_equal(mkfifo(pipe.c_str(), 0600), 0);
    std::string text = gltf_of(zeros("3"), PRIMITIVE);
    text.insert(1, "\"buffers\":[{\"byteLength\":1,\"uri\":\"a.bin\"}],");
    alarm(20);
    assert_fails(import_path(folder.write("a.gltf", text)), GTX_ERROR_READ, "not a regular");
    alarm(0);
}

/* A file of no such kind is not read to its end, which takes 64 GB here. */
static void first_bytes_come_first(void **)
{
    Folder folder;
    for (const char *name : {"a.ply", "a.drc", "a.glb", "a.gltf", "a.obj", "a.off", "a.stl", "a"}) {
        const std::string path = folder.write(name, "");
        std::filesystem::resize_file(path, uint64_t(1) << 36);
        const Imported read = import_path(path);
        if (read.result != GTX_ERROR_INPUT && read.result != GTX_ERROR_EMPTY &&
            read.result != GTX_ERROR_UNSUPPORTED)
            fail_msg("%s: %d, %s", name, read.result, read.message.c_str());
    }
}

int main()
{
    const CMUnitTest tests[] = {
        cmocka_unit_test(accessors_without_data),
        cmocka_unit_test(instances),
        cmocka_unit_test(buffers_that_name_the_document),
        cmocka_unit_test(what_gzip_has_packed),
        cmocka_unit_test(draco_claims),
        cmocka_unit_test(images),
        cmocka_unit_test(pipes_are_not_waited_for),
        cmocka_unit_test(first_bytes_come_first),
    };
    return cmocka_run_group_tests_name("limits", tests, nullptr, nullptr);
}
