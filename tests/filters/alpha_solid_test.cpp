// SPDX-License-Identifier: GPL-3.0-or-later
#include "alpha_solid/alpha_solid.hpp"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>
#include <numbers>
#include <set>

#include "delaunay/delaunay.hpp"
#include "scanmill/filter/error.hpp"
#include "scanmill/geometry/topology.hpp"
#include "support/point_sets.hpp"
#include "support/shapes.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::HasSubstr;

TetMesh tets_of(const PointCloud& cloud) {
    Context context;
    return delaunay(cloud, {}, context).tets;
}

AlphaSolidResult solid_of(const TetMesh& tets, const AlphaSolidParams& params = {}, unsigned threads = 1) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    return alpha_solid(tets, params, context);
}
AlphaSolidResult solid_of(const PointCloud& cloud, const AlphaSolidParams& params = {}) {
    return solid_of(tets_of(cloud), params);
}

AlphaSolidParams at_alpha(double alpha) {
    AlphaSolidParams params;
    params.alpha = Length(alpha);
    return params;
}
AlphaSolidParams covering(double percent, AlphaComponents components = AlphaComponents::single) {
    AlphaSolidParams params;
    params.coverage = Ratio::percent(percent);
    params.components = components;
    return params;
}
AlphaSolidParams many() { return covering(100, AlphaComponents::many); }

/// V, E, F of the boundary, and that it is closed and outward round exactly the cells inside.
void expect_closed(const AlphaSolidResult& result, std::size_t vertices, long euler) {
    const MeshTopology facts = topology(result.mesh);
    EXPECT_TRUE(facts.closed);
    EXPECT_EQ(facts.unused_vertices, 0u);
    EXPECT_EQ(facts.vertices, vertices);
    EXPECT_EQ(facts.euler, euler);
    EXPECT_EQ(facts.triangles, static_cast<std::size_t>(2 * (static_cast<long>(vertices) - euler)));
    EXPECT_EQ(facts.components, result.components);
    EXPECT_EQ(result.nonmanifold_vertices, 0u);
}

double cell_volumes(const AlphaSolidResult& result) {
    double sum = 0;
    for (std::size_t c = 0; c < result.tets.cells.size(); ++c) {
        if (!result.tets.inside[c]) continue;
        const auto& [i, j, k, l] = result.tets.cells[c];
        const Vec3& a = result.tets.positions[i];
        const Vec3 u = result.tets.positions[j] - a, v = result.tets.positions[k] - a;
        sum += u.cross(v).dot(result.tets.positions[l] - a) / 6;
    }
    return sum;
}

using Point = std::array<double, 3>;
Point point(const Vec3& p) { return {p.x(), p.y(), p.z()}; }

/// The boundary as a set of oriented triangles between places, whatever the vertices' numbers.
std::set<std::array<Point, 3>> places(const TriangleMesh& mesh) {
    std::set<std::array<Point, 3>> result;
    for (const auto& [a, b, c] : mesh.triangles) {
        std::array<Point, 3> t{point(mesh.positions[a]), point(mesh.positions[b]), point(mesh.positions[c])};
        std::ranges::rotate(t, std::ranges::min_element(t));
        result.insert(t);
    }
    return result;
}

std::string refusal(const TetMesh& tets, const AlphaSolidParams& params) {
    try {
        solid_of(tets, params);
    } catch (const Error& error) {
        return error.what();
    }
    return "accepted";
}

TEST(AlphaSolid, CubeCorners_AreTheirHullAtHalfTheSquaresDiagonal) {
    for (double edge : {1.0, 0.001, 25.4}) {
        const AlphaSolidResult result = solid_of(lattice_cube(1, edge));
        EXPECT_NEAR(result.alpha, edge / std::numbers::sqrt2, 1e-12 * edge);
        EXPECT_EQ(result.alpha_cover, result.alpha);
        EXPECT_EQ(result.cells_inside, result.tets.cells.size());
        EXPECT_EQ(result.choice, AlphaChoice::scan);
        expect_closed(result, 8, 2);
        EXPECT_NEAR(signed_volume(result.mesh), edge * edge * edge, 1e-12 * edge * edge * edge);
    }
}

