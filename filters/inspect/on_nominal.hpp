// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The deviations as a map on the nominal mesh.

#include <span>

#include "inspect/nominal.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::inspecting {

struct RefinedMesh {
    /// Positions, triangles and sharp edges; no columns. The first vertices are those of the given mesh.
    TriangleMesh mesh;
    /// The given mesh's triangle that contains each triangle; ascending.
    Array<u32> parents;
};

/// Splits every edge longer than `longest` at its midpoint, in all its triangles, and repeats this until no edge is
/// longer. So the mesh stays conforming, and its surface the same. Pre: consistent; longest > 0. Cost: linear in the
/// result.
RefinedMesh refined(const TriangleMesh& mesh, double longest, const Execution& execution);

/// The longest edge for refined(): `wanted`, or the least length above it, in steps of a quarter, with which the mesh
/// gets not many more than 2 million triangles.
double affordable_edge(const TriangleMesh& mesh, double wanted);

/// The deviations that are averaged, in any order.
struct Footprints {
    std::span<const Vec3> feet;  ///< nearest points of the nominal
    std::span<const u32> triangles;  ///< rows of Nominal::surface()
    std::span<const double> deviations;
};

/// For each vertex, the mean of the deviations whose feet are nearer than `radius`, with the weights 1 - (distance /
/// radius)²; NaN where there are none. A foot counts if the normal of its triangle and that of a triangle at the vertex
/// differ by at most 60 degrees. So the two sides of a thin wall do not mix. `positions` are those of the refined mesh
/// in the frame of the feet. Bytes do not depend on the number of threads.
Array<double> averaged(const RefinedMesh& refined, std::span<const Vec3> positions, const Nominal& nominal,
                       const Footprints& footprints, double radius, const Execution& execution);

}  // namespace scanmill::inspecting
