// SPDX-License-Identifier: GPL-3.0-or-later
// Measured lines as constraints: their segments are sharp edges of the mesh.

#include <gmock/gmock.h>

#include "filters/region_grow/cases.hpp"
#include "region_grow/lines.hpp"
#include "virtual_scan/virtual_scan.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::HasSubstr;

struct Polyline {
    std::vector<Vec3> points;
    bool closed = false;
};

FeatureGraph lines_of(const std::vector<Polyline>& polylines) {
    FeatureGraph graph;
    Array<Vec3> positions;
    Array<u32> vertices;
    for (const Polyline& line : polylines) {
        const u32 begin = static_cast<u32>(vertices.size());
        for (const Vec3& p : line.points) {
            vertices.push_back(static_cast<u32>(positions.size()));
            positions.push_back(p);
        }
        graph.polylines.push_back({FeatureType::crease, line.closed, begin, static_cast<u32>(vertices.size())});
    }
    Array<Vec3> normals(vertices.size(), Vec3::Zero());
    graph.positions = std::move(positions);
    graph.vertices = std::move(vertices);
    graph.left_normals = Buffer<Vec3>(Array<Vec3>(normals));
    graph.right_normals = std::move(normals);
    return graph;
}

/// Points from a to b, evenly, at most `step` apart.
Polyline straight(const Vec3& a, const Vec3& b, double step = 1) {
    const double count = std::ceil((b - a).norm() / step - 1e-9);
    Polyline line;
    for (double i = 0; i <= count; ++i) line.points.push_back(a + (i / count) * (b - a));
    return line;
}

/// The 12 edges of the box around 0.
std::vector<Polyline> box_edges(const Vec3& size, double step = 1) {
    std::vector<Polyline> edges;
    for (int axis = 0; axis < 3; ++axis)
        for (const double u : {-0.5, 0.5})
            for (const double v : {-0.5, 0.5}) {
                Vec3 from;
                from[axis] = -0.5;
                from[(axis + 1) % 3] = u;
                from[(axis + 2) % 3] = v;
                Vec3 to = from;
                to[axis] = 0.5;
                edges.push_back(straight(from.cwiseProduct(size), to.cwiseProduct(size), step));
            }
    return edges;
}

Polyline circle(const Vec3& centre, double radius, double step = 1) {
    const double count = std::ceil(2 * std::numbers::pi * radius / step);
    Polyline line;
    line.closed = true;
    for (double i = 0; i < count; ++i) {
        const double angle = 2 * std::numbers::pi * i / count;
        line.points.push_back(centre + radius * Vec3(std::cos(angle), std::sin(angle), 0));
    }
    return line;
}

using Shape = VirtualScanParams::Shape;

PointCloud scanned(Shape shape, std::vector<double> size, double noise = 0, double voxel = 1, bool normals = false) {
    VirtualScanParams params;
    params.shape = shape;
    for (const double s : size) params.size.push_back(Length(s));
    params.views = {24};
    params.resolution = Length(voxel / 4);
    params.noise = Length(noise);
    Context context;
    PointCloud cloud = virtual_scan(nullptr, params, context).points;
    if (!normals) cloud.columns = {};
    return thinned(cloud, voxel);
}

struct Grown {
    RegionGrowResult result;
    std::string warnings, doubts;
};

Grown grown_with(const PointCloud& cloud, const std::vector<Polyline>& lines, const RegionGrowParams& params = {}) {
    Context context;
    Grown grown{region_grow(cloud, lines_of(lines), params, context), {}, {}};
    for (const std::string& warning : context.warnings()) grown.warnings += warning + "\n";
    for (const Doubt& doubt : context.doubts()) grown.doubts += doubt.text + "\n";
    return grown;
}

using Position = std::array<double, 3>;
Position key(const Vec3& p) { return {p.x(), p.y(), p.z()}; }
using SegmentKey = std::pair<Position, Position>;
SegmentKey key(const Vec3& a, const Vec3& b) { return std::minmax(key(a), key(b)); }

std::set<SegmentKey> segments_of(const std::vector<Polyline>& lines) {
    std::set<SegmentKey> segments;
    for (const Polyline& line : lines)
        for (std::size_t i = line.closed ? 0 : 1; i < line.points.size(); ++i)
            segments.insert(key(line.points[(i + line.points.size() - 1) % line.points.size()], line.points[i]));
    return segments;
}

