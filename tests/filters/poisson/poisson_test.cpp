// SPDX-License-Identifier: GPL-3.0-or-later
#ifdef SCANMILL_PCL
#include "poisson/poisson.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "scanmill/base/random.hpp"
#include "scanmill/data/topology.hpp"
#include "scanmill/formats/files.hpp"
#include "support/doubts.hpp"
#include "support/point_sets.hpp"
#include "support/real_data.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

// PCL leaks a table per call.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:pcl::poisson::"; }

namespace scanmill::test {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

struct Made : PoissonResult {
    std::vector<std::string> doubts, warnings;
    Metrics metrics;
    float density(std::size_t vertex) const {
        return static_cast<float>(mesh.vertex_columns.find("density")->number(vertex));
    }
};
Made made(const PointCloud& cloud, const PoissonParams& params = {}, unsigned threads = 1) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    return {poisson(cloud, params, context), doubts_of(context), context.warnings(), context.metrics()};
}
PoissonParams with(u32 depth, double trim, std::optional<double> max_distance = {}) {
    PoissonParams params;
    params.depth = depth;
    params.trim = Ratio::fraction(trim);
    if (max_distance) params.max_distance = Length(*max_distance);
    return params;
}
PointCloud with_normals(PointCloud cloud, const std::function<Vec3(std::size_t)>& normal) {
    Array<float> values;
    for (std::size_t row = 0; row < cloud.size(); ++row)
        for (const double number : normal(row)) values.push_back(static_cast<float>(number));
    cloud.columns = {};
    cloud.columns.add(Column("normal", 3, Buffer<float>(std::move(values))));
    return cloud;
}
/// Points around 0 with normals of length `length` that point away from it.
PointCloud outward(const PointCloud& cloud, double length = 1) {
    return with_normals(cloud, [&](std::size_t row) { return Vec3(length * cloud.positions[row].normalized()); });
}
/// The points of the sphere above `height`.
PointCloud cap(const PointCloud& sphere, double height) {
    Array<u32> rows;
    for (u32 row = 0; row < sphere.size(); ++row)
        if (sphere.positions[row].z() > height) rows.push_back(row);
    return gather(sphere, rows);
}
/// The points (x, y, 0) of a square grid, with normals upwards.
PointCloud sheet(u32 size) {
    Array<Vec3> positions;
    for (u32 y = 0; y < size; ++y)
        for (u32 x = 0; x < size; ++x) positions.emplace_back(x, y, 0);
    PointCloud cloud;
    cloud.positions = std::move(positions);
    return with_normals(cloud, [](std::size_t) { return Vec3(0, 0, 1); });
}
double farthest_from_unit_sphere(const TriangleMesh& mesh) {
    double most = 0;
    for (const Vec3& p : mesh.positions) most = std::max(most, std::abs(p.norm() - 1));
    return most;
}

TEST(Poisson, OfASphere_IsTheClosedSphere) {
    for (const u32 depth : {5u, 6u, 7u}) {
        const Made result = made(outward(fibonacci_sphere(5000)), with(depth, 0));
        const MeshTopology shape = topology(result.mesh);
        EXPECT_TRUE(shape.closed) << depth;
        EXPECT_EQ(shape.euler, 2) << depth;
        EXPECT_EQ(result.loops, 0u);
        EXPECT_EQ(result.trimmed, 0u);
        EXPECT_LT(farthest_from_unit_sphere(result.mesh), 0.02) << depth;
        EXPECT_NEAR(signed_volume(result.mesh), 4 * std::numbers::pi / 3, 0.03) << depth;
        EXPECT_NEAR(area(result.mesh), 4 * std::numbers::pi, 0.1) << depth;
        EXPECT_NEAR(result.cell, 3.0 / (1 << depth), 0.01 / (1 << depth));
        EXPECT_THAT(result.doubts, IsEmpty());
        EXPECT_THAT(result.warnings, IsEmpty());
    }
}

TEST(Poisson, NormalsInwards_TheSurfaceFacesOutwardsAllTheSame) {
    const Made result = made(outward(fibonacci_sphere(3000), -1), with(6, 0));
    EXPECT_NEAR(signed_volume(result.mesh), 4 * std::numbers::pi / 3, 0.05);
    EXPECT_THAT(result.warnings, ElementsAre(HasSubstr("the normals point into the volume that the surface encloses")));
    EXPECT_EQ(result.against, 0);
}

