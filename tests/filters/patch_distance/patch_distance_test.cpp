// SPDX-License-Identifier: GPL-3.0-or-later
#include "patch_distance/patch_distance.hpp"

#include "filters/a_patch/sharp_cases.hpp"
#include "tessellate/tessellate.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::ElementsAre;
using testing::HasSubstr;

PatchDistanceResult measured(const PatchComplex& patches, const PointCloud& points, Context& context) {
    return patch_distance(patches, points, context);
}

const PatchComplex& unit_sphere() {
    static const PatchComplex patches = patched(exact_sphere(2), Curvature::mean).result.patches;
    return patches;
}

PointCloud around_sphere(std::size_t count, double least, double most) {
    Random random(2);
    Array<Vec3> points;
    for (const Vec3& p : random_sphere(count, 1).positions) points.push_back(p * random.uniform(least, most));
    PointCloud cloud;
    cloud.positions = std::move(points);
    return cloud;
}

TEST(PatchDistance, OfASphere_IsTheSignedDistanceToIt) {
    Context context;
    const PointCloud points = around_sphere(2000, 0.7, 1.3);  // up to 0.3: a tenth of the diagonal is 0.35
    const PatchDistanceResult result = measured(unit_sphere(), points, context);
    const Column* column = result.points.columns.find("distance-to-patches");
    ASSERT_TRUE(column);
    EXPECT_EQ(column->length_exponent(), 1);
    double squares = 0;
    std::vector<double> sorted;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double wanted = points.positions[i].norm() - 1, found = column->number(i);
        ASSERT_FALSE(std::isnan(found)) << points.positions[i].norm();
        EXPECT_NEAR(found, wanted, 1e-14);
        squares += wanted * wanted;
        sorted.push_back(std::abs(wanted));
    }
    std::ranges::sort(sorted);
    EXPECT_EQ(result.unlocated, 0u);
    EXPECT_THAT(context.warnings(), testing::IsEmpty());
    EXPECT_NEAR(result.rms, std::sqrt(squares / 2000), 1e-14);
    EXPECT_NEAR(result.max, sorted[1999], 1e-14);
    EXPECT_NEAR(result.p95, sorted[1899], 1e-14);
}

TEST(PatchDistance, ByHand) {
    Context context;
    // Five points on a line through a vertex: the gradient there is radial.
    PointCloud points;
    const Vec3 v = exact_sphere(2).positions[0];
    points.positions = {v, v * 1.01, v * 0.99, v * 1.005, v * 50};
    points.columns.add(Column("weight", 1, Buffer<double>{1, 2, 3, 4, 5}));
    const PatchDistanceResult result = measured(unit_sphere(), points, context);
    const Column* column = result.points.columns.find("distance-to-patches");
    EXPECT_NEAR(column->number(0), 0, 1e-15);
    EXPECT_NEAR(column->number(1), 0.01, 1e-14);
    EXPECT_NEAR(column->number(2), -0.01, 1e-14);
    EXPECT_NEAR(column->number(3), 0.005, 1e-14);
    EXPECT_TRUE(std::isnan(column->number(4)));
    // The four distances are 0, 0.005, 0.01 and 0.01.
    EXPECT_NEAR(result.rms, 0.0075, 1e-14);
    EXPECT_NEAR(result.p95, 0.01, 1e-14);
    EXPECT_NEAR(result.max, 0.01, 1e-14);
    std::map<std::string, double> metrics;
    for (const Metric& metric : context.metrics().values) metrics[metric.name] = metric.value;
    EXPECT_EQ(metrics, (std::map<std::string, double>{
                           {"rms", result.rms}, {"p95", result.p95}, {"max", result.max}, {"unlocated", 1}}));
    EXPECT_EQ(result.points.columns.find("weight")->number(4), 5);
    EXPECT_EQ(result.unlocated, 1u);
    EXPECT_THAT(context.warnings(), ElementsAre(HasSubstr("of 5 points")));
}

TEST(PatchDistance, OfATorus_IsTheLeastDistanceFoundByBruteForce) {
    const PatchComplex patches = patched(exact_torus(12, 6)).result.patches;
    Execution execution;
    const TriangleMesh fine = tessellate(patches, {32, {}}, execution);
    const TriangleTree tree(fine.positions.span(), fine.triangles.span(), 1);
    Random random(3);
    Array<Vec3> positions;
    for (int i = 0; i < 500; ++i)
        positions.emplace_back(random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5), random.uniform(-0.6, 0.6));
    PointCloud points;
    points.positions = positions;
    Context context;
    const PatchDistanceResult result = measured(patches, points, context);
    const Column* column = result.points.columns.find("distance-to-patches");
    const PatchSurface surface(patches);
    const double limit = 0.1 * surface_box(fine).diagonal();
    std::size_t located = 0;
    for (std::size_t i = 0; i < positions.size(); ++i) {
        const double wanted = std::sqrt(tree.nearest(positions[i]).squared_distance), found = column->number(i);
        if (std::abs(wanted - limit) < 1e-2) continue;
        EXPECT_EQ(std::isnan(found), wanted > limit) << wanted;
        if (std::isnan(found)) continue;
        ++located;
        // The axis of the tube is equally far from everywhere.
        EXPECT_NEAR(std::abs(found), wanted, wanted < 0.25 ? 1e-3 : 2e-2);
        EXPECT_EQ(found < 0, surface.is_inside(positions[i]));
    }
    EXPECT_GT(located, 200u);
}

