// SPDX-License-Identifier: GPL-3.0-or-later
// The fit that moves vertices: its parts by hand, and surfaces with known normals.
#include "a_patch/joint_fit.hpp"

#include "a_patch/evening.hpp"
#include "a_patch/facet_height.hpp"
#include "decimate/decimate.hpp"
#include "filters/a_patch/sharp_cases.hpp"
#include "scanmill/geometry/distance/self_intersections.hpp"
#include "tessellate/tessellate.hpp"

namespace scanmill {
namespace {

using namespace test;
using a_patches::FacetHeight;

// The height over a triangle.

/// A polynomial of degree 3 in the plane, with its derivatives.
struct Cubic {
    std::array<double, 10> c;
    double value(double x, double y) const {
        return c[0] + c[1] * x + c[2] * y + c[3] * x * x + c[4] * x * y + c[5] * y * y + c[6] * x * x * x +
               c[7] * x * x * y + c[8] * x * y * y + c[9] * y * y * y;
    }
    Eigen::Vector2d slope(double x, double y) const {
        return {c[1] + 2 * c[3] * x + c[4] * y + 3 * c[6] * x * x + 2 * c[7] * x * y + c[8] * y * y,
                c[2] + c[4] * x + 2 * c[5] * y + c[7] * x * x + 2 * c[8] * x * y + 3 * c[9] * y * y};
    }
};

const std::array<Vec3, 3> corners{Vec3(0.2, 0.1, 1), Vec3(1.1, 0.3, 1), Vec3(0.4, 0.9, 1)};

FacetHeight::Numbers numbers_of(const FacetHeight& height, const Cubic& cubic) {
    FacetHeight::Numbers numbers;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 &p = corners[i], middle = (corners[i] + corners[(i + 1) % 3]) / 2;
        const auto row = static_cast<Eigen::Index>(i);
        numbers[row] = cubic.value(p.x(), p.y());
        const Eigen::Vector2d slope = cubic.slope(p.x(), p.y()), between = cubic.slope(middle.x(), middle.y());
        for (std::size_t a = 0; a < 2; ++a)
            numbers[3 + 2 * row + static_cast<Eigen::Index>(a)] = slope.dot(height.axes()[a].head<2>());
        // The slope across an edge is linear along it, so that of a cubic is matched only without terms of degree 3.
        numbers[9 + row] = between.dot(height.across(i).head<2>());
    }
    return numbers;
}

TEST(FacetHeight, OfAQuadric_IsTheQuadric_AndItsBendingIsExact) {
    const FacetHeight height(corners);
    const Cubic quadric{{0.3, -0.2, 0.5, 0.7, -0.4, 0.9, 0, 0, 0, 0}};
    const FacetHeight::Numbers numbers = numbers_of(height, quadric);
    Random random(1);
    for (int i = 0; i < 200; ++i) {
        const double x = random.uniform(0, 1.2), y = random.uniform(0, 1);
        const FacetHeight::Basis basis = height.basis(height.in_plane(Vec3(x, y, 1)));
        EXPECT_NEAR(basis.height.dot(numbers), quadric.value(x, y), 1e-13);
        Eigen::Vector2d slope = Eigen::Vector2d::Zero();
        for (std::size_t a = 0; a < 2; ++a) slope += basis.slopes[a].dot(numbers) * height.axes()[a].head<2>();
        EXPECT_LT((slope - quadric.slope(x, y)).norm(), 1e-12);
    }
    // Second derivatives xx, xy and yy are 1.4, -0.4 and 1.8.
    const double area = (corners[1] - corners[0]).cross(corners[2] - corners[0]).norm() / 2;
    EXPECT_NEAR(numbers.dot(height.bending() * numbers), area * (1.4 * 1.4 + 2 * 0.4 * 0.4 + 1.8 * 1.8), 1e-12);
}

TEST(FacetHeight, IsSmoothAcrossItsParts_AndHasTheGivenSlopesAtItsEdges) {
    const FacetHeight height(corners);
    Random random(2);
    FacetHeight::Numbers numbers;
    for (int i = 0; i < FacetHeight::numbers; ++i) numbers[i] = random.uniform(-1, 1);
    const Vec3 a = corners[1] - corners[0], b = corners[2] - corners[1], c = corners[0] - corners[2];
    const Vec3 centre =
        (b.norm() * corners[0] + c.norm() * corners[1] + a.norm() * corners[2]) / (a.norm() + b.norm() + c.norm());
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 on = (corners[i] + 2 * centre) / 3, beside = 1e-9 * Vec3::UnitZ().cross(centre - corners[i]);
        const auto one = height.basis(height.in_plane(on + beside)), other = height.basis(height.in_plane(on - beside));
        EXPECT_NEAR(one.height.dot(numbers), other.height.dot(numbers), 1e-7);
        for (std::size_t axis = 0; axis < 2; ++axis)
            EXPECT_NEAR(one.slopes[axis].dot(numbers), other.slopes[axis].dot(numbers), 1e-6);
        const Vec3 middle = (corners[i] + corners[(i + 1) % 3]) / 2;
        const auto edge = height.basis(height.in_plane(middle));
        double across = 0;
        for (std::size_t axis = 0; axis < 2; ++axis)
            across += edge.slopes[axis].dot(numbers) * height.axes()[axis].dot(height.across(i));
        EXPECT_NEAR(across,
                    (numbers[3 + 2 * static_cast<Eigen::Index>(i)] * height.axes()[0] +
                     numbers[4 + 2 * static_cast<Eigen::Index>(i)] * height.axes()[1])
                                .dot(height.across(i)) /
                            4 +
                        (numbers[3 + 2 * static_cast<Eigen::Index>((i + 1) % 3)] * height.axes()[0] +
                         numbers[4 + 2 * static_cast<Eigen::Index>((i + 1) % 3)] * height.axes()[1])
                                .dot(height.across(i)) /
                            4 +
                        numbers[9 + static_cast<Eigen::Index>(i)] / 2,
                    1e-12)
            << "mean of the ends' with weights 1/4, and of the given slope with 1/2";
    }
}

