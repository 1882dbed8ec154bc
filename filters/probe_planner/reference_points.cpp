// SPDX-License-Identifier: GPL-3.0-or-later
#include "probe_planner/reference_points.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <set>

#include "scanmill/base/error.hpp"
#include "scanmill/geometry/spatial/angle.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill::probing {

namespace {

constexpr double pi = std::numbers::pi, sqrt_half = std::numbers::sqrt2 / 2;
constexpr u32 reach = 2;  ///< segments of a window on either side
constexpr std::size_t most_points = 1'000'000;

constexpr const char* damaged = "the features are damaged: make them again from a mesh";

std::string_view name_of(FeatureType type) {
    return type == FeatureType::crease ? "crease" : type == FeatureType::hole ? "hole" : "outer boundary";
}

/// A polyline with what is computed once for every segment. Segment i starts at vertex i; those of closed lines wrap.
struct Line {
    u32 row = 0;
    FeatureType type{};
    bool closed = false;
    Array<Vec3> points, left,
        right;  ///< right: zero also where it is not perpendicular to the line to within 45 degrees
    Array<Vec3> directions;
    Array<double> lengths;
    Array<double> arcs;  ///< where the segments begin, and the whole length
    std::vector<bool> stops;  ///< vertices that no window passes

    u32 vertices() const { return static_cast<u32>(points.size()); }
    u32 segments() const { return static_cast<u32>(lengths.size()); }
    bool is_boundary() const { return type != FeatureType::crease; }
    const Vec3& end_of(u32 segment) const { return points[(segment + 1) % vertices()]; }
    Vec3 middle(u32 segment) const { return (points[segment] + end_of(segment)) / 2; }
    double middle_arc(u32 segment) const { return arcs[segment] + lengths[segment] / 2; }
    bool has_right(u32 segment) const { return right[segment] != Vec3::Zero(); }
    /// The segments beside one; nothing at the ends of open lines.
    std::optional<u32> before(u32 segment) const {
        if (segment > 0) return segment - 1;
        return closed ? std::optional(segments() - 1) : std::nullopt;
    }
    std::optional<u32> after(u32 segment) const {
        if (segment + 1 < segments()) return segment + 1;
        return closed ? std::optional(0u) : std::nullopt;
    }
};

void require_unit(const Vec3& normal, u32 line, u32 segment, const char* side) {
    constexpr double most = 1e-3;
    if (!normal.allFinite())
        throw Error("the {} normal of segment {} of line {} is not finite", side, segment, line)
            .hint("make the features again from a mesh without NaN: `features`, or region-grow's port `features`");
    if (std::abs(normal.norm() - 1) > most)
        throw Error("the {} normal of segment {} of line {} has the length {:.6g}; a unit normal has 1", side, segment,
                    line, normal.norm())
            .hint("make the features again: `features`, or region-grow's port `features`");
}

Line read_line(const FeatureGraph& graph, u32 row) {
    const FeaturePolyline& polyline = graph.polylines[row];
    Line line;
    line.row = row;
    line.type = polyline.type;
    line.closed = polyline.closed;
    if (line.is_boundary() && !line.closed)
        throw Error("line {} is an open {} with {} vertices; boundaries of a mesh are closed", row, name_of(line.type),
                    polyline.end - polyline.begin)
            .hint("make the features again from a mesh, or probe creases alone: features: creases");
    const u32 least = line.closed ? 3 : 2;
    if (polyline.begin > polyline.end || polyline.end > graph.vertices.size() || polyline.end - polyline.begin < least)
        throw Error("line {} names the vertices {} to {} of {}; a line needs at least {}", row, polyline.begin,
                    polyline.end, graph.vertices.size(), least)
            .hint(damaged);
    for (u32 i = polyline.begin; i < polyline.end; ++i) {
        const u32 vertex = graph.vertices[i];
        if (vertex >= graph.positions.size())
            throw Error("line {} names the point {}; there are {}", row, vertex, graph.positions.size()).hint(damaged);
        if (!graph.positions[vertex].allFinite())
            throw Error("vertex {} of line {} is not finite", i - polyline.begin, row)
                .hint("make the features again from a mesh without NaN");
        line.points.push_back(graph.positions[vertex]);
    }
    const u32 segments = line.vertices() - (line.closed ? 0 : 1);
    line.arcs.push_back(0);
    for (u32 segment = 0; segment < segments; ++segment) {
        const Vec3 along = line.end_of(segment) - line.points[segment];
        const double length = along.norm();
        if (!(length > 0))
            throw Error("segment {} of line {} has the length 0: both ends are at ({:.6g}, {:.6g}, {:.6g})", segment,
                        row, line.points[segment].x(), line.points[segment].y(), line.points[segment].z())
                .hint("remove repeated points from the scan, or repeated vertices from the mesh");
        line.directions.push_back(along / length);
        line.lengths.push_back(length);
        line.arcs.push_back(line.arcs.back() + length);
        const Vec3 &left = graph.left_normals[polyline.begin + segment],
                   &right = graph.right_normals[polyline.begin + segment];
        if (left == Vec3::Zero())
            throw Error("segment {} of line {} has no normal on its left", segment, row)
                .hint("the surface is on the left of a line: make the features again from a mesh");
        require_unit(left, row, segment, "left");
        line.left.push_back(left);
        line.right.push_back(Vec3::Zero());
        if (right == Vec3::Zero()) continue;
        require_unit(right, row, segment, "right");
        constexpr double least_angle = 1e-6;
        if (angle_between(left, right) < least_angle)
            throw Error(
                "the normals on both sides of segment {} of line {} are equal (0 deg between them): there is no "
                "edge",
                segment, row)
                .hint("find the features with a sharp-angle above 0");
        if (std::abs(right.dot(line.directions.back())) < sqrt_half) line.right.back() = right;
    }
    return line;
}

/// The vertex `steps` segments before (negative) or after a vertex, at most to the ends of an open line.
Vec3 beside(const Line& line, u32 vertex, int steps) {
    const auto count = static_cast<int>(line.vertices());
    const int at = static_cast<int>(vertex) + steps;
    if (line.closed) return line.points[static_cast<std::size_t>((at % count + count) % count)];
    return line.points[static_cast<std::size_t>(std::clamp(at, 0, count - 1))];
}

/// Whether the line turns by more than 45 degrees between two chords.
bool is_turn(const Vec3& before, const Vec3& after) {
    return before.dot(after) < sqrt_half * before.norm() * after.norm();
}

void find_stops(const FeatureGraph& graph, std::vector<Line>& lines) {
    std::vector<u32> uses(graph.positions.size());
    for (const FeaturePolyline& polyline : graph.polylines)
        for (u32 i = polyline.begin; i < polyline.end; ++i) ++uses[graph.vertices[i]];
    std::vector<bool> is_corner(graph.positions.size());
    for (const u32 corner : graph.corners)
        if (corner < is_corner.size()) is_corner[corner] = true;
    for (Line& line : lines) {
        line.stops.assign(line.vertices(), false);
        const FeaturePolyline& polyline = graph.polylines[line.row];
        for (u32 i = 0; i < line.vertices(); ++i) {
            const u32 vertex = graph.vertices[polyline.begin + i];
            if (uses[vertex] > 1) line.stops[i] = true;
            if (!is_corner[vertex]) continue;
            const int chord = reach;
            const Vec3 before = line.points[i] - beside(line, i, -chord),
                       after = beside(line, i, chord) - line.points[i];
            if (is_turn(before, after)) line.stops[i] = true;
        }
    }
}

/// Consecutive segments round one.
struct Window {
    Array<u32> segments;
    Vec3 start, end;
    double length = 0;
};

Window window_round(const Line& line, u32 segment, const Vec3& point) {
    // Of a closed line at most half is in a window.
    const u32 widest = line.closed ? std::min(reach, (line.segments() - 1) / 4) : reach;
    for (u32 most = widest;; --most) {
        Window window;
        u32 first = segment, last = segment;
        for (u32 step = 0; step < most && !line.stops[first]; ++step) {
            const std::optional<u32> next = line.before(first);
            if (!next) break;
            first = *next;
        }
        for (u32 step = 0; step < most && !line.stops[(last + 1) % line.vertices()]; ++step) {
            const std::optional<u32> next = line.after(last);
            if (!next) break;
            last = *next;
        }
        window.start = line.points[first];
        window.end = line.end_of(last);
        for (u32 at = first;; at = *line.after(at)) {
            window.segments.push_back(at);
            window.length += line.lengths[at];
            if (at == last) break;
        }
        if (most == 0 || !is_turn(point - window.start, window.end - point)) return window;
    }
}

/// The length-weighted mean of unit normals, without those that are zero.
Vec3 mean_normal(const Line& line, const Window& window, const Array<Vec3>& normals) {
    Vec3 sum = Vec3::Zero();
    for (const u32 segment : window.segments) sum += line.lengths[segment] * normals[segment];
    return sum;
}

Vec3 perpendicular(const Vec3& normal, const Vec3& tangent) { return normal - tangent.dot(normal) * tangent; }

/// How far a chord of a line that turns to the right lies beyond it.
double sagitta(const Line& line, const Window& window, u32 segment, const Vec3& point, const Vec3& normal) {
    const Vec3 before = point - window.start, after = window.end - point;
    if (!(normal.dot(before.cross(after)) < 0)) return 0;
    const double curvature = angle_between(before, after) / (window.length / 2);
    return line.lengths[segment] * line.lengths[segment] * curvature / 8;
}

void set_interior_angle(ReferencePoint& reference) {
    const double between = angle_between(reference.left_normal, reference.right_normal);
    const bool is_convex = reference.tangent.dot(reference.left_normal.cross(reference.right_normal)) > 0;
    reference.interior_angle = is_convex ? pi - between : pi + between;
}

ReferencePoint reference_at(const Line& line, u32 segment, const Vec3& point, double hole_radius) {
    Window window = window_round(line, segment, point);
    ReferencePoint reference;
    reference.line = line.row;
    reference.position = point;
    reference.hole_radius = hole_radius;
    reference.beyond = 0;
    constexpr double least = 0.1;
    const Vec3 chord = window.end - window.start;
    reference.tangent = chord.norm() > 0.5 * window.length ? chord.normalized() : line.directions[segment];
    Vec3 left = perpendicular(mean_normal(line, window, line.left), reference.tangent) / window.length;
    if (!(left.norm() > least)) {  // a fold: the segment's own triangle decides
        window = {{segment}, line.points[segment], line.end_of(segment), line.lengths[segment]};
        reference.tangent = line.directions[segment];
        left = perpendicular(line.left[segment], reference.tangent);
    }
    if (!(left.norm() > least))
        throw Error("the left normal of segment {} of line {} is along the line", segment, line.row).hint(damaged);
    reference.segment_length = window.length / static_cast<double>(window.segments.size());
    reference.left_normal = left.normalized();
    const Vec3 right = perpendicular(mean_normal(line, window, line.right), reference.tangent);
    reference.assumed = !(right.norm() > least * line.lengths[segment]);
    if (reference.assumed) {
        reference.right_normal = reference.tangent.cross(reference.left_normal);
        reference.interior_angle = pi / 2;
        reference.beyond = sagitta(line, window, segment, point, reference.left_normal);
    } else {
        reference.right_normal = right.normalized();
        set_interior_angle(reference);
    }
    return reference;
}

// Pairs of lines along one edge.

/// A segment of a line by the numbers of both.
struct Place {
    u32 line, segment;
    auto operator<=>(const Place&) const = default;
};

/// Consecutive boundary segments along one edge: with a normal on both sides, or with a match.
struct Run {
    std::vector<u32> sides;
    double length = 0;
};

/// Boundary segments are sides. Two sides match if they lie along one edge: of region-grow's two patches at an edge at
/// least one has the normal of the other beyond its boundary.
class Pairs {
public:
    explicit Pairs(const std::vector<Line>& lines) : lines_(lines) {
        partners_.resize(lines.size());
        left_out_.resize(lines.size());
        first_side_.resize(lines.size());
        bool any_right = false;
        for (u32 number = 0; number < lines.size(); ++number) {
            const Line& line = lines[number];
            partners_[number].resize(line.segments());
            left_out_[number].resize(line.segments());
            first_side_[number] = static_cast<u32>(sides_.size());
            std::vector<double> lengths(line.lengths.begin(), line.lengths.end());
            std::ranges::sort(lengths);
            sorted_lengths_.push_back(std::move(lengths));
            if (!line.is_boundary()) continue;
            for (u32 segment = 0; segment < line.segments(); ++segment) {
                sides_.push_back({number, segment});
                any_right = any_right || line.has_right(segment);
            }
        }
        if (!any_right) return;
        find_matches();
        run_of_.assign(sides_.size(), none);
        for (u32 number = 0; number < lines.size(); ++number)
            if (lines[number].is_boundary()) find_runs(number);
        pair_runs();
    }

