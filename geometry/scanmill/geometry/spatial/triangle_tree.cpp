// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/spatial/triangle_tree.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>

#include "scanmill/base/parallel.hpp"
#include "scanmill/geometry/spatial/triangle_distance.hpp"

namespace scanmill {

namespace {

constexpr std::size_t largest_leaf = 4;
/// Widening of boxes, as a share of the scaled extent. It is far above the rounding error of a distance in doubles and
/// far below the rounding error of a float.
constexpr double widening = 0x1p-40;

/// A float below `value`, also if `value` is a float.
float rounded_down(double value) {
    return std::nextafterf(static_cast<float>(value), -std::numeric_limits<float>::infinity());
}
float rounded_up(double value) { return -rounded_down(-value); }

using Float3 = Eigen::Array3f;

Float3 rounded_down(const Vec3& point) {
    return {rounded_down(point.x()), rounded_down(point.y()), rounded_down(point.z())};
}
Float3 rounded_up(const Vec3& point) { return -rounded_down(Vec3(-point)); }

struct Centroid {
    Float3 at;
    u32 row;
};

/// Moves the `middle - first` centroids that are smallest along the longest axis to the front; equal ones by row.
void split(Centroid* first, Centroid* middle, Centroid* last) {
    if (middle == first || middle == last) return;
    Float3 low = first->at, high = first->at;
    for (const Centroid* c = first; c != last; ++c) {
        low = low.min(c->at);
        high = high.max(c->at);
    }
    int longest = 0;
    (high - low).maxCoeff(&longest);
    std::nth_element(first, middle, last, [longest](const Centroid& a, const Centroid& b) {
        return a.at[longest] != b.at[longest] ? a.at[longest] < b.at[longest] : a.row < b.row;
    });
}

}  // namespace

TriangleTree::TriangleTree(std::span<const Vec3> positions, std::span<const Triangle> triangles, unsigned threads) {
    assert(!triangles.empty() && triangles.size() < ~u32(0));
    BoundingBox box;
    for (const Triangle& triangle : triangles)
        for (u32 vertex : triangle) box.add(positions[vertex]);
    centre_ = box.low + (box.high - box.low) / 2;
    if (const double extent = (box.high - box.low).maxCoeff(); extent > 0)
        scale_ = std::ldexp(1.0, -std::ilogb(extent));

    while (triangles.size() > largest_leaf << (2 * depth_)) ++depth_;
    assert(depth_ <= deepest);
    sort_triangles(positions, triangles, threads);
    bound_nodes(threads);
}

void TriangleTree::sort_triangles(std::span<const Vec3> positions, std::span<const Triangle> triangles,
                                  unsigned threads) {
    constexpr std::size_t chunk = 1 << 14;
    const std::size_t count = triangles.size();
    Array<Centroid> centroids(count);
    for_each_chunk(threads, count, chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
            const auto& [a, b, c] = triangles[row];
            const Vec3 sum = scaled(positions[a]) + scaled(positions[b]) + scaled(positions[c]);
            centroids[row] = {sum.cast<float>().array(), static_cast<u32>(row)};
        }
    });
    rows_.resize(count);
    for (unsigned level = 0; level < depth_; ++level)
        for_each_chunk(threads, std::size_t(1) << (2 * level), 16, [&](std::size_t begin, std::size_t end) {
            for (std::size_t node = begin; node < end; ++node) {
                std::array<Centroid*, arity + 1> cut;
                for (std::size_t i = 0; i <= arity; ++i)
                    cut[i] = centroids.data() + begin_of(arity * node + i, level + 1);
                split(cut[0], cut[2], cut[4]);
                split(cut[0], cut[1], cut[2]);
                split(cut[2], cut[3], cut[4]);
            }
        });
    corners_.resize(count);
    for_each_chunk(threads, count, chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t slot = begin; slot < end; ++slot) {
            rows_[slot] = centroids[slot].row;
            const auto& [a, b, c] = triangles[rows_[slot]];
            corners_[slot] = {positions[a], positions[b], positions[c]};
        }
    });
}

