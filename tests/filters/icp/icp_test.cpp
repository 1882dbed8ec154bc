// SPDX-License-Identifier: GPL-3.0-or-later
/// icp: hand-computed cases, ties, laws, and the accuracy on parts with dents.

#include "icp/icp.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cstring>

#include "filters/icp/cases.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

double off_identity(const Eigen::Matrix3d& rotation) {
    return (rotation - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
}

/// A part of 80 x 80 x 40 mm with seven planes and a reflex edge.
TriangleMesh part() { return l_block(40); }
const Vec3 part_centre(40, 40, 20);

PointCloud with_normals(PointCloud points, const std::vector<Vec3>& normals) {
    Array<double> numbers;
    for (const Vec3& n : normals) numbers.insert(numbers.end(), {n.x(), n.y(), n.z()});
    points.columns.add(Column("normal", 3, Buffer<double>(std::move(numbers))));
    return points;
}

TEST(Icp, ThreePlanesMovedByAKnownShift_AreFoundByHand) {
    const Vec3 shift(0.1, -0.2, 0.3);
    std::vector<Vec3> points = corner_points();
    for (Vec3& p : points) p += shift;
    const Refined result = refined(cloud(points, "scanner"), room_corner(10));
    EXPECT_LT(off_identity(result.transform.rotation), 1e-13);
    EXPECT_LT((result.transform.translation + shift).norm(), 1e-12);
    EXPECT_LT(result.rms, 1e-12);
    EXPECT_EQ(result.overlap, 1);
    EXPECT_TRUE(result.converged);
    EXPECT_EQ(result.transform.from, "scanner");
    EXPECT_EQ(result.transform.to, "");
    EXPECT_EQ(result.transform.rms, result.rms);
    EXPECT_EQ(result.metrics.find("iterations")->value, result.iterations);
    EXPECT_EQ(result.metrics.find("overlap")->value, 1);
    EXPECT_THAT(result.doubts, IsEmpty());
    EXPECT_THAT(result.warnings, IsEmpty());
}

TEST(Icp, TheSlideOfACube_IsComputedByHand) {
    // Lattices of u, v in {-0.8, -0.4, 0, 0.4, 0.8} on the faces of [-1, 1]³, mean of u² is s = 0.32. Translations have
    // the eigenvalue 1/3. A turn about an axis moves points of four faces along their normals: 4/6 s / R², where R² is
    // 1
    // + 2 s.
    std::vector<Vec3> points;
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {0.0, 2.0}) {
            std::vector<Vec3> face;
            add_lattice(face, -2, 2, axis);
            for (Vec3& p : face) {
                p = p * 0.4 + Vec3::Ones();
                p[axis] = side;
                points.push_back(p);
            }
        }
    IcpParams params;
    params.trim = Ratio::percent(0);
    const Refined result = refined(cloud(points), cube(2), params);
    EXPECT_NEAR(result.slide, 2 * 0.32 / (3 * 1.64), 1e-9);
    EXPECT_EQ(result.metrics.find("slide")->value, result.slide);
    EXPECT_EQ(result.free_directions, 0u);
}

TEST(Icp, WhatIsAligned_StaysWhereItIs) {
    Random random(1);
    const Scan scan = scan_of(part(), 5000, 0, random);
    const Refined result = refined(cloud(scan.points), part());
    EXPECT_LT(off_identity(result.transform.rotation), 1e-13);
    EXPECT_LT(result.transform.translation.norm(), 1e-11);
}

