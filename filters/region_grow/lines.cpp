// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/lines.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "region_grow/search_radii.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/data/point_tree.hpp"
#include "scanmill/geometry/growing/distinct_points.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill::growing {

namespace {

// All lengths in spacings; see the specification of prepare_lines().
constexpr double longest_part = 1.5;
constexpr double crossing_distance = 0.1;
constexpr double support_distance = 3;
constexpr double near_distance = 0.5;
constexpr double straddling_distance = 1;
/// Beyond two spacings, the normals of a hole's wall with a radius of 5 spacings differ by more than 23 degrees.
constexpr double side_distance = 2;
constexpr double straddling_cosine = 0.8660254037844387;  // 30 degrees

struct LowerPosition {
    bool operator()(const Vec3& a, const Vec3& b) const { return is_lower(a, b); }
};
template <class T>
using PositionMap = std::map<Vec3, T, LowerPosition>;

struct Segment {
    Vec3 a, b;
    NamedSegment name;
    double uncertainty = 0, spacing = 0;

    Vec3 middle() const { return (a + b) / 2; }
    double length() const { return (b - a).norm(); }
};

Vec3 nearest_on(const Segment& segment, const Vec3& point) {
    const Vec3 along = segment.b - segment.a;
    const double share = (point - segment.a).dot(along) / along.squaredNorm();
    return segment.a + std::clamp(share, 0.0, 1.0) * along;
}

double distance_to(const Segment& segment, const Vec3& point) { return (nearest_on(segment, point) - point).norm(); }

/// The distance of two segments. Source: Lumelsky 1985; in the degenerate case the ends decide.
double distance_between(const Segment& one, const Segment& other) {
    double least = std::min(
        {distance_to(one, other.a), distance_to(one, other.b), distance_to(other, one.a), distance_to(other, one.b)});
    const Vec3 u = one.b - one.a, v = other.b - other.a, w = other.a - one.a;
    const Vec3 across = u.cross(v);
    const double squared = across.squaredNorm();
    if (!(squared > 0)) return least;
    const double s = w.cross(v).dot(across) / squared, t = w.cross(u).dot(across) / squared;
    if (s >= 0 && s <= 1 && t >= 0 && t <= 1) least = std::min(least, std::abs(w.dot(across)) / std::sqrt(squared));
    return least;
}

bool cross(const Segment& one, const Segment& other) {
    const double limit = crossing_distance * std::min(one.spacing, other.spacing);
    const auto free_ends_touch = [&](const Vec3& of_one, const Vec3& of_other) {
        return std::min(distance_to(other, of_one), distance_to(one, of_other)) < limit;
    };
    if (one.a == other.a) return free_ends_touch(one.b, other.b);
    if (one.a == other.b) return free_ends_touch(one.b, other.a);
    if (one.b == other.a) return free_ends_touch(one.a, other.b);
    if (one.b == other.b) return free_ends_touch(one.a, other.a);
    return distance_between(one, other) < limit;
}

void require_valid_indices(const FeatureGraph& lines) {
    for (std::size_t number = 0; number < lines.polylines.size(); ++number) {
        const auto [type, closed, begin, end] = lines.polylines[number];
        if (begin > end || end > lines.vertices.size())
            throw Error("line {} has the entries from {} to {}; the lines have {} entries", number, begin, end,
                        lines.vertices.size())
                .hint("make the lines anew, with the filter features or probe-compensate");
    }
    for (std::size_t entry = 0; entry < lines.vertices.size(); ++entry)
        if (lines.vertices[entry] >= lines.positions.size())
            throw Error("entry {} of the lines is point {}; the lines have {} points, counted from 0", entry,
                        lines.vertices[entry], lines.positions.size())
                .hint("make the lines anew, with the filter features or probe-compensate");
}

/// All segments of the lines in the scan's frame, without repeats and without segments of zero length.
std::vector<Segment> segments_of(const PointCloud& scan, const FeatureGraph& lines) {
    require_valid_indices(lines);
    require_same_frame(scan.frame, "the points are", lines.frame, "the lines");
    require_finite(lines.positions.span(), "points of lines");
    const Vec3 shift = lines.frame.origin - scan.frame.origin;
    std::vector<Segment> segments;
    for (u32 number = 0; number < lines.polylines.size(); ++number) {
        const FeaturePolyline& line = lines.polylines[number];
        const auto position = [&](u32 entry) -> Vec3 { return lines.positions[lines.vertices[entry]] + shift; };
        for (u32 entry = line.begin; entry < line.end; ++entry) {
            if (entry + 1 == line.end && !line.closed) break;
            Segment segment{position(entry), position(entry + 1 < line.end ? entry + 1 : line.begin), {}, 0, 0};
            segment.name = {number, entry - line.begin, segment.middle()};
            if (is_lower(segment.b, segment.a)) std::swap(segment.a, segment.b);
            if (segment.a != segment.b) segments.push_back(segment);
        }
    }
    // Repeats of a segment are removed; the first one keeps its place.
    PositionMap<PositionMap<bool>> seen;
    std::erase_if(segments, [&](const Segment& s) { return !seen[s.a].emplace(s.b, true).second; });
    return segments;
}

/// The scan without the points that the lines consist of: the spacing, and the nearest of its points.
class Scan {
public:
    Scan(std::span<const Vec3> positions, std::size_t rows, unsigned threads) : points_(distinct_points_of(positions)) {
        require_area(points_, rows);
        spacings_ = local_spacings(points_, Neighbourhoods(points_, threads), threads);
        tree_.emplace(points_.positions, threads);
        point_of_index_.resize(points_.size());
        const auto indices = tree_->index_of_row();
        for (u32 point = 0; point < indices.size(); ++point) point_of_index_[indices[point]] = point;
    }

