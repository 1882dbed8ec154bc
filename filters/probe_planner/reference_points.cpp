// SPDX-License-Identifier: GPL-3.0-or-later
#include "probe_planner/reference_points.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <optional>

#include "probe_planner/edge_fit.hpp"
#include "probe_planner/pairs.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/base/statistics.hpp"
#include "scanmill/geometry/spatial/angle.hpp"

namespace scanmill::probing {

namespace {

constexpr double pi = std::numbers::pi;
constexpr std::size_t most_points = 1'000'000;

/// Returns how far a segment of a line that turns right lies beyond the line's curve; 0 if it does not turn right.
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

/// Moves a point of a paired segment to the intersection of the planes of both faces.
ReferencePoint between_faces(const std::vector<Line>& lines, const Pairs& pairs, const SegmentIndex& a,
                             const SegmentIndex& b, ReferencePoint reference) {
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
    const Vec3 shift = nearest_on_both(n1, n1.dot(middle_a - between), n2, n2.dot(middle_b - between));
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
    u32 first = 0;  // the segment with which a part begins, if there is more than one part
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

/// Replaces the faces and the edge of a point if the mesh shows other ones there.
void fit_to_mesh(std::vector<ReferencePoint>& points, const TriangleTree& mesh, double error, double radius,
                 const Context& context) {
    constexpr double segments_near = 2, segments_apart = 1.5;
    constexpr std::size_t chunk = 64;
    for_each_chunk(context.threads(), points.size(), chunk, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        for (std::size_t i = begin; i < end; ++i) {
            ReferencePoint& point = points[i];
            // A single segment may be much shorter than the edges round it.
            const double size =
                std::max(point.segment_length, mean_edge_near(mesh, point.position, point.segment_length));
            const Vec3& right = point.assumed ? point.left_normal : point.right_normal;
            // Beyond the reach of the ball, the mesh has other edges.
            const double reach = std::min(size, radius);
            const auto faces = edge_faces(mesh, {point.position, point.tangent, point.left_normal, right},
                                          segments_near * reach + error, segments_apart * reach + error);
            if (!faces) continue;
            if (point.assumed) {
                // The line runs along the edge, with its own face on the left.
                const double cosine_30 = std::sqrt(0.75);
                if (faces->left_normal.dot(point.left_normal) < cosine_30 ||
                    faces->left_normal.dot(faces->right_normal) > cosine_30 || faces->tangent.dot(point.tangent) < 0.5)
                    continue;
                point.assumed = false;
                point.beyond = 0;
            }
            point.position = faces->position;
            point.tangent = faces->tangent;
            point.left_normal = faces->left_normal;
            point.right_normal = faces->right_normal;
            point.segment_length = size;
            set_interior_angle(point);
        }
    });
}

bool is_same_edge(const ReferencePoint& a, const ReferencePoint& b, double error) {
    const double cosine_30 = std::sqrt(0.75);
    const auto agree = [&](const Vec3& left, const Vec3& right) {
        return a.left_normal.dot(left) >= cosine_30 && a.right_normal.dot(right) >= cosine_30;
    };
    return perpendicular(b.position - a.position, a.tangent).norm() <= error + 1.5 * a.segment_length &&
           (agree(b.left_normal, b.right_normal) || agree(b.right_normal, b.left_normal));
}

/// Leaves out points that are on the same edge as a point of a longer chain and nearer to it than three quarters of a
/// spacing. `lengths`: lengths of the chains.
///
/// Consider points at random, each kept if no kept point is nearer than x spacings. In the end there are 0.7476 / x
/// points per spacing (Rényi 1958): 1.0 for x = 3/4, 1.5 for x = 1/2. Gaps are at most 2 x spacings long.
void leave_out_repeated(ReferencePoints& result, std::span<const double> lengths, double spacing, double error,
                        const Context& context) {
    if (result.chains.size() < 2) return;
    const double least = 0.75 * spacing;
    Array<Vec3> positions;
    for (const ReferencePoint& point : result.points) positions.push_back(point.position);
    const TriangleTree tree = tree_of_points(positions, 1);
    std::vector<u32> order(result.chains.size()), chain_of(result.points.size());
    std::iota(order.begin(), order.end(), u32(0));
    std::ranges::stable_sort(order, std::greater(), [&](u32 chain) { return lengths[chain]; });
    std::vector<bool> is_left_out(result.points.size());
    for (u32 number = 0; number < result.chains.size(); ++number)
        for (u32 i = result.chains[number].begin; i < result.chains[number].end; ++i) chain_of[i] = number;
    Array<u32> near;
    for (const u32 number : order) {
        context.check_cancelled();
        for (u32 i = result.chains[number].begin; i < result.chains[number].end; ++i) {
            const ReferencePoint& point = result.points[i];
            if (is_left_out[i] || point.assumed) continue;
            near.clear();
            BoundingBox box;
            box.low = point.position.array() - least;
            box.high = point.position.array() + least;
            tree.meeting(box, near);
            for (const u32 other : near)
                if (chain_of[other] != number && !result.points[other].assumed &&
                    (result.points[other].position - point.position).norm() < least &&
                    is_same_edge(point, result.points[other], error))
                    is_left_out[other] = true;
        }
    }
    std::vector<ReferencePoint> points;
    std::vector<Chain> chains;
    for (Chain chain : result.chains) {
        const auto begin = static_cast<u32>(points.size());
        for (u32 i = chain.begin; i < chain.end; ++i)
            if (!is_left_out[i]) points.push_back(result.points[i]);
        const auto end = static_cast<u32>(points.size());
        if (end > begin) chains.push_back({chain.closed, begin, end});
    }
    result.points = std::move(points);
    result.chains = std::move(chains);
}

/// Appends the distances of the line's vertices from quadratics that fit the vertices around them.
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

}  // namespace

ReferencePoints find_reference_points(const FeatureGraph& features, const LineChoice& choice, double spacing,
                                      const TriangleTree& mesh, double error, double radius, const Context& context) {
    const ChosenLines chosen = chosen_lines(features, choice, error, context);
    const std::vector<Line>& lines = chosen.lines;
    context.check_cancelled();
    const Pairs pairs(lines, context);
    ReferencePoints result;
    result.left_out_creases = chosen.left_out;
    result.paired_lines = pairs.count();
    std::vector<double> distances, lengths;
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
            lengths.push_back(length);
            result.chains.push_back({part.closed, begin, static_cast<u32>(result.points.size())});
        }
    }
    fit_to_mesh(result.points, mesh, error, radius, context);
    leave_out_repeated(result, lengths, spacing, error, context);
    if (!distances.empty()) result.edge_roughness = quantile(distances, 0.95);
    return result;
}

}  // namespace scanmill::probing