    std::size_t count() const { return paired_lines_.size(); }
    const std::optional<Place>& partner(u32 line, u32 segment) const { return partners_[line][segment]; }
    bool is_left_out(u32 line, u32 segment) const { return left_out_[line][segment]; }

    /// The largest distance between the middles of segments of two lines that match: twice the median segment length.
    double reach_of(u32 one, u32 other) const {
        const auto key = std::minmax(one, other);
        const auto found = reaches_.find(key);
        if (found != reaches_.end()) return found->second;
        std::vector<double> lengths;
        std::ranges::merge(sorted_lengths_[one], sorted_lengths_[other], std::back_inserter(lengths));
        return reaches_[key] = 2 * lengths[lengths.size() / 2];
    }

private:
    static constexpr u32 none = ~u32(0);

    const Line& line_of(u32 side) const { return lines_[sides_[side].line]; }
    double length_of(u32 side) const { return line_of(side).lengths[sides_[side].segment]; }
    bool has_right(u32 side) const { return line_of(side).has_right(sides_[side].segment); }

    bool is_far_along(u32 a, u32 b, double distance) const {
        const Line& line = line_of(a);
        double along = std::abs(line.middle_arc(sides_[a].segment) - line.middle_arc(sides_[b].segment));
        if (line.closed) along = std::min(along, line.arcs.back() - along);
        return along > distance;
    }

