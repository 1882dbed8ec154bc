// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Preconditions and doubts of an inspection. Every Error has a hint.

#include "inspect/inspect.hpp"
#include "inspect/nominal.hpp"

namespace scanmill::inspecting {

/// Requires two lengths of tolerance, at least one bin, sigma above 0, and lengths that are not negative.
void require_sound(const InspectParams& params);

/// Requires finite ends in the right order.
void require_tolerance(const InspectParams& params, const Tolerance& tolerance, LengthUnit unit);

/// Requires consistent, finite triangles, one with an area.
void require_surface(const TriangleMesh& nominal);

/// The rms of a transform in this unit, which is its own if one of both is unknown.
double in_unit_of(const RigidTransform& transform, LengthUnit unit);

/// The boxes of scan and nominal, relative to the scan's origin.
struct Extents {
    BoundingBox scan, nominal;
    Vec3 origin;
    LengthUnit unit;
};

/// Throws Error with the numbers of points by finding. Names two units if the sizes of the boxes have their ratio.
[[noreturn]] void refuse_without_points(const Inspection& inspected, const Extents& extents,
                                        const InspectParams& params);

/// Doubts a nominal that is inside out or not consistently oriented.
void doubt_nominal(const Nominal& nominal, Context& context);

/// Doubts an inspection of which most points are too far or undecided.
void doubt_findings(const Inspection& inspected, const Extents& extents, Context& context);

void warn_of_chord_error(const Inspection& inspected, Context& context);

}  // namespace scanmill::inspecting