    std::size_t size() const { return points_.size(); }
    /// Row of the nearest point among the positions.
    u32 nearest_row(const Vec3& at) { return points_.rows[nearest(at).point]; }
    double distance(const Vec3& at) { return nearest(at).distance; }
    double spacing(const Segment& segment) {
        return std::min({spacing_at(segment.a), spacing_at(segment.b), spacing_at(segment.middle())});
    }

private:
    struct Nearest {
        u32 point;
        double distance;
    };
    Nearest nearest(const Vec3& at) {
        const Neighbour found = tree_->nearest_to(at, 1, buffer_).front();
        return {point_of_index_[found.index], std::sqrt(found.squared)};
    }
    double spacing_at(const Vec3& at) { return spacings_[nearest(at).point]; }

    DistinctPoints points_;
    Array<double> spacings_;
    std::optional<PointTree> tree_;
    Array<u32> point_of_index_;
    NeighbourBuffer buffer_;
};

/// Removes the segments that yield to a crossing one.
std::vector<NamedSegment> remove_crossing(std::vector<Segment>& segments, const Context& context) {
    // A sweep along x finds the pairs whose boxes are near.
    double reach = 0;
    for (const Segment& s : segments) reach = std::max(reach, crossing_distance * s.spacing);
    std::vector<u32> order(segments.size());
    for (u32 i = 0; i < order.size(); ++i) order[i] = i;
    std::ranges::sort(order, [&](u32 i, u32 j) {  // a is the lower end
        return segments[i].a.x() != segments[j].a.x() ? segments[i].a.x() < segments[j].a.x() : i < j;
    });
    const auto is_better = [&](u32 i, u32 j) {
        const double one = segments[i].uncertainty, other = segments[j].uncertainty;
        return one != other ? one < other : i < j;
    };
    std::vector<std::pair<u32, u32>> pairs;  // the better one first
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (i % 1024 == 0) context.check_cancelled();
        const Segment& one = segments[order[i]];
        for (std::size_t j = i + 1; j < order.size() && segments[order[j]].a.x() <= one.b.x() + reach; ++j) {
            const Segment& other = segments[order[j]];
            const auto apart = [&](int axis) {
                const auto [low, high] = std::minmax(one.a[axis], one.b[axis]);
                const auto [other_low, other_high] = std::minmax(other.a[axis], other.b[axis]);
                return low > other_high + reach || other_low > high + reach;
            };
            if (apart(1) || apart(2) || !cross(one, other)) continue;
            pairs.emplace_back(order[i], order[j]);
            if (!is_better(order[i], order[j])) std::swap(pairs.back().first, pairs.back().second);
        }
    }
    // From the best segment on, so that a segment that has yielded removes no other one.
    std::ranges::sort(pairs, [&](const auto& p, const auto& q) {
        return p.first != q.first ? is_better(p.first, q.first) : p.second < q.second;
    });
    std::vector<bool> yields(segments.size(), false);
    for (const auto& [better, worse] : pairs)
        if (!yields[better]) yields[worse] = true;
    std::vector<NamedSegment> named;
    std::size_t kept = 0;
    for (std::size_t i = 0; i < segments.size(); ++i) {
        if (yields[i])
            named.push_back(segments[i].name);
        else
            segments[kept++] = segments[i];
    }
    segments.resize(kept);
    return named;
}

