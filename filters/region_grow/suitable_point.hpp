// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The places that a triangle may still take: a search that grows cheaper as the surface closes over them.

#include <optional>
#include <vector>

#include "region_grow/intersections.hpp"
#include "region_grow/surface.hpp"

namespace scanmill::growing {

/// A tree over the places as they are numbered, which is along a curve through space. Places that are neither unused
/// nor of the front are forgotten when a search meets them; so none may come back while this is used.
class LivePlaces {
public:
    /// Cost: linear, 7 to 14 bytes per place.
    explicit LivePlaces(const Surface& surface);

    /// Appends the live places at a squared distance from `place` below `squared`, itself not among them, by number.
    void within(u32 place, double squared, std::vector<u32>& found);

private:
    static constexpr std::size_t leaf_size = 16;
    struct Node {
        Vec3 low, high;
        bool live;
    };

    void visit(std::size_t node, u32 place, double squared, std::vector<u32>& found);
    bool visit_leaf(std::size_t leaf, u32 place, double squared, std::vector<u32>& found) const;

    const Surface& surface_;
    /// Node i has the children 2 i + 1 and 2 i + 2; leaves come last.
    std::size_t leaves_;
    std::vector<Node> nodes_;
};

// The rules by which an edge of the front chooses the point of its next triangle.

/// Of the search radius: how large an empty circle may be before it is a hole of the surface. Points thinned with bins
/// of edge B leave circles of 1.1 B at most; the search radius is 2 √3 B.
inline constexpr double largest_circle = 1.0 / 3;

enum class Score : u8 { circumradius, midpoint };

/// What a new triangle must keep to. Angles as what is compared.
struct Limits {
    double least_sine;  ///< of the triangle's smallest angle
    double normal_cosine;  ///< between the triangle's normal and that of every joined one: at least
    double touch_cosine;  ///< the same to the triangles that it meets in nothing but its new point, on average
    double point_cosine;  ///< between the triangle's normal and that of each of its points: at least
    double rough_cosine;  ///< the same for points that do not lie in a plane with their neighbours
    double reach;  ///< the search radius counts this many times
    Pass pass;  ///< 0: the given limits; later ones judge sectors by the triangles there, not by points
};

struct SuitablePoint {
    u32 point = nobody;
    /// Nothing about the choice is in doubt: the surface bends little here.
    bool plain = false;
    /// The neighbour lists did not hold all points that could have been better.
    bool uncovered = false;
};

class PointChooser {
public:
    PointChooser(const Surface& surface, Score score) : surface_(surface), score_(score), live_(surface) {}

    /// The point D for which triangle (from, D, to) continues the surface over its border edge from → to; none when no
    /// point keeps to the limits. `far`: look at all points in the search radius, not only at the nearest ones.
    ///
    /// circumradius: the point that sees the edge under the largest angle, so that no other one lies in the circle
    /// through the three; midpoint: the one nearest the edge's midpoint. Equal ones (within rounding) by number.
    /// `in_space`: the triangle does not pass through others near it either, which the plane that the surface faces
    /// along does not tell where it bends. Asked in any case where a front that faces away is near.
    SuitablePoint choose(u32 from, u32 to, const Limits& limits, bool far, bool in_space);
    /// Whether the triangle meets those at the places nearest to its corners in more than common corners and edges.
    bool passes_through_others(const Triangle& triangle);
    /// The point with which two unused ones begin a surface, on whichever side.
    u32 choose_third(u32 from, u32 to, const Limits& limits);
    /// The place on the front that a border edge would take, were it not for the angle to the triangle there: none of
    /// the ends' neighbours, suitable in all else, and no fold back onto that triangle. nobody when there is none.
    u32 beyond_sharp_edge(u32 from, u32 to, const Limits& limits);

private:
    struct Candidate {
        double score;
        u32 point;
        Vec3 normal;
    };

    void collect(u32 from, u32 to, double reach, bool far);
    /// Of how far a search goes.
    double squared_range(double reach) const;
    /// False when nobody in the search radius keeps to the limits, whatever lies nearer. Changes near_ and candidates_.
    bool may_find(u32 from, u32 to, const Vec3& joined, double reach, const Limits& limits);
    /// Between rate() and take_best(): begins a new order, with nothing turned down.
    void put_in_order();
    bool has_candidates() const { return !candidates_.empty() || !equal_.empty(); }
    /// Takes out the candidate of the least score, of equal ones that of the lowest number. Pre: has_candidates().
    Candidate take_best();
    bool is_neighbour(u32 point, u32 vertex) const;
    void rate(u32 from, u32 to, const Vec3& joined, const Limits& limits);
    /// With sectors_are_free() all that does not depend on other candidates.
    bool keeps_limits(u32 from, u32 to, const Candidate& candidate, const Limits& limits, bool new_surface) const;
    bool is_suitable(u32 from, u32 to, const Candidate& candidate, const Limits& limits, bool new_surface);
    bool has_good_angles(u32 from, u32 to, u32 point, const Limits& limits) const;
    bool agrees_with_points(const Triangle& triangle, const Vec3& normal, const Limits& limits) const;
    bool agrees_with_joined(u32 from, u32 to, const Vec3& normal, double least) const;
    bool sectors_are_free(const Triangle& triangle, const Vec3& normal, Pass pass) const;
    /// The direction of the summed normals of the vertex's triangles and one more.
    Vec3 fan_axis(u32 vertex, const Vec3& more) const;
    bool lies_over_others(const Triangle& triangle, const Vec3& normal);
    double search_radius(u32 from, u32 to) const;

    const Surface& surface_;
    Score score_;
    LivePlaces live_;
    NeighbourBuffer buffer_;
    NearTriangles near_triangles_;
    std::vector<u32> near_;
    std::vector<u32> fronts_;
    /// A heap by score, the least first, and those taken from it because their scores are equal to the least.
    std::vector<Candidate> candidates_, equal_;
    std::vector<Candidate> turned_down_;
};

}  // namespace scanmill::growing
