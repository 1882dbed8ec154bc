// SPDX-License-Identifier: GPL-3.0-or-later
#include "probe_compensate/arcs.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace scanmill::compensating {

namespace {

constexpr double sqrt_half = std::numbers::sqrt2 / 2;
constexpr double most_ratio = 4;  ///< between the two distances of three points on one circle
constexpr double most_parts = 64;  ///< into which a chord is divided

/// A circle through two points a and b, as the height of its arc over their chord.
struct ArcOverChord {
    Vec3 up;  ///< unit vector, perpendicular to the chord
    double curvature;  ///< 1 / radius

    /// The height of the arc at a distance from a.
    double height(double from_a, double chord) const {
        const auto depth = [&](double aside) {
            const double sine = curvature * aside;
            return std::sqrt(std::max(0.0, 1 - sine * sine));
        };
        return curvature * from_a * (chord - from_a) / (depth(from_a - chord / 2) + depth(chord / 2));
    }
};

/// The circle through a, b and a third point beside one of them: `third` - a - b, or a - b - `third`.
std::optional<ArcOverChord> arc_over(const Vec3& a, const Vec3& b, const Vec3& third, bool is_before) {
    const Vec3 chord = b - a, other = is_before ? Vec3(a - third) : Vec3(third - b);
    const double length = chord.norm(), other_length = other.norm();
    if (!(length > 0) || !(other_length > 0)) return {};
    if (std::max(length, other_length) > most_ratio * std::min(length, other_length)) return {};
    if (chord.dot(other) < sqrt_half * length * other_length) return {};
    const Vec3 normal = is_before ? Vec3(other.cross(chord)) : Vec3(chord.cross(other));
    const double sine = normal.norm() / (length * other_length), across = (third - (is_before ? b : a)).norm();
    if (!(sine > 0)) return ArcOverChord{Vec3::Zero(), 0};
    // The circle bends towards the side of the third point, so the arc is on the other side of the chord.
    return ArcOverChord{chord.cross(normal).normalized(), 2 * sine / across};
}

double height_of(const std::optional<ArcOverChord>& arc, double from_a, double chord) {
    return arc ? arc->height(from_a, chord) : 0;
}

/// The points between a and b on the mean of the circles that exist.
Array<Vec3> between(const Vec3& a, const Vec3& b, const std::optional<ArcOverChord>& from_before,
                    const std::optional<ArcOverChord>& from_after, double chord_error) {
    Array<Vec3> points;
    const double chord = (b - a).norm();
    const double rise = std::max(height_of(from_before, chord / 2, chord), height_of(from_after, chord / 2, chord));
    if (!(rise > chord_error)) return points;
    const auto parts = static_cast<int>(std::clamp(std::ceil(std::sqrt(rise / chord_error)), 1.0, most_parts));
    for (int i = 1; i < parts; ++i) {
        const double share = static_cast<double>(i) / parts;
        const auto raised = [&](const std::optional<ArcOverChord>& arc) -> Vec3 {
            return height_of(arc, share * chord, chord) * (arc ? arc->up : Vec3::Zero());
        };
        const double weight = !from_after ? 0 : !from_before ? 1 : share;
        points.push_back(a + share * (b - a) + (1 - weight) * raised(from_before) + weight * raised(from_after));
    }
    return points;
}

}  // namespace

FeatureGraph along_arcs(const FeatureGraph& lines, const std::vector<bool>& is_exact, double chord_error) {
    FeatureGraph result;
    result.frame = lines.frame;
    result.corners = lines.corners;
    Array<Vec3> positions(lines.positions.begin(), lines.positions.end());
    Array<u32> vertices;
    for (const FeaturePolyline& line : lines.polylines) {
        const u32 begin = static_cast<u32>(vertices.size()), count = line.end - line.begin;
        const auto vertex = [&](u32 i) { return lines.vertices[line.begin + i % count]; };
        /// The circle through the points i and i + 1, and their neighbour before or after them.
        const auto arc = [&](u32 i, bool is_before) -> std::optional<ArcOverChord> {
            if (!line.closed && (is_before ? i == 0 : i + 2 >= count)) return {};
            const u32 a = vertex(i), b = vertex(i + 1), third = vertex(is_before ? i + count - 1 : i + 2);
            if (third == a || third == b || !is_exact[a] || !is_exact[b] || !is_exact[third]) return {};
            return arc_over(lines.positions[a], lines.positions[b], lines.positions[third], is_before);
        };
        for (u32 i = 0; i < count; ++i) {
            vertices.push_back(vertex(i));
            if (!line.closed && i + 1 == count) break;
            for (const Vec3& point : between(lines.positions[vertex(i)], lines.positions[vertex(i + 1)], arc(i, true),
                                             arc(i, false), chord_error)) {
                vertices.push_back(static_cast<u32>(positions.size()));
                positions.push_back(point);
            }
        }
        result.polylines.push_back({line.type, line.closed, begin, static_cast<u32>(vertices.size())});
    }
    result.positions = std::move(positions);
    result.left_normals = result.right_normals = Buffer<Vec3>(Array<Vec3>(vertices.size(), Vec3::Zero()));
    result.vertices = std::move(vertices);
    return result;
}

}  // namespace scanmill::compensating
