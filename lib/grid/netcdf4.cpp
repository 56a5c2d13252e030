/* NetCDF-4 files, which are HDF5 -> classic ones, by a program of ours: HDF5's library crashes on
 * damaged files, and must not take the host with it. */
#include "grid/text.hpp"
#include "image/open.h"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace gtx {

namespace {

constexpr const char *NO_PROGRAM = "it is HDF5, as NetCDF-4 is, and geotex-netcdf is not there, "
                                   "which reads that: nccopy -k classic IN OUT makes one that is "
                                   "read";

/* The program, which reads from and writes to `socket`; ended with this. */
class Program {
public:
    Program(const char *path, uint64_t memory)
    {
        int pair[2];
        if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair) != 0)
            throw Error(GTX_ERROR_READ, std::strerror(errno));
        socket = pair[0];
        const std::string most = std::to_string(memory);
        char *const arguments[] = {const_cast<char *>(path), const_cast<char *>(most.c_str()),
                                   nullptr};
        char *const environment[] = {nullptr};
        posix_spawn_file_actions_t files;
        posix_spawn_file_actions_init(&files);
        for (int k : {0, 1})
            posix_spawn_file_actions_adddup2(&files, pair[1], k);
        posix_spawn_file_actions_addopen(&files, 2, "/dev/null", O_WRONLY, 0);
#if defined(__GLIBC__) && __GLIBC_PREREQ(2, 34)
        posix_spawn_file_actions_addclosefrom_np(&files, 3); /* nothing of the host's */
#endif
        const int failed = posix_spawn(&id_, path, &files, nullptr, arguments, environment);
        posix_spawn_file_actions_destroy(&files);
        close(pair[1]);
        if (failed) {
            close(socket);
            throw Error(GTX_ERROR_READ, std::string("geotex-netcdf: ") + std::strerror(failed));
        }
    }
    ~Program()
    {
        close(socket);
        kill(id_, SIGKILL); /* ours until it is waited for */
        while (waitpid(id_, nullptr, 0) < 0 && errno == EINTR)
            ;
    }
    Program(const Program &) = delete;
    Program &operator=(const Program &) = delete;

    void send(std::string_view bytes)
    {
        while (!bytes.empty()) {
            wait(POLLOUT);
            const ssize_t sent = ::send(socket, bytes.data(), std::min(bytes.size(), PART),
                                        MSG_NOSIGNAL | MSG_DONTWAIT);
            if (sent < 0 && errno != EAGAIN && errno != EINTR)
                break; /* it has ended: what it said tells why */
            bytes.remove_prefix(size_t(std::max<ssize_t>(sent, 0)));
        }
        shutdown(socket, SHUT_WR);
    }
    Bytes receive()
    {
        Bytes out;
        for (ssize_t got = 1; got != 0;) {
            const size_t before = out.size();
            wait(POLLIN);
            out.resize(before + PART);
            got = recv(socket, &out[before], PART, MSG_DONTWAIT);
            const bool again = got < 0 && (errno == EAGAIN || errno == EINTR);
            out.resize(before + size_t(std::max<ssize_t>(got, 0)));
            if (got < 0 && !again)
                break;
        }
        return out;
    }

private:
    static constexpr size_t PART = 1 << 16;

    /* With a point to cancel at now and then. */
    void wait(short what)
    {
        constexpr int MILLISECONDS = 100;
        pollfd ready = {socket, what, 0};
        do
            cancel_point();
        while (poll(&ready, 1, MILLISECONDS) == 0);
    }

    int socket;
    pid_t id_ = 0;
};

} // namespace

Bytes classic_of_netcdf4(std::string_view bytes, Task &task)
{
    /* Bytes of addresses beside what the job may take: a small file needs 70 MB, so half would do
     * with these libraries, and at double nothing changes. */
    constexpr uint64_t LIBRARIES = 256 << 20;
    char path[GTX_MAX_PROGRAM_PATH];
    if (!gtx_find_program("geotex-netcdf", path))
        throw Error(GTX_ERROR_UNSUPPORTED, NO_PROGRAM);
    const uint64_t memory = task.limits.of(GTX_LIMITED_MEMORY);
    Program program(path, std::min(memory, UINT64_MAX / 2) + LIBRARIES);
    program.send(bytes);
    Bytes said = program.receive();
    if (!said.empty() && said[0] == 'E')
        malformed("HDF5's library does not read it: " + std::string(said.begin() + 1, said.end()));
    uint64_t size = 0;
    for (size_t k = 1; k < 9 && k < said.size(); ++k)
        size = size << 8 | uint8_t(said[k]);
    if (said.size() < 9 || said[0] != 'C' || said.size() - 9 != size)
        malformed("it is damaged: HDF5's library crashes on it, or takes too much");
    said.erase(0, 9);
    return said;
}

} // namespace gtx
