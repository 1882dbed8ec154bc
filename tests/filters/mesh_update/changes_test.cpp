// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_update/changes.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "filters/mesh_update/changes_cases.hpp"
#include "scanmill/base/random.hpp"
#include "support/shapes.hpp"

namespace scanmill::updating {
namespace {

using namespace test;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

/// Errors that the header states, as shares of added + removed, for changes of a few hundred triangles and of
/// thousands.
constexpr double coarse = 1e-3, fine = 1e-5;

void expect_volumes(const Change& change, double added, double removed, double tolerance) {
    EXPECT_NEAR(change.volume_added, added, tolerance * (added + removed));
    EXPECT_NEAR(change.volume_removed, removed, tolerance * (added + removed));
    EXPECT_NEAR(change.volume_added - change.volume_removed, added - removed, 1e-12 * (added + removed));
}

TEST(Changes, Tetrahedron_WithAHigherApex) {
    const TriangleMesh low =
        soup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
    TriangleMesh high = low;
    high.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 3}};
    const std::vector<Change> grown = Difference(low, high).changes();
    ASSERT_THAT(grown, SizeIs(1));
    EXPECT_THAT(grown[0].old_triangles, ElementsAre(0, 1, 2)) << "all but the base";
    EXPECT_THAT(grown[0].new_triangles, ElementsAre(0, 1, 2));
    // Two right triangles of 1 by 3, and one with the sides √2, √10 and √10.
    EXPECT_NEAR(grown[0].area, 3 + std::sqrt(19) / 2, 1e-14);
    EXPECT_NEAR(grown[0].volume_added, 2.0 / 6, 1e-15);
    EXPECT_EQ(grown[0].volume_removed, 0);
    const std::vector<Change> shrunk = Difference(high, low).changes();
    ASSERT_THAT(shrunk, SizeIs(1));
    EXPECT_NEAR(shrunk[0].area, 1 + std::numbers::sqrt3 / 2, 1e-14);
    EXPECT_EQ(shrunk[0].volume_added, 0);
    EXPECT_NEAR(shrunk[0].volume_removed, 2.0 / 6, 1e-15);
}

const Cubes plate = block({0, 0, 0}, {12, 10, 3});

TEST(Changes, PadOnAPlate_OnlyAdds) {
    const TriangleMesh before = surface_of(plate), after = surface_of(with(plate, block({3, 2, 3}, {8, 6, 5})));
    const std::vector<Change> found = Difference(before, after).changes();
    ASSERT_THAT(found, SizeIs(1));
    EXPECT_THAT(found[0].old_triangles, SizeIs(2 * 5 * 4));
    EXPECT_THAT(found[0].new_triangles, SizeIs(2 * (5 * 4 + 2 * 2 * (5 + 4))));
    EXPECT_NEAR(found[0].area, 5 * 4 + 2 * 2 * (5 + 4), 1e-12);
    EXPECT_NEAR(found[0].volume_added, 40, 1e-12);
    EXPECT_EQ(found[0].volume_removed, 0);
}

TEST(Changes, PocketInAPlate_OnlyRemoves) {
    const TriangleMesh before = surface_of(plate), after = surface_of(without(plate, block({3, 2, 1}, {8, 6, 3})));
    const std::vector<Change> found = Difference(before, after).changes();
    ASSERT_THAT(found, SizeIs(1));
    EXPECT_NEAR(found[0].area, 5 * 4 + 2 * 2 * (5 + 4), 1e-12);
    EXPECT_EQ(found[0].volume_added, 0);
    EXPECT_NEAR(found[0].volume_removed, 40, 1e-12);
}

TEST(Changes, Hole_ThroughThePlate) {
    const std::vector<Change> found =
        Difference(surface_of(plate), surface_of(without(plate, block({3, 2, 0}, {8, 6, 3})))).changes();
    ASSERT_THAT(found, SizeIs(1)) << "the walls connect the top to the bottom";
    EXPECT_NEAR(found[0].volume_removed, 60, 1e-12);
}

