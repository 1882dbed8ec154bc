// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Surfaces, scans of them, and motions for tests of icp.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "icp/icp.hpp"
#include "scanmill/base/random.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"
#include "support/doubts.hpp"
#include "support/mesh_operations.hpp"

namespace scanmill::test {

inline PointCloud cloud(const std::vector<Vec3>& points, std::string frame = {}) {
    PointCloud result;
    result.frame.name = std::move(frame);
    result.positions = Array<Vec3>(points.begin(), points.end());
    return result;
}

/// Points with the normals of the surface that they were taken from.
struct Scan {
    std::vector<Vec3> points, normals;
};

/// Random points of a mesh, uniform by area, `noise` along the normal.
inline Scan scan_of(const TriangleMesh& mesh, std::size_t count, double noise, Random& random) {
    std::vector<double> areas;
    double area = 0;
    for (const Triangle& t : mesh.triangles) areas.push_back(area += area_vector(mesh.positions, t).norm());
    Scan scan;
    for (std::size_t i = 0; i < count; ++i) {
        const auto chosen = std::upper_bound(areas.begin(), areas.end() - 1, random.uniform(0, area));
        const Triangle& t = mesh.triangles[static_cast<std::size_t>(chosen - areas.begin())];
        const double root = std::sqrt(random.uniform()), share = random.uniform();
        const Vec3 normal = area_vector(mesh.positions, t).normalized();
        scan.points.push_back((1 - root) * mesh.positions[t[0]] + root * (1 - share) * mesh.positions[t[1]] +
                              root * share * mesh.positions[t[2]] + noise * random.normal() * normal);
        scan.normals.push_back(normal);
    }
    return scan;
}

/// A turn by `degrees` about an axis through `centre`, then a shift.
inline RigidTransform motion_about(const Vec3& centre, double degrees, const Vec3& axis, const Vec3& shift) {
    RigidTransform motion;
    motion.rotation = Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis.normalized()).toRotationMatrix();
    motion.translation = centre - motion.rotation * centre + shift;
    return motion;
}

inline Vec3 random_direction(Random& random) {
    return Vec3(random.normal(), random.normal(), random.normal()).normalized();
}

inline RigidTransform random_motion_about(const Vec3& centre, double degrees, double shift, Random& random) {
    const Vec3 axis = random_direction(random);
    return motion_about(centre, degrees, axis, shift * random_direction(random));
}

inline std::vector<Vec3> moved(const std::vector<Vec3>& points, const RigidTransform& motion) {
    std::vector<Vec3> result;
    for (const Vec3& p : points) result.push_back(motion.apply(p));
    return result;
}

/// First `first`, then `second`.
inline RigidTransform composed(const RigidTransform& second, const RigidTransform& first) {
    RigidTransform result;
    result.rotation = second.rotation * first.rotation;
    result.translation = second.apply(first.translation);
    return result;
}

inline double largest_distance(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, (a[i] - b[i]).norm());
    return largest;
}

/// How far the motion is from the identity, over the points.
inline double largest_motion(const RigidTransform& motion, const std::vector<Vec3>& points) {
    return largest_distance(moved(points, motion), points);
}

struct Refined : IcpResult {
    Metrics metrics;
    std::vector<std::string> warnings, doubts;
};

template <class Target>
Refined refined(const PointCloud& source, const Target& target, const IcpParams& params = {}, unsigned threads = 1) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    IcpResult result = icp(source, target, params, context);
    return {std::move(result), context.metrics(), context.warnings(), doubts_of(context)};
}

inline IcpParams within(double max_distance) {
    IcpParams params;
    params.max_distance = max_distance;
    return params;
}

/// The square [0, edge]² at this height.
inline TriangleMesh square(double edge, double z = 0) {
    return soup({{0, 0, z}, {edge, 0, z}, {edge, edge, z}, {0, edge, z}}, {{0, 1, 2}, {0, 2, 3}});
}

/// Three squares [0, edge]² in the planes of the coordinates, without common vertices.
inline TriangleMesh room_corner(double edge) {
    const TriangleMesh floor = square(edge);
    const auto turned_to = [&](int x, int y, int z) {
        return with_positions(floor, [=](const Vec3& p) -> Vec3 { return {p[x], p[y], p[z]}; });
    };
    return both(both(floor, turned_to(2, 0, 1)), turned_to(0, 2, 1));
}

/// Lattice points first, first + 1 … last of a plane z = `height`, with z as coordinate `axis`.
inline void add_lattice(std::vector<Vec3>& points, int first, int last, int axis, double height = 0) {
    for (int i = first; i <= last; ++i)
        for (int j = first; j <= last; ++j) {
            Vec3 p;
            p[axis] = height;
            p[(axis + 1) % 3] = i;
            p[(axis + 2) % 3] = j;
            points.push_back(p);
        }
}

/// Lattice points 2 … 8 on the three squares of room_corner(10).
inline std::vector<Vec3> corner_points() {
    std::vector<Vec3> points;
    for (int axis = 0; axis < 3; ++axis) add_lattice(points, 2, 8, axis);
    return points;
}

/// The surface of revolution about z of a polyline of (radius, z); open at its ends.
inline TriangleMesh revolved(const std::vector<Vec3>& profile, u32 around) {
    Array<Vec3> positions;
    Array<Triangle> triangles;
    for (u32 k = 0; k < profile.size(); ++k)
        for (u32 i = 0; i < around; ++i) {
            const double angle = 2 * std::numbers::pi * i / around;
            positions.emplace_back(profile[k].x() * std::cos(angle), profile[k].x() * std::sin(angle), profile[k].z());
            if (k == 0) continue;
            const u32 a = (k - 1) * around + i, b = (k - 1) * around + (i + 1) % around;
            triangles.push_back({a, b, b + around});
            triangles.push_back({a, b + around, a + around});
        }
    return soup(std::move(positions), std::move(triangles));
}

}  // namespace scanmill::test
