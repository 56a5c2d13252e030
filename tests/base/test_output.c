/* Files written whole: over links, devices, pipes and other writers, and on disks that are full. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

#include "base/output.h"

#include <dirent.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <sys/wait.h>
#include <unistd.h>

/* Every test has a folder of its own, which is the current one. */
static char home[4096];

static int enter(void **state)
{
    char folder[] = "/tmp/gtx-output-XXXXXX";
    (void)state;
    umask(022);
    return !getcwd(home, sizeof home) || !mkdtemp(folder) || chdir(folder) ||
           !(*state = strdup(folder));
}

static int leave(void **state)
{
    char command[64];
    snprintf(command, sizeof command, "rm -rf %s", (char *)*state);
    free(*state);
    return chdir(home) || system(command);
}

/* What lies in a folder. */
static int entries(const char *folder)
{
    int count = -2;
    DIR *list = opendir(folder);
    assert_non_null(list);
    while (readdir(list))
        ++count;
    closedir(list);
    return count;
}

static gtx_result put(const char *path, const char *text)
{
    return gtx_write_file(path, text, strlen(text), NULL);
}

static void holds(const char *path, const char *text)
{
    char found[256] = "";
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    found[fread(found, 1, sizeof found - 1, file)] = 0;
    fclose(file);
    assert_string_equal(found, text);
}

static struct stat about(const char *path)
{
    struct stat info;
    assert_int_equal(lstat(path, &info), 0);
    return info;
}

static void permissions_are_kept(void **state)
{
    (void)state;
    assert_int_equal(put("new", "1"), GTX_OK);
    assert_int_equal(about("new").st_mode & 07777, 0644);
    assert_int_equal(chmod("new", 0600), 0);
    assert_int_equal(put("new", "two"), GTX_OK);
    assert_int_equal(about("new").st_mode & 07777, 0600);
    assert_int_equal(put("new", ""), GTX_OK);
    holds("new", "");
    if (geteuid() == 0) {
        assert_int_equal(chown("new", 65534, 65533), 0);
        assert_int_equal(put("new", "3"), GTX_OK);
        assert_true(about("new").st_uid == 65534 && about("new").st_gid == 65533);
    }
    assert_int_equal(entries("."), 1);
}

static void links_stay_links(void **state)
{
    (void)state;
    assert_int_equal(mkdir("far", 0755) | put("far/real", "old"), 0);
    assert_int_equal(symlink("far/second", "first") | symlink("real", "far/second"), 0);
    assert_int_equal(put("first", "new"), GTX_OK);
    assert_true(S_ISLNK(about("first").st_mode) && S_ISLNK(about("far/second").st_mode));
    holds("far/real", "new");
    assert_int_equal(entries("far"), 2);

    assert_int_equal(symlink("far/none", "dangling"), 0);
    assert_int_equal(put("dangling", "made"), GTX_OK);
    assert_true(S_ISLNK(about("dangling").st_mode) && S_ISREG(about("far/none").st_mode));
    holds("far/none", "made");

    gtx_error error;
    assert_int_equal(symlink("loop", "loop"), 0);
    assert_int_equal(gtx_write_file("loop", "x", 1, &error), GTX_ERROR_WRITE);
    assert_non_null(strstr(error.message, "cannot write loop: "));
    assert_int_equal(symlink("far", "folder"), 0);
    assert_int_equal(put("folder", "x"), GTX_ERROR_WRITE);
    assert_int_equal(put("nowhere/a", "x"), GTX_ERROR_WRITE);
    assert_int_equal(entries("."), 5);

    assert_int_equal(link("far/real", "hard"), 0);
    assert_int_equal(put("far/real", "third"), GTX_OK);
    holds("hard", "new"); /* what has another name does not change under it */
}