TEST(Icp, MotionsOfAFewDegreesAndPercent_AreFoundToTheLastDigits) {
    Random random(2);
    for (int trial = 0; trial < 20; ++trial) {
        const Scan scan = scan_of(part(), 3000, 0, random);
        const double degrees = random.uniform(0.5, 2), shift = random.uniform(1, 2.4);
        const RigidTransform motion = random_motion_about(part_centre, degrees, shift, random);
        const Refined result = refined(cloud(moved(scan.points, motion)), part());
        EXPECT_LT(largest_motion(composed(result.transform, motion), scan.points), 1e-9) << trial;
        EXPECT_NEAR(result.transform.rotation.determinant(), 1, 1e-14);
        EXPECT_LT(off_identity(result.transform.rotation * result.transform.rotation.transpose()), 1e-14);
        EXPECT_THAT(result.doubts, IsEmpty());
    }
}

TEST(Icp, APointBetweenTwoSheets_BelongsToTheLowerRow) {
    // Both sheets are at the distance 0.5.
    std::vector<Vec3> points;
    add_lattice(points, 2, 8, 2, 0.5);
    const TriangleMesh low = square(10, 0), high = square(10, 1);
    EXPECT_NEAR(refined(cloud(points), both(low, high), within(0.6)).transform.translation.z(), -0.5, 1e-12);
    EXPECT_NEAR(refined(cloud(points), both(high, low), within(0.6)).transform.translation.z(), 0.5, 1e-12);
}

TEST(Icp, APointBetweenTwoPoints_BelongsToTheLowerOne) {
    std::vector<Vec3> points, target;
    add_lattice(points, 2, 8, 2, 0.5);
    add_lattice(target, 0, 10, 2, 1);
    add_lattice(target, 0, 10, 2, 0);
    const PointCloud sheets = with_normals(cloud(target), std::vector<Vec3>(target.size(), Vec3(0, 0, 2)));
    EXPECT_NEAR(refined(cloud(points), sheets, within(0.6)).transform.translation.z(), -0.5, 1e-12);
}

TEST(Icp, Trim_RemovesTheLargestResiduals) {
    // Of every five points, two are 0.01 above the plane, two 0.01 below it, and one 0.03 above it. Without the last
    // ones the plane is in the middle; least squares over all raise it by a fifth of 0.03.
    std::vector<Vec3> points;
    for (int i = 2; i < 52; ++i)
        for (int j = 2; j < 52; ++j) {
            const int group = (i + 2 * j) % 5;
            points.emplace_back(i, j, group == 4 ? 0.03 : group < 2 ? 0.01 : -0.01);
        }
    IcpParams params = within(1);
    const auto height = [&](double percent) {
        params.trim = Ratio::percent(percent);
        const Refined result = refined(cloud(points), square(54), params);
        return result.transform.apply(Vec3(26.5, 26.5, 0)).z();
    };
    EXPECT_NEAR(height(20), 0, 1e-5);
    EXPECT_NEAR(height(0), -0.006, 1e-5);
    EXPECT_LT(height(10), -0.001);
}

TEST(Icp, Weights_AreThoseOfTukeysBiweight) {
    // As above, with the last ones at 0.05: within the cut of about 0.13, but with a smaller weight.
    const std::array<double, 5> heights{0.01, 0.01, -0.01, -0.01, 0.05};
    std::vector<Vec3> points;
    for (int i = 2; i < 52; ++i)
        for (int j = 2; j < 52; ++j) points.emplace_back(i, j, heights[static_cast<std::size_t>((i + 2 * j) % 5)]);
    double expected = 0.01;  // of least squares
    for (int round = 0; round < 100; ++round) {
        std::array<double, 5> residuals = heights;
        for (double& r : residuals) r -= expected;
        std::ranges::sort(residuals, {}, [](double r) { return std::abs(r); });
        const double cut = 4.685 * 1.4826 * std::abs(residuals[2]);
        double weights = 0, sum = 0;
        for (const double r : residuals) {
            const double root = 1 - r * r / (cut * cut), weight = root * root;
            weights += weight, sum += weight * r;
        }
        expected += sum / weights;
    }
    EXPECT_NEAR(expected, 0.0087, 1e-4);
    IcpParams params = within(1);
    params.trim = Ratio::percent(1e-9);
    const Refined result = refined(cloud(points), square(54), params);
    EXPECT_NEAR(result.transform.apply(Vec3(26.5, 26.5, 0)).z(), -expected, 1e-4);
}

