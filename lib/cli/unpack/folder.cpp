/* Folders of an unpacked asset, through POSIX. */
#include "cli/unpack/unpacked.hpp"

#include <cerrno>
#include <cstring>
#include <memory>

#include <dirent.h>
#include <fcntl.h>
#include <unistd.h>

namespace gtx {

using Listing = std::unique_ptr<DIR, int (*)(DIR *)>;

static const char *next_name(DIR *listing)
{
    const dirent *entry = readdir(listing);
    while (entry && (!std::strcmp(entry->d_name, ".") || !std::strcmp(entry->d_name, "..")))
        entry = readdir(listing);
    return entry ? entry->d_name : nullptr;
}

Vector<std::string> names_in(const std::string &folder)
{
    Vector<std::string> out;
    const Listing listing(opendir(folder.c_str()), closedir);
    if (!listing && errno == ENOMEM)
        throw std::bad_alloc();
    while (const char *name = listing ? next_name(listing.get()) : nullptr)
        out.emplace_back(name);
    return out;
}

void remove_folder(const std::string &folder) noexcept
{
    if (const Listing listing{opendir(folder.c_str()), closedir})
        while (const char *name = next_name(listing.get()))
            unlinkat(dirfd(listing.get()), name, 0);
    rmdir(folder.c_str());
}

} // namespace gtx