TEST(Poisson, LengthsOfNormals_DoNotMatter) {
    const PointCloud sphere = fibonacci_sphere(1000);
    const Made one = made(outward(sphere)), other = made(outward(sphere, 0.25)), tiny = made(outward(sphere, 0x1p-100));
    EXPECT_TRUE(std::ranges::equal(one.mesh.positions, other.mesh.positions));
    EXPECT_TRUE(std::ranges::equal(one.mesh.triangles, tiny.mesh.triangles));
}

TEST(Poisson, Density_IsThatOfThePoints) {
    // Half of the sphere has a quarter of the points: there, the 8th nearest is twice as far away.
    const PointCloud all = outward(fibonacci_sphere(20000));
    Array<u32> rows;
    for (u32 row = 0; row < all.size(); ++row)
        if (all.positions[row].z() > 0 || row % 4 == 0) rows.push_back(row);
    const Made result = made(gather(all, rows), with(7, 0));
    double sums[2] = {0, 0}, counts[2] = {0, 0};
    for (std::size_t i = 0; i < result.mesh.positions.size(); ++i) {
        if (const double z = result.mesh.positions[i].z(); std::abs(z) < 0.9 && std::abs(z) > 0.1) {
            sums[z > 0] += result.density(i);
            ++counts[z > 0];
        }
    }
    EXPECT_NEAR(sums[1] / counts[1], 1, 0.2);
    EXPECT_NEAR(sums[0] / counts[0], 0.25, 0.06);
}

TEST(Poisson, Density_ByHand) {
    // Every point of a lattice has its 8th nearest other one at √2, except at the border. A vertex at height h above
    // the middle of a cell has four points at √(0.5 + h²) and eight at √(2.5 + h²).
    const Made result = made(sheet(41), with(5, 0));
    std::size_t checked = 0;
    for (std::size_t i = 0; i < result.mesh.positions.size(); ++i) {
        const Vec3& p = result.mesh.positions[i];
        if (p.x() < 3 || p.x() > 37 || p.y() < 3 || p.y() > 37) continue;
        std::vector<double> squares;
        for (int y = 0; y < 41; ++y)
            for (int x = 0; x < 41; ++x) squares.push_back((Vec3(x, y, 0) - p).squaredNorm());
        std::ranges::sort(squares);
        EXPECT_NEAR(result.density(i), 2 / squares[7], 1e-6);
        ++checked;
    }
    EXPECT_GT(checked, 100u);
}

TEST(Poisson, Trim_RemovesTheShareOfLeastDensity) {
    const PointCloud cloud = cap(outward(fibonacci_sphere(5000)), -0.5);
    const Made whole = made(cloud, with(6, 0)), part = made(cloud, with(6, 0.1));
    EXPECT_EQ(whole.trimmed, 0u);
    const auto tenth = static_cast<std::size_t>(0.1 * static_cast<double>(whole.mesh.positions.size()));
    EXPECT_GE(part.trimmed, tenth);
    EXPECT_LE(part.trimmed, tenth + tenth / 5) << "few vertices are left without a triangle";
    EXPECT_EQ(part.metrics.find("trimmed")->value, static_cast<double>(part.trimmed));
    float least = 1e9f;
    for (std::size_t i = 0; i < part.mesh.positions.size(); ++i) least = std::min(least, part.density(i));
    std::size_t lower = 0;
    for (std::size_t i = 0; i < whole.mesh.positions.size(); ++i) lower += whole.density(i) < least;
    EXPECT_GE(lower, tenth);
    EXPECT_LT(part.invented, whole.invented);
    EXPECT_EQ(part.mesh.positions.size() + part.trimmed, whole.mesh.positions.size());
    EXPECT_EQ(topology(part.mesh).unused_vertices, 0u);
}