/// Divides long segments evenly, and removes the parts without support.
std::vector<NamedSegment> divide(std::vector<Segment>& segments, Scan& scan) {
    std::vector<NamedSegment> unsupported;
    std::vector<Segment> parts;
    const auto add = [&](Segment part) {
        part.spacing = scan.spacing(part);
        part.name.middle = part.middle();
        if (scan.distance(part.middle()) > support_distance * part.spacing)
            unsupported.push_back(part.name);
        else
            parts.push_back(part);
    };
    for (const Segment& segment : segments) {
        const double ratio = segment.length() / segment.spacing;
        if (ratio <= longest_part) {
            add(segment);
            continue;
        }
        if (!(ratio < static_cast<double>(scan.size()))) {
            unsupported.push_back(segment.name);
            continue;
        }
        const double count = std::ceil(ratio * (1 - 1e-9));
        Segment part = segment;
        for (double i = 1; i <= count; ++i) {
            part.b = i == count ? segment.b : Vec3(segment.a + (i / count) * (segment.b - segment.a));
            add(part);
            part.a = part.b;
        }
    }
    segments = std::move(parts);
    return unsupported;
}

/// Marks the scan points that are left out because of a segment.
class NearPoints {
public:
    NearPoints(const PointCloud& scan, unsigned threads) : tree_(scan.positions.span(), threads), marks_(scan.size()) {
        const Column* normals = scan.columns.find("normal");
        if (!normals || normals->components() != 3) return;
        normals_.resize(tree_.positions().size());
        std::ranges::fill(normals_, Vec3::Zero());
        for (u32 row = 0; row < scan.size(); ++row) {
            const Vec3 normal(normals->number(row, 0), normals->number(row, 1), normals->number(row, 2));
            Vec3& known = normals_[tree_.index_of_row()[row]];
            if (known.isZero() && normal.allFinite()) known = normal.normalized();
        }
    }

    void mark(const Segment& segment) {
        find(segment.middle(), segment.length() / 2 + side_distance * segment.spacing);
        const auto sides = normals_of_sides(segment);
        for (const u32 index : found_) {
            const Vec3& p = tree_.positions()[index];
            const double distance = distance_to(segment, p);
            const bool in_sphere =
                (p - segment.middle()).squaredNorm() <= segment.length() * segment.length() / 4 * (1 + 1e-9);
            if (distance < near_distance * segment.spacing || in_sphere ||
                (sides && distance < straddling_distance * segment.spacing && straddles(normals_[index], *sides)))
                marks_[index] = true;
        }
    }
    bool is_marked(u32 row) const { return marks_[tree_.index_of_row()[row]]; }

private:
    using Sides = std::pair<Vec3, Vec3>;

    void find(const Vec3& at, double radius) {
        std::size_t count = 32;
        std::span<const Neighbour> near = tree_.nearest_to(at, count, buffer_);
        while (near.size() == count && near.back().squared <= radius * radius)
            near = tree_.nearest_to(at, count *= 2, buffer_);
        found_.clear();
        for (const Neighbour& neighbour : near)
            if (neighbour.squared <= radius * radius) found_.push_back(neighbour.index);
    }