/// The segments of the polylines of the result, by type.
std::map<SegmentKey, FeatureType> segments_of(const FeatureGraph& graph) {
    std::map<SegmentKey, FeatureType> segments;
    for (const FeaturePolyline& line : graph.polylines)
        for (u32 i = line.begin; i < line.end; ++i) {
            if (i + 1 == line.end && !line.closed) break;
            const u32 next = i + 1 < line.end ? i + 1 : line.begin;
            segments[key(graph.positions[graph.vertices[i]], graph.positions[graph.vertices[next]])] = line.type;
        }
    return segments;
}

/// Every segment is an edge of the mesh with `triangles` triangles, a sharp edge, and part of a polyline of `features`
/// of this type. The positions are exact.
void expect_edges(const RegionGrowResult& result, const std::set<SegmentKey>& segments, std::size_t triangles = 2,
                  FeatureType type = FeatureType::crease) {
    std::map<SegmentKey, std::size_t> edges;
    const auto& p = result.mesh.positions;
    for (const Triangle& t : result.mesh.triangles)
        for (std::size_t i = 0; i < 3; ++i) ++edges[key(p[t[i]], p[t[(i + 1) % 3]])];
    std::map<SegmentKey, std::size_t> sharp;
    for (const auto& [a, b] : result.mesh.sharp_edges) ++sharp[key(p[a], p[b])];
    const auto polylines = segments_of(result.features);
    for (const SegmentKey& segment : segments) {
        const auto name = testing::PrintToString(segment);
        EXPECT_EQ(edges[segment], triangles) << name;
        EXPECT_EQ(sharp[segment], 1u) << name;
        ASSERT_TRUE(polylines.contains(segment)) << name;
        EXPECT_EQ(polylines.at(segment), type) << name;
    }
}

double metric(const Context& context, std::string_view name) {
    for (const Metric& m : context.metrics().values)
        if (m.name == name) return m.value;
    return -1;
}

const Vec3 box_size(20, 16, 12.5);
PointCloud scanned_box(double noise = 0, bool normals = false) {
    return scanned(Shape::box, {20, 16, 12.5}, noise, 1, normals);
}

TEST(RegionGrow_LineAcrossAGrid, IsAnEdgeOfItsPlane) {
    const Polyline line = straight(Vec3(0, 5.25, 0), Vec3(10, 5.25, 0));
    const Grown grown = grown_with(grid(11, 11), {line});
    expect_consistent(grown.result);
    expect_edges(grown.result, segments_of({line}));
    // The row y = 5 is nearer than half a spacing.
    EXPECT_EQ(grown.result.near_lines, 11u);
    EXPECT_EQ(grown.result.line_segments, 10u);
    EXPECT_EQ(grown.result.mesh.positions.size(), 121u);
    EXPECT_EQ(grown.result.mesh.triangles.size(), 200u);
    EXPECT_EQ(grown.result.creases, 1u);
    EXPECT_EQ(overlapping_pairs(grown.result.mesh), 0u);
    EXPECT_EQ(grown.warnings + grown.doubts, "");
    // Points of the line come last, by position.
    EXPECT_EQ(grown.result.rows.back(), 121u + 10);
}

TEST(RegionGrow_ObliqueLineAcrossAGrid, IsAnEdgeOfItsPlane) {
    const Polyline line = straight(Vec3(1.3, 0.9, 0), Vec3(8.1, 9.2, 0));
    const Grown grown = grown_with(grid(11, 11), {line});
    expect_consistent(grown.result);
    expect_edges(grown.result, segments_of({line}));
    EXPECT_EQ(grown.result.loops, 1u);
    EXPECT_NEAR(area(grown.result.mesh), 100, 1e-9);
    EXPECT_EQ(overlapping_pairs(grown.result.mesh), 0u);
}

TEST(RegionGrow_LineAtABorder, HasOneTriangle) {
    const Polyline line = straight(Vec3(-0.25, 0, 0), Vec3(-0.25, 10, 0));
    const Grown grown = grown_with(grid(11, 11), {line});
    expect_consistent(grown.result);
    expect_edges(grown.result, segments_of({line}), 1, FeatureType::outer_boundary);
    EXPECT_EQ(grown.result.near_lines, 11u);
    EXPECT_EQ(grown.result.creases, 0u);
}