TEST(AlphaSolid, RegularTetrahedron_AppearsAtItsFacetsCircumradius) {
    const TetMesh tets = tets_of(vertices_of(regular_tetrahedron(1)));
    const AlphaSolidResult result = solid_of(tets);
    EXPECT_NEAR(result.alpha, 1 / std::sqrt(3.0), 1e-12);
    EXPECT_EQ(result.candidates, 1u);
    expect_closed(result, 4, 2);
    EXPECT_EQ(refusal(tets, at_alpha(0.57)),
              "alpha 0.57 u leaves no cell inside; the least that gives one is 0.57735, and 0.57735 covers 4 of 4 "
              "points\nhint: 'alpha: auto' finds the least alpha with a closed manifold boundary");
}

TEST(AlphaSolid, FibonacciSphere_IsClosedThroughAllItsPoints) {
    const AlphaSolidResult result = solid_of(fibonacci_sphere(500, 1e-4));
    EXPECT_NEAR(result.alpha_cover, 0.1218, 0.0005);
    expect_closed(result, 500, 2);
    EXPECT_EQ(result.interior_points.size() + result.uncovered_points.size(), 0u);
}

TEST(AlphaSolid, SphereSampling_CoversAtMostAtItsCoveringRadius) {
    // Every point of the sphere has a sample within `covering_radius`: no ball of that radius passes between samples.
    const PointCloud cloud = fibonacci_sphere(800);
    double covering_radius = 0;
    Random random(3);
    for (int i = 0; i < 20000; ++i) {
        const double x = random.normal(), y = random.normal();
        const Vec3 p = Vec3(x, y, random.normal()).normalized();
        double nearest = 2;
        for (const Vec3& sample : cloud.positions) nearest = std::min(nearest, (sample - p).norm());
        covering_radius = std::max(covering_radius, nearest);
    }
    EXPECT_LT(covering_radius, 0.15);
    const AlphaSolidResult result = solid_of(cloud);
    // The sampled maximum may miss the true one by as much as the random points are apart.
    EXPECT_LT(result.alpha_cover, covering_radius + 0.02);
    expect_closed(result, 800, 2);
}

TEST(AlphaSolid, PoissonTorus_HasItsGenusAndAllPoints) {
    const PointCloud cloud = poisson_torus(0.06, 0.4, 20000);
    const AlphaSolidResult result = solid_of(cloud);
    EXPECT_LT(result.alpha_cover, 0.1);
    EXPECT_EQ(result.choice, AlphaChoice::scan);
    expect_closed(result, cloud.size(), 0);
    // 2 π² R r², less what the chords cut off.
    EXPECT_NEAR(signed_volume(result.mesh), 2 * std::numbers::pi * std::numbers::pi * 0.16, 0.05);
}

TEST(AlphaSolid, LBlockOnALattice_IsExactAtHalfTheSquaresDiagonal) {
    const PointCloud cloud = l_block_surface(10, 2, 10);
    const AlphaSolidResult result = solid_of(cloud);
    EXPECT_NEAR(result.alpha, 0.1 / std::numbers::sqrt2, 1e-9);
    expect_closed(result, cloud.size(), 2);
    EXPECT_NEAR(signed_volume(result.mesh), 3, 1e-9);
}

TEST(AlphaSolid, LBlockAboveItsSpacing_FillsTheConcaveEdge) {
    const PointCloud cloud = l_block_surface(4, 2, 8, 2e-3);
    const AlphaSolidResult chosen = solid_of(cloud);
    const AlphaSolidResult result = solid_of(chosen.tets, at_alpha(1.6 * chosen.alpha_cover));
    EXPECT_GE(result.interior_points.size(), 7u);
    EXPECT_GT(signed_volume(result.mesh), 6.02);
    for (u32 vertex : result.interior_points) {
        const Vec3& p = cloud.positions[vertex];
        EXPECT_NEAR(p.x(), 1, 0.01);
        EXPECT_NEAR(p.y(), 1, 0.01);
    }
}

TEST(AlphaSolid, SurfaceOfALatticeCube_IsSolidThroughout) {
    // What walls enclose is inside, however large the cells.
    const AlphaSolidResult result = solid_of(lattice_cube(8, 0.125, true));
    EXPECT_EQ(result.cells_inside, result.tets.cells.size());
    expect_closed(result, 386, 2);
    EXPECT_NEAR(signed_volume(result.mesh), 1, 1e-12);
}

