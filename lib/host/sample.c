/* The arguments of a sample, then a window or a PNG. */
#include "host/sample.h"

#include "image/image.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int gtx_sample_main(gtx_show *show, int argc, char **argv, const char **asset)
{
    const char *still = NULL;
    int bad = 0;
    *asset = NULL;
    for (int i = 1; i < argc; ++i)
        if (strcmp(argv[i], "--headless") == 0 && i + 1 < argc)
            still = argv[++i];
        else if (strcmp(argv[i], "--size") == 0 && i + 1 < argc)
            bad |= sscanf(argv[++i], "%dx%d", &show->width, &show->height) != 2;
        else if (argv[i][0] == '-' || *asset)
            bad = 1;
        else
            *asset = argv[i];
    if (!*asset || bad) {
        fprintf(stderr, "usage: %s ASSET.gtx [--headless OUT.png] [--size WxH]\n", show->title);
        return 1;
    }
    gtx_error error = {0};
    uint8_t *pixels = NULL;
    gtx_result result = still ? gtx_show_still(show, &pixels, &error)
                              : gtx_show_window(show, &error);
    if (still && !result)
        result = gtx_image_write_png(still, (uint32_t)show->width, (uint32_t)show->height, 4,
                                     pixels, &error);
    free(pixels);
    if (result)
        fprintf(stderr, "%s: %s\n", show->title, error.message);
    return result ? 1 : 0;
}
