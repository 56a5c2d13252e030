/* Open an asset and say what is in it.    open_asset ASSET.gtx */
#include <geotex/geotex.h>

#include <stdio.h>

int main(int argc, char **argv)
{
    gtx_asset *asset;
    gtx_error error;
    if (argc != 2 || gtx_open_file(argv[1], NULL, &asset, &error)) {
        fprintf(stderr, "%s\n", argc != 2 ? "usage: open_asset ASSET.gtx" : error.message);
        return 1;
    }
    gtx_info info;
    gtx_get_info(asset, &info);
    printf("%u patches on %u pages of %u x %u texels, for %llu triangles\n", info.patch_count,
           info.page_count, info.page_width, info.page_height,
           (unsigned long long)info.source_triangles);
    for (uint32_t i = 0; i < info.patch_count && i < 3; ++i) {
        const gtx_patch *p = &gtx_patches(asset)[i]; /* owned by the asset */
        printf("patch %u: %u x %u texels, box %g x %g x %g\n", i, p->rect[2], p->rect[3],
               p->extent_x, p->extent_y, p->extent_z);
    }
    gtx_close(asset);
    return 0;
}
