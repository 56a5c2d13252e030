/* A folder of its own for each test program. */
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

namespace fs = std::filesystem;

inline fs::path folder;

inline std::string in_folder(const char *name)
{
    return (folder / name).string();
}

/* Fixtures of a group of tests. */
inline int make_folder(void **)
{
    char name[] = "/tmp/geotex-test-XXXXXX";
    if (!mkdtemp(name))
        return -1;
    folder = name;
    return 0;
}

inline int remove_folder(void **)
{
    fs::remove_all(folder);
    return 0;
}