// Even triangles.

/// Two flat triangles that share the long diagonal of a kite, within a fan that gives every vertex enough triangles.
a_patches::PatchMesh kite_in_a_plane() {
    // A 5 x 5 grid in which the middle square's corners are moved so that its diagonal is long.
    a_patches::PatchMesh mesh;
    Array<Vec3> positions;
    for (int y = 0; y < 5; ++y)
        for (int x = 0; x < 5; ++x) positions.emplace_back(x, y, 0);
    positions[2 * 5 + 1] += Vec3(0.35, -0.35, 0);
    positions[1 * 5 + 2] += Vec3(-0.35, 0.35, 0);
    Array<Triangle> triangles;
    for (u32 y = 0; y < 4; ++y)
        for (u32 x = 0; x < 4; ++x) {
            const u32 a = y * 5 + x;
            triangles.push_back({a, a + 1, a + 6});
            triangles.push_back({a, a + 6, a + 5});
        }
    mesh.mesh.positions = std::move(positions);
    mesh.mesh.triangles = std::move(triangles);
    const std::array<Vec3, 3> up{Vec3::UnitZ(), Vec3::UnitZ(), Vec3::UnitZ()};
    mesh.normals.assign(mesh.mesh.triangles.size(), up);
    return mesh;
}

bool has_edge(const TriangleMesh& mesh, u32 a, u32 b) {
    return std::ranges::any_of(mesh.triangles, [&](const Triangle& t) {
        return std::ranges::find(t, a) != t.end() && std::ranges::find(t, b) != t.end();
    });
}

TEST(Evening, FlipsAnEdgeWithObtuseAnglesOppositeToIt) {
    // Vertices 6 and 12 are the ends of the long diagonal, 7 and 11 those of the short one.
    a_patches::PatchMesh mesh = kite_in_a_plane();
    const std::vector<bool> none(25, false);
    ASSERT_TRUE(has_edge(mesh.mesh, 6, 12));
    EXPECT_GE(flip_edges(mesh, none, 0), 1u);
    EXPECT_FALSE(has_edge(mesh.mesh, 6, 12));
    EXPECT_TRUE(has_edge(mesh.mesh, 7, 11));
    EXPECT_EQ(flip_edges(mesh, none, 0), 0u);
}