TEST(RegionGrow_Box, WithLinesHasTheirCreases) {
    const std::vector<Polyline> edges = box_edges(box_size);
    for (const bool normals : {false, true})
        for (const double limit : {60.0, 90.0, 120.0}) {
            const Grown grown = grown_with(scanned_box(0, normals), edges, with_max_normal_angle(limit));
            expect_consistent(grown.result);
            EXPECT_TRUE(topology(grown.result.mesh).closed);
            expect_edges(grown.result, segments_of(edges));
            EXPECT_EQ(segments_of(grown.result.features).size(), segments_of(edges).size());
            EXPECT_EQ(grown.result.mesh.sharp_edges.size(), segments_of(edges).size());
            EXPECT_EQ(grown.result.creases, 12u);
            EXPECT_EQ(grown.result.corners, 8u);
            if (limit >= 90) {  // the growth finds the segments by itself
                EXPECT_EQ(grown.result.removed_triangles, 0u);
            }
            EXPECT_NEAR(signed_volume(grown.result.mesh), 20 * 16 * 12.5, 1e-6);
        }
}

TEST(RegionGrow_NoisyBox, HasTheLinesExactly) {
    const std::vector<Polyline> edges = box_edges(box_size);
    for (const bool normals : {false, true}) {
        const Grown grown = grown_with(scanned_box(0.05, normals), edges);
        expect_consistent(grown.result);
        expect_edges(grown.result, segments_of(edges));
        EXPECT_EQ(grown.doubts, "");
    }
}

TEST(RegionGrow_BoxWithoutTheLines, MissesTheEdges) {
    const RegionGrowResult result = grown(scanned_box());
    EXPECT_NE(result.creases, 12u);
    EXPECT_LT(signed_volume(result.mesh), 20 * 16 * 12.5 - 1);
}

TEST(RegionGrow_DenseLines, DoNotChangeTheDensityBesideThem) {
    const std::vector<Polyline> edges = box_edges(box_size, 0.3);
    for (const bool normals : {false, true}) {
        const Grown grown = grown_with(scanned_box(0, normals), edges);
        expect_consistent(grown.result);
        EXPECT_TRUE(topology(grown.result.mesh).closed);
        expect_edges(grown.result, segments_of(edges));
        EXPECT_EQ(grown.result.creases, 12u);
        EXPECT_EQ(grown.result.removed_triangles, 0u);
    }
}

TEST(RegionGrow_SparseLine, LeavesOutThePointsInTheSpheresOverItsSegments) {
    // The middles of the segments are at x = 0.7, 2.1, 3.5 … and the spheres have a radius of 0.7. The points y = 6 are
    // 0.55 from the line, so those within 0.433 of a middle are in a sphere: x = 1, 2, 5, 6, 8, 9. Away from the
    // border, half a spacing is 0.51.
    const Polyline line = straight(Vec3(0, 5.45, 0), Vec3(9.8, 5.45, 0), 1.4);
    const Grown grown = grown_with(grid(11, 11), {line});
    expect_consistent(grown.result);
    expect_edges(grown.result, segments_of({line}));
    std::set<double> kept;
    for (const Vec3& p : grown.result.mesh.positions)
        if (p.y() == 6) kept.insert(p.x());
    for (const double x : {1.0, 2.0, 5.0, 6.0, 8.0, 9.0}) EXPECT_FALSE(kept.contains(x)) << x;
    for (const double x : {3.0, 4.0, 7.0}) EXPECT_TRUE(kept.contains(x)) << x;
}

TEST(RegionGrow_LongSegments, AreDividedEvenly) {
    const Grown grown = grown_with(scanned_box(), box_edges(box_size, 100));
    expect_consistent(grown.result);
    EXPECT_EQ(grown.result.missing_lines, 0u);
    EXPECT_EQ(grown.result.creases, 12u);
    EXPECT_NEAR(signed_volume(grown.result.mesh), 20 * 16 * 12.5, 1e-6);
    // Parts along x have one of a few equal lengths.
    std::set<int> lengths;
    for (const auto& [a, b] : grown.result.mesh.sharp_edges) {
        const Vec3 along = grown.result.mesh.positions[b] - grown.result.mesh.positions[a];
        EXPECT_LE(along.norm(), 1.5 * 1.2);
        if (along.y() == 0 && along.z() == 0) lengths.insert(static_cast<int>(std::round(20 / along.norm())));
    }
    EXPECT_LE(lengths.size(), 4u);
}

