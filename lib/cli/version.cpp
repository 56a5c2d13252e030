/* gtx --version: versions for bug reports and build logs. */
#include "cli/cli.h"

extern "C" {
#include "asset/codec.h"
}
#include "cook/options.hpp"
#include "mesh/versions.hpp"

#include "commit.h" /* made by the Makefile; empty where the sources are no git checkout */

#include <cstdio>
#include <string>

void print_version()
{
    const uint32_t v = gtx_version();
    std::printf("gtx %u.%u.%u%s\n", v / 10000, v / 100 % 100, v % 100, GTX_COMMIT);
    std::printf("format %d.%d, cooker revision %d\n", GTX_FORMAT_MAJOR, GTX_FORMAT_MINOR,
                gtx::COOKER_REVISION);
    const std::string zstd = gtx_zstd_version();
    std::printf("zstd %s, %s\n", zstd.empty() ? "none" : zstd.c_str(),
                gtx::mesh_library_versions().c_str());
}
