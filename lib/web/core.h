/* What the parts of the core share. */
#ifndef GTX_WEB_CORE_H
#define GTX_WEB_CORE_H

#include <geotex/geotex.h>

/* Where the call that begins puts its error: gtxw_result and gtxw_message tell it. */
gtx_error *gtxw_begin(void);

#endif
