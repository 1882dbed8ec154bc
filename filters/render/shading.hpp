// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The light and colours of a scene's surface in one view.

#include "render/camera.hpp"
#include "render/canvas.hpp"
#include "render/surface_normals.hpp"

namespace scanmill {

/// Depths of the surface in a view: samples_per_side² samples per pixel of View::part(); infinity where no surface is.
struct DepthMap {
    u32 samples_per_side = 0;
    Array<float> depths;

    /// The share of a pixel's samples where nothing is before `depth`.
    double visible(const View& view, std::int64_t x, std::int64_t y, double depth) const;
};

/// Draws the triangles and discs of the scene. `normals` are those of scene.mesh, or null without triangles. Progress
/// goes from the first to the second number of `progress`.
/// Cost: see render(); parallel over rows of pixels.
DepthMap shade(Canvas& canvas, const View& view, const DrawnScene& scene, const RayCaster& caster,
               const SurfaceNormals* normals, const RenderParams& params, Context& context,
               const std::array<double, 2>& progress);

}  // namespace scanmill
