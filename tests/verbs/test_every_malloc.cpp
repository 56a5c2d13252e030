/* The k-th malloc of a verb fails, for every k: the verb says so and ends with an exit code that
 * is documented, or does all of its work; what it writes is whole or not there. */
#include "bake/shapes.hpp"
#include "cli/cli.h"
#include "image/image.h"

#include <geotex/cook.h>

#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <map>
#include <new>

#include <dlfcn.h>
#include <execinfo.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
extern "C" {
#include <cmocka.h>
}

namespace fs = std::filesystem;

/* ---- mallocs that fail ---- */

#ifdef __SANITIZE_ADDRESS__
#define REAL(name) __interceptor_##name
#else
#define REAL(name) __libc_##name
#endif
extern "C" void *REAL(malloc)(size_t);
extern "C" void *REAL(calloc)(size_t, size_t);
extern "C" void *REAL(realloc)(void *, size_t);

/* Shared with the copies of this process: how many a whole run takes. */
static size_t *taken;
static size_t fail_at = 0; /* 0 = never */

static bool fails()
{
    if (!fail_at || ++*taken != fail_at)
        return false;
    errno = ENOMEM;
    return true;
}

extern "C" void *malloc(size_t size)
{
    return fails() ? nullptr : REAL(malloc)(size);
}

extern "C" void *calloc(size_t count, size_t size)
{
    return fails() ? nullptr : REAL(calloc)(count, size);
}

extern "C" void *realloc(void *memory, size_t size)
{
    return fails() ? nullptr : REAL(realloc)(memory, size);
}

void *operator new(size_t size)
{
    void *memory = malloc(size ? size : 1);
    if (!memory)
        throw std::bad_alloc();
    return memory;
}

void *operator new[](size_t size) { return operator new(size); }
void operator delete(void *memory) noexcept { std::free(memory); }
void operator delete[](void *memory) noexcept { std::free(memory); }
void operator delete(void *memory, size_t) noexcept { std::free(memory); }
void operator delete[](void *memory, size_t) noexcept { std::free(memory); }

/* OpenImageIO takes memory in functions that may not throw, and so ends the program: an exit code
 * of its own, for that is not ours to mend. */
constexpr int EXIT_CODE_LIBRARY = 99;

static void on_terminate()
{
    void *frames[64];
    fail_at = 0;
    const int count = backtrace(frames, 64);
    for (int i = 0; i < count; ++i) {
        Dl_info code;
        if (dladdr(frames[i], &code) && strstr(code.dli_fname, "libOpenImageIO"))
            _exit(EXIT_CODE_LIBRARY);
    }
    abort();
}

/* ---- verbs, each in a copy of this process ---- */

static fs::path folder;

static const struct {
    const char *name;
    int (*run)(int, char **);
    std::vector<const char *> arguments;
} runs[] = {
    {"unpack", cmd_unpack, {"a.gtx", "out"}},
    {"pack", cmd_pack, {"unpacked", "-o", "out"}},
    {"pack an asset", cmd_pack, {"a.gtx", "-o", "out", "--lod-levels", "1", "--zstd", "1"}},
    {"filter", cmd_filter, {"a.gtx", "-o", "out", "--gaussian", "1"}},
    {"combine", cmd_combine, {"a.gtx", "b.gtx", "-o", "out", "--op", "subtract"}},
    {"compare", cmd_compare, {"a.gtx", "ball.obj", "--size", "64", "--json"}},
    {"validate", cmd_validate, {"a.gtx", "--json"}},
    {"info", cmd_info, {"a.gtx", "--json"}},
};

/* Every file below the folder. */
static std::map<std::string, std::string> contents()
{
    std::map<std::string, std::string> out;
    for (const auto &entry : fs::recursive_directory_iterator(folder)) {
        std::ifstream file(entry.path(), std::ios::binary);
        const std::string name = fs::relative(entry.path(), folder).string();
        if (name != "stdout" && name != "stderr")
            out[name] = entry.is_directory()
                            ? std::string()
                            : std::string(std::istreambuf_iterator<char>(file), {});
    }
    return out;
}

static std::string said()
{
    std::ifstream file(folder / "stderr");
    return {std::istreambuf_iterator<char>(file), {}};
}