TEST(Changes, PadBesidePocket_IsOneChangeThatDoesBoth) {
    const TriangleMesh before = surface_of(plate),
                       after =
                           surface_of(without(with(plate, block({2, 2, 3}, {3, 9, 8})), block({3, 3, 0}, {10, 7, 3})));
    Random random(5);
    for (int turn = 0; turn < 20; ++turn) {
        const double angle = turn == 0 ? 0 : random.uniform(0, 6);
        const Vec3 axis(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
        const std::vector<Change> found = Difference(turned(before, angle, axis), turned(after, angle, axis)).changes();
        ASSERT_THAT(found, SizeIs(1));
        expect_volumes(found[0], 35, 84, coarse);
    }
}

TEST(Changes, SeparateChanges_AreOrderedByTheirLowestOldTriangles) {
    // The triangles of `before` are ordered by x.
    const Cubes changed = without(with(plate, block({8, 2, 3}, {10, 4, 6})), block({2, 2, 2}, {5, 4, 3}));
    const Difference difference(surface_of(plate), surface_of(changed));
    const std::vector<Change> found = difference.changes();
    ASSERT_THAT(found, SizeIs(2));
    EXPECT_EQ(found[0].old_triangles[0], 0u);
    expect_volumes(found[0], 0, 6, 1e-12);
    expect_volumes(found[1], 12, 0, 1e-12);
    EXPECT_EQ(found[0].old_triangles.size() + found[1].old_triangles.size(), difference.old_triangles.size());
    EXPECT_EQ(found[0].new_triangles.size() + found[1].new_triangles.size(), difference.new_triangles.size());
    for (const Change& change : found) {
        EXPECT_TRUE(std::ranges::is_sorted(change.old_triangles));
        EXPECT_TRUE(std::ranges::is_sorted(change.new_triangles));
    }
}

TEST(Changes, NewCavity_HasNoOldTriangles_AndIsLast) {
    const Cubes hollow = without(plate, {{1, 1, 1}, {9, 8, 1}});
    const Difference opened(surface_of(plate), surface_of(with(hollow, {{5, 5, 3}})));
    const std::vector<Change> found = opened.changes();
    ASSERT_THAT(found, SizeIs(3));
    expect_volumes(found[0], 1, 0, 1e-12);
    for (const std::size_t i : {1, 2}) {
        EXPECT_THAT(found[i].old_triangles, IsEmpty());
        EXPECT_THAT(found[i].new_triangles, SizeIs(12));
        EXPECT_NEAR(found[i].area, 6, 1e-14);
        expect_volumes(found[i], 0, 1, 1e-12);
    }
    EXPECT_LT(found[1].new_triangles[0], found[2].new_triangles[0]);

    const std::vector<Change> filled = Difference(surface_of(hollow), surface_of(plate)).changes();
    ASSERT_THAT(filled, SizeIs(2));
    EXPECT_THAT(filled[0].new_triangles, IsEmpty());
    EXPECT_EQ(filled[0].area, 0);
    expect_volumes(filled[0], 1, 0, 1e-12);
}

TEST(Changes, ChangeInsideAnotherOne_IsMeasuredByItself) {
    const std::vector<Change> found =
        Difference(surface_of(plate), surface_of(without(with(plate, block({2, 2, 3}, {7, 7, 8})), {{4, 4, 5}})))
            .changes();
    ASSERT_THAT(found, SizeIs(2));
    expect_volumes(found[0], 125, 0, 1e-12);
    expect_volumes(found[1], 0, 1, 1e-12);
}

TEST(Changes, RandomCubes_EqualTheirNumbers) {
    Random random(11);
    for (int run = 0; run < 20; ++run) {
        Cubes before = plate, after = plate;
        double added = 0, removed = 0;
        for (int x = 2; x < 8; ++x)
            for (int y = 2; y < 8; ++y)
                for (int z = 2; z < 5; ++z) {
                    const std::array<int, 3> cube{x, y, z};
                    const bool was = random.uniform() < 0.5, is = random.uniform() < 0.5;
                    was ? (void)before.insert(cube) : (void)before.erase(cube);
                    is ? (void)after.insert(cube) : (void)after.erase(cube);
                    added += is && !was;
                    removed += was && !is;
                }
        double found_added = 0, found_removed = 0;
        for (const Change& change : Difference(surface_of(before), surface_of(after)).changes()) {
            found_added += change.volume_added;
            found_removed += change.volume_removed;
        }
        EXPECT_NEAR(found_added, added, coarse * (added + removed));
        EXPECT_NEAR(found_removed, removed, coarse * (added + removed));
        EXPECT_NEAR(found_added - found_removed, added - removed, 1e-11);
    }
}

/// 0 at the boundary of the relief; over x > 0, the volume is 1/5.
double wave(double x, double y) { return 0.6 * x * (1 - x * x) * (1 - y * y); }
double flat(double, double) { return 0; }

TEST(Changes, Wave_HalfOutAndHalfIn) {
    for (const u32 cells : {8u, 64u}) {
        // The wave is 0 along x = 0, so that the triangles of its two halves are those of the whole.
        const TriangleMesh before = relief(cells, flat), after = relief(cells, wave),
                           out = relief(cells, [](double x, double y) { return x > 0 ? wave(x, y) : 0; }),
                           in = relief(cells, [](double x, double y) { return x < 0 ? wave(x, y) : 0; });
        const double added = test::signed_volume(out) - test::signed_volume(before),
                     removed = test::signed_volume(before) - test::signed_volume(in);
        EXPECT_NEAR(added, 0.2, 2.0 / (cells * cells)) << "the case itself";
        Random random(5);
        for (int turn = 0; turn < 10; ++turn) {
            const double angle = turn == 0 ? 0 : random.uniform(0, 6);
            const Vec3 axis(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
            const std::vector<Change> found =
                Difference(turned(before, angle, axis), turned(after, angle, axis)).changes();
            ASSERT_THAT(found, SizeIs(1));
            expect_volumes(found[0], added, removed, cells < 64 ? coarse : fine);
        }
    }
}

TEST(Changes, SphericalCaps_OneOutAndOneIn) {
    // Caps of height 0.1 over circles of radius 0.4.
    const double height = 0.1, radius = (0.4 * 0.4 + height * height) / (2 * height);
    const auto cap = [&](double x, double y) {
        const double squared = x * x + y * y;
        return squared < 0.16 ? std::sqrt(radius * radius - squared) - (radius - height) : 0;
    };
    const TriangleMesh before = relief(160, flat),
                       after = relief(160, [&](double x, double y) { return cap(x + 0.5, y) - cap(x - 0.5, y); });
    const std::vector<Change> found = Difference(before, after).changes();
    ASSERT_THAT(found, SizeIs(2));
    const double volume = std::numbers::pi * height * height * (3 * radius - height) / 3;
    const double area = 2 * std::numbers::pi * radius * height;
    for (const Change& change : found) {
        EXPECT_NEAR(change.volume_added + change.volume_removed, volume, 2e-3 * volume);
        EXPECT_GE(change.area, area);
        EXPECT_LE(change.area, area + 2 * std::numbers::pi * 0.4 * 0.03) << "and flat parts of triangles at the rim";
        EXPECT_EQ(std::min(change.volume_added, change.volume_removed), 0);
    }
    EXPECT_NE(found[0].volume_added > 0.01, found[1].volume_added > 0.01);
}

TEST(Changes, ShearedCube_AddsWhatItRemoves) {
    for (const double slope : {0.25, 0.01, 0.001}) {
        const TriangleMesh before = cube();
        const TriangleMesh after = with_positions(before, [&](const Vec3& p) -> Vec3 {
            return {p.x() + slope * p.z(), p.y(), p.z()};
        });
        const std::vector<Change> found = Difference(before, after).changes();
        ASSERT_THAT(found, SizeIs(1));
        expect_volumes(found[0], slope / 2, slope / 2, slope < 0.1 ? 1e-2 : coarse);
    }
}

TEST(Changes, MovedWalls_AlongAnAxis_AreNotMissed) {
    // A block of 40 × 40 × 40 moves by one unit: slices that are much thinner than the block.
    const TriangleMesh before = surface_of(block({0, 0, 0}, {40, 40, 40}));
    for (const std::size_t axis : {0, 1, 2}) {
        Vec3 shift = Vec3::Zero();
        shift[static_cast<Eigen::Index>(axis)] = 1;
        const std::vector<Change> found = Difference(before, shifted(before, shift)).changes();
        double added = 0, removed = 0;
        for (const Change& change : found) {
            added += change.volume_added;
            removed += change.volume_removed;
        }
        EXPECT_NEAR(added, 1600, coarse * 3200);
        EXPECT_NEAR(removed, 1600, coarse * 3200);
    }
}

TEST(Changes, OtherDiagonalsOfAPlane_ChangeNoVolume) {
    const TriangleMesh before = relief(8, flat);
    Array<Triangle> triangles;
    // The two triangles of a square follow each other.
    for (std::size_t i = 0; i < before.triangles.size(); i += 2) {
        const auto [a, b, c] = before.triangles[i];
        const u32 d = before.triangles[i + 1][2];
        triangles.push_back({a, b, d});
        triangles.push_back({b, c, d});
    }
    TriangleMesh after = before;
    after.triangles = triangles;
    for (const double angle : {0.0, 1.0}) {
        const std::vector<Change> found =
            Difference(turned(before, angle, {1, 2, 3}), turned(after, angle, {1, 2, 3})).changes();
        ASSERT_THAT(found, SizeIs(1));
        EXPECT_NEAR(found[0].area, area(before), 1e-12);
        EXPECT_EQ(found[0].volume_added, 0);
        EXPECT_EQ(found[0].volume_removed, 0);
    }
}

TEST(Changes, EqualMeshes_HaveNone) { EXPECT_THAT(Difference(cube(), cube()).changes(), IsEmpty()); }

TEST(Changes, TrianglesInBothLists_CancelEachOther) {
    const TriangleMesh mesh = geodesic_sphere(1, 4);
    std::vector<u32> common(mesh.positions.size());
    for (u32 i = 0; i < common.size(); ++i) common[i] = i;
    Context context;
    const ChangedTriangles all{mesh.positions.span(), mesh.triangles.span()};
    const std::vector<Change> found = changes(all, all, common, context);
    ASSERT_THAT(found, SizeIs(1));
    EXPECT_EQ(found[0].volume_added, 0);
    EXPECT_EQ(found[0].volume_removed, 0);
    EXPECT_NEAR(found[0].area, area(mesh), 1e-12);
}

TEST(Changes, WithoutTriangles_ThereAreNone) {
    Context context;
    const TriangleMesh mesh = cube();
    const std::vector<u32> common(mesh.positions.size(), no_common_vertex);
    EXPECT_THAT(changes({mesh.positions.span(), {}}, {mesh.positions.span(), {}}, common, context), IsEmpty());
    EXPECT_THAT(changes({}, {}, {}, context), IsEmpty());
}

TEST(Changes, ScaledAndShiftedMeshes_HaveTheSameChanges) {
    const TriangleMesh before = relief(8, flat), after = relief(8, wave);
    const Change original = Difference(before, after).changes()[0];
    const auto moved = [](const TriangleMesh& mesh) { return shifted(scaled(mesh, 3), {1000, -2000, 500}); };
    const Change change = Difference(moved(before), moved(after)).changes()[0];
    EXPECT_NEAR(change.area, 9 * original.area, 1e-9);
    EXPECT_NEAR(change.volume_added, 27 * original.volume_added, 1e-9);
    EXPECT_NEAR(change.volume_removed, 27 * original.volume_removed, 1e-9);
}

TEST(Changes, FarFromTheOrigin_AreAsExactAsNearIt) {
    const Vec3 shift(0x1p30, -0x1p31, 0x1p29);  // whole coordinates stay exact
    const TriangleMesh before = surface_of(plate), after = surface_of(with(plate, block({3, 2, 3}, {8, 6, 5})));
    const std::vector<Change> found = Difference(shifted(before, shift), shifted(after, shift)).changes();
    ASSERT_THAT(found, SizeIs(1));
    EXPECT_NEAR(found[0].area, 56, 1e-12);
    EXPECT_NEAR(found[0].volume_added, 40, 1e-12);
    EXPECT_EQ(found[0].volume_removed, 0);
}

TEST(Changes, AnyNumberOfThreads_GivesTheSameNumbers) {
    const Difference difference(relief(40, flat), relief(40, wave));
    const Change expected = difference.changes()[0];
    for (const unsigned threads : {2u, 7u}) {
        ContextOptions options;
        options.threads = threads;
        Context context(options);
        const Change found = difference.changes(context)[0];
        EXPECT_EQ(found.volume_added, expected.volume_added);
        EXPECT_EQ(found.volume_removed, expected.volume_removed);
        EXPECT_EQ(found.area, expected.area);
    }
}

TEST(Changes, Cancelled_StopsAtEveryCheck) {
    const Difference difference(relief(40, flat), relief(40, wave));
    int checks = 0, last = 0;
    ContextOptions options;
    options.is_cancelled = [&] { return ++checks, false; };
    {
        Context context(options);
        difference.changes(context);
    }
    const int all = checks;
    EXPECT_GT(all, 5);
    options.is_cancelled = [&] { return ++checks >= last; };
    for (last = 1; last <= all; ++last) {
        checks = 0;
        Context context(options);
        EXPECT_THROW(difference.changes(context), Cancelled);
        EXPECT_EQ(checks, last);
    }
}

}  // namespace
}  // namespace scanmill::updating
