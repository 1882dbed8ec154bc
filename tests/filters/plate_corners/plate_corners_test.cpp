// SPDX-License-Identifier: GPL-3.0-or-later
/// plate-corners on plates whose corners are known.

#include "plate_corners/plate_corners.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <cstring>

#include "filters/align/cases.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"
#include "virtual_scan/virtual_scan.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::MatchesRegex;

struct Found : PlateCornersResult {
    Metrics metrics;
};

Found corners_of(const PointCloud& cloud, const PlateCornersParams& params, unsigned threads = 1) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    PlateCornersResult result = plate_corners(cloud, params, context);
    return {std::move(result), context.metrics()};
}

PlateCornersParams within(double tolerance) {
    PlateCornersParams params;
    params.tolerance = tolerance;
    return params;
}

PlateCornersParams of_sides(double first, double second, double tolerance) {
    PlateCornersParams params = within(tolerance);
    params.sides = {first, second};
    return params;
}

Error refusal(const PointCloud& cloud, const PlateCornersParams& params) {
    const Error error = error_of([&] { corners_of(cloud, params); });
    EXPECT_FALSE(error.hint().empty()) << error.sentence();
    return error;
}

/// A grid over [0, width] x [0, depth] at z = 0: the middles of its cells.
std::vector<Vec3> grid(double width, double depth, double step) {
    std::vector<Vec3> points;
    for (double x = step / 2; x <= width; x += step)
        for (double y = step / 2; y <= depth; y += step) points.emplace_back(x, y, 0);
    return points;
}

/// The farthest that a corner of `wanted` is from the nearest found one.
double worst(const Found& found, const std::vector<Vec3>& wanted) {
    double largest = 0;
    for (const Vec3& corner : wanted) {
        double nearest = std::numeric_limits<double>::infinity();
        for (const Vec3& p : found.corners.positions) nearest = std::min(nearest, (p - corner).norm());
        largest = std::max(largest, nearest);
    }
    return largest;
}

TriangleMesh box(const Vec3& low, const Vec3& high) {
    TriangleMesh mesh = cube();
    Array<Vec3> positions;
    for (const Vec3& p : mesh.positions) positions.push_back(low + p.cwiseProduct(high - low));
    mesh.positions = std::move(positions);
    return mesh;
}

TriangleMesh both(const TriangleMesh& a, const TriangleMesh& b) {
    TriangleMesh mesh;
    Array<Vec3> positions(a.positions.begin(), a.positions.end());
    Array<Triangle> triangles(a.triangles.begin(), a.triangles.end());
    const auto first = static_cast<u32>(positions.size());
    positions.insert(positions.end(), b.positions.begin(), b.positions.end());
    for (const Triangle& t : b.triangles) triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(triangles);
    return mesh;
}

/// A plate of 200 x 120 x 10 with its upper side at z = 0 and a block on it, seen from above and four sides.
PointCloud scanned_plate(double noise, std::vector<double> views = {0, 0, 1, 1, 0, 1, -1, 0, 1, 0, 1, 1, 0, -1, 1}) {
    VirtualScanParams params;
    params.views = std::move(views);
    params.resolution = 1;
    params.noise = noise;
    const TriangleMesh mesh = both(box({-100, -60, -10}, {100, 60, 0}), box({-40, -30, 0}, {30, 25, 50}));
    Context context;
    return virtual_scan(&mesh, params, context).points;
}

TEST(PlateCorners, AGrid_HasTheCornersOfItsBorder) {
    // The outermost points are half a step, 0.25, inside; a tenth of that remains.
    const Found found = corners_of(cloud(grid(20, 10, 0.5)), within(0.1));
    ASSERT_EQ(found.corners.size(), 4u);
    const std::vector<Vec3> expected{{0, 0, 0}, {20, 0, 0}, {20, 10, 0}, {0, 10, 0}};
    for (std::size_t i = 0; i < 4; ++i) EXPECT_LT((found.corners.positions[i] - expected[i]).norm(), 0.03) << i;
    EXPECT_NEAR(found.first_side, 20, 0.05);
    EXPECT_NEAR(found.second_side, 10, 0.05);
    EXPECT_LT(found.residual, 1e-12);
    EXPECT_LT(found.flatness, 1e-12);
    EXPECT_EQ(found.points, 40u * 20u);
    EXPECT_EQ(found.metrics.find("side-2")->value, found.second_side);
}

