/* LOD meshes for an asset that a verb has made. */
#include "cli/cli.h"

#include <geotex/cook.h>

gtx_result add_lod_meshes(gtx_asset **asset, uint32_t levels, uint32_t threads, gtx_error *error)
{
    const gtx_lod_desc desc = {
        .levels = levels, .threads = threads, .progress = show_progress, .limits = cli_limits};
    gtx_asset *made = NULL;
    catch_interrupt();
    const gtx_result result = gtx_cook_lod_meshes(*asset, &desc, &made, error);
    end_progress();
    if (result)
        return result;
    gtx_close(*asset);
    *asset = made;
    return GTX_OK;
}