TEST(PatchDistance, OfACube_IsExactBesideItsEdgesAndCorners) {
    const PatchComplex patches = patched(sharp_cube()).result.patches;
    Random random(5);
    Array<Vec3> positions;
    for (int i = 0; i < 2000; ++i)
        positions.emplace_back(random.uniform(-0.09, 1.09), random.uniform(-0.09, 1.09), random.uniform(-0.09, 1.09));
    PointCloud points;
    points.positions = positions;
    Context context;
    const PatchDistanceResult result = measured(patches, points, context);
    const Column* column = result.points.columns.find("distance-to-patches");
    std::size_t located = 0;
    for (std::size_t i = 0; i < positions.size(); ++i) {
        const Vec3 beyond = (positions[i] - Vec3::Constant(0.5)).cwiseAbs() - Vec3::Constant(0.5);
        const double wanted = beyond.maxCoeff() < 0 ? beyond.maxCoeff() : beyond.cwiseMax(0).norm();
        EXPECT_EQ(std::isnan(column->number(i)), std::abs(wanted) > 0.1 * std::sqrt(3.0)) << wanted;
        if (std::isnan(column->number(i))) continue;
        EXPECT_NEAR(column->number(i), wanted, 1e-12);
        ++located;
    }
    EXPECT_GT(located, 1000u);
}

TEST(PatchDistance, OfPointsEquallyNearToTwoSides_IsThatToEither) {
    const TriangleMesh flat =
        with_positions(sharp_cube(), [](const Vec3& p) { return Vec3(p.x(), p.y(), 0.125 * p.z()); });
    PointCloud points;
    points.positions = {Vec3(0.5, 0.5, 0.0625), Vec3(0.3, 0.6, 0.0625)};
    Context context;
    const PatchDistanceResult result = measured(patched(flat).result.patches, points, context);
    for (std::size_t i = 0; i < 2; ++i)
        EXPECT_NEAR(result.points.columns.find("distance-to-patches")->number(i), -0.0625, 1e-14);
}

TEST(PatchDistance, BeyondACornerOfAnOpenSurface_IsPositive) {
    // Two cubes. The second one is open towards the first, so that a ray meets it from inside.
    const TriangleMesh one = sharp_cube();
    std::vector<Vec3> positions(one.positions.begin(), one.positions.end());
    std::vector<Triangle> triangles(one.triangles.begin(), one.triangles.end());
    std::vector<Edge> sharp(one.sharp_edges.begin(), one.sharp_edges.end());
    for (const Vec3& p : one.positions) positions.emplace_back(p + Vec3(2, 0.5, 0.5));
    for (Triangle t : one.triangles) {
        if (std::ranges::all_of(t, [&](u32 v) { return one.positions[v].x() == 0; })) continue;
        for (u32& v : t) v += 8;
        triangles.push_back(t);
    }
    for (const Edge& edge : one.sharp_edges) sharp.push_back(make_edge(edge[0] + 8, edge[1] + 8));
    std::ranges::sort(sharp);
    TriangleMesh mesh = soup({positions.begin(), positions.end()}, {triangles.begin(), triangles.end()});
    mesh.sharp_edges = Array<Edge>(sharp.begin(), sharp.end());
    ASSERT_EQ(mesh.triangles.size(), 22u);
    const PatchComplex patches = patched(mesh).result.patches;
    PointCloud points;
    points.positions = {Vec3(1.05, 1.05, 1.05), Vec3(1.1, 1.1, 1.2), Vec3(1.1, 0.9, 0.9), Vec3(0.9, 0.8, 0.7)};
    Context context;
    const PatchDistanceResult result = measured(patches, points, context);
    const Column* column = result.points.columns.find("distance-to-patches");
    const double expected[] = {0.05 * std::sqrt(3.0), 0.1 * std::sqrt(6.0), 0.1, -0.1};
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(column->number(i), expected[i], 1e-12) << i;
}