TEST(Poisson, TrimOfOneVertex_RemovesTheLeastDense) {
    // If several were equally dense, the first would be removed.
    const Made whole = made(outward(vertices_of(icosahedron())), with(3, 0));
    const double share = 1.5 / static_cast<double>(whole.mesh.positions.size());
    const Made less = made(outward(vertices_of(icosahedron())), with(3, share));
    float least = whole.density(0);
    std::size_t first = 0;
    for (std::size_t i = 1; i < whole.mesh.positions.size(); ++i)
        if (whole.density(i) < least) least = whole.density(i), first = i;
    ASSERT_EQ(less.trimmed, 1u);
    for (std::size_t i = 0; i < less.mesh.positions.size(); ++i)
        EXPECT_EQ(less.mesh.positions[i], whole.mesh.positions[i < first ? i : i + 1]);
}

TEST(Poisson, MaxDistance_RemovesWhatIsFarther) {
    const PointCloud cloud = cap(outward(fibonacci_sphere(5000)), 0);
    const Made result = made(cloud, with(6, 0, 0.1));
    EXPECT_GT(result.trimmed, 0u);
    EXPECT_EQ(result.loops, 1u);
    for (const Vec3& vertex : result.mesh.positions) {
        double nearest = 9;
        for (const Vec3& point : cloud.positions) nearest = std::min(nearest, (point - vertex).norm());
        EXPECT_LE(nearest, 0.1);
    }
    EXPECT_GT(made(cloud, with(6, 0)).mesh.positions.size(), result.mesh.positions.size());
}

TEST(Poisson, SurfaceWithoutPoints_IsDoubtful) {
    // A sphere without two caps of height 0.2 (a fifth of its area): the surface closes both gaps, with 18 to 20 % of
    // its own area. At the rims the nearest point is near.
    PointCloud barrel = cap(outward(fibonacci_sphere(10000)), -0.8);
    barrel = cap(outward(moved(barrel, -1)), -0.8);
    const Made result = made(barrel, with(6, 0));
    EXPECT_TRUE(topology(result.mesh).closed);
    EXPECT_GT(result.invented, 0.09);
    EXPECT_LT(result.invented, 0.2);
    EXPECT_EQ(result.metrics.find("invented")->value, result.invented);
    EXPECT_THAT(result.doubts, ElementsAre(HasSubstr("% of the area is far from all points, and so invented")));
    const Made trimmed = made(barrel, with(6, 0, 0.1));
    EXPECT_EQ(trimmed.loops, 2u);
    EXPECT_LT(trimmed.invented, 0.01);
    EXPECT_THAT(trimmed.doubts, IsEmpty());
}

TEST(Poisson, NormalsOnAnySide_AreDoubtful) {
    Random random(4);
    const PointCloud sphere = fibonacci_sphere(5000);
    const PointCloud cloud = with_normals(
        sphere, [&](std::size_t row) { return Vec3((random.uniform() < 0.5 ? 1 : -1) * sphere.positions[row]); });
    const Made result = made(cloud, with(6, 0));
    EXPECT_GT(result.against, 0.05);
    EXPECT_THAT(result.doubts, Contains(HasSubstr("the surface faces away from the normals of the nearest points")));
}

TEST(Poisson, NormalsReversedOnOneHalf_AreDoubtful) {
    const PointCloud sphere = fibonacci_sphere(5000);
    const PointCloud half = with_normals(sphere, [&](std::size_t row) {
        return Vec3((sphere.positions[row].x() > 0 ? 1 : -1) * sphere.positions[row]);
    });
    const Made result = made(half, with(6, 0));
    EXPECT_THAT(result.doubts, Contains(HasSubstr("the surface faces away from the normals of the nearest points")));
    EXPECT_THAT(result.doubts, Contains(HasSubstr("of the area is far from all points")));
}

TEST(Poisson, ASheet_ReachesTheCube) {
    // No side of the plane is closed: the surface ends where the cube ends, a quarter of the sheet beyond the points.
    const Made result = made(sheet(30), with(6, 0));
    EXPECT_EQ(result.loops, 1u);
    EXPECT_THAT(result.warnings,
                ElementsAre(HasSubstr("the surface leaves the octree's cube and ends there, in 1 boundary loop")));
    EXPECT_NEAR(area(result.mesh), 43.5 * 43.5, 5);
    for (const Vec3& p : result.mesh.positions) EXPECT_NEAR(p.z(), 0, 0.05);
}

