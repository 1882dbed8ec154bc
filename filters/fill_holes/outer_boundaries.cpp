// SPDX-License-Identifier: GPL-3.0-or-later
#include "fill_holes/outer_boundaries.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <span>

namespace scanmill {

namespace {

double flat_area(const TriangleMesh& mesh, const MeshLoops& boundary, std::span<const u32> loop) {
    const Vec3 origin = mesh.positions[boundary.start(loop.front())];
    Vec3 sum = Vec3::Zero();
    for (std::size_t i = 0; i < loop.size(); ++i)
        sum += (mesh.positions[boundary.start(loop[i])] - origin)
                   .cross(mesh.positions[boundary.start(loop[(i + 1) % loop.size()])] - origin);
    return sum.norm() / 2;
}

}  // namespace

OuterBoundaries outer_boundaries(const TriangleMesh& mesh, const MeshLoops& boundary, const FillHolesParams& params) {
    using P = FillHolesParams;
    double area = 0;
    for (const auto& [a, b, c] : mesh.triangles)
        area += (mesh.positions[b] - mesh.positions[a]).cross(mesh.positions[c] - mesh.positions[a]).norm() / 2;
    std::vector<double> shares;
    for (const std::vector<u32>& loop : boundary.loops())
        shares.push_back(area > 0 ? flat_area(mesh, boundary, loop) / area : 0);

    OuterBoundaries result;
    result.is_outer.resize(shares.size());
    if (shares.empty()) return result;
    result.largest_share = std::ranges::max(shares);
    const bool keeps_large = !params.must_close && params.outer != P::Outer::fill &&
                             (params.outer == P::Outer::keep || result.largest_share >= P::outer_share);
    for (std::size_t i = 0; i < shares.size(); ++i) {
        if (!keeps_large || shares[i] < P::large_share) continue;
        result.is_outer[i] = true;
        result.share += shares[i];
    }
    return result;
}

}  // namespace scanmill
