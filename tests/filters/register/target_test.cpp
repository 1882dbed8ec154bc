// SPDX-License-Identifier: GPL-3.0-or-later
/// One scan on a model that stays: parts with and without symmetries.
#include "register/register_to_target.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <numbers>

#include "filters/register/cases.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

using Corners = std::vector<Eigen::Vector2d>;

/// A prism over convex polygons that share edges, from z = low to z = high. Walls between two polygons stay.
TriangleMesh prism(const std::vector<Corners>& polygons, double low, double high) {
    Array<Vec3> positions;
    Array<Triangle> triangles;
    for (const Corners& polygon : polygons) {
        const auto first = static_cast<u32>(positions.size()), count = static_cast<u32>(polygon.size());
        for (const double z : {low, high})
            for (const Eigen::Vector2d& p : polygon) positions.emplace_back(p.x(), p.y(), z);
        for (u32 i = 1; i + 1 < count; ++i) {
            triangles.push_back({first, first + i + 1, first + i});
            triangles.push_back({first + count, first + count + i, first + count + i + 1});
        }
    }
    // Only walls that no other polygon has in the opposite direction.
    u32 first = 0;
    for (const Corners& polygon : polygons) {
        const auto count = static_cast<u32>(polygon.size());
        for (u32 i = 0; i < count; ++i) {
            const Eigen::Vector2d &a = polygon[i], &b = polygon[(i + 1) % count];
            const bool is_inside = std::ranges::any_of(polygons, [&](const Corners& other) {
                for (std::size_t k = 0; k < other.size(); ++k)
                    if (other[k] == b && other[(k + 1) % other.size()] == a) return true;
                return false;
            });
            if (is_inside) continue;
            const u32 j = first + (i + 1) % count, k = first + i;
            triangles.push_back({k, j, j + count});
            triangles.push_back({k, j + count, k + count});
        }
        first += 2 * count;
    }
    return soup(std::move(positions), std::move(triangles));
}

Corners rectangle(double x, double y, double to_x, double to_y) { return {{x, y}, {to_x, y}, {to_x, to_y}, {x, to_y}}; }

Corners circle(double radius, int corners) {
    Corners result;
    for (int i = 0; i < corners; ++i) {
        const double turn = 2 * std::numbers::pi * i / corners;
        result.emplace_back(radius * std::cos(turn), radius * std::sin(turn));
    }
    return result;
}

TriangleMesh box(double x, double y, double z) { return prism({rectangle(0, 0, x, y)}, 0, z); }

/// 120 × 80 × 40 with a notch of `x` × `y` in one corner.
TriangleMesh notched(double x, double y) {
    return prism({{{0, 0}, {120 - x, 0}, {120 - x, y}, {0, y}},
                  {{120 - x, y}, {120, y}, {120, 80}, {120 - x, 80}},
                  {{0, y}, {120 - x, y}, {120 - x, 80}, {0, 80}}},
                 0, 40);
}

TriangleMesh l_shape(double leg, double other_leg) {
    return prism({rectangle(0, 0, 30, 30), rectangle(30, 0, leg, 30), rectangle(0, 30, 30, other_leg)}, 0, 40);
}

/// All points of views from ten sides, or those of one view, in a random frame.
struct Scan {
    std::vector<Vec3> points, to_scanner;
    RigidMotion truth;
};
Scan scan_of(const TriangleMesh& model, u64 seed, std::optional<std::size_t> only = {}) {
    Random random(seed);
    const RigidMotion motion = random_motion(random, 300);
    Scan scan;
    scan.truth = motion.inverse();
    const std::vector<View> views = views_of(model, 10);
    for (std::size_t i = 0; i < views.size(); ++i) {
        if (only && i != *only) continue;
        for (const Vec3& p : views[i].points) {
            scan.points.push_back(motion.apply(p));
            scan.to_scanner.push_back(motion.turned(views[i].to_scanner));
        }
    }
    return scan;
}

RegisterToTargetResult placed(const Scan& scan, const TriangleMesh& model, unsigned threads = 2,
                              std::optional<RigidMotion> start = {}) {
    ExecutionOptions options;
    options.threads = threads;
    Execution execution(options);
    return register_to_target(
        {"scan", scan.points, scan.to_scanner, start}, [&](double spacing) { return samples_of(model, spacing); }, {},
        execution);
}

double error_of(const RegisterToTargetResult& result, const Scan& scan) {
    double squares = 0;
    for (const Vec3& p : scan.points) squares += (result.pose.apply(p) - scan.truth.apply(p)).squaredNorm();
    return std::sqrt(squares / static_cast<double>(scan.points.size())) / result.spacing;
}