    bool may_match(u32 a, u32 b, double squared_distance) const {
        if (!has_right(a) && !has_right(b)) return false;
        const double d = reach_of(sides_[a].line, sides_[b].line);
        if (squared_distance > d * d) return false;
        if (sides_[a].line == sides_[b].line && !is_far_along(a, b, 4 * d)) return false;
        const Line &one = line_of(a), &other = line_of(b);
        const u32 i = sides_[a].segment, j = sides_[b].segment;
        const double cosine_30 = std::sqrt(0.75);
        return one.directions[i].dot(other.directions[j]) <= -sqrt_half &&
               (!has_right(b) || one.left[i].dot(other.right[j]) >= cosine_30) &&
               (!has_right(a) || one.right[i].dot(other.left[j]) >= cosine_30);
    }

    void find_matches() {
        double farthest = 0;
        for (const auto& lengths : sorted_lengths_) farthest = std::max(farthest, 2 * lengths[lengths.size() / 2]);
        Array<Vec3> middles(sides_.size());
        for (u32 side = 0; side < sides_.size(); ++side) middles[side] = line_of(side).middle(sides_[side].segment);
        const TriangleTree tree = tree_of_points(middles, 1);
        matches_.assign(sides_.size(), none);
        Array<u32> near;
        for (u32 side = 0; side < sides_.size(); ++side) {
            near.clear();
            BoundingBox box;
            box.low = middles[side].array() - farthest;
            box.high = middles[side].array() + farthest;
            tree.meeting(box, near);
            std::ranges::sort(near);
            double least = std::numeric_limits<double>::infinity();
            for (const u32 other : near) {
                const double squared = (middles[other] - middles[side]).squaredNorm();
                if (other == side || squared >= least || !may_match(side, other, squared)) continue;
                least = squared;
                matches_[side] = other;
            }
        }
    }

