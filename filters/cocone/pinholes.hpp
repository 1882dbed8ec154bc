// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What the solid behind a surface adds to it: the side that is outside, and the closing of small gaps.

#include "cocone/peeling.hpp"

namespace scanmill::cocones {

/// Reverses each component of the surface, connected through edges, whose outer side is the solid's inside for most of
/// its area on the solid's boundary. Returns whether there is one. Cost: linear.
bool face_outside(const TetMesh& tets, std::span<const u8> labels, const SurfaceMesh& mesh, Surface& surface);

/// Closes gaps of the surface where the sampling is just too sparse for the vote. A gap is a part of the solid's
/// boundary that is not in the surface, connected through edges. It is added as a whole if it joins the surface along
/// its whole boundary loop, with the same outer side, and no triangle of it spans an opening. Returns the number of
/// gaps closed. Pre: the surface faces outside. Cost: linear in the cells.
std::size_t close_pinholes(const TetMesh& tets, const Sampling& sampling, double lid_factor, std::span<const u8> labels,
                           Surface& surface);

struct SurfaceWithSolid {
    Peeling peeling;
    SurfaceMesh mesh;  ///< the surface with its pinholes closed
};

/// All steps of cocone.hpp, with what they leave for further use. Reports progress up to 0.8.
struct Reconstruction {
    Reconstruction(const TetMesh& given, const CoconeParams& params, Context& context);
    Reconstruction(const Reconstruction&) = delete;  // `diagram` refers to `spatial`

    SpatialTets spatial;
    Diagram diagram;
    Sampling samples;
    Surface surface;
    SurfaceWithSolid solid;
};

}  // namespace scanmill::cocones