TEST(Icp, PointsOffTheTarget_AreNoOverlap) {
    std::vector<Vec3> points = corner_points();
    const std::size_t all = points.size() + 9;
    for (int i = 0; i < 9; ++i) points.emplace_back(3 + 0.5 * i, 4, 0.05);
    const Refined result = refined(cloud(points), room_corner(10));
    EXPECT_DOUBLE_EQ(result.overlap, static_cast<double>(all - 9) / static_cast<double>(all));
    EXPECT_LT(largest_motion(result.transform, points), 1e-12) << "they do not attract the others";
    EXPECT_LT(result.rms, 1e-12);
}

TEST(Icp, PointsBesideAnOpenMesh_HaveNoPair) {
    // Lattice points 1 … 9 of -2 … 12 are above the square, but not above its boundary.
    std::vector<Vec3> points;
    add_lattice(points, -2, 12, 2);
    EXPECT_DOUBLE_EQ(refined(cloud(points), square(10), within(5)).overlap, 81.0 / 225.0);
}

TEST(Icp, CollapsedTriangleOnTheBoundary_LeavesItABoundary) {
    std::vector<Vec3> points;
    add_lattice(points, -2, 12, 2);
    TriangleMesh mesh = square(10);
    Array<Triangle> triangles(mesh.triangles.begin(), mesh.triangles.end());
    for (std::size_t i = 0; i < 3; ++i) {
        const u32 a = mesh.triangles[0][i], b = mesh.triangles[0][(i + 1) % 3];
        triangles.push_back({a, a, b});
    }
    mesh.triangles = std::move(triangles);
    EXPECT_DOUBLE_EQ(refined(cloud(points), mesh, within(5)).overlap, 81.0 / 225.0);
}

TEST(Icp, NormalsThatAreAllZero_AreNotUsed) {
    Random random(8);
    const Scan target = scan_of(part(), 20000, 0.02, random);
    const PointCloud bare = cloud(target.points);
    const PointCloud zeros = with_normals(bare, std::vector<Vec3>(target.points.size(), Vec3::Zero()));
    const PointCloud source = cloud(moved(target.points, random_motion_about(part_centre, 0.5, 1, random)));
    EXPECT_EQ(refined(source, zeros).transform.rotation, refined(source, bare).transform.rotation);
}

TEST(Icp, ASeamOfEqualVertices_IsNoBoundary) {
    // Two squares that meet at x = 10, each with its own vertices; the lattice has points on the seam.
    const TriangleMesh other = with_positions(square(10), [](const Vec3& p) -> Vec3 { return p + Vec3(10, 0, 0); });
    std::vector<Vec3> points;
    add_lattice(points, 1, 9, 2);
    for (Vec3& p : points) p.x() += 5;
    EXPECT_EQ(refined(cloud(points), both(square(10), other), within(1)).overlap, 1);
}

TEST(Icp, TrianglesWithoutArea_DoNotMatter) {
    Random random(3);
    const Scan scan = scan_of(part(), 3000, 0.02, random);
    const PointCloud source = cloud(moved(scan.points, random_motion_about(part_centre, 0.5, 1, random)));
    TriangleMesh slivers = part();
    Array<Triangle> triangles(slivers.triangles.begin(), slivers.triangles.end());
    triangles.insert(triangles.begin(), {triangles[0][0], triangles[0][0], triangles[0][1]});
    triangles.push_back({triangles[1][2], triangles[1][2], triangles[1][2]});
    slivers.triangles = triangles;
    EXPECT_LT((refined(source, slivers).transform.translation - refined(source, part()).transform.translation).norm(),
              1e-9);
}

// Accuracy on a scan with noise of 0.02 mm: a dent of 0.4 mm and a pad of 0.2 mm, as wide as a few percent of the area.