    /// Runs end at corners, and where the matching line changes.
    void find_runs(u32 number) {
        const Line& line = lines_[number];
        const auto side_of = [&](u32 segment) { return first_side_[number] + segment; };
        const auto is_member = [&](u32 side) { return has_right(side) || matches_[side] != none; };
        const auto line_matched = [&](u32 side) { return matches_[side] == none ? none : sides_[matches_[side]].line; };
        const auto ends_between = [&](u32 matched, u32 side) {
            const u32 next = line_matched(side);
            return matched != none && next != none && matched != next;
        };
        u32 first = 0;  // a closed line begins where a run does
        for (u32 i = 0; i < line.segments(); ++i) {
            const u32 before = side_of((i + line.segments() - 1) % line.segments());
            if (line.stops[i] || !is_member(before) || ends_between(line_matched(before), side_of(i))) {
                first = i;
                break;
            }
        }
        bool goes_on = false;
        u32 matched = none;
        for (u32 step = 0; step < line.segments(); ++step) {
            const u32 segment = (first + step) % line.segments(), side = side_of(segment);
            goes_on = goes_on && is_member(side) && !line.stops[segment] && !ends_between(matched, side);
            if (!is_member(side)) continue;
            if (!goes_on) {
                runs_.emplace_back();
                matched = none;
                goes_on = true;
            }
            if (line_matched(side) != none) matched = line_matched(side);
            runs_.back().sides.push_back(side);
            runs_.back().length += length_of(side);
            run_of_[side] = static_cast<u32>(runs_.size() - 1);
        }
    }

