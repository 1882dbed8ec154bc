// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Feature lines for probing: polylines with the normals on both sides of every segment, and windows on these lines.

#include <numbers>
#include <optional>
#include <vector>

#include "scanmill/data/features.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::probing {

/// Hint for features whose arrays do not fit together.
inline constexpr const char* damaged = "the features are damaged: make them again from a mesh";
inline constexpr double sqrt_half = std::numbers::sqrt2 / 2;

/// A polyline with the values that are computed once per segment. Segment i starts at vertex i. The last segment of a
/// closed line ends at vertex 0.
struct Line {
    u32 row = 0;  ///< the line's row in the features; for a joined line, the row of its first part
    FeatureType type{};
    bool closed = false;
    Array<Vec3> points;
    Array<Vec3> left, right;  ///< normals; on the right zero if unknown or within 45 degrees of the line's direction
    Array<Vec3> directions;
    Array<double> lengths;
    Array<double> arcs;  ///< arc length at which each segment begins, then the whole length
    std::vector<bool> stops;  ///< by vertex: whether windows end there

    u32 vertices() const { return static_cast<u32>(points.size()); }
    u32 segments() const { return static_cast<u32>(lengths.size()); }
    bool is_boundary() const { return type != FeatureType::crease; }
    const Vec3& end_of(u32 segment) const { return points[(segment + 1) % vertices()]; }
    Vec3 middle(u32 segment) const { return (points[segment] + end_of(segment)) / 2; }
    double middle_arc(u32 segment) const { return arcs[segment] + lengths[segment] / 2; }
    bool has_right(u32 segment) const { return right[segment] != Vec3::Zero(); }
    /// The previous and the next segment; empty at the ends of open lines.
    std::optional<u32> before(u32 segment) const {
        if (segment > 0) return segment - 1;
        return closed ? std::optional(segments() - 1) : std::nullopt;
    }
    std::optional<u32> after(u32 segment) const {
        if (segment + 1 < segments()) return segment + 1;
        return closed ? std::optional(0u) : std::nullopt;
    }
};

struct LineChoice {
    bool creases = true, holes = true, boundaries = true;
};

struct ChosenLines {
    std::vector<Line> lines;
    std::size_t left_out = 0;  ///< creases
};

/// Returns the chosen lines in the order of their rows, with creases made whole by whole_lines(). Throws Error as
/// find_reference_points() does.
ChosenLines chosen_lines(const FeatureGraph& features, const LineChoice& choice, double error, const Context& context);

/// Consecutive segments around one segment.
struct Window {
    Array<u32> segments;
    Vec3 start, end;
    double length = 0;
};

/// Returns the window around a point of a segment, as reference_points.hpp defines it.
Window window_round(const Line& line, u32 segment, const Vec3& point);

/// Returns the sum of the normals in the window, weighted by the lengths of their segments; not normalized.
Vec3 mean_normal(const Line& line, const Window& window, const Array<Vec3>& normals);

inline Vec3 perpendicular(const Vec3& normal, const Vec3& tangent) { return normal - tangent.dot(normal) * tangent; }

}  // namespace scanmill::probing