void TriangleTree::bound_nodes(unsigned threads) {
    std::size_t first = ((std::size_t(1) << (2 * depth_)) - 1) / 3;
    nodes_.resize(first);
    while (first > 0) {
        const std::size_t end = first;
        first = (first - 1) / arity;
        for_each_chunk(threads, end - first, 256, [&](std::size_t from, std::size_t to) {
            for (std::size_t node = first + from; node < first + to; ++node) bound_node(node);
        });
    }
}

void TriangleTree::bound_node(std::size_t node) {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    for (std::size_t i = 0; i < arity; ++i) {
        Float3 low = Float3::Constant(infinity), high = -low;
        const std::size_t child = arity * node + 1 + i;
        if (child < nodes_.size()) {
            for (int axis = 0; axis < 3; ++axis) {
                low[axis] = *std::ranges::min_element(nodes_[child].bounds[axis]);
                high[axis] = *std::ranges::max_element(nodes_[child].bounds[axis + 3]);
            }
        } else {
            const std::size_t leaf = child - nodes_.size();
            for (std::size_t slot = begin_of(leaf, depth_); slot < begin_of(leaf + 1, depth_); ++slot) {
                for (const Vec3& corner : corners_[slot]) {
                    low = low.min(rounded_down(Vec3(scaled(corner).array() - widening)));
                    high = high.max(rounded_up(Vec3(scaled(corner).array() + widening)));
                }
            }
        }
        for (int axis = 0; axis < 3; ++axis) {
            nodes_[node].bounds[axis][i] = low[axis];
            nodes_[node].bounds[axis + 3][i] = high[axis];
        }
    }
}

TriangleTree tree_of_points(std::span<const Vec3> positions, unsigned threads) {
    Array<Triangle> triangles(positions.size());
    for (u32 i = 0; i < triangles.size(); ++i) triangles[i] = {i, i, i};
    return TriangleTree(positions, triangles, threads);
}

namespace {

using Float4 = float __attribute__((vector_size(16)));
using Int4 = std::int32_t __attribute__((vector_size(16)));

Float4 larger(Float4 a, Float4 b) { return a > b ? a : b; }
Float4 all(float value) { return Float4{value, value, value, value}; }
Float4 load(const float* values) { return Float4{values[0], values[1], values[2], values[3]}; }

/// For each coordinate of a point, an interval of floats that contains it, four times for four boxes.
struct FloatPoint {
    explicit FloatPoint(const Vec3& point) {
        for (int axis = 0; axis < 3; ++axis) {
            // A far point is moved nearer: it remains outside of all boxes, and its squared distance fits in a float.
            const double moved = std::clamp(point[axis], -1e18, 1e18);
            low[axis] = all(rounded_down(moved));
            high[axis] = all(rounded_up(moved));
        }
    }
    /// Lower bounds of the squared distances to four boxes, apart from a few rounding errors.
    Float4 squared_distances(const float (&bounds)[6][4]) const {
        Float4 sum = all(0);
        for (int axis = 0; axis < 3; ++axis) {
            const Float4 below = load(bounds[axis]) - high[axis];
            const Float4 above = low[axis] - load(bounds[axis + 3]);
            const Float4 outside = larger(larger(below, above), all(0));
            sum += outside * outside;
        }
        return sum;
    }
    Float4 low[3], high[3];
};

/// An upper bound of what squared_distances() gives for a box that contains a triangle at squared distance `squared`.
/// The added terms exceed all roundings together.
float reach(double squared, double scale) {
    return static_cast<float>(std::min(squared * (scale * scale) * (1 + 0x1p-18), 1e38)) + 1e-36f;
}

}  // namespace

Vec3 TriangleTree::nearest_point(const Vec3& point, u32 slot) const {
    const auto& [a, b, c] = corners_[slot];
    return nearest_on_triangle(point, a, b, c);
}

