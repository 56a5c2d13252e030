/* A display of the test's own, and pictures of what gtx view shows on it. */
#ifndef GTX_TESTS_WINDOW_H
#define GTX_TESTS_WINDOW_H

#include "cli/command.h"

#include "image/image.h"

#include <signal.h>
#include <unistd.h>

static pid_t server; /* Xvfb, or 0 */

/* Starts Xvfb on a free display; 0 where there is none to start. */
static inline void start_display(void)
{
    int ends[2];
    char number[16] = "", display[20];
    size_t got = 0;
    assert_int_equal(pipe(ends), 0);
    server = fork();
    if (server == 0) {
        char fd[16];
        snprintf(fd, sizeof fd, "%d", ends[1]);
        if (freopen("/dev/null", "w", stderr))
            execlp("Xvfb", "Xvfb", "-displayfd", fd, "-screen", "0", "1280x1024x24", (char *)NULL);
        _exit(127);
    }
    close(ends[1]);
    for (ssize_t n; got + 1 < sizeof number && !strchr(number, '\n'); got += (size_t)n)
        if ((n = read(ends[0], number + got, sizeof number - 1 - got)) <= 0)
            break;
    close(ends[0]);
    number[strcspn(number, "\n")] = 0;
    if (number[0]) {
        snprintf(display, sizeof display, ":%s", number);
        setenv("DISPLAY", display, 1);
    } else {
        waitpid(server, NULL, 0);
        server = 0;
    }
}

static inline int open_stage(void **state)
{
    unsetenv("DISPLAY");
    unsetenv("WAYLAND_DISPLAY");
    if (set_up(state) || gtx("view --size 320x240 --frames 1") != 5)
        return 1;
    start_display();
    return 0;
}

static inline int close_stage(void **state)
{
    if (server > 0) {
        kill(server, SIGTERM);
        waitpid(server, NULL, 0);
    }
    return tear_down(state);
}

static inline gtx_image picture(const char *name)
{
    gtx_image image;
    gtx_error error;
    if (gtx_image_read(in_folder(name), &image, &error))
        fail_msg("%s: %s", name, error.message);
    return image;
}

/* The picture that the window shows after some keys. */
static inline gtx_image view(const char *arguments, const char *keys)
{
    expect(gtx("view --camera 30,20,5 %s --size 320x240 --frames 2 --keys '%s' "
               "--screenshot shown.png", arguments, keys), 0);
    return picture("shown.png");
}

/* Pixels below the text (the model), or within it, that differ. */
static inline unsigned difference(const gtx_image *a, const gtx_image *b, bool text)
{
    unsigned count = 0;
    assert_int_equal(a->width, b->width);
    assert_int_equal(a->height, b->height);
    for (uint32_t y = 0; y < a->height; ++y)
        for (uint32_t x = 0; x < a->width; ++x) {
            const size_t at = 4 * ((size_t)y * a->width + x);
            count += (y < 58) == text && memcmp(a->pixels + at, b->pixels + at, 3) != 0;
        }
    return count;
}

static inline const uint8_t *pixel(const gtx_image *image, uint32_t x, uint32_t y)
{
    return image->pixels + 4 * ((size_t)y * image->width + x);
}

#endif
