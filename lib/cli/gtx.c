/* The `gtx` command: picks a verb. */
#include "cli/cli.h"

#include <signal.h>
#include <string.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

static const struct {
    const char *name;
    int (*run)(int argc, char **argv);
    const char *summary;
} verbs[] = {
    {"cook", cmd_cook, "cook a triangle mesh into a .gtx asset"},
    {"horizons", cmd_horizons, "make an asset of height grids: horizons or terrain"},
    {"world", cmd_world, "cook models of any size in parts, into a tree of tiles (3D Tiles)"},
    {"info", cmd_info, "print what is in an asset"},
    {"validate", cmd_validate, "check an asset against every rule of the format"},
    {"unpack", cmd_unpack, "write an asset's maps as images, to inspect and edit"},
    {"pack", cmd_pack, "make an asset of unpacked images"},
    {"export", cmd_export, "export an asset as glTF, for tools that do not read .gtx"},
    {"filter", cmd_filter, "blur, boost or pattern the surface of an asset"},
    {"combine", cmd_combine, "unite, intersect or subtract two closed assets"},
    {"render", cmd_render, "draw assets and meshes to a PNG, without a window"},
    {"view", cmd_view, "show assets and meshes in a window"},
    {"compare", cmd_compare, "measure an asset or a world against the mesh it was cooked from"},
    {"bench", cmd_bench, "time an asset against the mesh it was cooked from"},
};

static void print_verbs(FILE *to)
{
    fputs("gtx VERB [options] ...\n\n", to);
    for (size_t i = 0; i < sizeof verbs / sizeof *verbs; ++i)
        fprintf(to, "  %-10s %s\n", verbs[i].name, verbs[i].summary);
    fputs("\n`gtx help VERB` lists a verb's options. Results go to stdout, messages to stderr.\n"
          "Exit codes: 0 ok, 1 usage, 2 a file cannot be read or written, 3 invalid input,\n"
          "4 internal error, 5 unsupported, 6 a --max limit is exceeded or memory is out,\n"
          "7 a limit of compare is exceeded, 130 cancelled.\n", to);
}

/* A cook takes large blocks and gives them back all the time: kept, they are not new pages that
 * the kernel has to clear. Andes of 2.88 M triangles: 1.7 s in the kernel become .7, of 19.5 in
 * all, and the peak grows by 1 to 7 %. */
static void keep_memory(void)
{
#ifdef __GLIBC__
    mallopt(M_MMAP_MAX, 0);
    mallopt(M_TRIM_THRESHOLD, -1);
    mallopt(M_TOP_PAD, 16 << 20);
#endif
}

int main(int argc, char **argv)
{
    signal(SIGXFSZ, SIG_IGN); /* a file that may not grow is an error, as a full disk is */
    if (argc < 2) {
        print_verbs(stderr);
        return EXIT_CODE_USAGE;
    }
    if (!strcmp(argv[1], "help") && argc > 2) { /* as `gtx VERB --help` */
        static char help[] = "--help";
        argv[1] = argv[2];
        argv[2] = help;
        argc = 3;
    }
    if (!strcmp(argv[1], "--help") || !strcmp(argv[1], "-h") || !strcmp(argv[1], "help")) {
        print_verbs(stdout);
        return EXIT_CODE_OK;
    }
    if (!strcmp(argv[1], "--version")) {
        print_version();
        return EXIT_CODE_OK;
    }
    for (size_t i = 0; i < sizeof verbs / sizeof *verbs; ++i)
        if (!strcmp(argv[1], verbs[i].name)) {
            if (verbs[i].run == cmd_cook || verbs[i].run == cmd_world)
                keep_memory();
            return verbs[i].run(argc - 1, argv + 1);
        }
    print_message("gtx: error[usage]: unknown verb '%s' (see gtx --help)", argv[1]);
    return EXIT_CODE_USAGE;
}
