/* Running the command in a folder of the test's own. */
#ifndef GTX_TESTS_COMMAND_H
#define GTX_TESTS_COMMAND_H

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include <dirent.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>

static char folder[64];
static char output[65536]; /* of the last command, stdout then stderr */

/* Runs `gtx ARGUMENTS` in the test's folder; returns the exit code. */
static inline int gtx(const char *format, ...)
{
    char arguments[1024], command[2048];
    va_list args;
    va_start(args, format);
    vsnprintf(arguments, sizeof arguments, format, args);
    va_end(args);
    snprintf(command, sizeof command, "cd %s && '%s' %s 2>stderr.txt", folder, getenv("GTX"),
             arguments);
    FILE *pipe = popen(command, "r");
    assert_non_null(pipe);
    size_t size = fread(output, 1, sizeof output - 1, pipe);
    int status = pclose(pipe);
    char path[128];
    snprintf(path, sizeof path, "%s/stderr.txt", folder);
    FILE *errors = fopen(path, "r");
    if (errors) {
        size += fread(output + size, 1, sizeof output - 1 - size, errors);
        fclose(errors);
    }
    output[size] = 0;
    if (!WIFEXITED(status))
        fail_msg("gtx %s died by signal: %s", arguments, output);
    return WEXITSTATUS(status);
}

static inline void expect(int code, int wanted)
{
    if (code != wanted)
        fail_msg("exit code %d instead of %d: %s", code, wanted, output);
}

static inline void expect_text(const char *text)
{
    if (!strstr(output, text))
        fail_msg("'%s' is not in: %s", text, output);
}

/* Runs a shell command in the test's folder; its output goes to `output`. */
static inline int shell(const char *format, ...)
{
    char line[2048], command[3072];
    va_list args;
    va_start(args, format);
    vsnprintf(line, sizeof line, format, args);
    va_end(args);
    snprintf(command, sizeof command, "cd %s && { %s; } 2>&1", folder, line);
    FILE *pipe = popen(command, "r");
    assert_non_null(pipe);
    output[fread(output, 1, sizeof output - 1, pipe)] = 0;
    int status = pclose(pipe);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/* The same; fails the test if the command fails. */
static inline void run_shell(const char *command)
{
    expect(shell("%s", command), 0);
}

/* Skips the test where the machine lacks a program. */
static inline void need(const char *program)
{
    if (shell("command -v %s", program))
        skip();
}

static inline char *in_folder(const char *name)
{
    static char path[4][192];
    static unsigned turn;
    turn = (turn + 1) % 4;
    snprintf(path[turn], sizeof path[turn], "%s/%s", folder, name);
    return path[turn];
}

static inline bool exists(const char *name)
{
    struct stat info;
    return stat(in_folder(name), &info) == 0;
}

/* Files of the command's own that are still in the test's folder. */
static inline int left_over(void)
{
    int count = 0;
    DIR *list = opendir(folder);
    assert_non_null(list);
    for (struct dirent *entry; (entry = readdir(list)) != NULL;)
        count += !strncmp(entry->d_name, ".gtx-", 5) || strstr(entry->d_name, ".tmp") != NULL;
    closedir(list);
    return count;
}

static inline void write_file(const char *name, const void *data, size_t size)
{
    FILE *file = fopen(in_folder(name), "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(data, 1, size, file), size);
    fclose(file);
}

static inline char *slurp(const char *name, size_t *size)
{
    FILE *file = fopen(in_folder(name), "rb");
    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    *size = (size_t)ftell(file);
    rewind(file);
    char *data = (char *)malloc(*size + 1);
    assert_non_null(data);
    assert_int_equal(fread(data, 1, *size, file), *size);
    fclose(file);
    return data;
}

static inline void same_files(const char *a, const char *b)
{
    size_t size[2];
    char *data[2] = {slurp(a, &size[0]), slurp(b, &size[1])};
    assert_int_equal(size[0], size[1]);
    assert_memory_equal(data[0], data[1], size[0]);
    free(data[0]);
    free(data[1]);
}

/* A closed bumpy sphere of 2 * n * n * 2 triangles or so. */
static inline void write_sphere(const char *name, unsigned n)
{
    FILE *file = fopen(in_folder(name), "w");
    const double pi = acos(-1);
    unsigned columns = 2 * n;
    assert_non_null(file);
    fprintf(file, "v 0 1 0\nv 0 -1 0\n");
    for (unsigned i = 1; i < n; ++i)
        for (unsigned j = 0; j < columns; ++j) {
            double a = pi * i / n, b = 2 * pi * j / columns;
            double r = 1 + 0.03 * sin(7 * a) * cos(6 * b);
            fprintf(file, "v %.9g %.9g %.9g\n", r * sin(a) * cos(b), r * cos(a),
                    r * sin(a) * sin(b));
        }
    for (unsigned j = 0; j < columns; ++j) {
        unsigned k = (j + 1) % columns, last = 3 + (n - 2) * columns;
        fprintf(file, "f 1 %u %u\nf 2 %u %u\n", 3 + k, 3 + j, last + j, last + k);
        for (unsigned i = 0; i + 2 < n; ++i) {
            unsigned a = 3 + i * columns, b = a + columns;
            fprintf(file, "f %u %u %u %u\n", a + j, a + k, b + k, b + j);
        }
    }
    fclose(file);
}

static inline int set_up(void **state)
{
    (void)state;
    if (!getenv("GTX")) {
        fprintf(stderr, "GTX, the path of the command, is not set\n");
        return 1;
    }
    strcpy(folder, "/tmp/gtx-cli-XXXXXX");
    if (!mkdtemp(folder))
        return 1;
    write_sphere("sphere.obj", 40);
    return gtx("cook sphere.obj -o sphere.gtx");
}

static inline int tear_down(void **state)
{
    char command[128];
    (void)state;
    snprintf(command, sizeof command, "rm -rf %s", folder);
    return system(command);
}

#endif
