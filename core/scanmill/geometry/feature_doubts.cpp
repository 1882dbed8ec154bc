// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/feature_doubts.hpp"

#include "scanmill/filter/counted.hpp"
namespace scanmill {

void warn_of_doubts(const FeatureCounts& counts, Context& context) {
    if (counts.without_area > 0)
        context.warn(counted(counts.without_area, "triangle", "triangles") +
                     " without area: counted to a neighbour's plane");
    if (counts.ambiguous > 0)
        context.warn(counted(counts.ambiguous, "boundary loop", "boundary loops") +
                     " whose area does not tell outer boundaries from holes: the longest of a piece was taken for its "
                     "outer boundary");
}

}  // namespace scanmill