template <class Offer>
void TriangleTree::search(const Vec3& point, float& limit, const Offer& offer) const {
    struct Waiting {
        float bound;
        u32 node;
    };
    std::array<Waiting, (arity - 1) * deepest + 1> stack;
    std::size_t waiting = 0;
    const FloatPoint query(scaled(point));
    stack[waiting++] = {0, 0};
    while (waiting > 0) {
        const Waiting next = stack[--waiting];
        if (next.bound > limit) continue;
        if (next.node >= nodes_.size()) {
            const std::size_t leaf = next.node - nodes_.size();
            for (std::size_t slot = begin_of(leaf, depth_); slot < begin_of(leaf + 1, depth_); ++slot)
                if (offer(static_cast<u32>(slot))) return;
            continue;
        }
        const Float4 bounds = query.squared_distances(nodes_[next.node].bounds);
        // The new entries are kept in descending order, so that the nearest box is popped first.
        const std::size_t bottom = waiting;
        for (u32 i = 0; i < arity; ++i) {
            if (!(bounds[i] <= limit)) continue;
            std::size_t at = waiting++;
            for (; at > bottom && stack[at - 1].bound < bounds[i]; --at) stack[at] = stack[at - 1];
            stack[at] = {bounds[i], static_cast<u32>(arity * next.node + 1 + i)};
        }
    }
}

NearestTriangle TriangleTree::nearest(const Vec3& point, u32 hint) const {
    assert(point.allFinite());
    NearestTriangle best;
    float limit = std::numeric_limits<float>::infinity();
    const auto offer = [&](u32 slot) {
        const double squared = squared_distance(point, slot);
        if (squared < best.squared_distance || (squared == best.squared_distance && rows_[slot] < best.triangle)) {
            best = {rows_[slot], slot, squared};
            limit = reach(squared, scale_);
        }
        return false;
    };
    if (hint < corners_.size()) offer(hint);
    search(point, limit, [&](u32 slot) { return slot != hint && offer(slot); });
    assert(best.triangle != NearestTriangle::none);
    return best;
}

bool TriangleTree::is_within(const Vec3& point, double squared, u32& hint) const {
    assert(point.allFinite() && squared >= 0);
    if (hint < corners_.size() && squared_distance(point, hint) <= squared) return true;
    bool found = false;
    float limit = reach(squared, scale_);
    search(point, limit, [&](u32 slot) {
        found = squared_distance(point, slot) <= squared;
        if (found) hint = slot;
        return found;
    });
    return found;
}

void TriangleTree::meeting(const BoundingBox& box, Array<u32>& rows) const {
    const Float3 low = rounded_down(scaled(box.low)), high = rounded_up(scaled(box.high));
    std::array<u32, (arity - 1) * deepest + 1> stack;
    std::size_t waiting = 0;
    stack[waiting++] = 0;
    while (waiting > 0) {
        const u32 node = stack[--waiting];
        if (node < nodes_.size()) {
            Int4 meets = {-1, -1, -1, -1};
            for (int axis = 0; axis < 3; ++axis)
                meets &= (load(nodes_[node].bounds[axis]) <= all(high[axis])) &
                         (load(nodes_[node].bounds[axis + 3]) >= all(low[axis]));
            for (u32 i = 0; i < arity; ++i)
                if (meets[i]) stack[waiting++] = static_cast<u32>(arity * node + 1 + i);
            continue;
        }
        const std::size_t leaf = node - nodes_.size();
        for (std::size_t slot = begin_of(leaf, depth_); slot < begin_of(leaf + 1, depth_); ++slot) {
            const auto& [a, b, c] = corners_[slot];
            const Vec3 least = a.cwiseMin(b).cwiseMin(c), most = a.cwiseMax(b).cwiseMax(c);
            if ((least.array() <= box.high.array()).all() && (most.array() >= box.low.array()).all())
                rows.push_back(rows_[slot]);
        }
    }
}