struct Shape {
    const char* name;
    TriangleMesh (*model)();
};
void PrintTo(const Shape& shape, std::ostream* out) { *out << shape.name; }
std::string shape_name(const testing::TestParamInfo<Shape>& info) { return info.param.name; }

class SymmetricModel : public testing::TestWithParam<Shape> {};

TEST_P(SymmetricModel, IsRefused_FromAllSidesAndFromOne) {
    const TriangleMesh model = GetParam().model();
    const RegisterToTargetResult whole = placed(scan_of(model, 1), model);
    EXPECT_TRUE(whole.refusal == TargetRefusal::ambiguous || whole.refusal == TargetRefusal::slides)
        << name_of(whole.refusal) << " " << whole.fit << " " << whole.rival << " " << whole.slide;
    EXPECT_GE(whole.rival, 0.98 * whole.fit);
    const RegisterToTargetResult side = placed(scan_of(model, 2, 3), model);
    EXPECT_NE(side.refusal, TargetRefusal::none) << side.fit << " " << side.rival << " " << side.slide;
}

INSTANTIATE_TEST_SUITE_P(RegisterToTarget, SymmetricModel,
                         testing::Values(Shape{"Box", [] { return box(120, 80, 40); }},
                                         Shape{"SquareBox", [] { return box(80, 80, 40); }},
                                         Shape{"LOfEqualLegs", [] { return l_shape(100, 100); }},
                                         Shape{"SixSidedNut", [] { return prism({circle(60, 6)}, 0, 30); }},
                                         Shape{"FiveSidedPrism", [] { return prism({circle(60, 5)}, 0, 30); }},
                                         Shape{"Cylinder", [] { return prism({circle(20, 90)}, 0, 50); }},
                                         Shape{"Sphere", [] { return geodesic_sphere(25, 16); }}),
                         shape_name);

class PlainModel : public testing::TestWithParam<Shape> {};

TEST_P(PlainModel, IsPlacedFromAllSides) {
    const TriangleMesh model = GetParam().model();
    const Scan scan = scan_of(model, 1);
    const RegisterToTargetResult result = placed(scan, model);
    EXPECT_EQ(result.refusal, TargetRefusal::none)
        << name_of(result.refusal) << " " << result.fit << " " << result.rival;
    EXPECT_LT(error_of(result, scan), 0.15);
}

TEST(RegisterToTarget, AStartDecidesBetweenEqualPoses) {
    const TriangleMesh model = box(120, 80, 40);
    const Scan scan = scan_of(model, 1);
    RigidMotion near = scan.truth;
    near.translation += Vec3(2, -1, 1);
    const RegisterToTargetResult result = placed(scan, model, 2, near);
    EXPECT_EQ(result.refusal, TargetRefusal::none) << name_of(result.refusal);
    EXPECT_LT(error_of(result, scan), 0.15);
}

TEST(RegisterToTarget, TheNumberOfThreads_ChangesNothing) {
    const TriangleMesh model = l_shape(120, 80);
    const Scan scan = scan_of(model, 1);
    const RegisterToTargetResult one = placed(scan, model, 1), three = placed(scan, model, 3);
    EXPECT_EQ(one.pose.rotation, three.pose.rotation);
    EXPECT_EQ(one.pose.translation, three.pose.translation);
    EXPECT_EQ(one.fit, three.fit);
    EXPECT_EQ(one.rival, three.rival);
}

TEST(RegisterToTarget, ALongThinTriangle_IsSampledEvenly) {
    const TriangleMesh sliver = soup({Vec3(0, 0, 0), Vec3(1000, 0, 0), Vec3(0, 1, 0)}, {{0, 1, 2}});
    const TargetSamples samples = samples_of(sliver, 1);
    EXPECT_GT(samples.points.size(), 666u);
    EXPECT_LT(samples.points.size(), 3000u);
    for (const Vec3& n : samples.normals) EXPECT_EQ(n, Vec3::UnitZ());
}

INSTANTIATE_TEST_SUITE_P(RegisterToTarget, PlainModel,
                         testing::Values(Shape{"Lump", [] { return lump(); }},
                                         Shape{"LOfUnequalLegs", [] { return l_shape(120, 80); }},
                                         Shape{"NotchedBox", [] { return notched(16, 12); }}),
                         shape_name);

}  // namespace
}  // namespace scanmill::test
