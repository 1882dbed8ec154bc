// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Registers clouds: one motion per view, with warnings, refusals and metrics.

#include <filesystem>
#include <memory>
#include <optional>
#include <span>

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/data/transform.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct RegisterParams {
    enum class OnRefusal { fail, leave_out };
    Ratio overlap = Ratio::percent(30);
    std::optional<Length> resolution;  ///< see RegisterViewsParams
    std::optional<std::filesystem::path> poses;  ///< file of poses that are taken as they are, see read_poses()
    std::optional<std::filesystem::path> start;  ///< file of poses to begin with
    bool as_is = false;
    bool whole_views = true;
    u32 seed_tries = 20;
    OnRefusal on_refusal = OnRefusal::fail;
};

/// One motion per placed view, from the view's frame to that of the first placed view, and the refused views with their
/// reasons. Views without a name are called `view 1`, `view 2`, … See register_views() for method, ties and cost. With
/// `poses`, the motions are those of the file. Single views that do not fit the others there are a doubt: see
/// misplaced_views.hpp.
///
/// Throws Error for no view, different units, the errors of register_views(), files whose poses do not match the views,
/// and refused views, all of them with numbers, with OnRefusal::fail or if fewer than two views are placed. With
/// OnRefusal::leave_out refused views are a doubt, as are views that stay as they are because they overlap too little
/// to be tested or registered. Metrics: see plugin.cpp.
Transforms registered_clouds(std::span<const std::shared_ptr<const PointCloud>> views, const RegisterParams& params,
                             Context& context);

/// The motion of one scan, from one side or all sides, onto a mesh or cloud that stays, into its frame. See
/// register_to_target() for method and cost.
///
/// Throws Error for not exactly one scan, different units, the errors of register_to_target(), and a scan that does not
/// fit, slides, or fits equally well in several poses, with numbers. Metrics: see plugin.cpp.
Transforms registered_to(const TriangleMesh& target, std::span<const std::shared_ptr<const PointCloud>> scans,
                         const RegisterParams& params, Context& context);
Transforms registered_to(const PointCloud& target, std::span<const std::shared_ptr<const PointCloud>> scans,
                         const RegisterParams& params, Context& context);

}  // namespace scanmill
