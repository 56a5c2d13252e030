/* Writing files atomically. The only file of libgeotex that uses POSIX, where it exists: standard C
 * has neither links nor permissions, and cannot tell when bytes are on the disk. */
#if defined(__unix__) || defined(__APPLE__)
#define _POSIX_C_SOURCE 200809L
#define HAS_POSIX
#endif
#include "base/output.h"

#include "base/error.h"

#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

enum { MAX_PATH = 4096, MAX_TRIES = 100, MAX_SHOWN = 120 };

/* Bytes of `path` before its last name. */
static size_t folder_length(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? (size_t)(slash - path) + 1 : 0;
}

/* A short name beside `path`, which may itself be as long as names can be. Who takes it makes sure
 * that nobody else has: others only make it likely that the first try will do. */
static bool name_temporary(const char *path, unsigned others, unsigned try, char name[MAX_PATH])
{
    static const char digits[] = "0123456789abcdefghijklmnopqrstuv";
    const size_t folder = folder_length(path);
    char own[] = ".gtx-xxxxxxxx";
    uint64_t seed = (uint64_t)time(NULL) * 0x9e3779b97f4a7c15u ^ (uint64_t)clock() << 32 ^
                    (uintptr_t)&seed ^ (uint64_t)others * 0xc2b2ae3d27d4eb4fu;
    seed = (seed ^ seed >> 29) * 0xbf58476d1ce4e5b9u + try;
    for (size_t i = 0; i < 8; ++i)
        own[5 + i] = digits[seed >> 5 * i & 31];
    if (folder + sizeof own > MAX_PATH) {
        errno = ENAMETOOLONG;
        return false;
    }
    memcpy(name, path, folder);
    memcpy(name + folder, own, sizeof own);
    return true;
}

#ifdef HAS_POSIX
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MAX_LINKS = 40, MAX_PIECE = 1 << 30 };

static bool is_same(const struct stat *a, const struct stat *b)
{
    return a->st_dev == b->st_dev && a->st_ino == b->st_ino;
}

/* The path that `path` leads to, whether there is anything or not. */
static bool follow(const char *path, char target[MAX_PATH])
{
    struct stat info;
    char link[MAX_PATH];
    size_t length = strlen(path), folder = 0;
    const char *next = path;
    for (int links = 0; ; ++links) {
        if (folder + length >= MAX_PATH || links > MAX_LINKS) {
            errno = links > MAX_LINKS ? ELOOP : ENAMETOOLONG;
            return false;
        }
        memcpy(target + folder, next, length);
        target[folder + length] = 0;
        if (lstat(target, &info) || !S_ISLNK(info.st_mode))
            return true;
        const ssize_t got = readlink(target, link, sizeof link);
        if (got < 0)
            return false;
        length = (size_t)got;
        folder = length && *link == '/' ? 0 : folder_length(target);
        next = link;
    }
}

static bool write_all(int file, const char *data, size_t size)
{
    while (size) {
        const ssize_t done = write(file, data, size < MAX_PIECE ? size : MAX_PIECE);
        if (done == 0)
            errno = EIO;
        if (done <= 0 && (done == 0 || errno != EINTR))
            return false;
        data += done > 0 ? done : 0;
        size -= done > 0 ? (size_t)done : 0;
    }
    return true;
}

/* Some file systems cannot, which is no fault of the data. */
static bool sync_file(int file)
{
    return fsync(file) == 0 || errno == EINVAL || errno == ENOSYS || errno == ENOTSUP;
}

static void sync_folder(char *path)
{
    path[folder_length(path)] = 0;
    const int folder = open(*path ? path : ".", O_RDONLY | O_CLOEXEC);
    if (folder < 0)
        return;
    fsync(folder);
    close(folder);
}

/* The owner and permissions of the file that it replaces. Where the group cannot be kept, the new
 * one may do what everybody may. */
static void keep_mode(int file, const struct stat *old)
{
    mode_t mode = old->st_mode & 0777;
    if (fchown(file, old->st_uid, old->st_gid) && fchown(file, (uid_t)-1, old->st_gid))
        mode = (mode & 0707) | (mode & 07) << 3;
    fchmod(file, mode);
}