    std::optional<Sides> normals_of_sides(const Segment& segment) const {
        if (normals_.empty()) return std::nullopt;
        std::vector<Vec3> beside;
        for (const u32 index : found_)
            if (!normals_[index].isZero() &&
                distance_to(segment, tree_.positions()[index]) >= straddling_distance * segment.spacing)
                beside.push_back(normals_[index]);
        if (beside.empty()) return std::nullopt;
        std::optional<Sides> sides;
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < beside.size(); ++i)
            for (std::size_t j = 0; j <= i; ++j)
                if (const double cosine = beside[i].dot(beside[j]); cosine < least) {
                    least = cosine;
                    sides = {beside[i], beside[j]};
                }
        return sides;
    }

    static bool straddles(const Vec3& normal, const Sides& sides) {
        return !normal.isZero() && normal.dot(sides.first) < straddling_cosine &&
               normal.dot(sides.second) < straddling_cosine;
    }

    PointTree tree_;
    std::vector<bool> marks_;
    /// By index in the tree, zero if unknown; empty without the column.
    Array<Vec3> normals_;
    NeighbourBuffer buffer_;
    std::vector<u32> found_;
};

/// Sets the uncertainty of every segment from the scan's rows at its ends.
void set_uncertainties(const PointCloud& scan, const PositionMap<u32>& row_at, std::vector<Segment>& segments) {
    constexpr double unknown = std::numeric_limits<double>::infinity();
    const Column* column = scan.columns.find("uncertainty");
    const auto at = [&](const Vec3& position) {
        const u32 row = row_at.at(position);
        if (row == invalid_index || !column || column->components() != 1) return unknown;
        const double number = column->number(row);
        return std::isnan(number) ? unknown : number;
    };
    for (Segment& segment : segments) segment.uncertainty = std::max(at(segment.a), at(segment.b));
}

}  // namespace

PreparedLines prepare_lines(const PointCloud& scan, const FeatureGraph& lines, Context& context) {
    std::vector<Segment> segments = segments_of(scan, lines);
    // For each point of a line, the lowest row of the scan at its position.
    PositionMap<u32> row_at;
    for (const Segment& segment : segments)
        for (const Vec3& end : {segment.a, segment.b}) row_at.emplace(end, invalid_index);
    Array<u32> scanned;
    for (u32 row = 0; row < scan.size(); ++row) {
        const auto found = row_at.find(scan.positions[row]);
        if (found == row_at.end())
            scanned.push_back(row);
        else if (found->second == invalid_index)
            found->second = row;
    }
    context.check_cancelled();
    Scan near(gather(scan.positions, scanned), scan.size(), context.threads());
    for (Segment& segment : segments) segment.spacing = near.spacing(segment);
    set_uncertainties(scan, row_at, segments);

    PreparedLines prepared;
    prepared.crossing = remove_crossing(segments, context);
    prepared.unsupported = divide(segments, near);
    context.check_cancelled();

    NearPoints left_out(scan, context.threads());
    PositionMap<u32> vertices;  // points of lines, later with their row in the prepared cloud
    for (const Segment& segment : segments) {
        left_out.mark(segment);
        for (const Vec3& end : {segment.a, segment.b}) vertices.emplace(end, invalid_index);
    }
    Array<u32> sources;  // for each row of the prepared cloud, the row of its columns
    const auto add = [&](u32 row, u32 source) {
        prepared.rows.push_back(row);
        sources.push_back(source);
    };
    for (u32 row = 0; row < scan.size(); ++row) {
        const auto vertex = vertices.find(scan.positions[row]);
        if (vertex == vertices.end() && left_out.is_marked(row)) {
            ++prepared.near_lines;
            continue;
        }
        if (vertex != vertices.end() && vertex->second == invalid_index)
            vertex->second = static_cast<u32>(prepared.rows.size());
        add(row, row);
    }
    Array<Vec3> positions;
    for (u32 row : prepared.rows) positions.push_back(scan.positions[row]);
    u32 next = static_cast<u32>(scan.size());
    for (auto& [position, vertex] : vertices) {
        if (vertex != invalid_index) continue;
        vertex = static_cast<u32>(positions.size());
        positions.push_back(position);
        add(next++, scanned[near.nearest_row(position)]);
    }
    prepared.cloud.frame = scan.frame;
    prepared.cloud.positions = std::move(positions);
    prepared.cloud.columns = scan.columns.gather(sources);
    for (const Segment& segment : segments) {
        prepared.segments.push_back({vertices.at(segment.a), vertices.at(segment.b)});
        prepared.names.push_back(segment.name);
        prepared.spacings.push_back(segment.spacing);
    }
    return prepared;
}

}  // namespace scanmill::growing
