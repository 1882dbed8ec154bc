// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What icp() moves a scan onto: a mesh or points, with the plane next to any point.

#include <memory>
#include <vector>

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/point_tree.hpp"
#include "scanmill/filter/context.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill::detail {

/// The target next to a point.
struct Foot {
    double distance = 0;  ///< to the nearest point of the target
    /// The unit normal of the plane, and the distance of the point from it; its sign is that of the plane's side.
    Vec3 normal = Vec3::Zero();
    double residual = 0;
    /// False if the target ends there, or has no normal.
    bool is_valid = false;
};

/// Memory of a search, one per thread.
struct Search {
    u32 hint = NearestTriangle::none;
    NeighbourBuffer buffer;
};

class Target {
public:
    virtual ~Target() = default;
    /// Safe from several threads. `search` makes searches for points near each other faster.
    virtual Foot foot(const Vec3& point, Search& search) const = 0;
    /// Diagonal of its box; of points, without stray ones.
    double diagonal() const { return diagonal_; }

protected:
    double diagonal_ = 0;
};

class MeshTarget : public Target {
public:
    /// Pre: consistent, finite, at least one triangle. Throws Error if no triangle has an area.
    MeshTarget(const TriangleMesh& mesh, Context& context);
    Foot foot(const Vec3& point, Search& search) const override;

private:
    /// Which edges (bit i: from corner i) and corners (bit 3 + i) of a triangle are on the boundary. Vertices at one
    /// position are one vertex.
    using BoundaryBits = unsigned char;
    bool is_on_boundary(u32 kept, const std::array<Vec3, 3>& corners, const Vec3& point) const;

    std::unique_ptr<TriangleTree> tree_;  ///< contains the triangles with an area
    std::vector<BoundaryBits> boundary_;  ///< by triangle of the tree
};

class PointsTarget : public Target {
public:
    /// Pre: finite. Throws Error for fewer than 6 different positions.
    PointsTarget(const PointCloud& cloud, Context& context);
    Foot foot(const Vec3& point, Search& search) const override;

private:
    PointTree tree_;
    Array<Vec3> normals_;  ///< by position of the tree; zero where there is none
    Array<double> reach_;  ///< how far beside a position its plane is used
};

}  // namespace scanmill::detail