TEST(AlphaSolid, FilledLatticeCube_ReportsItsInteriorPoints) {
    const AlphaSolidResult result = solid_of(lattice_cube(6));
    EXPECT_NEAR(result.alpha, 1 / std::numbers::sqrt2, 1e-12);
    EXPECT_EQ(result.interior_points.size(), 125u);
    EXPECT_EQ(result.uncovered_points.size(), 0u);
    expect_closed(result, 343 - 125, 2);
    EXPECT_DOUBLE_EQ(signed_volume(result.mesh), 216);
}

TEST(AlphaSolid, GrowingAlpha_GrowsTheSolidUpToTheHull) {
    const TetMesh tets = tets_of(random_cube(400, 2));
    const AlphaSolidResult chosen = solid_of(tets);
    std::vector<u8> before(tets.cells.size(), 0);
    double volume = 0;
    for (double factor : {0.6, 0.8, 1.0, 1.1, 1.5, 3.0, 1e9}) {
        const AlphaSolidResult result = solid_of(tets, at_alpha(factor * chosen.alpha_cover));
        for (std::size_t c = 0; c < before.size(); ++c) EXPECT_LE(before[c], result.tets.inside[c]);
        before.assign(result.tets.inside.begin(), result.tets.inside.end());
        EXPECT_GE(cell_volumes(result), volume);
        volume = cell_volumes(result);
        EXPECT_NEAR(signed_volume(result.mesh), volume, 1e-12);
        EXPECT_EQ(result.choice, AlphaChoice::given);
        EXPECT_EQ(result.alpha_cover, chosen.alpha_cover);
    }
    EXPECT_EQ(std::ranges::count(before, 1), static_cast<long>(before.size()));
}

TEST(AlphaSolid, JustBelowAlphaCover_APointIsLeftUncovered) {
    for (const PointCloud& cloud : {random_cube(300, 4), fibonacci_sphere(300), lattice_cube(4)}) {
        const TetMesh tets = tets_of(cloud);
        const double cover = solid_of(tets).alpha_cover;
        EXPECT_EQ(solid_of(tets, at_alpha(cover)).uncovered_points.size(), 0u);
        try {
            EXPECT_GT(solid_of(tets, at_alpha(cover * (1 - 1e-9))).uncovered_points.size(), 0u);
        } catch (const Error& error) {
            EXPECT_THAT(error.what(), HasSubstr("leaves no cell inside"));  // lattices appear all at once
        }
    }
}

TEST(AlphaSolid, TheReportedAlpha_GivesTheSameSolidWhenGiven) {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        const TetMesh tets = tets_of(random_cube(200, seed));
        const AlphaSolidResult automatic = solid_of(tets);
        if (automatic.choice != AlphaChoice::scan) continue;
        const AlphaSolidResult given = solid_of(tets, at_alpha(automatic.alpha));
        EXPECT_TRUE(std::ranges::equal(given.tets.inside, automatic.tets.inside));
        EXPECT_EQ(given.candidates, automatic.candidates);
    }
}

TEST(AlphaSolid, TheScan_FindsTheLeastValidAlpha) {
    // Every smaller candidate from alpha_cover on is invalid, judged from outside by the mesh's topology.
    int beyond_cover = 0;
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        const TetMesh tets = tets_of(random_cube(60, seed));
        const AlphaSolidResult chosen = solid_of(tets);
        ASSERT_NE(chosen.choice, AlphaChoice::hull);
        if (chosen.choice != AlphaChoice::scan) continue;
        expect_closed(chosen, chosen.mesh.positions.size(), topology(chosen.mesh).euler);
        EXPECT_EQ(chosen.components, 1u);
        beyond_cover += chosen.alpha > chosen.alpha_cover;
        double alpha = chosen.alpha_cover;
        for (int guard = 0; alpha < chosen.alpha; ++guard) {
            ASSERT_LT(guard, 1000);
            const AlphaSolidResult smaller = solid_of(tets, at_alpha(alpha));
            EXPECT_TRUE(smaller.nonmanifold_vertices > 0 || smaller.components > 1);
            // The next candidate: bisect for the least alpha with more cells.
            double low = alpha, high = chosen.alpha;
            while (std::nextafter(low, high) < high) {
                const double middle = low + (high - low) / 2;
                (solid_of(tets, at_alpha(middle)).cells_inside > smaller.cells_inside ? high : low) = middle;
            }
            alpha = high;
        }
    }
    EXPECT_GT(beyond_cover, 2);
}