namespace {

/// The convex hull of one to three points, for tests against boxes with separating axes. The axes are the coordinate
/// axes and, for a triangle, its normal. For a segment, they are also its three cross products with the coordinate
/// axes.
class Hull {
public:
    Hull(std::span<const Vec3> points, double distance) {
        for (const Vec3& point : points) box_.add(point);
        box_.low.array() -= distance;
        box_.high.array() += distance;
        if (points.size() == 2)
            for (int axis = 0; axis < 3; ++axis) add((points[1] - points[0]).cross(Vec3::Unit(axis)), points, distance);
        if (points.size() == 3) add((points[1] - points[0]).cross(points[2] - points[0]), points, distance);
    }
    bool is_separated(const Vec3& low, const Vec3& high) const {
        if ((low.array() > box_.high.array()).any() || (high.array() < box_.low.array()).any()) return true;
        const Vec3 centre = (low + high) / 2, half = (high - low) / 2;
        for (std::size_t i = 0; i < directions_; ++i) {
            const double middle = direction_[i].dot(centre), reach = direction_[i].cwiseAbs().dot(half);
            if (middle - reach > high_[i] || middle + reach < low_[i]) return true;
        }
        return false;
    }

private:
    void add(const Vec3& direction, std::span<const Vec3> points, double distance) {
        const double length = direction.stableNorm();
        if (!(length > 0)) return;
        const Vec3 unit = direction / length;
        double low = unit.dot(points[0]), high = low;
        for (const Vec3& point : points) {
            low = std::min(low, unit.dot(point));
            high = std::max(high, unit.dot(point));
        }
        direction_[directions_] = unit;
        low_[directions_] = low - distance;
        high_[directions_] = high + distance;
        ++directions_;
    }

    BoundingBox box_;
    std::size_t directions_ = 0;
    std::array<Vec3, 3> direction_;
    std::array<double, 3> low_, high_;
};

}  // namespace

bool TriangleTree::any_near(std::span<const Vec3> hull, double distance,
                            const std::function<bool(u32 slot)>& accept) const {
    assert(!hull.empty() && hull.size() <= 3 && distance >= 0);
    std::array<Vec3, 3> points;
    double furthest = 0;
    for (std::size_t i = 0; i < hull.size(); ++i) {
        points[i] = scaled(hull[i]);
        furthest = std::max(furthest, points[i].cwiseAbs().maxCoeff());
    }
    // The added width exceeds the rounding errors of the tests, whose numbers are not much larger than the furthest
    // coordinate.
    const Hull query({points.data(), hull.size()}, distance * scale_ + (1 + furthest) * widening);
    std::array<u32, (arity - 1) * deepest + 1> stack;
    std::size_t waiting = 0;
    stack[waiting++] = 0;
    while (waiting > 0) {
        const u32 node = stack[--waiting];
        if (node < nodes_.size()) {
            const auto& bounds = nodes_[node].bounds;
            for (u32 i = 0; i < arity; ++i) {
                const Vec3 low(bounds[0][i], bounds[1][i], bounds[2][i]),
                    high(bounds[3][i], bounds[4][i], bounds[5][i]);
                // Boxes without triangles have an infinite low corner.
                if (low.x() <= high.x() && !query.is_separated(low, high))
                    stack[waiting++] = static_cast<u32>(arity * node + 1 + i);
            }
            continue;
        }
        const std::size_t leaf = node - nodes_.size();
        for (std::size_t slot = begin_of(leaf, depth_); slot < begin_of(leaf + 1, depth_); ++slot) {
            const auto& [a, b, c] = corners_[slot];
            const Vec3 least = scaled(a.cwiseMin(b).cwiseMin(c)), most = scaled(a.cwiseMax(b).cwiseMax(c));
            if (!query.is_separated(least, most) && accept(static_cast<u32>(slot))) return true;
        }
    }
    return false;
}

}  // namespace scanmill