/// The edges of the block with five holes: 12 straight ones and 10 circles.
std::vector<Polyline> block_edges() {
    std::vector<Polyline> edges = box_edges(Vec3(44, 48, 16));
    for (const double z : {-8.0, 8.0}) {
        edges.push_back(circle(Vec3(0, 0, z), 10));
        for (const double x : {-0.35, 0.35})
            for (const double y : {-0.35, 0.35}) edges.push_back(circle(Vec3(44 * x, 48 * y, z), 4));
    }
    return edges;
}

/// Number of segments of `features` that are on no line but begin or end at one.
std::size_t segments_beside(const RegionGrowResult& result, const std::set<SegmentKey>& lines) {
    std::set<Position> ends;
    for (const SegmentKey& line : lines) ends.insert({line.first, line.second});
    std::size_t count = 0;
    for (const auto& [segment, type] : segments_of(result.features))
        if (!lines.contains(segment) && (ends.contains(segment.first) || ends.contains(segment.second))) ++count;
    return count;
}

TEST(RegionGrow_BlockWithHoles, HasTheCircles) {
    const std::vector<Polyline> edges = block_edges();
    const std::set<SegmentKey> segments = segments_of(edges);
    for (const double noise : {0.0, 0.02, 0.05}) {
        const Grown grown = grown_with(scanned(Shape::holed_block, {44, 48, 16, 10, 4}, noise), edges);
        expect_consistent(grown.result);
        EXPECT_TRUE(topology(grown.result.mesh).closed);
        EXPECT_EQ(topology(grown.result.mesh).euler, -8);
        expect_edges(grown.result, segments);
        EXPECT_EQ(grown.result.missing_lines, 0u);
        if (noise == 0) {
            EXPECT_EQ(grown.result.creases, 22u);
        }
        EXPECT_LE(segments_beside(grown.result, segments), segments.size() / 100) << noise;
    }
}

TEST(RegionGrow_Bicone, HasItsEdgeOf90Degrees) {
    const Polyline edge = circle(Vec3(0, 0, 0), 20);
    const Grown grown = grown_with(scanned(Shape::bicone, {20, 20}), {edge});
    expect_consistent(grown.result);
    EXPECT_EQ(grown.result.loops, 0u);
    expect_edges(grown.result, segments_of({edge}));
}

TEST(RegionGrow_ThinBicone, HasItsEdge) {
    // Near the edge, the two sides are less than three voxels apart. Their angle is 53 and 39 degrees.
    const Polyline edge = circle(Vec3(0, 0, 0), 20);
    const std::set<SegmentKey> segments = segments_of({edge});
    for (const double height : {10.0, 7.0})
        for (const double noise : {0.0, 0.05})
            for (const bool normals : {false, true}) {
                const auto name = testing::PrintToString(std::tuple(height, noise, normals));
                const Grown grown = grown_with(scanned(Shape::bicone, {20, height}, noise, 1, normals), {edge});
                expect_consistent(grown.result);
                EXPECT_EQ(grown.result.loops, 0u) << name;
                EXPECT_EQ(grown.result.missing_lines, 0u) << name;
                EXPECT_EQ(grown.doubts, "") << name;
                if (noise == 0) expect_edges(grown.result, segments);
                // With noise, a few segments are divided. Their halves are the only ones that begin at the line.
                const std::size_t divided = grown.result.line_segments - segments.size();
                EXPECT_EQ(segments_beside(grown.result, segments), 2 * divided) << name;
                EXPECT_LE(divided, 3u) << name;
            }
}

TEST(RegionGrow_VeryNoisyBicone, HasNoCreasesBesideTheLine) {
    const Polyline edge = circle(Vec3(0, 0, 0), 20);
    const Grown grown = grown_with(scanned(Shape::bicone, {20, 10}, 0.2), {edge});
    expect_consistent(grown.result);
    EXPECT_EQ(grown.result.missing_lines, 0u);
    EXPECT_GT(grown.result.noise, 0.1);
    EXPECT_LE(grown.result.creases, 126u / 4);  // a quarter of the segments; most are elsewhere
}