TEST(AlphaSolid, Bisection_GivesAValidSolidNotBelowTheScans) {
    for (std::uint64_t seed = 0; seed < 12; ++seed) {
        const TetMesh tets = tets_of(random_cube(80, seed));
        AlphaSolidParams params;
        params.search = AlphaSearch::binary;
        const AlphaSolidResult binary = solid_of(tets, params), scan = solid_of(tets);
        expect_closed(binary, binary.mesh.positions.size(), topology(binary.mesh).euler);
        EXPECT_EQ(binary.components, 1u);
        EXPECT_EQ(binary.choice, AlphaChoice::binary);
        EXPECT_EQ(binary.uncovered_points.size(), 0u);
        EXPECT_TRUE(scan.choice != AlphaChoice::scan || binary.alpha >= scan.alpha);
    }
}

/// Two unit-spaced lattice cubes that share exactly one corner: pinched there until alpha reaches across.
PointCloud cubes_sharing_a_corner() { return joined(lattice_cube(8), moved(lattice_cube(8), 1, Vec3(8, 8, 8))); }

TEST(AlphaSolid, CubesThatTouchInACorner_AreNotTakenForManifold) {
    const TetMesh tets = tets_of(cubes_sharing_a_corner());
    const AlphaSolidResult pinched = solid_of(tets, at_alpha(0.71));
    EXPECT_EQ(pinched.nonmanifold_vertices, 1u);
    EXPECT_EQ(pinched.nonmanifold_edges, 0u);
    EXPECT_EQ(pinched.components, 1u);
    for (const AlphaSolidParams& params : {AlphaSolidParams{}, many()}) {
        const AlphaSolidResult result = solid_of(tets, params);
        EXPECT_EQ(topology(result.mesh).nonmanifold_vertices, 0u);
        EXPECT_GT(result.alpha, 0.71);
        EXPECT_GT(result.cells_inside, pinched.cells_inside);
        EXPECT_NEAR(result.alpha_cover, 1 / std::numbers::sqrt2, 1e-9);
        expect_closed(result, result.mesh.positions.size(), 2);
        EXPECT_EQ(result.uncovered_points.size(), 0u);
    }
}

/// Two needles that share their tip and point away from each other: each appears at about half its length, but the
/// least circumsphere that reaches from one into the other is many times larger.
PointCloud opposite_needles() {
    Array<Vec3> positions{Vec3(0, 0, 0)};
    for (double end : {1.0, -1.0})
        for (int i = 0; i < 3; ++i) {
            const double angle = end + 2 * std::numbers::pi * i / 3;
            positions.push_back(Vec3(0.05 * std::cos(angle), 0.05 * std::sin(angle), end));
        }
    PointCloud cloud;
    cloud.positions = std::move(positions);
    return cloud;
}

TEST(AlphaSolid, OppositeNeedles_AreClosedRoundTheirCommonTip) {
    const TetMesh tets = tets_of(opposite_needles());
    std::vector<std::string> warnings;
    ContextOptions options;
    options.on_warning = [&](std::string_view text) { warnings.emplace_back(text); };
    Context context(options);
    const AlphaSolidResult result = alpha_solid(tets, {}, context);
    EXPECT_EQ(result.choice, AlphaChoice::repaired);
    EXPECT_EQ(result.alpha, result.alpha_cover);
    EXPECT_NEAR(result.alpha, 0.5, 0.01);
    EXPECT_THAT(warnings, testing::ElementsAre(HasSubstr("was closed round its non-manifold vertices")));
    expect_closed(result, 7, 2);
    // The two needles were all that alpha gave; the repair has added to them without filling the hull.
    const AlphaSolidResult before = solid_of(tets, at_alpha(result.alpha));
    EXPECT_EQ(before.cells_inside, 2u);
    EXPECT_EQ(before.nonmanifold_vertices, 1u);
    EXPECT_GT(result.cells_inside, 2u);
    EXPECT_LT(result.cells_inside, tets.cells.size());
    for (std::size_t c = 0; c < tets.cells.size(); ++c) EXPECT_LE(before.tets.inside[c], result.tets.inside[c]);
    for (std::uint64_t seed : {1, 2, 3})
        EXPECT_EQ(places(solid_of(shuffled(opposite_needles(), seed)).mesh), places(result.mesh));
}