    void pair_runs() {
        std::map<std::pair<u32, u32>, std::pair<double, double>> matched;  // of runs: lengths of the first and second
        for (u32 side = 0; side < sides_.size(); ++side) {
            if (matches_[side] == none) continue;
            const u32 run = run_of_[side], other = run_of_[matches_[side]];
            if (other == none) continue;
            auto& [first, second] = matched[std::minmax(run, other)];
            (run <= other ? first : second) += length_of(side);
        }
        for (const auto& [runs, lengths] : matched) {
            const Run &kept = runs_[runs.first], &other = runs_[runs.second];
            const bool is_first_shorter = kept.length <= other.length;
            const double shorter = std::min(kept.length, other.length);
            if ((is_first_shorter ? lengths.first : lengths.second) < shorter / 2) continue;
            paired_lines_.insert({sides_[kept.sides[0]].line, sides_[other.sides[0]].line});
            for (const u32 side : kept.sides) {
                const u32 match = matches_[side];
                if (match == none || run_of_[match] != runs.second) continue;
                if (runs.first != runs.second || side < match)
                    partners_[sides_[side].line][sides_[side].segment] = sides_[match];
            }
            for (const u32 side : other.sides) {
                const u32 match = matches_[side];
                if (match == none || run_of_[match] != runs.first) continue;
                if (runs.first != runs.second || match < side)
                    left_out_[sides_[side].line][sides_[side].segment] = true;
            }
        }
    }