static void a_pipe_is_written_to(void **state)
{
    (void)state;
    assert_int_equal(mkfifo("pipe", 0600), 0);
    const pid_t reader = fork();
    assert_true(reader >= 0);
    if (reader == 0) {
        char text[8] = "";
        alarm(20); /* where nobody ever writes */
        const int file = open("pipe", O_RDONLY);
        _exit(read(file, text, sizeof text) != 5 || strcmp(text, "bytes"));
    }
    int status;
    assert_int_equal(put("pipe", "bytes"), GTX_OK);
    assert_int_equal(waitpid(reader, &status, 0), reader);
    assert_int_equal(status, 0);
    assert_true(S_ISFIFO(about("pipe").st_mode));
    assert_int_equal(entries("."), 1);
}

static void devices_are_written_to(void **state)
{
    (void)state;
    if (mknod("null", S_IFCHR | 0666, makedev(1, 3)) ||
        mknod("full", S_IFCHR | 0666, makedev(1, 7)) || open("null", O_WRONLY) < 0)
        skip();
    gtx_error error;
    assert_int_equal(symlink("full", "link"), 0);
    assert_int_equal(put("null", "x"), GTX_OK);
    assert_int_equal(gtx_write_file("link", "x", 1, &error), GTX_ERROR_WRITE);
    assert_string_equal(error.message, "cannot write link: No space left on device");
    assert_true(S_ISCHR(about("null").st_mode) && S_ISCHR(about("full").st_mode));
    assert_false(gtx_same_file("null", "null")); /* it keeps nothing */
    assert_int_equal(entries("."), 3);
}

/* Where standard output is a file, what is there already is not lost. The link is the test's own,
 * as /dev/stdout is the system's: no test names a device that others use. */
static void standard_output_goes_on(void **state)
{
    (void)state;
    if (access("/proc/self/fd/1", F_OK))
        skip();
    assert_int_equal(symlink("/proc/self/fd/1", "stdout"), 0);
    const pid_t writer = fork();
    assert_true(writer >= 0);
    if (writer == 0) {
        const int file = open("log", O_WRONLY | O_CREAT | O_APPEND, 0600);
        const bool redirected = dup2(file, STDOUT_FILENO) == STDOUT_FILENO;
        _exit(!redirected || write(STDOUT_FILENO, "head ", 5) != 5 || put("stdout", "tail") ||
              write(STDOUT_FILENO, ".", 1) != 1);
    }
    int status;
    assert_int_equal(waitpid(writer, &status, 0), writer);
    assert_int_equal(status, 0);
    holds("log", "head tail.");
    assert_true(S_ISLNK(about("stdout").st_mode));
}

static void a_full_disk_keeps_what_was_there(void **state)
{
    static char large[8192];
    struct rlimit old;
    gtx_error error;
    (void)state;
    assert_int_equal(put("kept", "old"), GTX_OK);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &old), 0);
    signal(SIGXFSZ, SIG_IGN);
    const struct rlimit small = {4096, old.rlim_max};
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
    const gtx_result over = gtx_write_file("kept", large, sizeof large, &error);
    const gtx_result beside = gtx_write_file("fresh", large, sizeof large, NULL);
    setrlimit(RLIMIT_FSIZE, &old);
    assert_true(over == GTX_ERROR_WRITE && beside == GTX_ERROR_WRITE);
    assert_string_equal(error.message, "cannot write kept: File too large");
    holds("kept", "old");
    assert_int_equal(entries("."), 1);
}

static void a_closed_folder_keeps_what_was_there(void **state)
{
    (void)state;
    assert_int_equal(mkdir("closed", 0755) | put("closed/a", "old") | chmod("closed/a", 0666), 0);
    assert_int_equal(chmod("closed", 0555), 0);
    const pid_t other = fork();
    assert_true(other >= 0);
    if (other == 0) { /* root may write anywhere */
        if (geteuid() == 0 && (setgid(65534) || setuid(65534)))
            _exit(2);
        _exit(put("closed/a", "new") != GTX_ERROR_WRITE ||
              put("closed/b", "new") != GTX_ERROR_WRITE);
    }
    int status;
    assert_int_equal(waitpid(other, &status, 0), other);
    assert_int_equal(status, 0);
    holds("closed/a", "old");
    assert_int_equal(entries("closed"), 1);
}