PointCloud two_spheres() {
    return joined(fibonacci_sphere(600, 1e-4), moved(fibonacci_sphere(300, 1e-4, 2), 0.5, Vec3(3, 0, 0)));
}

TEST(AlphaSolid, TwoObjects_StayTwoWhenManyAreAllowed) {
    const AlphaSolidResult result = solid_of(two_spheres(), many());
    EXPECT_EQ(result.components, 2u);
    expect_closed(result, 900, 4);
    EXPECT_EQ(result.uncovered_points.size(), 0u);
}

TEST(AlphaSolid, TwoObjects_AreBridgedWhenOneIsAskedForWithAllPoints) {
    const AlphaSolidResult result = solid_of(two_spheres());
    EXPECT_EQ(result.components, 1u);
    EXPECT_EQ(result.uncovered_points.size(), 0u);
    EXPECT_GT(result.alpha, solid_of(two_spheres(), many()).alpha);
    expect_closed(result, result.mesh.positions.size(), 2);
}

TEST(AlphaSolid, TheLargerObject_IsKeptWhenItsShareIsEnough) {
    const TetMesh tets = tets_of(two_spheres());
    std::vector<std::string> warnings;
    ContextOptions options;
    options.on_warning = [&](std::string_view text) { warnings.emplace_back(text); };
    Context context(options);
    const AlphaSolidResult result = alpha_solid(tets, covering(66), context);
    EXPECT_EQ(result.components, 1u);
    expect_closed(result, 600, 2);
    EXPECT_EQ(result.uncovered_points.size(), 300u);
    EXPECT_EQ(result.uncovered_points[0], 600u);
    EXPECT_GT(result.cells_left_out, 0u);
    EXPECT_THAT(warnings, testing::ElementsAre(HasSubstr("300 of 900 points are not in or on the solid")));
    // A larger share than one object has needs both.
    const AlphaSolidResult both = solid_of(tets, covering(67));
    EXPECT_EQ(both.components, 1u);
    EXPECT_GE(900 - both.uncovered_points.size(), 603u);
    expect_closed(both, both.mesh.positions.size(), 2);
}

PointCloud sphere_with_outliers() {
    Array<Vec3> far;
    for (int i = 0; i < 5; ++i) far.push_back(Vec3(3 + i, 2 * i, 1 - i));
    PointCloud outliers;
    outliers.positions = std::move(far);
    return joined(outliers, fibonacci_sphere(995, 1e-4));
}

TEST(AlphaSolid, Outliers_AreLeftOutAndReportedWhenTheShareAllowsIt) {
    const TetMesh tets = tets_of(sphere_with_outliers());
    EXPECT_GT(solid_of(tets).alpha, 1);
    for (AlphaComponents components : {AlphaComponents::single, AlphaComponents::many}) {
        const AlphaSolidResult result = solid_of(tets, covering(99.5, components));
        EXPECT_LT(result.alpha, 0.2);
        EXPECT_THAT(result.uncovered_points.span(), testing::ElementsAre(0, 1, 2, 3, 4));
        expect_closed(result, 995, 2);
        EXPECT_GT(solid_of(tets, covering(99.6, components)).alpha, 0.5);
    }
}

TEST(AlphaSolid, AnyShareOfRandomPoints_IsHeldByOneClosedManifold) {
    // Random clumps: solids of many sizes that touch and merge.
    int kept_apart = 0;
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        PointCloud cloud = random_cube(40, seed);
        for (int clump = 0; clump < 4; ++clump)
            cloud = joined(cloud, moved(random_cube(40, 100 + seed), 0.2, random_cube(4, 200 + seed).positions[clump]));
        const TetMesh tets = tets_of(cloud);
        for (double share : {50.0, 75.0, 90.0, 99.0})
            for (AlphaComponents components : {AlphaComponents::single, AlphaComponents::many}) {
                const AlphaSolidResult result = solid_of(tets, covering(share, components));
                expect_closed(result, result.mesh.positions.size(), topology(result.mesh).euler);
                EXPECT_GE(200 - result.uncovered_points.size(), 2 * share);
                EXPECT_EQ(200 - result.uncovered_points.size(),
                          result.interior_points.size() + result.mesh.positions.size());
                if (components == AlphaComponents::single) {
                    EXPECT_EQ(result.components, 1u);
                    kept_apart += result.cells_left_out > 0;
                }
            }
    }
    EXPECT_GT(kept_apart, 10);
}