/* `old` is NULL for a new file. */
static bool replace(char target[MAX_PATH], const struct stat *old, const void *data, size_t size)
{
    char name[MAX_PATH];
    int file = -1;
    for (unsigned i = 0; file < 0 && i < MAX_TRIES; ++i) {
        if (!name_temporary(target, (unsigned)getpid(), i, name))
            return false;
        file = open(name, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, old ? 0600 : 0666);
        if (file < 0 && errno != EEXIST)
            return false;
    }
    if (file < 0)
        return false;
    if (old)
        keep_mode(file, old);
    int reason = write_all(file, data, size) && sync_file(file) ? 0 : errno;
    if (close(file) && !reason)
        reason = errno;
    if (!reason && rename(name, target))
        reason = errno;
    if (reason)
        unlink(name);
    else
        sync_folder(target);
    errno = reason;
    return !reason;
}

static bool write_through(const char *path, const void *data, size_t size)
{
    const int file = open(path, O_WRONLY | O_TRUNC | O_NOCTTY | O_CLOEXEC);
    if (file < 0)
        return false;
    int reason = write_all(file, data, size) ? 0 : errno;
    if (close(file) && !reason)
        reason = errno;
    errno = reason;
    return !reason;
}

static bool write_file(const char *path, const void *data, size_t size)
{
    struct stat old, at_target, stream;
    char target[MAX_PATH];
    if (!follow(path, target))
        return false;
    if (stat(path, &old))
        return replace(target, NULL, data, size);
    if (S_ISREG(old.st_mode))
        for (int i = STDOUT_FILENO; i <= STDERR_FILENO; ++i)
            if (fstat(i, &stream) == 0 && is_same(&stream, &old))
                return write_all(i, data, size);
    /* A link of the system's may lead elsewhere than it says: to a file without a name. */
    const bool is_plain = S_ISREG(old.st_mode) && lstat(target, &at_target) == 0 &&
                          is_same(&at_target, &old);
    return is_plain ? replace(target, &old, data, size) : write_through(path, data, size);
}

static bool is_kept(const struct stat *info)
{
    return !S_ISCHR(info->st_mode) && !S_ISSOCK(info->st_mode);
}

bool gtx_same_file(const char *a, const char *b)
{
    struct stat at_a, at_b;
    char to_a[MAX_PATH], to_b[MAX_PATH];
    const bool has_a = stat(a, &at_a) == 0, has_b = stat(b, &at_b) == 0;
    if (has_a || has_b)
        return has_a && has_b && is_same(&at_a, &at_b) && is_kept(&at_a);
    if (!follow(a, to_a) || !follow(b, to_b))
        return strcmp(a, b) == 0;
    char *name_a = to_a + folder_length(to_a), *name_b = to_b + folder_length(to_b);
    if (strcmp(name_a, name_b))
        return false;
    *name_a = *name_b = 0;
    return stat(*to_a ? to_a : ".", &at_a) == 0 && stat(*to_b ? to_b : ".", &at_b) == 0 &&
           is_same(&at_a, &at_b);
}

#else

static bool write_file(const char *path, const void *data, size_t size)
{
    char name[MAX_PATH];
    FILE *file = NULL;
    for (unsigned i = 0; !file && i < MAX_TRIES; ++i) {
        if (!name_temporary(path, 0, i, name))
            return false;
        file = fopen(name, "wbx");
    }
    if (!file)
        return false;
    bool whole = fwrite(data, 1, size, file) == size;
    whole = fclose(file) == 0 && whole;
    whole = whole && rename(name, path) == 0;
    if (!whole)
        remove(name);
    return whole;
}

bool gtx_same_file(const char *a, const char *b)
{
    return strcmp(a, b) == 0;
}

#endif

gtx_result gtx_write_file(const char *path, const void *data, size_t size, gtx_error *error)
{
    if (write_file(path, data, size))
        return GTX_OK;
    const size_t length = strlen(path), cut = length > MAX_SHOWN ? length - MAX_SHOWN : 0;
    return gtx_fail(error, GTX_ERROR_WRITE, "cannot write %s%s: %s", cut ? "..." : "", path + cut,
                    strerror(errno));
}
