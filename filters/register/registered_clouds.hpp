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
    std::optional<std::filesystem::path> start;  ///< file of poses, see read_poses()
    bool as_is = false;
    u32 seed_tries = 20;
    OnRefusal on_refusal = OnRefusal::fail;
};

/// One motion per placed view, from the view's frame to that of the first placed view, and the refused views with their
/// reasons. Views without a name are called `view 1`, `view 2`, … See register_views() for method, ties and cost.
///
/// Throws Error for no view, different units, the errors of register_views(), poses in the file `start` that match no
/// view, and refused views, all of them with numbers, with OnRefusal::fail or if fewer than two views are placed. With
/// OnRefusal::leave_out refused views are a doubt. Metrics: see plugin.cpp.
Transforms registered_clouds(std::span<const std::shared_ptr<const PointCloud>> views, const RegisterParams& params,
                             Context& context);

/// The motion of one scan onto a mesh that stays, into the mesh's frame. See register_to_target() for method and cost.
///
/// Throws Error for not exactly one scan, different units, the errors of register_to_target(), and a scan that does not
/// fit, slides, or fits equally well in several poses, with numbers. Metrics: see plugin.cpp.
Transforms registered_to_mesh(std::span<const std::shared_ptr<const PointCloud>> scans, const TriangleMesh& target,
                              const RegisterParams& params, Context& context);

}  // namespace scanmill
