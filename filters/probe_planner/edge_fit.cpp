// SPDX-License-Identifier: GPL-3.0-or-later
#include "probe_planner/edge_fit.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace scanmill::probing {

namespace {

constexpr std::size_t most_facets = 1000;
/// Least spread_between() at an edge. The smallest value at the edges of five scanned double cones and cones on
/// hemispheres is 0.017; a chamfer has 0.
constexpr double least_spread = 0.015;
constexpr double sine_10 = 0.17364817766693033;
/// Squared lengths of the chords of 15 degrees and of 1 degree on the unit sphere.
constexpr double chord_15 = 0.06814834742186338, chord_1 = 0.00030460968721746;

enum class Side : u8 { first, second, none };

/// A triangle near the point. Its corners are relative to the point.
struct Facet {
    std::array<Vec3, 3> corners;
    Vec3 normal;
    double weight;
    Side side = Side::none;

    Vec3 centre() const { return (corners[0] + corners[1] + corners[2]) / 3; }
};

std::vector<Facet> facets_near(const TriangleTree& mesh, const Vec3& point, double radius) {
    std::vector<u32> slots;
    mesh.any_near(std::array{point}, radius, [&](u32 slot) {
        slots.push_back(slot);
        return slots.size() > most_facets;
    });
    if (slots.size() > most_facets) return {};
    std::ranges::sort(slots, {}, [&](u32 slot) { return mesh.row(slot); });
    std::vector<Facet> facets;
    const double square = radius * radius;
    for (const u32 slot : slots) {
        const double share = mesh.squared_distance(point, slot) / square;
        Facet facet;
        facet.corners = mesh.corners(slot);
        for (Vec3& corner : facet.corners) corner -= point;
        const Vec3 area = (facet.corners[1] - facet.corners[0]).cross(facet.corners[2] - facet.corners[0]);
        if (!(share < 1) || !(area.norm() > 0)) continue;
        facet.normal = area.normalized();
        facet.weight = std::min(area.norm() / 2, square) * (1 - share);
        facets.push_back(facet);
    }
    return facets;
}

/// The plane { x : normal · (x - centre) = 0 }. The normal is 0 if no facet is on the side.
struct Plane {
    Vec3 normal = Vec3::Zero(), centre = Vec3::Zero();
};

Plane plane_of(const std::vector<Facet>& facets, Side side) {
    Plane plane;
    double weight = 0;
    for (const Facet& facet : facets) {
        if (facet.side != side) continue;
        weight += facet.weight;
        plane.normal += facet.weight * facet.normal;
        plane.centre += facet.weight * facet.centre();
    }
    if (weight > 0) plane.centre /= weight;
    if (plane.normal.norm() > 0) plane.normal.normalize();
    return plane;
}

/// Divides the facets in two along the direction in which their normals differ most.
void divide(std::vector<Facet>& facets) {
    double weight = 0;
    Vec3 mean = Vec3::Zero();
    for (const Facet& facet : facets) {
        weight += facet.weight;
        mean += facet.weight * facet.normal;
    }
    mean /= weight;
    Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
    for (const Facet& facet : facets) {
        const Vec3 off = facet.normal - mean;
        scatter += facet.weight * off * off.transpose();
    }
    const Vec3 across = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(scatter).eigenvectors().col(2);
    for (Facet& facet : facets) facet.side = across.dot(facet.normal - mean) > 0 ? Side::first : Side::second;
}

/// Assigns each facet to the plane that all its corners are nearer to, or to none. Returns whether any changed.
bool divide_anew(std::vector<Facet>& facets, const Plane& first, const Plane& second) {
    const auto side_of = [&](const Vec3& corner) {
        const double to_first = std::abs(first.normal.dot(corner - first.centre)),
                     to_second = std::abs(second.normal.dot(corner - second.centre));
        return to_first <= to_second ? Side::first : Side::second;
    };
    bool is_changed = false;
    for (Facet& facet : facets) {
        Side side = side_of(facet.corners[0]);
        if (side_of(facet.corners[1]) != side || side_of(facet.corners[2]) != side) side = Side::none;
        is_changed = is_changed || side != facet.side;
        facet.side = side;
    }
    return is_changed;
}

/// Returns the height of the face of `side`, at the edge, above the plane through the point. It is the offset of the
/// parabola height = offset + factor · along² that fits the facets.
double offset_of(const std::vector<Facet>& facets, Side side, const Vec3& normal, const Vec3& tangent) {
    double weight = 0, mean_square = 0, mean_height = 0;
    const auto for_each = [&](auto&& call) {
        for (const Facet& facet : facets)
            for (const Vec3& corner : facet.corners)
                if (const double along = tangent.dot(corner); facet.side == side)
                    call(facet.weight, along * along, normal.dot(corner));
    };
    for_each([&](double w, double square, double height) {
        weight += w;
        mean_square += w * square;
        mean_height += w * height;
    });
    mean_square /= weight;
    mean_height /= weight;
    double variance = 0, covariance = 0;
    for_each([&](double w, double square, double height) {
        variance += w * (square - mean_square) * (square - mean_square);
        covariance += w * (square - mean_square) * (height - mean_height);
    });
    return variance > 0 ? mean_height - covariance / variance * mean_square : mean_height;
}

/// Root mean square deviation of the left-out triangles' normals from their mean, along n2 - n1 and as a share of its
/// length. Infinite if no triangle is left out.
double spread_between(const std::vector<Facet>& facets, const Vec3& n1, const Vec3& n2) {
    const Vec3 way = (n2 - n1) / (n2 - n1).squaredNorm();
    double weight = 0, mean = 0, variance = 0;
    for (const Facet& facet : facets) {
        if (facet.side != Side::none) continue;
        weight += facet.weight;
        mean += facet.weight * way.dot(facet.normal);
    }
    if (!(weight > 0)) return std::numeric_limits<double>::infinity();
    mean /= weight;
    for (const Facet& facet : facets)
        if (const double off = way.dot(facet.normal) - mean; facet.side == Side::none)
            variance += facet.weight * off * off;
    return std::sqrt(variance / weight);
}

double misfit(const std::vector<Facet>& facets, const Vec3& n1, const Vec3& n2) {
    double sum = 0, weight = 0;
    for (const Facet& facet : facets) {
        const double chord = std::min((facet.normal - n1).squaredNorm(), (facet.normal - n2).squaredNorm());
        sum += facet.weight * std::min(1.0, chord / chord_15);
        weight += facet.weight;
    }
    return sum / weight;
}

}  // namespace