TEST(Poisson, PointsWithoutNormal_AreNotUsed) {
    const PointCloud sphere = fibonacci_sphere(3000);
    const PointCloud all = with_normals(joined(sphere, cloud_of({{3, 0, 0}, {0, 4, 0}})), [&](std::size_t row) {
        if (row < 3000) return sphere.positions[row];
        return row == 3000 ? Vec3(Vec3::Zero()) : Vec3(std::numeric_limits<double>::quiet_NaN(), 0, 1);
    });
    const Made result = made(all);
    EXPECT_EQ(result.without_normal, 2u);
    EXPECT_THAT(result.warnings, ElementsAre("2 points are not used: their normals are 0, NaN or infinite"));
    EXPECT_TRUE(std::ranges::equal(result.mesh.positions, made(outward(sphere)).mesh.positions));
}

TEST(Poisson, ColumnsOfThePoints_AreDroppedWithAWarning) {
    PointCloud cloud = outward(fibonacci_sphere(3000));
    for (const char* name : {"view", "confidence"})
        cloud.columns.add(Column(name, 1, Buffer<float>(Array<float>(3000, 1.f))));
    const Made result = made(cloud, with(5, 0));
    EXPECT_THAT(result.warnings, ElementsAre("columns of the points are dropped, because the vertices are new: "
                                             "'view', 'confidence'"));
    EXPECT_EQ(result.mesh.vertex_columns.size(), 1u);
}

TEST(Poisson, MovesAndScalesWithThePoints) {
    const PointCloud cloud = outward(fibonacci_sphere(1000));
    const Made one = made(cloud), other = made(moved(cloud, 8, {1024, 0, -64}));
    ASSERT_TRUE(std::ranges::equal(one.mesh.triangles, other.mesh.triangles));
    for (std::size_t i = 0; i < one.mesh.positions.size(); ++i) {
        EXPECT_LT((8 * one.mesh.positions[i] + Vec3(1024, 0, -64) - other.mesh.positions[i]).norm(), 1e-4);
        EXPECT_NEAR(one.density(i), other.density(i), 1e-3);
    }
    EXPECT_EQ(other.mesh.frame, cloud.frame);
}

TEST(Poisson, DoesNotDependOnThreadsOrEarlierCalls) {
    const PointCloud cloud = outward(fibonacci_sphere(20000, 0.01));
    const Made one = made(cloud);
    made(sheet(10));
    for (const unsigned threads : {1u, 2u, 7u}) {
        const Made other = made(cloud, {}, threads);
        EXPECT_TRUE(std::ranges::equal(one.mesh.positions, other.mesh.positions));
        EXPECT_TRUE(std::ranges::equal(one.mesh.triangles, other.mesh.triangles));
        EXPECT_EQ(*one.mesh.vertex_columns.find("density"), *other.mesh.vertex_columns.find("density"));
    }
}

TEST(Poisson, AnyDepth_HasASurface) {
    for (const u32 depth : {3u, 4u, 5u, 8u, 10u}) {
        const Made result = made(outward(fibonacci_sphere(300)), with(depth, 0));
        EXPECT_EQ(topology(result.mesh).euler, 2) << depth;
        EXPECT_NEAR(signed_volume(result.mesh), 4 * std::numbers::pi / 3, 0.3) << depth;
    }
}

TEST(Poisson, SixPoints_HaveASurfaceAroundThem) {
    const Made result =
        made(outward(cloud_of({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}})), with(5, 0));
    EXPECT_TRUE(topology(result.mesh).closed);
    EXPECT_EQ(topology(result.mesh).components, 1u);
    EXPECT_GT(signed_volume(result.mesh), 1);
}

TEST(Poisson, OutliersAlone_AreDoubtful) {
    Random random(8);
    const PointCloud outliers = with_normals(random_cube(2000, 3), [&](std::size_t) {
        return Vec3(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5);
    });
    EXPECT_THAT(made(outliers).doubts, Contains(HasSubstr("the surface faces away from the normals")));
}

TEST(PoissonRefuses, NormalsThatCancelOut) {
    // At every position one normal each way.
    const PointCloud sphere = fibonacci_sphere(200);
    const PointCloud cloud = with_normals(joined(sphere, sphere), [&](std::size_t row) {
        return Vec3((row < 200 ? 1 : -1) * sphere.positions[row % 200].normalized());
    });
    const Error error = error_of([&] { made(cloud, with(5, 0)); });
    EXPECT_THAT(error.sentence(), HasSubstr("no surface separates the 400 points"));
    EXPECT_THAT(error.hint(), HasSubstr("check that the normals point outwards"));
}

