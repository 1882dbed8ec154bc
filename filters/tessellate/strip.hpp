// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Builds the triangles beside an edge of the mesh, between the faces of its two triangles.

#include <algorithm>
#include <optional>
#include <vector>

#include "tessellate/lines.hpp"
#include "tessellate/structure.hpp"

namespace scanmill::tessellation {

/// A point of an edge between its ends.
struct Sample {
    std::array<double, 2> share;  ///< shares of the edge, from a and from b
    u8 side = 1;  ///< side of the mesh on which the surface is
    bool is_on_surface = false;  ///< the strip has one point here
    /// Whether there are no tetrahedra on this side. A straight line then leads from face to face.
    bool is_open = false;
    /// By triangle: how far a curved crease reaches above it, as a share of the way to its base point; otherwise 0.
    std::array<double, 2> inset{0, 0};
};

/// A grid of points. Its rows are the samples and the two ends of the edge. Its columns lead from the face of the first
/// triangle to that of the second. At a sharp edge, the middle column is the crease. At a border, there is only the
/// column of the first triangle. Several columns may share a point.
struct Strip {
    unsigned segments = 1;  ///< segments of the edge, not counting samples where the surface crosses it
    unsigned fan = 1;  ///< number of columns minus one
    std::vector<Sample> samples;
    std::vector<u32> numbers;  ///< point numbers, by sample and column
    std::vector<SurfacePoint> points;
    /// By point: at a sharp edge, the normal of the second triangle's function on the crease; otherwise zero.
    std::vector<Vec3> second_normals;
    u32 first_vertex = 0;
    double worst = 0;  ///< largest distance found between its triangles and the surface

    unsigned columns() const { return fan + 1; }
    u32 number(std::size_t sample, unsigned column) const { return numbers[sample * columns() + column]; }
    bool is_straight() const { return samples.empty(); }
};

/// The largest distances found between the surface and lines along rows, lines along columns, and triangles.
struct Errors {
    double along = 0, across = 0, inside = 0;

    double worst() const { return std::max({along, across, inside}); }
};

/// Doubles the numbers of segments of rows and of columns, up to `most` and `most_across`, where the errors demand it.
/// Returns whether one was doubled.
bool refine(unsigned& along, unsigned& across, const Errors& errors, double max_error, unsigned most,
            unsigned most_across);

/// The largest distance between a segment and the surface through its ends, if that is like a parabola. `distance_at`
/// is the distance at a point.
template <class DistanceAt>
double distance_on_segment(const Vec3& a, const Vec3& b, DistanceAt&& distance_at) {
    constexpr double middle_over_third = 9. / 8;  // for a quadratic function with zeros at the ends
    return middle_over_third * std::max(distance_at((2 * a + b) / 3), distance_at((a + 2 * b) / 3));
}

/// Sets all members but the first vertex. Begins with the strip's segments and fan. With `max_error`, they grow up to
/// `most` until the strip is within that distance. Values up to `zero` count as 0.
void build(Strip& strip, const PatchComplex& patches, const PatchStructure& structure, const EdgeTets& edge,
           double zero, std::optional<double> max_error, unsigned most);

}  // namespace scanmill::tessellation
