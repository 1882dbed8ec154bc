// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A mesh as 3MF prints it: which meshes are solid, and coordinates of six decimals.

#include <Model/Classes/NMR_ModelTypes.h>

#include <vector>

#include "scanmill/data/mesh.hpp"
#include "scanmill/formats/files.hpp"

namespace scanmill::threemf {

/// Throws Error, with numbers, unless the mesh is a closed, oriented manifold whose triangles face outwards, with
/// finite coordinates that lib3mf takes.
void require_solid(const TriangleMesh& mesh);

struct PrintedMesh {
    /// Where the object stands; its three numbers are what six digits of them say. A vertex plus this is the world
/// position.
    Eigen::Vector3f place = Eigen::Vector3f::Zero();
    std::vector<NMR::MODELMESHVERTEX> vertices;
    std::vector<NMR::MODELMESHTRIANGLE> triangles;
};

/// Tells when coordinates move by more than a millionth of the diagonal.
PrintedMesh printed(const TriangleMesh& mesh, const WriteOptions& options);

}  // namespace scanmill::threemf