TEST(PatchDistance, OfARoundRim_IsTheDistanceToTheCircle) {
    const PatchComplex patches = patched(cylinder(32)).result.patches;
    Random random(6);
    Array<Vec3> positions;
    for (int i = 0; i < 1000; ++i) {
        const double angle = random.uniform(0, 2 * std::numbers::pi), radius = random.uniform(0.9, 1.15),
                     z = random.uniform(0.9, 1.15);
        positions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    }
    PointCloud points;
    points.positions = positions;
    Context context;
    const PatchDistanceResult result = measured(patches, points, context);
    const Column* column = result.points.columns.find("distance-to-patches");
    std::size_t worse = 0;
    for (std::size_t i = 0; i < positions.size(); ++i) {
        const double out = std::hypot(positions[i].x(), positions[i].y()) - 1, up = positions[i].z() - 1;
        const double wanted =
            std::max(out, up) < 0 ? std::max(out, up) : std::hypot(std::max(out, 0.), std::max(up, 0.));
        const double error = std::abs(column->number(i) - wanted);
        // Inside, wall and top may be equally near within the error of the first tessellation. Where the way to the
        // boundary's part beside the next edge leaves the tetrahedra, the distance is that to the tessellation.
        EXPECT_LT(error, wanted < 0 && std::abs(out - up) < 5e-3 ? 5e-3 : 1.2e-3) << out << " " << up;
        worse += error > 3e-5;
    }
    EXPECT_LE(worse, 10u);
    EXPECT_EQ(result.unlocated, 0u);
}

TEST(PatchDistance, AboveTheHoleOfAnOpenSurface_ThereIsNone) {
    const TriangleMesh whole = geodesic_sphere(1, 2);
    const Vec3 above = (whole.positions[whole.triangles[0][0]] + whole.positions[whole.triangles[0][1]] +
                        whole.positions[whole.triangles[0][2]])
                           .normalized();
    const PatchComplex patches = patched(without_triangles(whole, {0}), Curvature::mean).result.patches;
    PointCloud points;
    points.positions = {above, -above, Vec3(-1.1 * above)};
    Context context;
    const PatchDistanceResult result = measured(patches, points, context);
    const Column* column = result.points.columns.find("distance-to-patches");
    EXPECT_TRUE(std::isnan(column->number(0)));
    EXPECT_NEAR(column->number(1), 0, 1e-14);
    EXPECT_NEAR(column->number(2), 0.1, 1e-14);
    EXPECT_EQ(result.unlocated, 1u);
}

TEST(PatchDistance, AnExistingColumn_IsReplacedWithAWarning) {
    Context context;
    PointCloud points;
    points.positions = {exact_sphere(2).positions[0]};
    points.columns.add(Column("distance-to-patches", 1, Buffer<double>{7}));
    const PatchDistanceResult result = measured(unit_sphere(), points, context);
    EXPECT_NEAR(result.points.columns.find("distance-to-patches")->number(0), 0, 1e-15);
    EXPECT_THAT(context.warnings(), ElementsAre(HasSubstr("is replaced")));
}

TEST(PatchDistance, AnyNumberOfThreads_GivesTheSameBits) {
    ContextOptions four;
    four.threads = 4;
    Context one, many(four);
    const PointCloud points = around_sphere(5000, 0.98, 1.02);
    const PatchDistanceResult a = measured(unit_sphere(), points, one), b = measured(unit_sphere(), points, many);
    EXPECT_TRUE(std::ranges::equal(a.points.columns.find("distance-to-patches")->bytes(),
                                   b.points.columns.find("distance-to-patches")->bytes()));
    EXPECT_EQ(a.rms, b.rms);
}

TEST(PatchDistanceRefuses, NothingToMeasure) {
    Context context;
    const Error empty = error_of([&] { measured({}, around_sphere(3, 1, 1.01), context); });
    EXPECT_THAT(empty.sentence(), HasSubstr("no tetra"));
    EXPECT_FALSE(empty.hint().empty());
    const Error pointless = error_of([&] { measured(unit_sphere(), {}, context); });
    EXPECT_THAT(pointless.sentence(), HasSubstr("needs points"));
    EXPECT_FALSE(pointless.hint().empty());
    PointCloud elsewhere = around_sphere(3, 1, 1.01);
    elsewhere.frame.unit = LengthUnit::metre;
    EXPECT_EQ(error_of([&] { measured(unit_sphere(), elsewhere, context); }).sentence(),
              "the points are in m, the patches in u; both need one unit");
    const Error far = error_of([&] { measured(unit_sphere(), around_sphere(3, 5, 6), context); });
    EXPECT_THAT(far.sentence(), HasSubstr("none of 3 points"));
    EXPECT_FALSE(far.hint().empty());
    PointCloud invalid;
    invalid.positions = {Vec3(0, std::nan(""), 1)};
    EXPECT_THROW(measured(unit_sphere(), invalid, context), Error);
}

}  // namespace
}  // namespace scanmill