/// Points of a plate of 200 x 120 at a spacing of about 1: at random, or on a grid that is turned by an angle and
/// moved.
std::vector<Vec3> sampled_plate(bool at_random, double angle, Random& random) {
    std::vector<Vec3> points;
    if (at_random) {
        for (int i = 0; i < 200 * 120; ++i)
            points.emplace_back(random.uniform(-100, 100), random.uniform(-60, 60), 0.01 * random.normal());
        return points;
    }
    const double dx = random.uniform(0, 1), dy = random.uniform(0, 1), c = std::cos(angle), s = std::sin(angle);
    for (int i = -130; i <= 130; ++i)
        for (int j = -130; j <= 130; ++j) {
            const double u = i + dx, v = j + dy;
            const Vec3 p(c * u - s * v, s * u + c * v, 0.01 * random.normal());
            if (std::abs(p.x()) <= 100 && std::abs(p.y()) <= 60) points.push_back(p);
        }
    return points;
}

TEST(PlateCorners, SidesOfScannedPlates_AreAsLongAsThePlateOnAverage) {
    Random random(3);
    constexpr int trials = 10;
    struct Sampling {
        bool at_random;
        double angle, most;
    };
    // With rows along the border, n of them fit sides from n - 1 to n + 1 spacings; these sides have n.
    for (const Sampling& sampling : {Sampling{true, 0, 0.4}, {false, 0.3, 0.1}, {false, 0.02, 0.1}, {false, 0, 0.1}}) {
        double sum = 0, largest = 0;
        for (int trial = 0; trial < trials; ++trial) {
            const Found found =
                corners_of(cloud(sampled_plate(sampling.at_random, sampling.angle, random)), within(0.1));
            const double one = std::max(found.first_side, found.second_side) - 200,
                         other = std::min(found.first_side, found.second_side) - 120;
            sum += one + other;
            largest = std::max({largest, std::abs(one), std::abs(other)});
        }
        const double mean = sum / (2 * trials);
        EXPECT_LT(std::abs(mean), 0.05) << sampling.at_random << " " << sampling.angle;
        EXPECT_LT(largest, sampling.most) << sampling.at_random << " " << sampling.angle;
    }
}

TEST(PlateCorners, FromBelow_TheOrderIsReversed) {
    PlateCornersParams below = within(0.1);
    below.up = {0, 0, -1};
    const Found found = corners_of(cloud(grid(20, 10, 0.5)), below);
    EXPECT_LT((found.corners.positions[1] - Vec3(0, 10, 0)).norm(), 0.03);
    EXPECT_NEAR(found.corners.columns.find("normal")->number(0, 2), -1, 1e-12);
    // Normals of the points decide before `up`.
    PointCloud points = cloud(grid(20, 10, 0.5));
    Array<double> normals;
    for (std::size_t i = 0; i < points.size(); ++i) normals.insert(normals.end(), {0, 0, 1});
    points.columns.add(Column("normal", 3, Buffer<double>(std::move(normals))));
    EXPECT_NEAR(corners_of(points, below).corners.columns.find("normal")->number(0, 2), 1, 1e-12);
}

TEST(PlateCorners, ASquareOnItsCorner_BeginsWithTheLowestSum_TiesByX) {
    std::vector<Vec3> points;
    for (const Vec3& p : grid(10, 10, 0.25)) points.emplace_back(p.x() + p.y(), p.x() - p.y(), 0);
    // The corners are (0, 0), (10, 10), (20, 0), (10, -10); the first and the last have the sum 0.
    const Found found = corners_of(cloud(points), within(0.1));
    const double first = found.corners.positions[0].sum();
    for (const Vec3& p : found.corners.positions) EXPECT_LE(first, p.sum() + 1e-9);
    EXPECT_LT(worst(found, {{0, 0, 0}, {10, 10, 0}, {20, 0, 0}, {10, -10, 0}}), 0.03);
}

TEST(PlateCorners, AScanWithAPartOnThePlate_IsFoundWithinASpacing) {
    for (const double noise : {0.0, 0.05}) {
        const PointCloud scan = scanned_plate(noise);
        const Found found = corners_of(scan, within(0.3));
        EXPECT_LT(worst(found, plate()), 1.2) << noise;
        EXPECT_NEAR(found.first_side, 200, 1.0);
        EXPECT_NEAR(found.second_side, 120, 1.0);
        EXPECT_LT(found.residual, 0.5);
        const Found sized = corners_of(scan, of_sides(120, 200, 0.3));
        EXPECT_LT(worst(sized, plate()), 0.3) << noise;
        EXPECT_NEAR((sized.corners.positions[1] - sized.corners.positions[0]).norm(), 200, 1e-9);
        EXPECT_NEAR((sized.corners.positions[2] - sized.corners.positions[1]).norm(), 120, 1e-9);
    }
}