    const std::vector<Line>& lines_;
    std::vector<Place> sides_;  ///< of boundary segments, line after line
    std::vector<u32> first_side_;  ///< by line
    std::vector<std::vector<double>> sorted_lengths_;  ///< by line
    std::vector<Run> runs_;
    std::vector<u32> run_of_, matches_;  ///< by side
    mutable std::map<std::pair<u32, u32>, double> reaches_;
    std::set<std::pair<u32, u32>> paired_lines_;
    std::vector<std::vector<std::optional<Place>>> partners_;  ///< by line and segment
    std::vector<std::vector<bool>> left_out_;
};

/// Moves a point of a paired segment to the intersection of the planes of both faces.
ReferencePoint between_faces(const std::vector<Line>& lines, const Pairs& pairs, const Place& a, const Place& b,
                             ReferencePoint reference) {
    const Line &one = lines[a.line], &other = lines[b.line];
    const Vec3 middle_a = one.middle(a.segment), middle_b = other.middle(b.segment);
    const Vec3 n1 = mean_normal(one, window_round(one, a.segment, middle_a), one.left).normalized(),
               n2 = mean_normal(other, window_round(other, b.segment, middle_b), other.left).normalized();
    const Vec3 between = (middle_a + middle_b) / 2 + (reference.position - middle_a);
    reference.position = between;
    const Vec3 across = n1.cross(n2);
    const double sine_10 = 0.17364817766693033;
    if (!(across.norm() >= sine_10)) return reference;
    Vec3 tangent = across.normalized();
    if (tangent.dot(reference.tangent) < 0) tangent = -tangent;
    reference.tangent = tangent;
    reference.left_normal = n1;
    reference.right_normal = n2;
    reference.assumed = false;
    reference.beyond = 0;
    set_interior_angle(reference);
    // The point of both planes nearest to `between`: between + x n1 + y n2.
    const double cosine = n1.dot(n2), c1 = n1.dot(middle_a - between), c2 = n2.dot(middle_b - between);
    const double determinant = 1 - cosine * cosine;
    const Vec3 shift = ((c1 - cosine * c2) * n1 + (c2 - cosine * c1) * n2) / determinant;
    if (shift.norm() <= pairs.reach_of(a.line, b.line)) reference.position += shift;
    return reference;
}

// Points along lines.

/// Consecutive segments of a line that are not left out.
struct Part {
    u32 first, count;
    bool closed;
};

std::vector<Part> parts_of(const Line& line, u32 number, const Pairs& pairs) {
    u32 first = 0;  // where a part begins, if there is more than one
    bool is_whole = true;
    for (u32 i = 0; i < line.segments(); ++i) {
        if (!pairs.is_left_out(number, i)) continue;
        is_whole = false;
        first = (i + 1) % line.segments();
    }
    if (is_whole) return {{0, line.segments(), line.closed}};
    std::vector<Part> parts;
    if (!line.closed) first = 0;
    bool goes_on = false;
    for (u32 step = 0; step < line.segments(); ++step) {
        const u32 segment = (first + step) % line.segments();
        const bool stays = !pairs.is_left_out(number, segment);
        if (stays && goes_on)
            ++parts.back().count;
        else if (stays)
            parts.push_back({segment, 1, false});
        goes_on = stays;
    }
    return parts;
}

std::size_t number_of_points(double length, double spacing, bool closed) {
    const double number = std::max(closed ? 3.0 : 1.0, std::floor(length / spacing + 0.5));
    return static_cast<std::size_t>(std::min(number, static_cast<double>(most_points + 1)));
}

double part_length(const Line& line, const Part& part) {
    double length = 0;
    for (u32 step = 0; step < part.count; ++step) length += line.lengths[(part.first + step) % line.segments()];
    return length;
}

/// The mean distance of the vertices from their centroid; NaN unless all are within 20 % of it.
double radius_of_hole(const Line& line) {
    if (line.type != FeatureType::hole) return std::numeric_limits<double>::quiet_NaN();
    Vec3 centroid = Vec3::Zero();
    for (const Vec3& point : line.points) centroid += point;
    centroid /= static_cast<double>(line.vertices());
    double mean = 0;
    for (const Vec3& point : line.points) mean += (point - centroid).norm();
    mean /= static_cast<double>(line.vertices());
    constexpr double most = 0.2;
    const bool is_round = std::ranges::all_of(
        line.points, [&](const Vec3& p) { return std::abs((p - centroid).norm() - mean) <= most * mean; });
    return is_round ? mean : std::numeric_limits<double>::quiet_NaN();
}

/// Distances of the line's vertices from quadratics through their neighbours.
void add_roughness(const Line& line, std::vector<double>& distances) {
    constexpr int beside_each = 4;
    constexpr u32 least = 16;
    if (line.vertices() < least) return;
    const u32 count = line.vertices();
    for (u32 i = 0; i < count; ++i) {
        if (!line.closed && (i < beside_each || i + beside_each >= count)) continue;
        Eigen::Matrix<double, 2 * beside_each + 1, 3> powers, points;
        bool passes_stop = false;
        double arc = 0;
        for (int step = -beside_each; step <= beside_each; ++step) {
            const u32 at = (i + count + static_cast<u32>(step + static_cast<int>(count))) % count;
            const double here = line.arcs[at];
            arc = here - line.arcs[i];
            if (line.closed && step < 0 && arc > 0) arc -= line.arcs.back();
            if (line.closed && step > 0 && arc < 0) arc += line.arcs.back();
            powers.row(step + beside_each) << 1, arc, arc * arc;
            points.row(step + beside_each) = (line.points[at] - line.points[i]).transpose();
            passes_stop = passes_stop || (std::abs(step) < beside_each && line.stops[at]);
        }
        if (passes_stop) continue;
        powers.col(1) /= arc;  // of order 1: better conditioned
        powers.col(2) /= arc * arc;
        const Eigen::Matrix3d fitted = (powers.transpose() * powers).ldlt().solve(powers.transpose() * points);
        const Vec3 residual = fitted.row(0).transpose(), along = fitted.row(1).transpose().normalized();
        distances.push_back(perpendicular(residual, along).norm());
    }
}

double quantile(std::vector<double> numbers, double share) {
    if (numbers.empty()) return 0;
    const auto at = static_cast<std::size_t>(std::ceil(share * static_cast<double>(numbers.size()))) - 1;
    std::ranges::nth_element(numbers, numbers.begin() + static_cast<std::ptrdiff_t>(at));
    return numbers[at];
}

bool is_chosen(FeatureType type, const LineChoice& choice) {
    if (type == FeatureType::crease) return choice.creases;
    return type == FeatureType::hole ? choice.holes : choice.boundaries;
}

std::vector<Line> chosen_lines(const FeatureGraph& features, const LineChoice& choice) {
    if (features.left_normals.size() != features.vertices.size() ||
        features.right_normals.size() != features.vertices.size())
        throw Error("the features have {} left and {} right normals for {} vertices of lines",
                    features.left_normals.size(), features.right_normals.size(), features.vertices.size())
            .hint(damaged);
    std::vector<Line> lines;
    std::array<std::size_t, 3> counts{};
    for (u32 row = 0; row < features.polylines.size(); ++row) {
        const FeatureType type = features.polylines[row].type;
        ++counts[static_cast<std::size_t>(type)];
        if (is_chosen(type, choice)) lines.push_back(read_line(features, row));
    }
    if (lines.empty())
        throw Error("there is no line to probe: the features have {} outer boundaries, {} holes and {} creases",
                    counts[0], counts[1], counts[2])
            .hint(features.polylines.empty()
                      ? "a closed mesh without sharp edges has no features; lower sharp-angle where they are found"
                      : "features: all takes every line");
    find_stops(features, lines);
    return lines;
}

}  // namespace