TEST(Poisson, TwoScales_AreFineWhereThePointsAre) {
    // A sphere of 1 beside one of 1/50, both of 4,000 points.
    const PointCloud large = outward(fibonacci_sphere(4000)), small = moved(outward(fibonacci_sphere(4000)), 0.02);
    PointCloud both = joined(large, moved(small, 1, {1.2, 0, 0}));
    both = with_normals(both, [&](std::size_t row) { return Vec3(large.positions[row % 4000]); });
    const Made result = made(both, with(9, 0));
    const MeshTopology shape = topology(result.mesh);
    EXPECT_EQ(shape.components, 2u);
    EXPECT_TRUE(shape.closed);
    EXPECT_NEAR(signed_volume(result.mesh), 4 * std::numbers::pi / 3 * (1 + 8e-6), 0.03);
}

TEST(Poisson, APartSmallerThanACell_IsMissedAndDoubtful) {
    const PointCloud sphere = fibonacci_sphere(4000);
    const PointCloud both = with_normals(joined(sphere, moved(sphere, 1e-4, {0, 0, 0.5})),
                                         [&](std::size_t row) { return Vec3(sphere.positions[row % 4000]); });
    const Made result = made(both, with(6, 0));
    EXPECT_DOUBLE_EQ(result.missed, 0.5);
    EXPECT_THAT(result.doubts, Contains(HasSubstr("50.0 % of the points are far from the surface")));
    const Made alone = made(outward(sphere), with(6, 0));
    EXPECT_EQ(alone.missed, 0);
    EXPECT_EQ(alone.metrics.find("missed")->value, 0);
    EXPECT_THAT(alone.doubts, IsEmpty());
}

TEST(PoissonRefuses, CloudsWithoutNormals) {
    const Error error = error_of([] { made(fibonacci_sphere(100)); });
    EXPECT_EQ(error.sentence(), "the scan has no column 'normal'; poisson needs a normal at every point");
    EXPECT_EQ(error.hint(), "put the filter `normals` before it");
    const PointCloud zero = with_normals(fibonacci_sphere(100), [](std::size_t) { return Vec3(Vec3::Zero()); });
    const Error none = error_of([&] { made(zero); });
    EXPECT_EQ(none.sentence(), "none of the 100 points has a normal: all are 0, NaN or infinite");
    EXPECT_FALSE(none.hint().empty());
    PointCloud flat = fibonacci_sphere(10);
    flat.columns.add(Column("normal", 2, Buffer<float>(Array<float>(20, 1.f))));
    EXPECT_EQ(sentence_of([&] { made(flat); }), "the column 'normal' has 2 numbers per point; 3 are needed");
}

TEST(PoissonRefuses, TooFewPoints) {
    EXPECT_EQ(sentence_of([] { made({}); }), "the cloud has 0 points; poisson needs at least 4 with normals");
    const PointCloud three = cloud_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 1, 0}});
    const Error error = error_of([&] { made(with_normals(three, [](std::size_t) { return Vec3(0, 0, 1); })); });
    EXPECT_EQ(error.sentence(), "the points with normals have 3 distinct positions; poisson needs at least 4");
    EXPECT_FALSE(error.hint().empty());
}

TEST(PoissonRefuses, ALine) {
    Array<Vec3> positions;
    for (int i = 0; i < 50; ++i) positions.emplace_back(0.1 * i, 0.2 * i, 1e5 + 0.3 * i);
    PointCloud cloud;
    cloud.positions = std::move(positions);
    const Error error = error_of([&] { made(with_normals(cloud, [](std::size_t) { return Vec3(0, 0, 1); })); });
    EXPECT_EQ(error.sentence(), "the 50 distinct positions with normals lie on one line; poisson needs a surface");
    EXPECT_FALSE(error.hint().empty());
}

