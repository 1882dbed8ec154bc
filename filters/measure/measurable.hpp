// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What must be true of parameters and surfaces before anything is measured. All throw Error with a way out.

#include <string_view>
#include <vector>

#include "measure/measure.hpp"
#include "scanmill/data/points.hpp"

namespace scanmill::measuring {

/// Enough samples, and a gap between 0 % and 100 %.
void require_sound(const MeasureParams& params);

/// The thresholds in the mesh's unit, above 0 and finite.
std::vector<double> thresholds_for(const TriangleMesh& mesh, const MeasureParams& params);

/// A diagonal whose square is a number. `name`: "mesh" or "truth".
void require_squares(const BoundingBox& box, std::string_view name);

/// Consistent and finite, of such a size, and at least one triangle has an area.
void require_surface(const TriangleMesh& mesh, std::string_view name);

}  // namespace scanmill::measuring
