/* Fills in what the report of cooking says of a partition: folds, charts, edges, unseen surface. */
#pragma once

#include "chart/split.hpp"

namespace gtx {

/* Of the partition before splitting. */
void report_initial(const Surface &surface, const Vector<Region> &regions, Task &task,
                    Partition &out);
/* Of the charts at last. */
void report_final(const Surface &surface, const Vector<Region> &regions,
                  const Vector<Frame> &frames, Task &task, Partition &out);
/* Of borders and sharp edges. */
void report_edges(const Surface &surface, Partition &out);
/* Of what no chart has. */
void report_unseen(const Surface &surface, const Region &unseen, Partition &out);

} // namespace gtx