TEST(PoissonRefuses, NaN) {
    PointCloud cloud;
    cloud.positions = Array<Vec3>(5, Vec3(0, std::numeric_limits<double>::quiet_NaN(), 0));
    EXPECT_THAT(sentence_of([&] { made(with_normals(cloud, [](std::size_t) { return Vec3(0, 0, 1); })); }),
                HasSubstr("5 of 5 points"));
}

TEST(PoissonRefuses, ParametersOutOfRange) {
    const PointCloud cloud = outward(fibonacci_sphere(100));
    for (const u32 depth : {0u, 2u, 13u, 99u})
        EXPECT_THAT(sentence_of([&] { made(cloud, with(depth, 0)); }), HasSubstr("depth must be from 3 to 12; it is"));
    for (const double scale : {1.0, 0.0, 11.0, std::numeric_limits<double>::quiet_NaN()}) {
        PoissonParams params;
        params.scale = scale;
        EXPECT_THAT(sentence_of([&] { made(cloud, params); }), HasSubstr("scale must be above 1 and at most 10"));
    }
    for (const double trim : {-0.1, 1.0, std::numeric_limits<double>::quiet_NaN()})
        EXPECT_THAT(error_of([&] { made(cloud, with(5, trim)); }).sentence(),
                    HasSubstr("trim must be from 0 to below 100 %"));
    for (const double distance : {0.0, -1.0, std::numeric_limits<double>::infinity()})
        EXPECT_THAT(error_of([&] { made(cloud, with(5, 0, distance)); }).sentence(),
                    HasSubstr("max-distance must be above 0"));
}

TEST(PoissonRefuses, WhenTrimmingLeavesNothing) {
    const PointCloud cloud = outward(fibonacci_sphere(100));
    const Error error = error_of([&] { made(cloud, with(5, 0, 1e-9)); });
    EXPECT_THAT(error.sentence(), HasSubstr("trimming leaves none of the"));
    EXPECT_THAT(error.hint(), HasSubstr("raise max-distance"));
    EXPECT_THAT(sentence_of([&] { made(cloud, with(5, 0.999)); }), HasSubstr("trim is 99.9 %"));
}

TEST(Poisson, Cancelled_Ends) {
    const PointCloud cloud = outward(fibonacci_sphere(5000));
    for (const int after : {0, 1, 3, 6, 9, 12}) {
        ContextOptions options;
        options.is_cancelled = [left = after]() mutable { return left-- <= 0; };
        Context context(options);
        EXPECT_THROW(poisson(cloud, with(6, 0), context), Cancelled) << after;
    }
    EXPECT_THAT(made(cloud, with(6, 0)).doubts, IsEmpty()) << "a cancelled call leaves nothing behind";
}

TEST(Poisson, Progress_Ascends) {
    std::vector<double> seen;
    ContextOptions options;
    options.on_progress = [&](double fraction) { seen.push_back(fraction); };
    Context context(options);
    poisson(outward(fibonacci_sphere(5000)), with(6, 0), context);
    EXPECT_TRUE(std::ranges::is_sorted(seen));
    EXPECT_GT(seen.size(), 8u);
    EXPECT_EQ(seen.back(), 1);
}

TEST(PoissonReal, OfTheKitten_IsAClosedTorus) {
    SCANMILL_REAL_SCAN(path, shared_data, "2-organic/kitten.xyz");
    const std::shared_ptr<const PointCloud> cloud = read_points(path);
    const Made result = made(*cloud, with(8, 0), 2);
    const MeshTopology shape = topology(result.mesh);
    EXPECT_TRUE(shape.closed);
    EXPECT_EQ(shape.genus, 1);
    EXPECT_EQ(result.loops, 0u);
    EXPECT_GT(signed_volume(result.mesh), 0);
    EXPECT_THAT(result.doubts, IsEmpty());
    // Every point is near a vertex: closer than two cells.
    std::size_t near = 0;
    for (const Vec3& point : cloud->positions) {
        double nearest = 9;
        for (const Vec3& vertex : result.mesh.positions) nearest = std::min(nearest, (vertex - point).squaredNorm());
        near += nearest < 16 * result.cell * result.cell;
    }
    EXPECT_GT(static_cast<double>(near), 0.99 * static_cast<double>(cloud->size()));
}

}  // namespace
}  // namespace scanmill::test

#endif  // SCANMILL_PCL