struct DamagedScan {
    std::vector<Vec3> points;
    std::vector<std::size_t> dent;
    double dented_share = 0, padded_share = 0;
};

DamagedScan damaged(const TriangleMesh& mesh, std::size_t count, double radius, const Vec3& dent, const Vec3& pad,
                    Random& random) {
    const Scan scan = scan_of(mesh, count, 0.02, random);
    DamagedScan result{scan.points, {}};
    std::size_t padded = 0;
    for (std::size_t i = 0; i < count; ++i) {
        if ((scan.points[i] - dent).norm() < radius) {
            result.points[i] -= 0.4 * scan.normals[i];
            result.dent.push_back(i);
        } else if ((scan.points[i] - pad).norm() < radius) {
            result.points[i] += 0.2 * scan.normals[i];
            ++padded;
        }
    }
    result.dented_share = static_cast<double>(result.dent.size()) / static_cast<double>(count);
    result.padded_share = static_cast<double>(padded) / static_cast<double>(count);
    return result;
}

TEST(IcpAccuracy, ADentAndAPad_DoNotAttractTheScan) {
    Random random(4);
    for (int trial = 0; trial < 10; ++trial) {
        const DamagedScan scan = damaged(part(), 20000, 16, Vec3(40, 20, 40), Vec3(80, 20, 20), random);
        ASSERT_GT(scan.dented_share, 0.03);
        ASSERT_GT(scan.padded_share, 0.03);
        const RigidTransform motion = random_motion_about(part_centre, 0.5, 1, random);
        const Refined result = refined(cloud(moved(scan.points, motion)), part());
        const RigidTransform error = composed(result.transform, motion);
        double depth = 0;
        for (const std::size_t i : scan.dent) depth += (error.apply(scan.points[i]) - scan.points[i]).z();
        EXPECT_LT(std::abs(depth / static_cast<double>(scan.dent.size())), 0.002) << trial;
        EXPECT_LT(largest_motion(error, scan.points), 0.005) << trial;
        EXPECT_NEAR(result.rms, 0.02, 0.002);
        EXPECT_NEAR(result.overlap, 1 - scan.dented_share - scan.padded_share, 0.01);
        EXPECT_THAT(result.doubts, IsEmpty());
    }
}

