// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Tests poses that were given: which views fit the others better elsewhere.

#include <vector>

#include "register/register_views.hpp"

namespace scanmill {

struct MisplacedView {
    u32 view;
    /// Root mean square distance of the view's points from where they fit the others, if they do.
    std::optional<double> distance;
};

/// Refines the poses `start` of all views, brings the result onto the given poses so that the better half of the views
/// moves least, and returns the views that still move: by more than half a spacing, and by more than 3 times the median
/// distance. Also returns views whose given pose the lines of sight contradict. Views that overlap too little, or
/// slide on the others, cannot be tested, and are not returned.
///
/// `spacing` receives the median spacing of the views. Pre: as for register_views(), and all views have `start`. Throws
/// what register_views() throws. Ties: as there. Cost: as there, without the search for poses.
std::vector<MisplacedView> misplaced_views(std::span<const ViewToRegister> views, RegisterViewsParams params,
                                           double& spacing, Execution& execution);

}  // namespace scanmill