static void names_may_be_as_long_as_there_are(void **state)
{
    char name[258];
    (void)state;
    memset(name, 'n', sizeof name);
    name[255] = 0;
    assert_int_equal(put(name, "1") | put(name, "2"), GTX_OK);
    holds(name, "2");
    name[255] = 'n';
    name[256] = 0;
    gtx_error error;
    assert_int_equal(gtx_write_file(name, "x", 1, &error), GTX_ERROR_WRITE);
    assert_non_null(strstr(error.message, "n: File name too long")); /* the reason is not cut off */
    assert_int_equal(entries("."), 1);
}

static void one_of_several_writers_wins(void **state)
{
    enum { WRITERS = 3, TIMES = 40, SIZE = 20000 };
    static char text[SIZE];
    pid_t writers[WRITERS];
    (void)state;
    for (int w = 0; w < WRITERS; ++w) {
        writers[w] = fork();
        assert_true(writers[w] >= 0);
        if (writers[w])
            continue;
        int failed = 0;
        memset(text, 'a' + w, sizeof text);
        for (int i = 0; i < TIMES; ++i)
            failed |= gtx_write_file("file", text, sizeof text / (size_t)(w + 1), NULL) != GTX_OK;
        _exit(failed);
    }
    for (int w = 0, status; w < WRITERS; ++w) {
        assert_int_equal(waitpid(writers[w], &status, 0), writers[w]);
        assert_int_equal(status, 0);
    }
    FILE *file = fopen("file", "rb");
    assert_non_null(file);
    const size_t size = fread(text, 1, sizeof text, file);
    fclose(file);
    assert_int_equal(size, SIZE / (text[0] - 'a' + 1));
    for (size_t i = 0; i < size; ++i)
        assert_int_equal(text[i], text[0]);
    assert_int_equal(entries("."), 1);
}

static void one_file_has_many_names(void **state)
{
    (void)state;
    assert_int_equal(mkdir("f", 0755) | put("a", "x") | put("b", "x"), 0);
    assert_int_equal(symlink("a", "soft") | link("a", "f/hard") | symlink("f/none", "dangling"), 0);
    static const char *const same[][2] = {{"a", "./a"}, {"a", "soft"}, {"a", "f/hard"},
                                          {"f/../soft", "f/hard"}, {"none", "./f/../none"},
                                          {"dangling", "f/none"}, {"f", "f/."}};
    static const char *const others[][2] = {{"a", "b"}, {"a", "none"}, {"none", "f/none"},
                                            {"f", "a"}, {"nowhere/a", "elsewhere/a"}};
    for (size_t i = 0; i < sizeof same / sizeof *same; ++i)
        if (!gtx_same_file(same[i][0], same[i][1]) || !gtx_same_file(same[i][1], same[i][0]))
            fail_msg("%s is %s", same[i][0], same[i][1]);
    for (size_t i = 0; i < sizeof others / sizeof *others; ++i)
        if (gtx_same_file(others[i][0], others[i][1]) || gtx_same_file(others[i][1], others[i][0]))
            fail_msg("%s is not %s", others[i][0], others[i][1]);
}

#define IN_A_FOLDER(test) cmocka_unit_test_setup_teardown(test, enter, leave)

int main(void)
{
    const struct CMUnitTest tests[] = {
        IN_A_FOLDER(permissions_are_kept),
        IN_A_FOLDER(links_stay_links),
        IN_A_FOLDER(a_pipe_is_written_to),
        IN_A_FOLDER(devices_are_written_to),
        IN_A_FOLDER(standard_output_goes_on),
        IN_A_FOLDER(a_full_disk_keeps_what_was_there),
        IN_A_FOLDER(a_closed_folder_keeps_what_was_there),
        IN_A_FOLDER(names_may_be_as_long_as_there_are),
        IN_A_FOLDER(one_of_several_writers_wins),
        IN_A_FOLDER(one_file_has_many_names),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
