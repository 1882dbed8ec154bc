// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The rules by which a boundary edge chooses the point of its next triangle.

#include <vector>

#include "scanmill/geometry/growing/intersections.hpp"
#include "scanmill/geometry/growing/surface.hpp"

namespace scanmill::growing {

/// Radius of the largest empty circle that is not a hole of the surface, as a share of the search radius. Points
/// thinned with voxels of edge B leave empty circles of at most 1.1 B; the search radius is 2 √3 B.
inline constexpr double largest_empty_circle = 1.0 / 3;

enum class Score : u8 { circumradius, midpoint };

/// Limits of a new triangle. Angles are stored as the sines and cosines that are compared.
struct Limits {
    double least_sine;  ///< sine of the triangle's smallest angle
    double normal_cosine;  ///< least cosine between the triangle's normal and that of each triangle that shares an edge
    double touch_cosine;  ///< least cosine to the mean normal of the triangles that share only the new point
    double point_cosine;  ///< least cosine between the normals of the triangle and of its points
    double sharp_cosine;  ///< point_cosine for points at edges and tips
    double radius_factor;  ///< multiplies the search radius
    Pass pass;  ///< 0: the given limits. Later passes project along the mean normal of the triangles at a
                ///< corner instead of the point's normal.
};

struct SuitablePoint {
    u32 point = invalid_index;
    /// The surface is flat and evenly sampled here; no other choice is likely.
    bool certain = false;
    /// The neighbour lists did not hold all points that could have been better.
    bool uncovered = false;
};

/// A radius search over the open points (unused or on the boundary), which becomes faster as the surface closes.
///
/// It is a tree over the points in their order, which follows a space-filling curve. A search forgets the interior
/// points that it meets. So no interior point may become open while the tree is in use.
class OpenPoints {
public:
    /// Cost: linear, 7 to 14 bytes per point.
    explicit OpenPoints(const Surface& surface);

    /// Appends the other open points at a squared distance from `point` below `squared`, ascending.
    void within(u32 point, double squared, std::vector<u32>& found);

private:
    static constexpr std::size_t leaf_size = 16;
    struct Node {
        Vec3 low, high;
        bool open;
    };

    void visit(std::size_t node, u32 point, double squared, std::vector<u32>& found);
    bool visit_leaf(std::size_t leaf, u32 point, double squared, std::vector<u32>& found) const;

    const Surface& surface_;
    /// Node i has the children 2 i + 1 and 2 i + 2; the leaves are last.
    std::size_t leaves_;
    std::vector<Node> nodes_;
};

class PointChooser {
public:
    PointChooser(const Surface& surface, Score score) : surface_(surface), score_(score), open_points_(surface) {}

    /// Returns the point D for which triangle (from, D, to) continues the surface over its boundary edge from → to;
    /// invalid_index if no point satisfies the limits. With `wide`, all points in the search radius are searched, not
    /// only the neighbour lists.
    ///
    /// Score::circumradius chooses the point that sees the edge under the largest angle, so that the circle through the
    /// three is empty. Score::midpoint chooses the point nearest the edge's midpoint. Ties (within rounding): the
    /// lowest number. With `in_space`, the triangle must not intersect the surface in space. Where a boundary that
    /// faces the other way is near, this is tested in any case.
    SuitablePoint choose(u32 from, u32 to, const Limits& limits, bool wide, bool in_space);
    /// Whether the triangle intersects triangles at the nearest neighbours of its corners.
    bool intersects_surface(const Triangle& triangle);
    /// The third point of a seed triangle, on either side of the edge.
    u32 choose_third(u32 from, u32 to, const Limits& limits);
    /// Returns the boundary point that a boundary edge would choose if it were not for `normal_cosine` at that edge.
    /// The point is a neighbour of neither end. It is otherwise suitable, and its triangle does not fold back onto the
    /// edge's triangle. invalid_index if there is none.
    u32 beyond_sharp_edge(u32 from, u32 to, const Limits& limits);

private:
    struct Candidate {
        double score;
        u32 point;
        Vec3 normal;
    };

    double search_radius(u32 from, u32 to) const;
    /// Squared distance from an end of an edge within which points may be candidates.
    double squared_search_range(double radius) const;
    /// Fills near_ with the points to consider.
    void collect(u32 from, u32 to, double radius, bool wide);
    /// Fills candidates_ with the points of near_ whose circle and normal allow a triangle. Fills boundary_points_ with
    /// those on the boundary.
    void rate(u32 from, u32 to, const Vec3& joined, const Limits& limits);
    /// A necessary condition for choose(). False if every open point in the search radius violates the limits or is
    /// certain to be rejected because of others. Changes near_, candidates_ and rejected_.
    bool may_find(u32 from, u32 to, const Vec3& joined, double radius, const Limits& limits);
    /// Orders the candidates, with none rejected. Call it between rate() and take_best().
    void start_ranking();
    bool has_candidates() const { return !candidates_.empty() || !equal_.empty(); }
    /// Removes the candidate with the lowest score; ties: the lowest number. Pre: has_candidates().
    Candidate take_best();

    bool is_suitable(u32 from, u32 to, const Candidate& candidate, const Limits& limits, bool is_seed);
    /// Tests the limits. Together with sectors_are_free(), these are all tests that do not depend on other candidates.
    bool satisfies_limits(u32 from, u32 to, const Candidate& candidate, const Limits& limits, bool is_seed) const;
    bool agrees_with_joined(u32 from, u32 to, const Vec3& normal, double least_cosine) const;
    /// The least cosine between the normals of the two triangles of an edge: `usual`, or at fixed edges fold_cosine.
    double least_cosine_across(u32 from, u32 to, double usual) const;
    /// Whether a rejected candidate lies in the triangle, or the boundary crosses it.
    bool overlaps_others(const Triangle& triangle, const Vec3& normal);
    bool is_neighbour(u32 point, u32 vertex) const;

    const Surface& surface_;
    Score score_;
    OpenPoints open_points_;
    NeighbourBuffer buffer_;
    NearTriangles near_triangles_;
    std::vector<u32> near_;
    std::vector<u32> boundary_points_;
    /// A heap by score, lowest first, and the candidates taken from it whose scores equal the lowest.
    std::vector<Candidate> candidates_, equal_;
    std::vector<Candidate> rejected_;
};

}  // namespace scanmill::growing
