/* From the clean mesh to an asset in memory, by options that are settled. */
#pragma once

#include "cook/report.hpp"
#include "cook/target.hpp"

namespace gtx {

/* Throws Error(INPUT) where warnings are errors, and there is one. */
void refuse_warnings(const Options &options, const Task &task);

/* Partition, maps and asset of the clean mesh, measured where that is wanted. Where the default's
 * finer layers pass a limit, cuts are taken. */
Attempt attempt(const Mesh &mesh, const Options &options, Task &task, const CookFacts &facts);

} // namespace gtx