TEST(RegionGrow_CrossingLines, KeepTheEarlierSegment) {
    const Polyline one = straight(Vec3(0, 5.25, 0), Vec3(10, 5.25, 0));
    const Polyline other = straight(Vec3(4.5, 0.25, 0), Vec3(4.5, 10.25, 0));  // crosses the middle of a segment
    const Grown grown = grown_with(grid(11, 11), {one, other});
    expect_consistent(grown.result);
    std::set<SegmentKey> segments = segments_of({one, other});
    segments.erase(key(Vec3(4.5, 4.25, 0), Vec3(4.5, 5.25, 0)));  // it ends on the other line
    segments.erase(key(Vec3(4.5, 5.25, 0), Vec3(4.5, 6.25, 0)));
    EXPECT_EQ(grown.result.crossing_lines, 2u);
    EXPECT_EQ(grown.result.line_segments, 18u);
    expect_edges(grown.result, segments);
    EXPECT_THAT(grown.warnings, HasSubstr("segment 4 of line 1 at (4.5, 4.75, 0) and segment 5 of line 1"));
}

TEST(RegionGrow_LinesAlmostTouching, CrossBelowATenthOfTheSpacing) {
    const Polyline one = straight(Vec3(0.5, 5, 0), Vec3(9.5, 5, 0), 1);
    for (const double gap : {0.08, 0.3}) {
        const Polyline other = straight(Vec3(5, 5 + gap, 0), Vec3(5, 9 + gap, 0), 1);
        const Grown grown = grown_with(grid(11, 11), {one, other});
        expect_consistent(grown.result);
        EXPECT_EQ(grown.result.crossing_lines, gap < 0.1 ? 1u : 0u);
        EXPECT_EQ(grown.result.line_segments + grown.result.missing_lines, gap < 0.1 ? 12u : 13u);
    }
}

TEST(RegionGrow_CrossingLines, KeepTheMoreCertainSegmentAsAWhole) {
    const Polyline one = straight(Vec3(0, 5.25, 0), Vec3(10, 5.25, 0));
    const Polyline other = straight(Vec3(4.5, 0.25, 0), Vec3(4.5, 9.75, 0), 1.2);
    // The cloud contains the points of both lines, as merge leaves them; those of the second one are more certain.
    PointCloud cloud = joined(grid(11, 11), joined(cloud_from(one.points), cloud_from(other.points)));
    Array<double> uncertainties(cloud.size(), 1);
    for (std::size_t i = 0; i < other.points.size(); ++i) uncertainties[cloud.size() - 1 - i] = 0.1;
    cloud.columns.add(Column("uncertainty", 1, Buffer<double>(std::move(uncertainties))));
    const Grown grown = grown_with(cloud, {one, other});
    expect_consistent(grown.result);
    EXPECT_EQ(grown.result.crossing_lines, 1u);
    EXPECT_THAT(grown.warnings, HasSubstr("segment 4 of line 0 at (4.5, 5.25, 0)"));
    std::set<SegmentKey> segments = segments_of({one, other});
    segments.erase(key(one.points[4], one.points[5]));
    expect_edges(grown.result, segments);
    // Points of lines that the cloud contains keep their rows and columns.
    for (u32 vertex = 0; vertex < grown.result.rows.size(); ++vertex) {
        const u32 row = grown.result.rows[vertex];
        ASSERT_LT(row, cloud.size());
        EXPECT_EQ(grown.result.mesh.positions[vertex], cloud.positions[row]);
        EXPECT_EQ(grown.result.mesh.vertex_columns.find("uncertainty")->number(vertex),
                  cloud.columns.find("uncertainty")->number(row));
    }
}

TEST(RegionGrow_LinesFarFromTheScan, AreUnsupported) {
    const Polyline line = straight(Vec3(0, 5.25, 0), Vec3(10, 5.25, 0));
    const Polyline far = straight(Vec3(0, 0, 50), Vec3(3, 0, 50));
    Polyline endless;
    endless.points = {Vec3(-1e8, 0, 100), Vec3(1e8, 0, 100)};
    const Grown grown = grown_with(grid(11, 11), {line, far, endless});
    expect_edges(grown.result, segments_of({line}));
    EXPECT_EQ(grown.result.unsupported_lines, 4u);
    EXPECT_EQ(grown.result.line_segments, 10u);
    EXPECT_EQ(grown.result.mesh.positions.size(), 121u);
    EXPECT_THAT(grown.warnings, HasSubstr("4 segments of lines have no scan point within 3 spacings"));
    EXPECT_THAT(grown.warnings, HasSubstr("segment 0 of line 1 at (0.5, 0, 50)"));
    EXPECT_EQ(grown.doubts, "");
}

