/* What fuzzing has found: every file of the corpora, and every one that once failed, again.
 *
 *   test_fuzz TARGET FILE...   runs these alone */
#include "fuzz/fuzz.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
extern "C" {
#include <cmocka.h>
}

namespace fuzz {
/* Nothing is changed here. */
size_t mutate_bytes(uint8_t *, size_t size, size_t)
{
    return size;
}
} // namespace fuzz

static std::vector<std::filesystem::path> files_of(const char *kind, const char *target)
{
    std::vector<std::filesystem::path> out;
    std::error_code ignored;
    const auto folder = std::filesystem::path("tests/fuzz") / kind / target;
    for (const auto &entry : std::filesystem::directory_iterator(folder, ignored))
        out.push_back(entry.path());
    std::sort(out.begin(), out.end());
    return out;
}

static void run(const fuzz::Target &target, const std::filesystem::path &path)
{
    std::fprintf(stderr, "%s\n", path.c_str()); /* the last one said is to blame */
    std::ifstream in(path, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(in)), {});
    target.run(reinterpret_cast<const uint8_t *>(bytes.data()), bytes.size());
}

static void replay(void **state)
{
    const auto *target = static_cast<const fuzz::Target *>(*state);
    const auto corpus = files_of("corpus", target->name);
    assert_true(corpus.size() >= 5);
    for (const auto &files : {corpus, files_of("found", target->name)})
        for (const auto &path : files)
            run(*target, path);
}

int main(int count, char **arguments)
{
    std::vector<CMUnitTest> tests;
    for (size_t i = 0; count > 1 && i < fuzz::target_count; ++i)
        for (int a = 2; a < count && fuzz::targets[i].name == std::string(arguments[1]); ++a)
            run(fuzz::targets[i], arguments[a]);
    if (count > 1)
        return 0;
    for (size_t i = 0; i < fuzz::target_count; ++i)
        tests.push_back({fuzz::targets[i].name, replay, nullptr, nullptr,
                         const_cast<fuzz::Target *>(&fuzz::targets[i])});
    return _cmocka_run_group_tests("fuzz", tests.data(), tests.size(), nullptr, nullptr);
}