TEST(PlateCorners, AnyMotionOfTheScan_MovesTheCorners) {
    const PointCloud scan = scanned_plate(0.05);
    Random random(1);
    for (int trial = 0; trial < 5; ++trial) {
        const RigidTransform motion = random_motion(random, 100);
        PointCloud turned;
        Array<Vec3> positions;
        for (const Vec3& p : scan.positions) positions.push_back(motion.apply(p));
        turned.positions = std::move(positions);
        PlateCornersParams params = of_sides(200, 120, 0.3);
        const Vec3 up = motion.rotation.col(2);
        params.up = {up.x(), up.y(), up.z()};
        EXPECT_LT(worst(corners_of(turned, params), moved(plate(), motion)), 0.3) << trial;
    }
}

TEST(PlateCorners, StraysOnThePlane_AndBittenSides_AreLeftOut) {
    std::vector<Vec3> points;
    for (const Vec3& p : grid(200, 120, 1))  // a bite of 60 x 12 at one side, a corner cut off
        if (!(p.x() > 60 && p.x() < 120 && p.y() < 12) && !(p.x() + p.y() > 310)) points.push_back(p);
    for (int i = 0; i < 40; ++i) points.emplace_back(230 + 7 * i, -30.0 - i, 0);
    EXPECT_LT(worst(corners_of(cloud(points), within(0.2)), {{0, 0, 0}, {200, 0, 0}, {200, 120, 0}, {0, 120, 0}}),
              0.05);
}

TEST(PlateCorners, ALargerTable_IsPassedOverForThePlateOfTheGivenSides) {
    std::vector<Vec3> points = grid(400, 300, 2);
    for (Vec3& p : points) p.z() = -10;
    std::erase_if(points, [](const Vec3& p) { return p.x() >= 100 && p.x() <= 200 && p.y() >= 100 && p.y() <= 180; });
    for (const Vec3& p : grid(100, 80, 1)) points.emplace_back(p + Vec3(100, 100, 0));
    EXPECT_LT(worst(corners_of(cloud(points), of_sides(100, 80, 0.2)),
                    {{100, 100, 0}, {200, 100, 0}, {200, 180, 0}, {100, 180, 0}}),
              1e-9);
}

TEST(PlateCorners, TheBytes_DoNotDependOnTheThreads) {
    const PointCloud scan = scanned_plate(0.05);
    const Found one = corners_of(scan, within(0.3), 1), many = corners_of(scan, within(0.3), 7);
    EXPECT_EQ(std::memcmp(one.corners.positions.data(), many.corners.positions.data(), 4 * sizeof(Vec3)), 0);
}

TEST(PlateCorners, ARegistrationByTwoScans_ComesOutRight) {
    const PointCloud scan = scanned_plate(0.02);
    const Found found = corners_of(scan, of_sides(200, 120, 0.2));
    Random random(2);
    RigidTransform motion = random_motion(random);
    motion.rotation = Eigen::AngleAxisd(1, Vec3::UnitZ()).toRotationMatrix();
    const Aligned result = aligned(found.corners, cloud(moved(plate(), motion)), in_rectangle(plate()[0]));
    EXPECT_LT((result.transform.rotation - motion.rotation).cwiseAbs().maxCoeff(), 2e-3);
    EXPECT_LT((result.transform.apply(Vec3(30, 25, 50)) - motion.apply(Vec3(30, 25, 50))).norm(), 0.3);
}

// Refusals.

TEST(PlateCornersRefusals, Parameters) {
    const PointCloud points = cloud(grid(20, 10, 0.5));
    EXPECT_EQ(refusal(cloud({{0, 0, 0}}), within(1)).sentence(), "the cloud has 1 point; a plate needs at least 4");
    EXPECT_EQ(refusal(points, within(0)).sentence(), "`tolerance` is 0 u; it must be above 0");
    PlateCornersParams one = within(1), negative = of_sides(20, -10, 1), flat_up = within(1), short_up = within(1);
    one.sides = {20};
    flat_up.up = {0, 0, 0};
    short_up.up = {1};
    EXPECT_EQ(refusal(points, one).sentence(), "`sides` has 1 length; it needs 2");
    EXPECT_EQ(refusal(points, negative).sentence(), "a length of `sides` is -10 u; it must be above 0");
    EXPECT_EQ(refusal(points, flat_up).sentence(), "`up` is (0, 0, 0); it must be finite and not zero");
    EXPECT_EQ(refusal(points, short_up).sentence(), "`up` has 1 number; it needs 3");
}