TEST(RegionGrow_LineThatLeavesTheScan, IsUsedWhereTheScanIs) {
    const Polyline line = straight(Vec3(2, 5.25, 0), Vec3(30, 5.25, 0));
    const Grown grown = grown_with(grid(11, 11), {line});
    expect_consistent(grown.result);
    EXPECT_GE(grown.result.unsupported_lines, 28u - 13u);
    EXPECT_GE(grown.result.line_segments, 8u);
    EXPECT_EQ(grown.result.line_segments + grown.result.unsupported_lines + grown.result.missing_lines, 28u);
}

TEST(RegionGrow_LineThatLeavesTheSurface, IsCountedWhereItIsMissing) {
    const Polyline post = straight(Vec3(5, 5, 0), Vec3(5, 5, 3));
    const Grown grown = grown_with(grid(11, 11), {post});
    expect_consistent(grown.result);
    EXPECT_EQ(grown.result.line_segments + grown.result.missing_lines, 3u);
    EXPECT_GT(grown.result.missing_lines, 0u);
    EXPECT_THAT(grown.doubts, HasSubstr("missing, because an end is in no triangle"));
    EXPECT_THAT(grown.doubts, HasSubstr("of line 0 at (5, 5, "));
}

TEST(RegionGrow_NoLines, GiveTheSameMesh) {
    const PointCloud box = scanned_box(0.05);
    const RegionGrowResult without = grown(box);
    const RegionGrowResult with = grown_with(box, {}).result;
    EXPECT_TRUE(std::ranges::equal(with.mesh.positions, without.mesh.positions));
    EXPECT_TRUE(std::ranges::equal(with.mesh.triangles, without.mesh.triangles));
    EXPECT_TRUE(std::ranges::equal(with.mesh.sharp_edges, without.mesh.sharp_edges));
    EXPECT_TRUE(std::ranges::equal(with.rows, without.rows));
}

TEST(RegionGrow_Lines, DependNeitherOnTheirOrderNorOnThreads) {
    const PointCloud box = scanned_box(0.05);
    std::vector<Polyline> edges = box_edges(box_size);
    const RegionGrowResult first = grown_with(box, edges).result;
    std::ranges::rotate(edges, edges.begin() + 5);
    for (Polyline& edge : edges) std::ranges::reverse(edge.points);
    edges.push_back(edges.front());  // repeats count once
    edges.push_back({{Vec3(1, 2, 3), Vec3(1, 2, 3)}, false});  // without length
    ContextOptions options;
    options.threads = 3;
    Context context(options);
    const RegionGrowResult other = region_grow(box, lines_of(edges), {}, context);
    EXPECT_TRUE(std::ranges::equal(other.mesh.positions, first.mesh.positions));
    EXPECT_TRUE(std::ranges::equal(other.mesh.triangles, first.mesh.triangles));
    EXPECT_TRUE(std::ranges::equal(other.mesh.sharp_edges, first.mesh.sharp_edges));
    EXPECT_EQ(other.line_segments, first.line_segments);
    EXPECT_EQ(metric(context, "lines"), first.line_segments);
    EXPECT_EQ(metric(context, "near-lines"), first.near_lines);
    EXPECT_EQ(metric(context, "missing-lines"), 0);
    EXPECT_EQ(metric(context, "unsupported"), 0);
    EXPECT_EQ(metric(context, "crossing"), 0);
}

TEST(RegionGrow_LinesOfAnotherOrigin, AreMoved) {
    const Polyline line = straight(Vec3(0, 5.25, 0), Vec3(10, 5.25, 0));
    Polyline moved_line = line;
    for (Vec3& p : moved_line.points) p -= Vec3(64, 0, 0);
    FeatureGraph lines = lines_of({moved_line});
    lines.frame.origin = Vec3(64, 0, 0);
    Context context;
    expect_edges(region_grow(grid(11, 11), lines, {}, context), segments_of({line}));
}