double mean_edge_near(const TriangleTree& mesh, const Vec3& point, double radius) {
    double sum = 0;
    std::size_t edges = 0;
    for (const Facet& facet : facets_near(mesh, point, radius))
        for (std::size_t i = 0; i < 3; ++i, ++edges) sum += (facet.corners[(i + 1) % 3] - facet.corners[i]).norm();
    return edges > 0 ? sum / static_cast<double>(edges) : 0;
}

Vec3 nearest_on_both(const Vec3& n1, double c1, const Vec3& n2, double c2) {
    const double cosine = n1.dot(n2);
    return ((c1 - cosine * c2) * n1 + (c2 - cosine * c1) * n2) / (1 - cosine * cosine);
}

std::optional<EdgeFaces> edge_faces(const TriangleTree& mesh, const EdgeFaces& guess, double radius, double farthest) {
    std::vector<Facet> facets = facets_near(mesh, guess.position, radius);
    if (facets.size() < 2) return {};
    divide(facets);
    Plane first, second;
    constexpr int most_rounds = 10;
    for (int round = 0; round < most_rounds; ++round) {
        first = plane_of(facets, Side::first);
        second = plane_of(facets, Side::second);
        if (first.normal.isZero(0) || second.normal.isZero(0)) return {};
        if (!divide_anew(facets, first, second)) break;
    }
    first = plane_of(facets, Side::first);
    second = plane_of(facets, Side::second);
    const double found = misfit(facets, first.normal, second.normal),
                 guessed = misfit(facets, guess.left_normal, guess.right_normal);
    const bool is_one_face = guess.left_normal == guess.right_normal;
    if (!(found + chord_1 / chord_15 < guessed) || (is_one_face && !(found < guessed / 2))) return {};

    const Vec3 across = first.normal.cross(second.normal);
    EdgeFaces faces = guess;
    if (!(across.norm() >= sine_10)) {
        const Vec3 sum = first.normal + second.normal, normal = sum - sum.dot(guess.tangent) * guess.tangent;
        if (!(normal.norm() >= 1)) return {};  // a fold, or a line that leaves the surface
        faces.left_normal = faces.right_normal = normal.normalized();
        return faces;
    }
    if (spread_between(facets, first.normal, second.normal) < least_spread) return {};
    faces.tangent = across.normalized();
    if (faces.tangent.dot(guess.tangent) < 0) faces.tangent = -faces.tangent;
    const Vec3 to_edge = nearest_on_both(first.normal, offset_of(facets, Side::first, first.normal, faces.tangent),
                                         second.normal, offset_of(facets, Side::second, second.normal, faces.tangent));
    if (!(to_edge.norm() <= farthest)) return {};
    faces.position = guess.position + to_edge;
    // The left face is on the left of the tangent, seen from outside.
    const Vec3 leftwards = (first.normal + second.normal).cross(faces.tangent);
    const double first_left = leftwards.dot(first.centre - to_edge),
                 second_left = leftwards.dot(second.centre - to_edge);
    if (!(first_left * second_left < 0)) return {};
    faces.left_normal = first_left > 0 ? first.normal : second.normal;
    faces.right_normal = first_left > 0 ? second.normal : first.normal;
    return faces;
}

}  // namespace scanmill::probing