TEST(PlateCornersRefusals, CoordinatesThatAreNotNumbers) {
    std::vector<Vec3> points = grid(20, 10, 0.5);
    points[3].x() = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(error_of([&] { corners_of(cloud(points), within(1)); }).sentence(), HasSubstr("1 of "));
}

TEST(PlateCornersRefusals, NoPlane) {
    EXPECT_THAT(refusal(random_cube(1000, 1), within(0.01)).sentence(), HasSubstr("no plane: the best one has "));
    EXPECT_THAT(refusal(random_cube(1000, 1), within(0.01)).sentence(), HasSubstr("at least 100 are needed"));
    const PointCloud line = cloud({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {4, 0, 0}});
    EXPECT_THAT(refusal(line, within(0.01)).sentence(), HasSubstr("no plane: the best one has 0 of 5 points"));
}

TEST(PlateCornersRefusals, ADiscHasNoFourSides) {
    std::vector<Vec3> disc;
    for (const Vec3& p : grid(100, 100, 1))
        if ((p - Vec3(50, 50, 0)).norm() <= 50) disc.push_back(p);
    EXPECT_THAT(refusal(cloud(disc), within(0.2)).sentence(), HasSubstr("4 of 4 sides of the plane are not straight"));
}

TEST(PlateCornersRefusals, ATriangleHasNoRightAngles) {
    std::vector<Vec3> triangle;
    for (const Vec3& p : grid(100, 100, 1))
        if (p.y() <= 2 * p.x() && p.y() <= 2 * (100 - p.x())) triangle.push_back(p);
    EXPECT_THAT(refusal(cloud(triangle), within(0.2)).sentence(), HasSubstr("two sides of the plane meet at"));
}

TEST(PlateCornersRefusals, ALozengeIsNotARectangle) {
    std::vector<Vec3> lozenge;
    for (const Vec3& p : grid(200, 100, 1)) lozenge.emplace_back(p.x() + 0.12 * p.y(), p.y(), 0);
    EXPECT_THAT(refusal(cloud(lozenge), within(0.2)).sentence(), HasSubstr("two sides of the plane meet at"));
}

TEST(PlateCornersRefusals, OtherSidesThanGiven) {
    EXPECT_THAT(refusal(cloud(grid(20, 10, 0.5)), of_sides(10, 22, 0.1)).sentence(),
                MatchesRegex("the sides of the plane are 10[.0-9]* and 20[.0-9]* u long, but 10 and 22 u are given; at "
                             "most 1.2 u of difference is accepted"));
}

TEST(PlateCornersRefusals, AnUprightPlateNeedsUp) {
    std::vector<Vec3> upright;
    for (const Vec3& p : grid(20, 10, 0.5)) upright.emplace_back(p.x(), 0, p.y());
    EXPECT_EQ(refusal(cloud(upright), within(0.1)).sentence(),
              "`up` is 90 deg off the normal of the plate; the upper side is undecided above 60 deg");
}

TEST(PlateCornersRefusals, NormalsAlongThePlate) {
    PointCloud points = cloud(grid(20, 10, 0.5));
    Array<double> normals;
    for (std::size_t i = 0; i < points.size(); ++i) normals.insert(normals.end(), {1, 0, 0});
    points.columns.add(Column("normal", 3, Buffer<double>(std::move(normals))));
    EXPECT_EQ(refusal(points, within(0.1)).sentence(),
              "the mean normal of the plate's points is 90 deg off the normal of the plate; the upper side is "
              "undecided above 60 deg");
}

TEST(PlateCornersRefusals, ScatteredPoints) {
    std::vector<Vec3> points;  // 100 groups of 1 %
    for (const Vec3& middle : grid(100, 100, 10))
        for (const double x : {0.0, 0.01})
            for (const double y : {0.0, 0.01}) points.push_back(middle + Vec3(x, y, 0));
    EXPECT_EQ(refusal(cloud(points), within(0.1)).sentence(),
              "the 400 points of the plane are scattered: no group has 2 % of them");
}

TEST(PlateCorners, ACancelledRun_Ends) {
    ContextOptions options;
    options.is_cancelled = [] { return true; };
    Context context(options);
    EXPECT_THROW(plate_corners(cloud(grid(20, 10, 0.5)), within(0.1), context), Cancelled);
}

}  // namespace
}  // namespace scanmill::test
