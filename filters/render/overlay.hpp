// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Lines, dots and labels that are drawn over the surface in one view.

#include "render/shading.hpp"

namespace scanmill {

/// Draws what the surface does not hide. A label is beside its dot, at the first of sixteen places that no earlier
/// label of the view covers; without a free place it is left out, and the number of such labels is returned. `size` is
/// the height of a line of text in pixels. `tolerance` is the depth by which a line on the surface may lie behind it;
/// labels and their dots may lie `label_tolerance` behind, because a dent is inside the nominal.
std::size_t draw_overlay(Canvas& canvas, Font& font, const View& view, const DrawnScene& scene, const DepthMap& depths,
                         double tolerance, double label_tolerance, double size);

}  // namespace scanmill