TEST(AlphaSolid, PointsInAnyOrder_GiveTheSameSolid) {
    const std::vector<PointCloud> clouds{random_cube(300, 3),        lattice_cube(5),
                                         l_block_surface(5, 1, 5),   cubes_sharing_a_corner(),
                                         lattice_cube(7, 0.1, true), two_spheres()};
    for (const PointCloud& cloud : clouds) {
        const AlphaSolidResult expected = solid_of(cloud);
        for (std::uint64_t seed : {1, 2, 3}) {
            const AlphaSolidResult result = solid_of(shuffled(cloud, seed));
            EXPECT_EQ(result.alpha, expected.alpha);
            EXPECT_EQ(result.alpha_cover, expected.alpha_cover);
            EXPECT_EQ(result.choice, expected.choice);
            EXPECT_EQ(places(result.mesh), places(expected.mesh));
        }
    }
}

TEST(AlphaSolid, AnyNumberOfThreads_GivesTheSameBytes) {
    for (const PointCloud& cloud : {random_cube(20000, 5), fibonacci_sphere(30000, 1e-4), lattice_cube(20)})
        for (AlphaComponents components : {AlphaComponents::single, AlphaComponents::many})
            for (double share : {100.0, 99.0}) {
                const TetMesh tets = tets_of(cloud);
                const AlphaSolidResult one = solid_of(tets, covering(share, components), 1);
                const AlphaSolidResult two = solid_of(tets, covering(share, components), 2);
                EXPECT_EQ(one.alpha, two.alpha);
                EXPECT_TRUE(std::ranges::equal(one.tets.inside, two.tets.inside));
                EXPECT_TRUE(std::ranges::equal(one.mesh.triangles, two.mesh.triangles));
                EXPECT_TRUE(std::ranges::equal(one.mesh.positions, two.mesh.positions));
                EXPECT_TRUE(std::ranges::equal(one.interior_points, two.interior_points));
                EXPECT_TRUE(std::ranges::equal(one.uncovered_points, two.uncovered_points));
            }
}

TEST(AlphaSolid, ScaledPoints_ScaleAlpha) {
    const PointCloud cloud = poisson_torus(0.15, 0.4, 5000);
    const AlphaSolidResult base = solid_of(cloud);
    for (double factor : {0x1p-30, 0.3, 1000.0}) {
        const AlphaSolidResult scaled = solid_of(moved(cloud, factor));
        EXPECT_NEAR(scaled.alpha / factor / base.alpha, 1, 1e-9);
        EXPECT_EQ(scaled.mesh.triangles.size(), base.mesh.triangles.size());
    }
}

TEST(AlphaSolid, MovedAndTurnedPoints_GiveTheSameAlpha) {
    const PointCloud cloud = poisson_torus(0.15, 0.4, 5000);
    const AlphaSolidResult base = solid_of(cloud);
    for (const PointCloud& other : {rotated(cloud, 0.6), moved(cloud, 1, Vec3(1e6, -3e5, 20))}) {
        const AlphaSolidResult result = solid_of(other);
        EXPECT_NEAR(result.alpha / base.alpha, 1, 1e-6);
        EXPECT_EQ(result.mesh.triangles.size(), base.mesh.triangles.size());
    }
}

