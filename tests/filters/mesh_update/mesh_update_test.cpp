// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_update/mesh_update.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <numbers>
#include <set>
#include <tuple>

#include "filters/mesh_update/blocks.hpp"
#include "filters/mesh_update/bumps.hpp"
#include "scanmill/data/spacing.hpp"
#include "scanmill/data/topology.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"
#include "support/point_sets.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

using ::testing::IsEmpty;
using Clouds = std::vector<std::shared_ptr<const PointCloud>>;

MeshUpdateParams with_distance(double max_distance) {
    MeshUpdateParams params;
    params.max_distance = max_distance;
    return params;
}

double metric(const Context& context, std::string_view name) {
    const Metric* found = context.metrics().find(name);
    EXPECT_TRUE(found) << name;
    return found ? found->value : std::numeric_limits<double>::quiet_NaN();
}

using Position = std::tuple<double, double, double>;
Position key(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

std::set<Position> positions(const TriangleMesh& mesh) {
    std::set<Position> found;
    for (const Vec3& p : mesh.positions) found.insert(key(p));
    return found;
}

/// The triangles as their positions, each from its lowest corner on, sorted.
std::set<std::array<Position, 3>> triangles(const TriangleMesh& mesh) {
    std::set<std::array<Position, 3>> found;
    for (const Triangle& t : mesh.triangles) {
        std::array<Position, 3> corners{key(mesh.positions[t[0]]), key(mesh.positions[t[1]]),
                                        key(mesh.positions[t[2]])};
        std::ranges::rotate(corners, std::ranges::min_element(corners));
        found.insert(corners);
    }
    return found;
}

double updated_area(const TriangleMesh& mesh) {
    const std::span<const u8> updated = mesh.face_columns.find("updated")->values<u8>();
    double sum = 0;
    for (std::size_t i = 0; i < updated.size(); ++i)
        if (updated[i] == 1) sum += area_vector(mesh.positions.span(), mesh.triangles[i]).norm() / 2;
    return sum;
}

/// What holds of every update.
void expect_laws(const MeshUpdateResult& result, const TriangleMesh& model, const Clouds& clouds) {
    EXPECT_EQ(result.initial + result.resampled, result.kept + result.discarded);
    std::size_t points = 0;
    for (const auto& cloud : clouds) points += cloud->size();
    EXPECT_EQ(result.added, points);
    EXPECT_EQ(result.mesh.positions.size(), result.kept + result.added - result.unused);
    EXPECT_TRUE(topology(result.mesh).closed);
    EXPECT_GT(signed_volume(result.mesh), 0);
    // Every vertex of the model is discarded, or keeps its coordinates.
    const std::set<Position> found = positions(result.mesh);
    std::size_t missing = 0;
    for (const Vec3& p : model.positions) missing += !found.contains(key(p));
    EXPECT_LE(missing, result.discarded + result.unused);
    const std::span<const u32> source = result.mesh.vertex_columns.find("source")->values<u32>();
    EXPECT_TRUE(std::ranges::is_sorted(source));
    for (std::size_t i = 0; i < source.size(); ++i) {
        if (source[i] == 0) continue;
        const auto& cloud = clouds.at(source[i] - 1)->positions;
        EXPECT_TRUE(std::ranges::find(cloud, result.mesh.positions[i]) != cloud.end());
    }
}

MeshUpdateResult updated(const TriangleMesh& model, const Clouds& clouds, const MeshUpdateParams& params,
                         Context& context) {
    MeshUpdateResult result = mesh_update(model, clouds, params, context);
    expect_laws(result, model, clouds);
    EXPECT_THAT(context.doubts(), IsEmpty());
    return result;
}

const Rectangle middle{20, 10, 40, 30};

struct Step {
    double height;
    MeshUpdateParams::Overlap overlap;
};

struct SteppedBlock : testing::TestWithParam<Step> {};

TEST_P(SteppedBlock, HasTheVolumeOfTheUnionOrTheDifference) {
    const Clouds clouds{step_cloud(middle, 20, GetParam().height, 4, 1)};
    MeshUpdateParams params = with_distance(3);
    params.overlap = GetParam().overlap;
    Context context;
    const MeshUpdateResult result = updated(block(), clouds, params, context);
    EXPECT_EQ(result.groups, 2);
    EXPECT_EQ(result.replaced, 1);
    EXPECT_EQ(topology(result.mesh).euler, 2);
    EXPECT_GT(metric(context, "mean-angle"), 160 * std::numbers::pi / 180);
    EXPECT_LT(metric(context, "mean-angle@2"), 20 * std::numbers::pi / 180);
    EXPECT_NEAR(signed_volume(result.mesh), 48000 + 400 * GetParam().height, updated_area(result.mesh) / 2);
    EXPECT_LE(result.unused, 1);
    const double added = std::max(GetParam().height, 0.0), removed = std::max(-GetParam().height, 0.0);
    ASSERT_EQ(result.changes.size(), 1);
    const MeshChange& change = result.changes[0];
    EXPECT_NEAR(change.volume_added, 400 * added, change.area / 2);
    EXPECT_NEAR(change.volume_removed, 400 * removed, change.area / 2);
    EXPECT_NEAR(change.deviation, added + removed, 1e-9);
    // Triangles between the cloud and the model are as wide as the model's edges, at most 4.
    EXPECT_GT(change.area, 28 * 28 + 80 * (added + removed) - 4 * 28);
    EXPECT_LT(change.area, 36 * 36 + 80 * (added + removed));
    // The block's other faces keep their triangles, although other ways to join their vertices are as good.
    const std::span<const u8> is_new = result.mesh.face_columns.find("updated")->values<u8>();
    for (std::size_t i = 0; i < is_new.size(); ++i)
        for (const u32 vertex : result.mesh.triangles[i]) {
            EXPECT_TRUE(is_new[i] == 0 || result.mesh.positions[vertex].z() > 11.9);
        }
    // Outside of the cloud, the top is whole: the group of the block's corners is kept.
    const std::set<Position> found = positions(result.mesh);
    for (const Vec3& corner : block().positions) EXPECT_TRUE(found.contains(key(corner)));
}

INSTANTIATE_TEST_SUITE_P(
    PadsAndPockets, SteppedBlock,
    testing::Values(Step{6, MeshUpdateParams::Overlap::projected}, Step{-8, MeshUpdateParams::Overlap::projected},
                    Step{3, MeshUpdateParams::Overlap::projected}, Step{-3, MeshUpdateParams::Overlap::projected},
                    Step{6, MeshUpdateParams::Overlap::candidates}, Step{-8, MeshUpdateParams::Overlap::candidates}));

/// The triangles of the mesh that lie outside of the ball.
std::set<std::array<Position, 3>> triangles_beyond(const TriangleMesh& mesh, const Vec3& centre, double radius) {
    std::set<std::array<Position, 3>> found = triangles(mesh);
    std::erase_if(found, [&](const std::array<Position, 3>& corners) {
        return std::ranges::any_of(corners, [&](const Position& p) {
            return (Vec3(std::get<0>(p), std::get<1>(p), std::get<2>(p)) - centre).norm() < radius;
        });
    });
    return found;
}

TEST(RebuildLocal, StepsOnABlock_LikeTheWhole_AndTheRestKeepsItsTriangles) {
    for (const double height : {6.0, -8.0}) {
        const Clouds clouds{step_cloud(middle, 20, height, 4, 1)};
        MeshUpdateParams params = with_distance(3);
        params.rebuild = MeshUpdateParams::Rebuild::local;
        Context context;
        const MeshUpdateResult result = updated(block(), clouds, params, context);
        EXPECT_EQ(topology(result.mesh).euler, 2);
        EXPECT_NEAR(signed_volume(result.mesh), 48000 + 400 * height, updated_area(result.mesh) / 2);
        ASSERT_EQ(result.changes.size(), 1);
        EXPECT_NEAR(result.changes[0].volume_added - result.changes[0].volume_removed, 400 * height, 28 * 28 / 2.0);
    }
}

TEST(RebuildLocal, ABumpOnASphere_BeyondTheCollarAllBytesStay) {
    const TriangleMesh model = geodesic_sphere(10, 40);
    for (const bool is_added : {true, false}) {
        Bump bump;
        bump.is_added = is_added;
        const Clouds clouds{bump_cloud(bump, {})};
        MeshUpdateParams params = with_distance(1);
        params.rebuild = MeshUpdateParams::Rebuild::local;
        Context context;
        const MeshUpdateResult result = updated(model, clouds, params, context);
        EXPECT_EQ(topology(result.mesh).euler, 2);
        EXPECT_NEAR(signed_volume(result.mesh), signed_volume(model) + bump.volume() - bump.ball(10),
                    0.5 * updated_area(result.mesh) / 2);
        EXPECT_EQ(triangles_beyond(result.mesh, {0, 0, 10}, 9), triangles_beyond(model, {0, 0, 10}, 9));
        const std::span<const u8> updated_faces = result.mesh.face_columns.find("updated")->values<u8>();
        std::size_t fixed = 0;
        while (updated_faces[fixed] == 0) ++fixed;
        EXPECT_GT(fixed, model.triangles.size() / 2) << "fixed triangles come first";
    }
}

TEST(MeshUpdate, UnchangedRegionOfAFlatFace_StaysWithinASpacing) {
    const Clouds clouds{step_cloud(middle, 20, 0, 4, 1)};
    Context context;
    const MeshUpdateResult result = updated(block(), clouds, with_distance(3), context);
    EXPECT_EQ(topology(result.mesh).euler, 2);
    EXPECT_NEAR(signed_volume(result.mesh), 48000, updated_area(result.mesh) / 2);
}

TEST(MeshUpdate, UnchangedRegionOfASphere_StaysWithinASpacing) {
    const TriangleMesh model = geodesic_sphere(10, 16);
    Array<Vec3> points;
    for (const Vec3& p : geodesic_sphere(10, 37).positions)
        if (p.x() > 5) points.push_back(p);
    PointCloud cloud;
    cloud.positions = std::move(points);
    const Clouds clouds{std::make_shared<const PointCloud>(cloud)};
    Context context;
    const MeshUpdateResult result = updated(model, clouds, with_distance(3), context);
    EXPECT_EQ(topology(result.mesh).euler, 2);
    const TriangleTree tree(model.positions.span(), model.triangles.span(), 1);
    const double spacing = point_spacing(cloud.positions.span());
    for (const Vec3& p : result.mesh.positions) EXPECT_LT(tree.nearest(p).squared_distance, spacing * spacing);
}

/// The walls of a square channel along z through the block, with a ring on its top and one on its bottom.
std::shared_ptr<const PointCloud> channel_cloud(const Rectangle& hole, double top, double border) {
    Array<Vec3> points;
    for (double x = hole.x0 - border; x <= hole.x1 + border; ++x)
        for (double y = hole.y0 - border; y <= hole.y1 + border; ++y) {
            const bool is_inside = x >= hole.x0 && x <= hole.x1 && y >= hole.y0 && y <= hole.y1;
            const bool is_wall = is_inside && (x == hole.x0 || x == hole.x1 || y == hole.y0 || y == hole.y1);
            if (is_inside && !is_wall) continue;
            points.emplace_back(x, y, 0);
            points.emplace_back(x, y, top);
            for (double z = 1; is_wall && z < top; ++z) points.emplace_back(x, y, z);
        }
    PointCloud cloud;
    cloud.positions = std::move(points);
    return std::make_shared<const PointCloud>(std::move(cloud));
}

TEST(MeshUpdate, ThroughHole_BothDiscsAreReplaced) {
    const Clouds clouds{channel_cloud({26, 16, 34, 24}, 20, 4)};
    Context context;
    const MeshUpdateResult result = updated(block(), clouds, with_distance(3), context);
    EXPECT_EQ(result.groups, 3);
    EXPECT_EQ(result.replaced, 2);
    EXPECT_EQ(topology(result.mesh).euler, 0);
    EXPECT_NEAR(signed_volume(result.mesh), 48000 - 64 * 20, updated_area(result.mesh) / 2);
}

TEST(MeshUpdate, ABandAroundAHandle_KeepsTheRestOfTheRing) {
    const TriangleMesh model = torus(10, 4, 60, 30);
    Array<Vec3> band;
    for (const Vec3& p : torus(10, 4, 120, 60).positions)
        if (p.x() > 0 && std::abs(p.y()) < 3) band.push_back(p);
    PointCloud cloud;
    cloud.positions = std::move(band);
    Context context;
    const MeshUpdateResult result =
        updated(model, {std::make_shared<const PointCloud>(cloud)}, with_distance(3), context);
    EXPECT_EQ(result.groups, 2);
    EXPECT_EQ(result.replaced, 1);
    EXPECT_EQ(topology(result.mesh).euler, 0);
}

TEST(MeshUpdate, TwoCloudsAtOnce_LikeOneAfterTheOther) {
    const auto pad = step_cloud(middle, 20, 6, 4, 1), pocket = step_cloud({20, 10, 40, 30}, 0, 5, 4, 1);
    Context context, first_context, second_context;
    const MeshUpdateResult both = updated(block(), {pad, pocket}, with_distance(3), context);
    const MeshUpdateResult first = updated(block(), {pad}, with_distance(3), first_context);
    const MeshUpdateResult second = updated(first.mesh, {pocket}, with_distance(3), second_context);
    EXPECT_EQ(both.replaced, 2);
    ASSERT_EQ(both.changes.size(), 2);
    EXPECT_NEAR(both.changes[0].deviation + both.changes[1].deviation, 11, 1e-9);
    for (const MeshChange& change : both.changes) {
        EXPECT_NEAR(change.position.z(), change.cloud == 1 ? 26 : 5, 1e-9);
        EXPECT_NEAR(change.deviation, change.cloud == 1 ? 6 : 5, 1e-9);
    }
    ASSERT_EQ(both.angles.size(), 4);
    for (const MeshUpdateAngle& angle : both.angles) EXPECT_EQ(angle.is_replaced, angle.mean < 1) << angle.group;
    EXPECT_EQ(both.groups, 3);
    EXPECT_EQ(positions(both.mesh), positions(second.mesh));
    EXPECT_EQ(triangles(both.mesh), triangles(second.mesh));
    EXPECT_NEAR(signed_volume(both.mesh), 48000 + 400 * 6 - 400 * 5, updated_area(both.mesh) / 2);
}

TEST(MeshUpdate, OverlappingClouds_CountAsOne) {
    const auto all = step_cloud(middle, 20, 6, 4, 1);
    Array<Vec3> left, right;
    for (const Vec3& p : all->positions) {
        if (p.x() <= 33) left.push_back(p);
        if (p.x() >= 29.5) right.push_back(p + Vec3(0, 0, 0));
    }
    PointCloud one, other;
    one.positions = std::move(left);
    other.positions = std::move(right);
    const Clouds clouds{std::make_shared<const PointCloud>(one), std::make_shared<const PointCloud>(other)};
    Context context;
    const MeshUpdateResult result = mesh_update(block(), clouds, with_distance(3), context);
    expect_laws(result, block(), clouds);
    EXPECT_EQ(result.replaced, 1);
    EXPECT_EQ(topology(result.mesh).euler, 2);
    EXPECT_NEAR(signed_volume(result.mesh), 48000 + 400 * 6, updated_area(result.mesh) / 2);
}

TEST(MeshUpdate, ACloudWithAHoleOverUnchangedParts_KeepsTheModelThere) {
    const auto all = step_cloud({10, 10, 50, 30}, 20, 0, 4, 1);
    Array<Vec3> ring;
    for (const Vec3& p : all->positions)
        if (std::max(std::abs(p.x() - 30) / 2, std::abs(p.y() - 20)) > 5.5) ring.push_back(p);
    PointCloud cloud;
    cloud.positions = std::move(ring);
    Context context;
    const MeshUpdateResult result =
        updated(block(), {std::make_shared<const PointCloud>(cloud)}, with_distance(3), context);
    EXPECT_EQ(result.groups, 3);
    EXPECT_EQ(result.replaced, 1);
    EXPECT_NEAR(signed_volume(result.mesh), 48000, updated_area(result.mesh) / 2);
}

TEST(MeshUpdate, ACloudWithAHoleOverTheChange_IsClosed) {
    const auto all = step_cloud(middle, 20, 6, 4, 1);
    Array<Vec3> holed;
    for (const Vec3& p : all->positions)
        if (p.z() < 26 || std::max(std::abs(p.x() - 30), std::abs(p.y() - 20)) > 4.5) holed.push_back(p);
    PointCloud cloud;
    cloud.positions = std::move(holed);
    const Clouds clouds{std::make_shared<const PointCloud>(cloud)};
    Context context;
    const MeshUpdateResult result = mesh_update(block(), clouds, with_distance(3), context);
    expect_laws(result, block(), clouds);
    EXPECT_EQ(result.replaced, 1);
    EXPECT_NEAR(signed_volume(result.mesh), 48000 + 400 * 6, updated_area(result.mesh) / 2);
}

TEST(UpdateDoubts, APadWithoutItsTop_IsClosedFarFromTheCloud) {
    const auto pad = step_cloud(middle, 20, 6, 4, 1);
    Array<Vec3> open;
    for (const Vec3& p : pad->positions)
        if (p.z() < 26) open.push_back(p);
    PointCloud cloud;
    cloud.positions = std::move(open);
    Context context;
    mesh_update(block(), {std::vector{std::make_shared<const PointCloud>(cloud)}}, with_distance(3), context);
    ASSERT_FALSE(context.doubts().empty());
    EXPECT_THAT(context.doubts()[0].text, testing::HasSubstr("farther than 1 u"));
}

TEST(UpdateDoubts, PointsInSpaceAreNotOnTheSurface) {
    PointCloud cloud = *step_cloud(middle, 20, 6, 4, 1);
    Array<Vec3> more(cloud.positions.begin(), cloud.positions.end());
    for (const Vec3& p : random_cube(200, 5, 10).positions) more.push_back(p + Vec3(25, 15, 30));
    cloud.positions = std::move(more);
    Context context;
    mesh_update(block(), {std::vector{std::make_shared<const PointCloud>(cloud)}}, with_distance(3), context);
    ASSERT_FALSE(context.doubts().empty());
    EXPECT_THAT(context.doubts()[0].text, testing::HasSubstr("of the clouds are not on the surface"));
}

TEST(UpdateDoubts, ANoisyCloudGivesTheRightTopologyOrADoubt) {
    for (const std::uint64_t seed : {1, 2, 3, 4, 5, 6}) {
        Bump bump;
        bump.is_added = seed % 2 == 0;
        Sampling sampling;
        sampling.noise = 0.3 * sampling.spacing;
        sampling.seed = seed;
        Context context;
        try {
            const MeshUpdateResult result = mesh_update(
                geodesic_sphere(10, 24), {std::vector{bump_cloud(bump, sampling)}}, with_distance(2), context);
            EXPECT_TRUE(topology(result.mesh).euler == 2 || !context.doubts().empty()) << seed;
        } catch (const Error& error) {
            EXPECT_NE(error.hint(), "") << seed;
        }
    }
}

TEST(MeshUpdate, AModelOfTwoComponents_KeepsTheOther) {
    TriangleMesh model = block();
    Array<Vec3> positions(model.positions.begin(), model.positions.end());
    Array<Triangle> triangles(model.triangles.begin(), model.triangles.end());
    for (const Vec3& p : block().positions) positions.push_back(p + Vec3(100, 0, 0));
    for (const Triangle& t : block().triangles) triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
    positions.emplace_back(200, 200, 200);  // in no triangle
    model.positions = std::move(positions);
    model.triangles = std::move(triangles);
    for (const auto rebuild : {MeshUpdateParams::Rebuild::whole, MeshUpdateParams::Rebuild::local}) {
        MeshUpdateParams params = with_distance(3);
        params.rebuild = rebuild;
        Context context;
        const MeshUpdateResult result =
            mesh_update(model, std::vector{step_cloud(middle, 20, 6, 4, 1)}, params, context);
        EXPECT_EQ(result.initial, 16);
        EXPECT_EQ(result.groups, 3);
        EXPECT_EQ(result.replaced, 1);
        EXPECT_EQ(topology(result.mesh).euler, 4);
        EXPECT_NEAR(signed_volume(result.mesh), 2 * 48000 + 2400, updated_area(result.mesh) / 2);
        EXPECT_THAT(context.doubts(), IsEmpty());
    }
}

TEST(MeshUpdate, NeitherOrderNorNumberingChangesTheDecision) {
    const TriangleMesh model = geodesic_sphere(10, 16);
    const auto cloud = bump_cloud({}, {});
    Context context;
    const MeshUpdateResult plain = updated(model, {cloud}, with_distance(3), context);
    TriangleMesh turned = model;
    const u32 last = static_cast<u32>(model.positions.size() - 1);
    Array<Vec3> reversed(model.positions.begin(), model.positions.end());
    std::ranges::reverse(reversed);
    Array<Triangle> renumbered;
    for (const Triangle& t : model.triangles) renumbered.push_back({last - t[1], last - t[2], last - t[0]});
    std::ranges::reverse(renumbered);
    turned.positions = std::move(reversed);
    turned.triangles = std::move(renumbered);
    const Clouds shuffled_clouds{std::make_shared<const PointCloud>(shuffled(*cloud, 7))};
    Context other_context;
    const MeshUpdateResult other = updated(turned, shuffled_clouds, with_distance(3), other_context);
    EXPECT_EQ(plain.discarded, other.discarded);
    EXPECT_EQ(positions(plain.mesh), positions(other.mesh));
    EXPECT_EQ(triangles(plain.mesh), triangles(other.mesh));
}

TEST(MeshUpdate, SameBytesForAnyNumberOfThreads) {
    const Clouds clouds{bump_cloud({}, {})};
    ContextOptions options;
    options.threads = 4;
    Context one, four(options);
    const MeshUpdateResult a = updated(geodesic_sphere(10, 16), clouds, with_distance(3), one);
    const MeshUpdateResult b = updated(geodesic_sphere(10, 16), clouds, with_distance(3), four);
    EXPECT_TRUE(std::ranges::equal(a.mesh.positions, b.mesh.positions));
    EXPECT_TRUE(std::ranges::equal(a.mesh.triangles, b.mesh.triangles));
    EXPECT_EQ(a.mesh.vertex_columns, b.mesh.vertex_columns);
    EXPECT_EQ(a.mesh.face_columns, b.mesh.face_columns);
}

TEST(MeshUpdate, OriginsMayDiffer) {
    PointCloud cloud = *bump_cloud({}, {});
    Context context, moved_context;
    const MeshUpdateResult plain =
        updated(geodesic_sphere(10, 16), {std::make_shared<const PointCloud>(cloud)}, with_distance(3), context);
    cloud.positions = translated(cloud.positions, Vec3(-1024, 0, 0));
    cloud.frame.origin = Vec3(1024, 0, 0);
    const Clouds moved{std::make_shared<const PointCloud>(cloud)};
    const MeshUpdateResult other = mesh_update(geodesic_sphere(10, 16), moved, with_distance(3), moved_context);
    EXPECT_EQ(plain.discarded, other.discarded);
    EXPECT_EQ(plain.mesh.positions.size(), other.mesh.positions.size());
}

TEST(MeshUpdate, ColumnsOfBothAreCarried) {
    TriangleMesh model = geodesic_sphere(10, 16);
    const std::size_t vertices = model.positions.size();
    Array<double> heights;
    for (const Vec3& p : model.positions) heights.push_back(p.z());
    model.vertex_columns.add(Column("height", 1, Buffer<double>(std::move(heights))));
    model.sharp_edges = Array<Edge>{make_edge(model.triangles[0][0], model.triangles[0][1])};
    PointCloud cloud = *bump_cloud({}, {});
    Array<double> own;
    for (const Vec3& p : cloud.positions) own.push_back(p.z());
    cloud.columns.add(Column("height", 1, Buffer<double>(std::move(own))));
    Context context;
    const MeshUpdateResult result =
        updated(model, {std::make_shared<const PointCloud>(cloud)}, with_distance(3), context);
    const std::span<const double> found = result.mesh.vertex_columns.find("height")->values<double>();
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_EQ(found[i], result.mesh.positions[i].z());
    EXPECT_LT(result.kept, vertices);
    const auto group = result.mesh.vertex_columns.find("group")->values<std::int32_t>();
    const auto source = result.mesh.vertex_columns.find("source")->values<u32>();
    for (std::size_t i = 0; i < group.size(); ++i) {
        if (source[i] == 1) {
            EXPECT_EQ(group[i], -1);
        } else {
            EXPECT_THAT(group[i], testing::AnyOf(-1, 1, 2));
        }
    }
    for (const Edge& edge : result.mesh.sharp_edges) EXPECT_TRUE(source[edge[0]] == 0 && source[edge[1]] == 0);
}

TEST(MeshUpdate, FeaturesAreTheLoopsOfTheClouds) {
    Context context;
    const MeshUpdateResult result =
        updated(block(), {step_cloud(middle, 20, 6, 4, 1), step_cloud(middle, 0, 5, 4, 1)}, with_distance(3), context);
    ASSERT_EQ(result.features.polylines.size(), 2);
    for (const FeaturePolyline& loop : result.features.polylines) {
        EXPECT_EQ(loop.type, FeatureType::outer_boundary);
        EXPECT_TRUE(loop.closed);
        double length = 0;
        for (u32 i = loop.begin; i < loop.end; ++i) {
            const u32 next = i + 1 < loop.end ? i + 1 : loop.begin;
            length += (result.features.positions[result.features.vertices[i]] -
                       result.features.positions[result.features.vertices[next]])
                          .norm();
        }
        EXPECT_NEAR(length, 4 * 28, 4);
    }
}

TEST(MeshUpdate, Cancelled) {
    ContextOptions options;
    options.is_cancelled = [] { return true; };
    Context context(options);
    const Clouds clouds{bump_cloud({}, {})};
    EXPECT_THROW(mesh_update(geodesic_sphere(10, 16), clouds, with_distance(3), context), Cancelled);
}

}  // namespace
}  // namespace scanmill::test