TEST(IcpAccuracy, APartThatIsTooLong_LiesInTheMiddleByLeastSquares) {
    // Both ends are 0.15 off, far more than the noise of 0.01, but nothing else shows the position along the part.
    Random random(3);
    const auto block = [](double length) {
        return with_positions(shifted(cube(1), -bounding_box(cube(1).positions.span()).low - Vec3(0.5, 0.5, 0.5)),
                              [&](const Vec3& p) { return Vec3(length * p.x(), 40 * p.y(), 20 * p.z()); });
    };
    const TriangleMesh nominal = block(60);
    const Scan part = scan_of(block(60.3), 20'000, 0.01, random);
    const RigidTransform motion = motion_about(Vec3::Zero(), 0.5, {1, 2, 2}, {0.6, -0.5, 0.4});
    std::vector<Vec3> moved;
    for (const Vec3& point : part.points) moved.push_back(motion.apply(point));
    Context context;
    IcpParams params;
    params.trim = Ratio::percent(0);
    const IcpResult result = icp(cloud(moved), nominal, params, context);
    EXPECT_THAT(context.doubts(), testing::IsEmpty());
    EXPECT_EQ(result.free_directions, 0u);
    double error = 0;
    for (std::size_t i = 0; i < moved.size(); ++i)
        error = std::max(error, (result.transform.apply(moved[i]) - part.points[i]).norm());
    EXPECT_LT(error, 0.01);
    EXPECT_GT(result.overlap, 0.99) << "the ends count";
}

TEST(IcpAccuracy, OfAThinPlate_TheEdgesPlaceItSideways) {
    // 5 % of the area show where the plate of 100 x 80 x 3 is; a share of 10 % that is trimmed too early would be they.
    TriangleMesh plate =
        with_positions(cube(1), [](const Vec3& p) -> Vec3 { return p.cwiseProduct(Vec3(100, 80, 3)); });
    Random random(5);
    const Scan scan = scan_of(plate, 30000, 0.02, random);
    const RigidTransform motion = motion_about(Vec3(50, 40, 1.5), 0.5, Vec3::UnitZ(), Vec3(0.9, -0.8, 0));
    const Refined result = refined(cloud(moved(scan.points, motion)), plate);
    EXPECT_LT(largest_motion(composed(result.transform, motion), scan.points), 0.01);
    EXPECT_THAT(result.doubts, IsEmpty());
}

TEST(IcpAccuracy, AClampOnTheScan_IsLeftOut) {
    Random random(6);
    Scan scan = scan_of(part(), 20000, 0.02, random);
    for (int i = 0; i < 8000; ++i)  // 29 % of the points, some of them near the part
        scan.points.emplace_back(random.uniform(20, 60), random.uniform(-30, -1), random.uniform(0, 40));
    const RigidTransform motion = random_motion_about(part_centre, 1, 1, random);
    const Refined result = refined(cloud(moved(scan.points, motion)), part());
    EXPECT_LT(largest_motion(composed(result.transform, motion), scan.points), 0.01);
    EXPECT_NEAR(result.overlap, 20.0 / 28, 0.01);
}

TEST(IcpAccuracy, MorePointsThanAreUsed_StandForAll) {
    Random random(7);
    const Scan scan = scan_of(part(), 120000, 0.02, random);
    const RigidTransform motion = random_motion_about(part_centre, 0.5, 1, random);
    const Refined result = refined(cloud(moved(scan.points, motion)), part());
    EXPECT_LT(largest_motion(composed(result.transform, motion), scan.points), 0.003);
    EXPECT_NEAR(result.rms, 0.02, 0.001);
}

TEST(IcpAccuracy, ATargetOfPoints_WithAndWithoutNormals) {
    Random random(8);
    const Scan target = scan_of(part(), 40000, 0.02, random);
    const DamagedScan scan = damaged(part(), 20000, 16, Vec3(40, 20, 40), Vec3(80, 20, 20), random);
    const RigidTransform motion = random_motion_about(part_centre, 0.5, 1, random);
    const PointCloud source = cloud(moved(scan.points, motion));
    for (const PointCloud& points : {cloud(target.points), with_normals(cloud(target.points), target.normals)}) {
        const Refined result = refined(source, points);
        EXPECT_LT(largest_motion(composed(result.transform, motion), scan.points), 0.01);
        EXPECT_THAT(result.doubts, IsEmpty());
    }
}

TEST(Icp, PointsWithoutAFiniteNormal_HaveNoPairs) {
    std::vector<Vec3> target, normals;
    for (int axis = 0; axis < 3; ++axis) {
        add_lattice(target, 0, 10, axis);
        normals.resize(target.size(), Vec3::Unit(axis));
    }
    const std::vector<Vec3> points = corner_points();
    EXPECT_EQ(refined(cloud(points), with_normals(cloud(target), normals), within(0.5)).overlap, 1);
    for (std::size_t i = 0; i < target.size(); ++i) {
        if (target[i] == Vec3(5, 5, 0)) normals[i].y() = std::nan("");
        if (target[i] == Vec3(6, 5, 0)) normals[i].setZero();
    }
    EXPECT_DOUBLE_EQ(refined(cloud(points), with_normals(cloud(target), normals), within(0.5)).overlap, 145.0 / 147);
}

// Laws.

struct Case {
    PointCloud source;
    TriangleMesh target = part();
    std::vector<Vec3> truth;
};

Case noisy_case(std::uint64_t seed) {
    Random random(seed);
    Case result;
    result.truth = scan_of(part(), 4000, 0.02, random).points;
    result.source = cloud(moved(result.truth, random_motion_about(part_centre, 0.7, 1, random)), "scanner");
    return result;
}

TEST(IcpLaws, OriginsOfTheFrames_DoNotMatter) {
    const Case given = noisy_case(9);
    const Refined usual = refined(given.source, given.target);
    // The same world positions, relative to other origins.
    const auto relative_to = [](const Vec3& origin, auto geometry) {
        geometry.frame.origin = origin;
        geometry.positions = translated(geometry.positions, -origin);
        return geometry;
    };
    const Refined other = refined(relative_to({64, -32, 8}, given.source), relative_to({-16, 128, 4}, given.target));
    EXPECT_LT((usual.transform.rotation - other.transform.rotation).norm(), 1e-10);
    EXPECT_LT((usual.transform.translation - other.transform.translation).norm(), 1e-8);
    // Far away, where both are equally far.
    const Vec3 far(3e6, -2e6, 1e6);
    PointCloud source = given.source;
    TriangleMesh target = given.target;
    source.frame.origin = target.frame.origin = far;
    const Refined distant = refined(source, target);
    EXPECT_LT((usual.transform.rotation - distant.transform.rotation).norm(), 1e-13);
    for (const Vec3& p : given.source.positions)
        ASSERT_LT((distant.transform.apply(p + far) - far - usual.transform.apply(p)).norm(), 1e-8);
}

TEST(IcpLaws, MotionsOfBoth_ConjugateTheResult) {
    const Case given = noisy_case(10);
    const Refined usual = refined(given.source, given.target);
    const RigidTransform both_moved = motion_about(part_centre, 77, Vec3(1, 2, 3), Vec3(50, -70, 20));
    PointCloud source = given.source;
    source.positions = Array<Vec3>();
    std::vector<Vec3> points(given.source.positions.begin(), given.source.positions.end());
    const Refined result = refined(cloud(moved(points, both_moved)),
                                   with_positions(given.target, [&](const Vec3& p) { return both_moved.apply(p); }));
    std::vector<Vec3> first, second;
    for (const Vec3& p : points) {
        first.push_back(both_moved.apply(usual.transform.apply(p)));
        second.push_back(result.transform.apply(both_moved.apply(p)));
    }
    EXPECT_LT(largest_distance(first, second), 1e-4);  // two results of one fit, each converged to 1/10,000 spacing
    EXPECT_NEAR(result.rms, usual.rms, 1e-6);
    EXPECT_NEAR(result.slide, usual.slide, 1e-4);
}

TEST(IcpLaws, APowerOfTwo_ScalesTheTranslation) {
    const Case given = noisy_case(11);
    const Refined usual = refined(given.source, given.target);
    PointCloud source = given.source;
    Array<Vec3> larger;
    for (const Vec3& p : given.source.positions) larger.push_back(p * 1024);
    source.positions = std::move(larger);
    const Refined result = refined(source, scaled(given.target, 1024));
    EXPECT_LT((result.transform.rotation - usual.transform.rotation).norm(), 1e-12);
    EXPECT_LT((result.transform.translation / 1024 - usual.transform.translation).norm(), 1e-10);
    EXPECT_EQ(result.iterations, usual.iterations);
}

TEST(IcpLaws, AnyNumberOfThreads_GivesTheSameBytes) {
    const Case given = noisy_case(12);
    Random random(12);
    const PointCloud points = cloud(scan_of(part(), 5000, 0.02, random).points);
    const auto bytes = [&](const auto& target, unsigned threads) {
        const Refined result = refined(given.source, target, {}, threads);
        std::vector<double> numbers(result.transform.rotation.data(), result.transform.rotation.data() + 9);
        numbers.insert(numbers.end(), result.transform.translation.begin(), result.transform.translation.end());
        numbers.insert(numbers.end(), {result.rms, result.overlap, result.slide, result.cut});
        return numbers;
    };
    for (const unsigned threads : {2u, 8u}) {
        EXPECT_EQ(bytes(given.target, 1), bytes(given.target, threads));
        EXPECT_EQ(bytes(points, 1), bytes(points, threads));
    }
}

TEST(IcpLaws, TheOrientationOfTheMesh_DoesNotMatter) {
    const Case given = noisy_case(13);
    EXPECT_LT((refined(given.source, given.target).transform.translation -
               refined(given.source, inside_out(given.target)).transform.translation)
                  .norm(),
              1e-9);
}

TEST(IcpLaws, FrameNames_AreThoseOfTheInputs) {
    Case given = noisy_case(14);
    given.target.frame.name = "machine";
    given.source.frame.unit = given.target.frame.unit = LengthUnit::millimetre;
    const RigidTransform result = refined(given.source, given.target).transform;
    EXPECT_EQ(result.from, "scanner");
    EXPECT_EQ(result.to, "machine");
    EXPECT_EQ(result.unit, LengthUnit::millimetre);
}

TEST(Icp, TooFewIterations_AreDoubtful) {
    const Case given = noisy_case(15);
    IcpParams params;
    params.max_iterations = 1;
    const Refined result = refined(given.source, given.target, params);
    EXPECT_FALSE(result.converged);
    EXPECT_EQ(result.iterations, 1u);
    EXPECT_GT(result.last_motion, 0.5) << "the scan was 1 mm away";
    EXPECT_THAT(result.doubts, ElementsAre(testing::AllOf(HasSubstr("not converged after 1 iteration"),
                                                          HasSubstr("moved a point by"), HasSubstr("is needed"))));
}

TEST(Icp, AnOverlapBelow30Percent_IsDoubtful) {
    std::vector<Vec3> points = corner_points();
    for (int i = 0; i < 400; ++i) points.emplace_back(100 + i % 20, 100 + i / 20, 100);
    const Refined result = refined(cloud(points), room_corner(10), within(1));
    EXPECT_DOUBLE_EQ(result.overlap, 147.0 / 547);
    EXPECT_THAT(result.doubts, ElementsAre(HasSubstr("only 26.9 % of the points of the source lie on the target")));
}

TEST(Icp, ResidualsThatFillTheRange_AreDoubtful) {
    Random random(16);
    std::vector<Vec3> points;
    for (int i = 0; i < 3000; ++i) {
        Vec3 p(random.uniform(1, 9), random.uniform(1, 9), random.uniform(1, 9));
        p[i % 3] = random.uniform(-0.5, 0.5);
        points.push_back(p);
    }
    EXPECT_THAT(refined(cloud(points), room_corner(10), within(0.5)).doubts,
                testing::Contains(HasSubstr("fill the range up to `max-distance`, 0.5 u, evenly")));
}

TEST(Icp, Cancelled_Ends) {
    const Case given = noisy_case(17);
    for (const int after : {0, 1, 5, 40}) {
        ContextOptions options;
        options.is_cancelled = [left = after]() mutable { return left-- <= 0; };
        Context context(options);
        EXPECT_THROW(icp(given.source, given.target, {}, context), Cancelled) << after;
        options.is_cancelled = [left = after]() mutable { return left-- <= 0; };
        Context second(options);
        EXPECT_THROW(icp(given.source, vertices_of(torus(30, 10, 60, 30)), {}, second), Cancelled) << after;
    }
}

TEST(Icp, Progress_Rises) {
    const Case given = noisy_case(18);
    std::vector<double> fractions;
    ContextOptions options;
    options.on_progress = [&](double fraction) { fractions.push_back(fraction); };
    Context context(options);
    icp(given.source, given.target, {}, context);
    EXPECT_GT(fractions.size(), 5u);
    EXPECT_TRUE(std::ranges::is_sorted(fractions));
    EXPECT_EQ(fractions.back(), 1);
}

}  // namespace
}  // namespace scanmill::test