TEST(Evening, FlipsNoSharpEdge_NoneAtAFixedVertex_AndNoneThatWouldSag) {
    const std::vector<bool> none(25, false);
    a_patches::PatchMesh sharp = kite_in_a_plane();
    sharp.mesh.sharp_edges = {make_edge(6, 12)};
    flip_edges(sharp, none, 0);
    EXPECT_TRUE(has_edge(sharp.mesh, 6, 12));
    std::vector<bool> fixed = none;
    fixed[7] = true;
    a_patches::PatchMesh mesh = kite_in_a_plane();
    flip_edges(mesh, fixed, 0);
    EXPECT_TRUE(has_edge(mesh.mesh, 6, 12));
    mesh = kite_in_a_plane();
    // Normals that lean apart at the ends of the new edge make it sag by 0.3 * 0.7 * sqrt(2) / 8 * sqrt(2).
    const Vec3 along = Vec3(-1, 1, 0).normalized();
    for (std::size_t f = 0; f < mesh.mesh.triangles.size(); ++f)
        for (std::size_t i = 0; i < 3; ++i) {
            const u32 v = mesh.mesh.triangles[f][i];
            if (v == 7) mesh.normals[f][i] = (Vec3::UnitZ() - 0.3 * along).normalized();
            if (v == 11) mesh.normals[f][i] = (Vec3::UnitZ() + 0.3 * along).normalized();
        }
    a_patches::PatchMesh again = mesh;
    flip_edges(mesh, none, 0.01);
    EXPECT_TRUE(has_edge(mesh.mesh, 6, 12));
    flip_edges(again, none, 1);
    EXPECT_FALSE(has_edge(again.mesh, 6, 12));
}

// Surfaces with known normals.

/// A dense torus of radii 1 and 0.4 with noise along the normals.
TriangleMesh dense_torus(double noise) {
    TriangleMesh mesh = exact_torus(180, 72);
    mesh.face_columns = {};
    Random random(3);
    Array<Vec3> positions;
    for (const Vec3& p : mesh.positions) {
        const Vec3 centre = Vec3(p.x(), p.y(), 0).normalized(), normal = (p - centre).normalized();
        // The sum of twelve uniform numbers is almost normal.
        double sum = 0;
        for (int i = 0; i < 12; ++i) sum += random.uniform(-0.5, 0.5);
        positions.push_back(p + noise * sum * normal);
    }
    mesh.positions = std::move(positions);
    return mesh;
}