ReferencePoints find_reference_points(const FeatureGraph& features, const LineChoice& choice, double spacing,
                                      const Context& context) {
    const std::vector<Line> lines = chosen_lines(features, choice);
    context.check_cancelled();
    const Pairs pairs(lines);
    ReferencePoints result;
    result.paired_lines = pairs.count();
    std::vector<double> distances;
    for (u32 number = 0; number < lines.size(); ++number) {
        context.check_cancelled();
        const Line& line = lines[number];
        const std::vector<Part> parts = parts_of(line, number, pairs);
        if (!parts.empty()) add_roughness(line, distances);
        const double hole_radius = radius_of_hole(line);
        for (const Part& part : parts) {
            const double length = part_length(line, part);
            const std::size_t count = number_of_points(length, spacing, part.closed);
            if (result.points.size() + count > most_points)
                throw Error("a spacing of {:.6g} u gives more than {} touches", spacing, most_points)
                    .hint("use a larger spacing");
            const auto begin = static_cast<u32>(result.points.size());
            u32 step = 0;
            double passed = 0;  // the length of the part's segments before this one
            for (std::size_t i = 0; i < count; ++i) {
                const double arc = length * (static_cast<double>(i) + 0.5) / static_cast<double>(count);
                const auto segment_at = [&] { return (part.first + step) % line.segments(); };
                while (step + 1 < part.count && passed + line.lengths[segment_at()] < arc)
                    passed += line.lengths[segment_at()], ++step;
                const u32 segment = segment_at();
                const Vec3 point =
                    line.points[segment] + std::min(arc - passed, line.lengths[segment]) * line.directions[segment];
                ReferencePoint reference = reference_at(line, segment, point, hole_radius);
                if (const auto& partner = pairs.partner(number, segment))
                    reference = between_faces(lines, pairs, {number, segment}, *partner, reference);
                result.points.push_back(reference);
            }
            result.chains.push_back({part.closed, begin, static_cast<u32>(result.points.size())});
        }
    }
    result.edge_roughness = quantile(std::move(distances), 0.95);
    return result;
}

}  // namespace scanmill::probing