/* The status that waitpid tells, of a run whose k-th malloc fails. */
static int status_of(size_t run, size_t k)
{
    constexpr unsigned SECONDS = 20; /* hangs */
    *taken = 0;
    const pid_t copy = fork();
    if (copy == 0) {
        const int out = open("stdout", O_WRONLY | O_CREAT | O_TRUNC, 0666);
        const int err = open("stderr", O_WRONLY | O_CREAT | O_TRUNC, 0666);
        dup2(out, STDOUT_FILENO);
        dup2(err, STDERR_FILENO);
        alarm(SECONDS);
        std::vector<char *> arguments = {const_cast<char *>(runs[run].name)};
        for (const char *argument : runs[run].arguments)
            arguments.push_back(const_cast<char *>(argument));
        arguments.push_back(nullptr);
        std::set_terminate(on_terminate);
        fail_at = k;
        const int code = runs[run].run(int(arguments.size()) - 1, arguments.data());
        fail_at = 0;
        fflush(nullptr); /* no exit: threads that libraries would wait for are not copied */
        _exit(code);
    }
    int status = -1;
    assert_int_equal(waitpid(copy, &status, 0), copy);
    return status;
}

/* All of them where all is asked for; else so many, evenly. */
static size_t stride(size_t count)
{
    constexpr size_t SOME = 40;
    const char *corpus = getenv("GTX_CORPUS");
    return corpus && !strcmp(corpus, "all") ? 1 : count / SOME + 1;
}

static void every_malloc_fails(void **state)
{
    const size_t run = *static_cast<size_t *>(*state);
    const auto before = contents();
    assert_int_equal(status_of(run, SIZE_MAX), 0);
    const size_t count = *taken;
    const auto after = contents();
    fs::remove_all("out");
    assert_true(contents() == before);
    std::map<int, size_t> codes;
    for (size_t k = 1; k <= count; k += stride(count)) {
        const int status = status_of(run, k);
        const int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
        ++codes[code];
        if (code != EXIT_CODE_OK && code != EXIT_CODE_LIMIT && code != EXIT_CODE_FILE &&
            code != EXIT_CODE_UNSUPPORTED && code != EXIT_CODE_LIBRARY)
            fail_msg("malloc %zu of %zu: status %#x: %s", k, count, status, said().c_str());
        if (code && code != EXIT_CODE_LIBRARY && said().empty())
            fail_msg("malloc %zu of %zu: exit code %d without a word", k, count, code);
        if (code == EXIT_CODE_LIBRARY) { /* what a program that dies has begun stays */
            assert_false(fs::exists("out"));
            for (const auto &file : contents())
                if (!before.count(file.first))
                    fs::remove_all(file.first);
        } else if (contents() != (code ? before : after))
            fail_msg("malloc %zu of %zu: exit code %d, and other files than then", k, count, code);
        fs::remove_all("out");
    }
    for (const auto &code : codes)
        print_message("%s: %zu of %zu end with %d\n", runs[run].name, code.second, count,
                      code.first);
}

/* ---- the assets ---- */

/* A ball that is moved by so much. */
static gtx_result cook_ball(double aside, const char *model, const char *asset)
{
    const gtx::Mesh ball = shapes::ball(4, shapes::bumps);
    std::ofstream file(model);
    for (const gtx::Vec3d &p : ball.positions)
        file << "v " << p.x + aside << ' ' << p.y << ' ' << p.z << '\n';
    for (const auto &t : ball.triangles)
        file << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
    file.close();
    gtx_cook_desc desc = {};
    desc.charts = 2;
    desc.resolution = 64;
    desc.mips = 2;
    desc.lod_levels = 1;
    return gtx_cook_file(model, asset, &desc, nullptr, nullptr);
}

static int prepare(void **)
{
    const fs::path home = fs::exists("/dev/shm") ? "/dev/shm" : fs::temp_directory_path();
    std::string name = (home / "gtx-verbs-XXXXXX").string();
    if (!mkdtemp(name.data()))
        return 1;
    folder = name;
    fs::current_path(folder);
    taken = static_cast<size_t *>(mmap(nullptr, sizeof *taken, PROT_READ | PROT_WRITE,
                                       MAP_SHARED | MAP_ANONYMOUS, -1, 0));
    if (cook_ball(0, "ball.obj", "a.gtx") || cook_ball(0.5, "aside.obj", "b.gtx"))
        return 1;
    const uint8_t texel[3] = {1, 2, 3}; /* the image module is loaded here, for all copies */
    if (gtx_image_write_png("texel.png", 1, 1, 3, texel, nullptr))
        return 1;
    char *arguments[] = {const_cast<char *>("unpack"), const_cast<char *>("a.gtx"),
                         const_cast<char *>("unpacked"), nullptr};
    return cmd_unpack(3, arguments);
}

static int remove_folder(void **)
{
    fs::current_path("/");
    fs::remove_all(folder);
    return 0;
}

int main()
{
    static size_t numbers[std::size(runs)];
    std::vector<CMUnitTest> tests;
    for (size_t i = 0; i < std::size(runs); ++i) {
        numbers[i] = i;
        tests.push_back({runs[i].name, every_malloc_fails, nullptr, nullptr, &numbers[i]});
    }
    return _cmocka_run_group_tests("verbs", tests.data(), tests.size(), prepare, remove_folder);
}