/// Mean angle in degrees between the triangles' normals and the torus's, weighted by area.
double mean_angle(const TriangleMesh& mesh) {
    double sum = 0, area = 0;
    for (const Triangle& t : mesh.triangles) {
        const Vec3 middle = (mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3;
        const Vec3 n =
            (mesh.positions[t[1]] - mesh.positions[t[0]]).cross(mesh.positions[t[2]] - mesh.positions[t[0]]) / 2;
        const Vec3 exact = (middle - Vec3(middle.x(), middle.y(), 0).normalized()).normalized();
        sum += std::atan2(n.cross(exact).norm(), n.dot(exact)) * n.norm();
        area += n.norm();
    }
    return sum / area * 180 / std::numbers::pi;
}

double rms_of(const TriangleMesh& mesh) {
    double sum = 0, area = 0;
    for (const Triangle& t : mesh.triangles) {
        const Vec3 &a = mesh.positions[t[0]], &b = mesh.positions[t[1]], &c = mesh.positions[t[2]];
        const double size = (b - a).cross(c - a).norm();
        for (const Vec3& p : {Vec3((a + b + c) / 3), Vec3((a + b) / 2), Vec3((b + c) / 2), Vec3((c + a) / 2)}) {
            const double d = torus_distance(p);
            sum += d * d * size / 4;
        }
        area += size;
    }
    return std::sqrt(sum / area);
}

PointCloud vertices_of(const TriangleMesh& mesh) {
    PointCloud points;
    points.frame = mesh.frame;
    points.positions = mesh.positions;
    return points;
}

TriangleMesh decimated(const TriangleMesh& mesh, double max_error, Context& context) {
    DecimateParams params;
    params.max_error = max_error;
    return decimate(mesh, nullptr, params, context).mesh;
}

struct TorusRun {
    TriangleMesh dense, light;
    PatchRun run;
    TriangleMesh fine;
};
TorusRun torus_run(double noise, double max_error, unsigned threads = 2) {
    TorusRun result{dense_torus(noise), {}, {}, {}};
    Context context;
    result.light = decimated(result.dense, max_error, context);
    const PointCloud points = vertices_of(result.dense);
    result.run = patched(result.light, {}, &points, threads);
    result.fine = tessellate(result.run.result.patches, {16, {}}, context);
    return result;
}

TEST(JointFit, OfANoisyTorus_HasNormalsSeveralTimesAsGoodAsTheDenseMesh) {
    // The diagonal is about 4.04: noise of 0.015 %, decimated within 0.1 %.
    const TorusRun torus = torus_run(6e-4, 4e-3);
    EXPECT_LT(mean_angle(torus.fine), 0.3 * mean_angle(torus.dense));
    EXPECT_LT(rms_of(torus.fine), 0.3 * rms_of(torus.light));
    const APatchResult& result = torus.run.result;
    EXPECT_EQ(result.inverted, 0u);
    EXPECT_EQ(result.sign_violations, 0u);
    EXPECT_EQ(result.loosened, 0u);
    EXPECT_LT(result.c1_jump, 1e-9);
    EXPECT_TRUE(topology(torus.fine).closed);
    EXPECT_EQ(topology(torus.fine).euler, 0);
    Execution execution;
    const TriangleTree tree(torus.fine.positions.span(), torus.fine.triangles.span(), 2);
    EXPECT_EQ(self_intersections(torus.fine.positions.span(), torus.fine.triangles.span(), tree, execution).count, 0u);
    ASSERT_TRUE(result.joint_fit);
    EXPECT_GT(result.joint_fit->flips, 0u);
    EXPECT_GT(metric_of(torus.run, "weight"), 0);
    EXPECT_GT(metric_of(torus.run, "offset-max"), metric_of(torus.run, "offset-rms"));
}

TEST(JointFit, OfACoarseCleanTorus_HasNormalsBetterThanTheDenseMesh) {
    const TorusRun torus = torus_run(0, 1.2e-2);
    EXPECT_LT(mean_angle(torus.fine), 0.6 * mean_angle(torus.dense));
    EXPECT_LT(rms_of(torus.fine), 0.1 * rms_of(torus.light));
}

TEST(JointFit, MoreNoise_FindsAGreaterWeight) {
    EXPECT_LT(torus_run(0, 4e-3).run.result.joint_fit->weight, torus_run(2e-3, 4e-3).run.result.joint_fit->weight);
}

TEST(JointFit, AnyNumberOfThreads_GivesTheSameBits) {
    const TorusRun one = torus_run(6e-4, 1.2e-2, 1), four = torus_run(6e-4, 1.2e-2, 4);
    EXPECT_TRUE(std::ranges::equal(one.run.result.patches.positions, four.run.result.patches.positions));
    EXPECT_TRUE(std::ranges::equal(one.run.result.patches.weights, four.run.result.patches.weights));
}

TEST(JointFit, OutliersOfTwentyPercent_HardlyMatter) {
    TriangleMesh dense = dense_torus(6e-4);
    Context context;
    const TriangleMesh light = decimated(dense, 4e-3, context);
    Random random(4);
    PointCloud points = vertices_of(dense);
    Array<Vec3> positions(points.positions.begin(), points.positions.end());
    for (std::size_t i = 0; i < positions.size(); i += 5)
        positions[i] += 0.02 * Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
    points.positions = std::move(positions);
    const PatchRun run = patched(light, {}, &points, 2);
    const TriangleMesh fine = tessellate(run.result.patches, {8, {}}, context);
    EXPECT_LT(mean_angle(fine), 0.6 * mean_angle(dense));
    EXPECT_LT(rms_of(fine), 0.5 * rms_of(light));
}

TEST(JointFit, WithoutPointsOnHalfOfTheMesh_TheOtherHalfIsFitted_AndVerticesStayThere) {
    const TriangleMesh dense = dense_torus(0);
    Context context;
    const TriangleMesh light = decimated(dense, 1.2e-2, context);
    PointCloud half;
    Array<Vec3> positions;
    for (const Vec3& p : dense.positions)
        if (p.x() > 0) positions.push_back(p);
    half.positions = std::move(positions);
    const PatchRun run = patched(light, {}, &half, 2);
    EXPECT_THAT(run.warnings,
                testing::Contains(testing::HasSubstr("the surface there only continues its surroundings")));
    EXPECT_EQ(run.result.inverted + run.result.sign_violations, 0u);
    const TriangleMesh fine = tessellate(run.result.patches, {8, {}}, context);
    EXPECT_TRUE(topology(fine).closed);
    double with = 0, without = 0;
    for (const Vec3& p : fine.positions)
        (p.x() > 0.3 ? with : without) = std::max(p.x() > 0.3 ? with : without, std::abs(torus_distance(p)));
    EXPECT_LT(with, 2e-3);
    EXPECT_LT(without, 4e-2);
}

TEST(JointFit, OnePointPerTriangle_IsEnough) {
    const TriangleMesh dense = dense_torus(0);
    Context context;
    const TriangleMesh light = decimated(dense, 1.2e-2, context);
    PointCloud points;
    Array<Vec3> positions;
    for (std::size_t i = 0; i < dense.positions.size(); i += dense.positions.size() / light.triangles.size())
        positions.push_back(dense.positions[i]);
    points.positions = std::move(positions);
    const PatchRun run = patched(light, {}, &points, 2);
    EXPECT_LT(rms_of(tessellate(run.result.patches, {8, {}}, context)), 0.5 * rms_of(light));
}

TEST(JointFit, OfFourTriangles_IsSound) {
    PointCloud points;
    Array<Vec3> positions;
    Random random(6);
    const TriangleMesh mesh =
        soup({{1, 1, 1}, {-1, -1, 1}, {-1, 1, -1}, {1, -1, -1}}, {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}});
    Vec3 centre = Vec3::Zero();
    for (const Vec3& p : mesh.positions) centre += p / 4;
    for (int i = 0; i < 400; ++i)
        positions.push_back(centre +
                            (mesh.positions[0] - centre).norm() *
                                Vec3(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)).normalized());
    points.positions = std::move(positions);
    const PatchRun fitted = patched(mesh, {}, &points);
    EXPECT_EQ(fitted.result.inverted + fitted.result.sign_violations, 0u);
    EXPECT_LT(fitted.result.c1_jump, 1e-9);
}

TEST(JointFit, CreasesKeepTheirVertices) {
    const TriangleMesh mesh = cylinder(12);
    PointCloud points;
    Array<Vec3> positions;
    Random random(4);
    for (int i = 0; i < 8000; ++i) {
        const double angle = random.uniform(0, 2 * std::numbers::pi), radius = std::sqrt(random.uniform(0, 1));
        const Vec3 out(std::cos(angle), std::sin(angle), 0);
        positions.push_back(i % 2 == 0 ? Vec3(out.x(), out.y(), random.uniform(-1, 1))
                                       : Vec3(radius * out.x(), radius * out.y(), i % 4 == 1 ? -1 : 1));
    }
    points.positions = std::move(positions);
    const PatchRun run = patched(mesh, {}, &points);
    for (const Edge& edge : mesh.sharp_edges)
        for (const u32 v : edge) EXPECT_EQ(run.result.mesh.positions[v], mesh.positions[v]);
    EXPECT_LT(worst_distance(run.result.patches, cylinder_distance), 4e-3);
}

}  // namespace
}  // namespace scanmill
