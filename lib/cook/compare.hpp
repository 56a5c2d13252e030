/* The inside of gtx_compare_files, for assets however they were opened. */
#pragma once

#include "cook/models.hpp"
#include "measure/measure.hpp"

namespace gtx {

/* What a comparison runs in, and is limited by. */
struct CompareTask : Task {
    explicit CompareTask(const gtx_compare_desc &desc);
};

Models read_compared(const char *model, const gtx_compare_desc &desc, Task &task);

/* Imports the models and measures what is shown against them, `levels` of the height fields unless
 * the descriptor says how many; `closed` as in gtx_cook_desc. `result` and `report` may be null. */
void compare_models(const ShownAt &shown, uint32_t levels, bool closed, Models &models,
                    const gtx_compare_desc &desc, Task &task, gtx_compare_result *result,
                    gtx_report *report);

} // namespace gtx