TEST(RegionGrow_PointsAcrossAnEdge, AreLeftOutByTheirNormal) {
    // Points 0.7 spacings from the line are kept, unless their normal belongs to neither side.
    PointCloud cloud = grid(11, 11);
    const Polyline line = straight(Vec3(0, 5.3, 0), Vec3(10, 5.3, 0));
    Array<Vec3> normals(cloud.size(), Vec3(0, 0, 1));
    const auto near_line = [&](u32 row) { return cloud.positions[row].y() == 6 && cloud.positions[row].x() == 4; };
    for (u32 row = 0; row < cloud.size(); ++row)
        if (near_line(row)) normals[row] = Vec3(0, 0.6, 0.8);
    Array<double> numbers;
    for (const Vec3& n : normals) numbers.insert(numbers.end(), {n.x(), n.y(), n.z()});
    cloud.columns.add(Column("normal", 3, Buffer<double>(std::move(numbers))));
    const Grown grown = grown_with(cloud, {line});
    EXPECT_EQ(grown.result.near_lines, 12u);
    for (u32 row : grown.result.rows) EXPECT_TRUE(row >= cloud.size() || !near_line(row));
    expect_edges(grown.result, segments_of({line}));
}

std::string refusal_of_lines(const PointCloud& cloud, const FeatureGraph& lines, const RegionGrowParams& params = {}) {
    try {
        Context context;
        region_grow(cloud, lines, params, context);
    } catch (const Error& error) {
        EXPECT_FALSE(error.hint().empty());
        return error.what();
    }
    return "accepted";
}

TEST(RegionGrow_Lines, AreRefusedInAnotherUnit) {
    FeatureGraph lines = lines_of({straight(Vec3(0, 5.25, 0), Vec3(10, 5.25, 0))});
    lines.frame.unit = LengthUnit::inch;
    PointCloud cloud = grid(11, 11);
    cloud.frame.unit = LengthUnit::millimetre;
    EXPECT_THAT(refusal_of_lines(cloud, lines), HasSubstr("the lines in in"));
}

TEST(RegionGrow_Lines, AreRefusedWithAPointOutOfRange) {
    FeatureGraph lines = lines_of({straight(Vec3(0, 5.25, 0), Vec3(10, 5.25, 0))});
    Array<u32> vertices(lines.vertices.begin(), lines.vertices.end());
    vertices[3] = 11;  // of the points 0 to 10
    lines.vertices = std::move(vertices);
    EXPECT_THAT(refusal_of_lines(grid(11, 11), lines), HasSubstr("entry 3 of the lines is point 11"));
}

TEST(RegionGrow_Lines, AreRefusedWithAnEntryOutOfRange) {
    FeatureGraph lines = lines_of({straight(Vec3(0, 5.25, 0), Vec3(10, 5.25, 0))});
    lines.polylines[0].end = 12;
    EXPECT_THAT(refusal_of_lines(grid(11, 11), lines), HasSubstr("entries from 0 to 12; the lines have 11 entries"));
    lines.polylines[0] = {FeatureType::crease, false, 5, 4};
    EXPECT_THAT(refusal_of_lines(grid(11, 11), lines), HasSubstr("from 5 to 4"));
}

TEST(RegionGrow_Lines, AreRefusedWithANaN) {
    const FeatureGraph lines = lines_of({{{Vec3(0, 5.25, 0), Vec3(std::nan(""), 5.25, 0)}, false}});
    EXPECT_THAT(refusal_of_lines(grid(11, 11), lines), HasSubstr("points of lines"));
}

TEST(RegionGrow_Start, IsRefusedIfALineRemovesIt) {
    RegionGrowParams params;
    params.start = 5;  // (0, 5, 0)
    const FeatureGraph lines = lines_of({straight(Vec3(0, 5.25, 0), Vec3(10, 5.25, 0))});
    EXPECT_THAT(refusal_of_lines(grid(11, 11), lines, params), HasSubstr("start is row 5"));
    params.start = 28;  // (2, 6, 0), in a later row of the prepared cloud
    Context context;
    const RegionGrowResult result = region_grow(grid(11, 11), lines, params, context);
    std::set<u32> first;
    for (u32 vertex : result.mesh.triangles[0]) first.insert(result.rows[vertex]);
    EXPECT_THAT(first, testing::Contains(28u));
}

}  // namespace
}  // namespace scanmill