TEST(AlphaSolid, ColumnsAndFrame_TravelWithTheVertices) {
    PointCloud cloud = lattice_cube(4);
    Array<u32> rows(cloud.size());
    for (u32 i = 0; i < rows.size(); ++i) rows[i] = i;
    cloud.columns.add(Column("row", 1, Buffer<u32>(std::move(rows))));
    cloud.frame = {LengthUnit::millimetre, Vec3(1000, 0, 0), "part"};
    const AlphaSolidResult result = solid_of(cloud);
    EXPECT_EQ(result.mesh.frame, cloud.frame);
    const Column* column = result.mesh.vertex_columns.find("row");
    ASSERT_NE(column, nullptr);
    for (std::size_t i = 0; i < result.mesh.positions.size(); ++i)
        EXPECT_EQ(result.mesh.positions[i], cloud.positions[column->values<u32>()[i]]);
    EXPECT_TRUE(std::ranges::is_sorted(column->values<u32>()));
}

TEST(AlphaSolid, Metrics_AreTheResultsNumbers) {
    const TetMesh tets = tets_of(lattice_cube(6));
    Context context;
    const AlphaSolidResult result = alpha_solid(tets, {}, context);
    const auto value = [&](std::string_view name) { return context.metrics().find(name)->value; };
    EXPECT_EQ(value("alpha"), result.alpha);
    EXPECT_EQ(context.metrics().find("alpha")->unit, Unit::length);
    EXPECT_EQ(value("alpha-cover"), result.alpha_cover);
    EXPECT_EQ(value("cells"), static_cast<double>(tets.cells.size()));
    EXPECT_EQ(value("interior-points"), 125);
    EXPECT_EQ(value("uncovered-points"), 0);
    EXPECT_EQ(value("triangles"), static_cast<double>(2 * 218 - 4));
    EXPECT_TRUE(context.warnings().empty());
}

TEST(AlphaSolid, GivenAlphaWithADefectiveBoundary_WarnsWithNumbers) {
    Context context;
    alpha_solid(tets_of(cubes_sharing_a_corner()), at_alpha(0.71), context);
    ASSERT_EQ(context.warnings().size(), 1u);
    EXPECT_THAT(context.warnings()[0], HasSubstr("1 non-manifold vertices and 0 edges"));
}

TEST(AlphaSolid, NonsenseParameters_AreRefused) {
    const TetMesh tets = tets_of(lattice_cube(1));
    EXPECT_THAT(refusal(tets, at_alpha(0)), HasSubstr("alpha must be a length above 0; it is 0 u"));
    EXPECT_THAT(refusal(tets, at_alpha(-1)), HasSubstr("above 0; it is -1 u"));
    EXPECT_THAT(refusal(tets, at_alpha(std::nan(""))), HasSubstr("alpha must be a length above 0"));
    EXPECT_THAT(refusal(tets, at_alpha(HUGE_VAL)), HasSubstr("alpha must be a length above 0"));
    EXPECT_THAT(refusal(tets, covering(0)), HasSubstr("coverage must be above 0 % and at most 100 %; it is 0 %"));
    EXPECT_THAT(refusal(tets, covering(101)), HasSubstr("it is 101 %"));
}

TEST(AlphaSolid, TetrahedralisationWithoutCells_IsRefused) {
    EXPECT_THAT(refusal(TetMesh{}, {}), HasSubstr("needs a tetrahedralisation with cells; this one has none"));
    TetMesh tets = tets_of(lattice_cube(1));
    tets.neighbours = Buffer<std::array<u32, 4>>();
    EXPECT_THAT(refusal(tets, {}), HasSubstr("there are 0"));
}

TEST(AlphaSolid, SizesWhoseSquaresAreNoNumbers_AreRefused) {
    EXPECT_THAT(refusal(tets_of(lattice_cube(1, 1e-120)), {}), HasSubstr("between 1e-100 and 1e100 in size"));
    EXPECT_NEAR(solid_of(lattice_cube(2, 1e-90)).alpha / 1e-90, 1 / std::numbers::sqrt2, 1e-9);
    EXPECT_NEAR(solid_of(lattice_cube(2, 1e90)).alpha / 1e90, 1 / std::numbers::sqrt2, 1e-9);
}

TEST(AlphaSolid, WhenCancelled_StopsWithCancelled) {
    const TetMesh tets = tets_of(random_cube(20000, 1));
    int asked = 0;
    ContextOptions options;
    options.is_cancelled = [&] { return ++asked > 12; };
    Context context(options);
    EXPECT_THROW(alpha_solid(tets, {}, context), Cancelled);
}

}  // namespace
}  // namespace scanmill
