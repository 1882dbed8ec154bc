// SPDX-License-Identifier: GPL-3.0-or-later
/// `rebuild: local` alone: removed facets and new points in, replaced facets and new triangles out.

#include "mesh_update/local_rebuild.hpp"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <set>

#include "filters/tight_cocone/cases.hpp"
#include "scanmill/base/statistics.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/data/point_tree.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"
#include "support/mesh_operations.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::AllOf;
using testing::HasSubstr;
using updating::LocalChange;
using updating::LocalRebuild;

constexpr double pi = std::numbers::pi;

struct Model {
    explicit Model(const TriangleMesh& given)
        : mesh(
              soup({given.positions.begin(), given.positions.end()}, {given.triangles.begin(), given.triangles.end()})),
          opposite(half_edges::opposites(mesh)),
          tree(mesh, 2) {}

    TriangleMesh mesh;
    Array<u32> opposite;
    updating::FacetTree tree;
};

double median_distance(std::span<const Vec3> points) {
    const PointTree tree(points);
    NeighbourBuffer buffer;
    std::vector<double> distances;
    for (u32 i = 0; i < tree.positions().size(); ++i)
        distances.push_back(std::sqrt(tree.nearest(i, 1, buffer).front().squared));
    return median(distances);
}

/// Changes of a model, as the steps before the rebuild find them.
class Changes {
public:
    explicit Changes(const Model& of) : model(of) {}

    /// Discards the vertices that `is_gone` accepts and removes their facets. Adds the points that keep at least 0.6 of
    /// their spacing from the vertices that remain.
    void add(const std::function<bool(const Vec3&)>& is_gone, const PointCloud& cloud) {
        std::vector<bool> gone;
        for (const Vec3& p : model.mesh.positions) gone.push_back(is_gone(p));
        add(gone, {}, cloud);
    }
    /// The same with flags by vertex and the rows of further facets to be removed.
    void add(const std::vector<bool>& gone, const std::set<u32>& rows, const PointCloud& cloud) {
        LocalChange change;
        change.spacing = median_distance(cloud.positions.span());
        std::vector<Vec3> kept;
        for (u32 vertex = 0; vertex < gone.size(); ++vertex) {
            if (gone[vertex])
                discarded.push_back(vertex);
            else
                kept.push_back(model.mesh.positions[vertex]);
        }
        std::ranges::sort(discarded);
        for (u32 row = 0; row < model.mesh.triangles.size(); ++row)
            if (rows.contains(row) ||
                std::ranges::any_of(model.mesh.triangles[row], [&](u32 vertex) { return bool(gone[vertex]); }))
                change.removed.push_back(row);
        std::optional<PointTree> tree;
        if (!kept.empty()) tree.emplace(kept);
        NeighbourBuffer buffer;
        const double least = 0.6 * change.spacing;
        for (const Vec3& p : cloud.positions) {
            if (tree && tree->nearest_to(p, 1, buffer).front().squared < least * least) continue;
            change.points.push_back(static_cast<u32>(points.size()));
            points.push_back(p);
        }
        changes.push_back(std::move(change));
    }

    LocalRebuild rebuild(unsigned threads = 1) const {
        ContextOptions options;
        options.threads = threads;
        Context context(options);
        LocalRebuild result = updating::rebuild_locally(model.mesh, model.opposite, model.tree, points, changes,
                                                        discarded, TightCoconeParams(), context);
        EXPECT_TRUE(context.doubts().empty());
        EXPECT_EQ(context.metrics().find("cells"), nullptr);
        return result;
    }

    TriangleMesh updated(const LocalRebuild& result) const {
        Array<Vec3> positions(model.mesh.positions.begin(), model.mesh.positions.end());
        positions.insert(positions.end(), points.begin(), points.end());
        Array<Triangle> triangles;
        for (u32 row = 0; row < model.mesh.triangles.size(); ++row)
            if (!std::ranges::binary_search(result.replaced, row)) triangles.push_back(model.mesh.triangles[row]);
        triangles.insert(triangles.end(), result.triangles.begin(), result.triangles.end());
        return soup(std::move(positions), std::move(triangles));
    }

    const Model& model;
    std::vector<Vec3> points;
    std::vector<LocalChange> changes;
    std::vector<u32> discarded;
};

/// What is true of every result.
TriangleMesh expect_promised(const Changes& changes, const LocalRebuild& result) {
    const auto is_ascending = [](const std::vector<u32>& list) {
        return std::ranges::adjacent_find(list, std::greater_equal()) == list.end();
    };
    EXPECT_TRUE(is_ascending(result.replaced));
    EXPECT_TRUE(is_ascending(result.dropped));
    for (const LocalChange& change : changes.changes)
        for (const u32 row : change.removed) EXPECT_TRUE(std::ranges::binary_search(result.replaced, row));
    const TriangleMesh mesh = changes.updated(result);
    EXPECT_TRUE(topology(mesh).closed);
    EXPECT_EQ(intersections(mesh), 0u);

    std::vector<bool> is_used(mesh.positions.size());
    for (const Triangle& triangle : mesh.triangles)
        for (const u32 vertex : triangle) is_used[vertex] = true;
    std::vector<u32> dropped;
    std::size_t unused = 0;
    const std::size_t vertices = changes.model.mesh.positions.size();
    for (u32 vertex = 0; vertex < is_used.size(); ++vertex) {
        if (is_used[vertex]) continue;
        if (vertex < vertices)
            dropped.push_back(vertex);
        else
            ++unused;
    }
    EXPECT_EQ(result.dropped, dropped);
    EXPECT_EQ(result.unused_points, unused);
    for (const u32 vertex : changes.discarded) EXPECT_FALSE(is_used[vertex]);
    return mesh;
}

/// The largest distance of vertices and centroids of `from` to the other surface.
double farthest(const TriangleMesh& from, const TriangleMesh& to) {
    const TriangleTree tree(to.positions.span(), to.triangles.span(), 2);
    double squared = 0;
    for (const auto& [a, b, c] : from.triangles)
        for (const Vec3& p : {from.positions[a], Vec3((from.positions[a] + from.positions[b] + from.positions[c]) / 3)})
            squared = std::max(squared, tree.nearest(p).squared_distance);
    return std::sqrt(squared);
}

/// Tight-cocone of all points that remain, and the new ones, differs by at most a spacing.
void expect_like_whole(const Changes& changes, const TriangleMesh& mesh) {
    PointCloud all;
    Array<Vec3> positions;
    for (u32 vertex = 0; vertex < changes.model.mesh.positions.size(); ++vertex)
        if (!std::ranges::binary_search(changes.discarded, vertex))
            positions.push_back(changes.model.mesh.positions[vertex]);
    positions.insert(positions.end(), changes.points.begin(), changes.points.end());
    all.positions = std::move(positions);
    const TriangleMesh whole = closed_through(all).mesh;
    EXPECT_EQ(topology(mesh).euler, topology(whole).euler);
    EXPECT_LT(farthest(mesh, whole), changes.changes[0].spacing);
    EXPECT_LT(farthest(whole, mesh), changes.changes[0].spacing);
}

/// Volume of the part of a ball that is more than `distance` from its centre in one direction.
double cap_volume(double radius, double distance) {
    const double height = radius - distance;
    return pi * height * height * (3 * radius - height) / 3;
}

constexpr double unit_ball = 4 * pi / 3;

const Model& sphere() {
    static const Model model(closed_through(fibonacci_sphere(6000, 1e-3)).mesh);
    return model;
}
constexpr double sphere_spacing = 0.045;

/// Points on the unit sphere and on a smaller one whose centre lies 0.9 along the axis; only those on the boundary of
/// the union, or of the difference.
PointCloud cap(const Vec3& axis, double radius, bool is_added, std::uint64_t seed) {
    const Vec3 centre = 0.9 * axis;
    const auto count = static_cast<std::size_t>(8000 * radius * radius);
    const PointCloud small = moved(fibonacci_sphere(count, 1e-3, seed), radius, centre),
                     large = fibonacci_sphere(8000, 1e-3, seed + 1);
    return joined(
        points_where(small, [&](const Vec3& p) { return is_added ? p.norm() > 1 : p.norm() < 1; }),
        points_where(large, [&](const Vec3& p) { return (p - centre).norm() > radius && p.dot(axis) > 0.8; }));
}

/// The volume of the small ball of cap() outside of the unit ball, and inside.
std::array<double, 2> cap_volumes(double radius) {
    const double d = 0.9, plane = (d * d + 1 - radius * radius) / (2 * d);  // of the circle where the spheres meet
    const double inside = cap_volume(1, plane) + cap_volume(radius, d - plane);
    return {4 * pi / 3 * std::pow(radius, 3) - inside, inside};
}

bool is_near(const Vec3& p, const Vec3& axis) { return p.dot(axis) > 0.85; }

TEST(LocalRebuild, CapAddedToASphere_HasTheVolumeOfTheUnion) {
    Changes changes(sphere());
    changes.add([](const Vec3& p) { return is_near(p, Vec3::UnitZ()); }, cap(Vec3::UnitZ(), 0.3, true, 1));
    const LocalRebuild result = changes.rebuild();
    const TriangleMesh mesh = expect_promised(changes, result);
    EXPECT_EQ(topology(mesh).euler, 2);
    expect_like_whole(changes, mesh);
    const double before = volume(sphere().mesh);
    EXPECT_NEAR(volume(mesh) - before, cap_volumes(0.3)[0], sphere_spacing * pi * 0.3 * 0.3);
    EXPECT_EQ(result.unused_points, 0u);
    EXPECT_EQ(result.dropped, changes.discarded);
}

TEST(LocalRebuild, CapCutFromASphere_HasTheVolumeOfTheDifference) {
    Changes changes(sphere());
    changes.add([](const Vec3& p) { return is_near(p, Vec3::UnitX()); }, cap(Vec3::UnitX(), 0.3, false, 3));
    const TriangleMesh mesh = expect_promised(changes, changes.rebuild());
    EXPECT_EQ(topology(mesh).euler, 2);
    expect_like_whole(changes, mesh);
    EXPECT_NEAR(volume(sphere().mesh) - volume(mesh), cap_volumes(0.3)[1], sphere_spacing * pi * 0.3 * 0.3);
}

TEST(LocalRebuild, CloudThatRepeatsItsRegion_StaysWithinItsSpacing) {
    Changes changes(sphere());
    changes.add([](const Vec3& p) { return is_near(p, Vec3::UnitY()); },
                points_where(fibonacci_sphere(7000, 1e-3, 5), [](const Vec3& p) { return p.y() > 0.8; }));
    const LocalRebuild result = changes.rebuild();
    const TriangleMesh mesh = expect_promised(changes, result);
    EXPECT_EQ(topology(mesh).euler, 2);
    expect_like_whole(changes, mesh);
    EXPECT_EQ(result.unused_points, 0u);
    EXPECT_LT(farthest(mesh, sphere().mesh), changes.changes[0].spacing);
    EXPECT_LT(farthest(sphere().mesh, mesh), changes.changes[0].spacing);
}

/// The same points give the same surface, so nothing beside the removed facets is replaced.
TEST(LocalRebuild, CloudOfTheDiscardedVertices_RestoresTheirFacets) {
    Changes changes(sphere());
    const auto is_gone = [](const Vec3& p) { return is_near(p, Vec3::UnitY()); };
    PointCloud cloud;
    cloud.positions = sphere().mesh.positions;
    changes.add(is_gone, points_where(cloud, is_gone));
    const LocalRebuild result = changes.rebuild();
    expect_promised(changes, result);
    EXPECT_EQ(result.replaced, changes.changes[0].removed);
    std::set<std::set<std::array<double, 3>>> before, after;
    const auto add = [&](auto& to, const Triangle& triangle, const auto& position) {
        std::set<std::array<double, 3>> corners;
        for (const u32 vertex : triangle) {
            const Vec3 p = position(vertex);
            corners.insert({p.x(), p.y(), p.z()});
        }
        to.insert(corners);
    };
    const TriangleMesh& mesh = sphere().mesh;
    const u32 vertices = static_cast<u32>(mesh.positions.size());
    for (const u32 row : result.replaced)
        add(before, mesh.triangles[row], [&](u32 vertex) { return mesh.positions[vertex]; });
    for (const Triangle& triangle : result.triangles)
        add(after, triangle,
            [&](u32 vertex) { return vertex < vertices ? mesh.positions[vertex] : changes.points[vertex - vertices]; });
    EXPECT_EQ(before, after);
}

TEST(LocalRebuild, SmallRegionOfAFlatFace_TakesADentOrABump) {
    // The dent lies below all other points of the region.
    const Model box(closed_through(l_block_surface(15, 30, 30, 0.1)).mesh);
    for (const double height : {-2., 2.}) {
        Changes changes(box);
        const Vec3 centre(8, 8, 30);
        const auto distance = [&](const Vec3& p) { return Vec3(p.x() - 8, p.y() - 8, 0).norm(); };
        Array<Vec3> positions;
        for (double x = 2; x < 14; x += 0.7)
            for (double y = 2; y < 14; y += 0.7) {
                const double t = std::min(1., distance({x, y, 0}) / 5);
                positions.emplace_back(x, y, 30 + height * (1 - t * t) * (1 - t * t));
            }
        PointCloud cloud;
        cloud.positions = std::move(positions);
        changes.add([&](const Vec3& p) { return p.z() > 29.5 && distance(p) < 6; },
                    points_where(cloud, [&](const Vec3& p) { return distance(p) < 6.2; }));
        const TriangleMesh mesh = expect_promised(changes, changes.rebuild());
        EXPECT_EQ(topology(mesh).euler, 2);
        expect_like_whole(changes, mesh);
        // The integral of (1 - r²/25)² over the disc of radius 5 is 25 pi / 3; jitter moves the old face.
        EXPECT_NEAR(volume(mesh) - volume(box.mesh), height * 25 * pi / 3, 0.1 * pi * 36 / 2);
    }
}

/// A plate of 30 × 30 × `thickness` whose lattice points are slightly moved within their faces.
TriangleMesh plate_of(int thickness) {
    Random random(8);
    Array<Vec3> positions;
    for (int i = 0; i <= 30; ++i)
        for (int j = 0; j <= 30; ++j)
            for (int k = 0; k <= thickness; ++k) {
                const bool at_side = i == 0 || j == 0 || i == 30 || j == 30;
                if (!at_side && k != 0 && k != thickness) continue;
                Vec3 p(i, j, k);
                for (int axis = 0; axis < 3; ++axis)
                    if (p[axis] > 0 && p[axis] < (axis == 2 ? thickness : 30)) p[axis] += random.uniform(-0.1, 0.1);
                positions.push_back(p);
            }
    PointCloud cloud;
    cloud.positions = std::move(positions);
    return closed_through(cloud).mesh;
}
const Model& plate() {
    static const Model model(plate_of(6));
    return model;
}

double distance_from_axis(const Vec3& p) { return Vec3(p.x() - 15, p.y() - 15, 0).norm(); }

/// Rings of points on the wall of a round hole or pad between two heights, and on the face around it.
void add_ring(Array<Vec3>& positions, double radius, double height) {
    const int count = static_cast<int>(2 * pi * radius / 0.7);
    for (int i = 0; i < count; ++i) {
        const double angle = 2 * pi * (i + 0.3 * height + 0.37 * radius) / count;
        positions.emplace_back(15 + radius * std::cos(angle), 15 + radius * std::sin(angle), height);
    }
}

TEST(LocalRebuild, HoleThroughAPlate_JoinsBothFaces) {
    Changes changes(plate());
    Array<Vec3> positions;
    for (double z = 0; z < 6.01; z += 0.6) add_ring(positions, 4, std::min(z, 6.));
    for (const double z : {0., 6.})
        for (double radius = 4.7; radius < 7; radius += 0.7) add_ring(positions, radius, z);
    PointCloud cloud;
    cloud.positions = std::move(positions);
    changes.add([](const Vec3& p) { return distance_from_axis(p) < 7; }, cloud);
    const TriangleMesh mesh = expect_promised(changes, changes.rebuild());
    EXPECT_EQ(topology(mesh).euler, 0);
    expect_like_whole(changes, mesh);
    EXPECT_NEAR(volume(plate().mesh) - volume(mesh), 6 * pi * 16, 0.7 * (2 * pi * 4 * 6) / 2);
}

/// The other face is nearer than the collar is wide.
TEST(LocalRebuild, RoundPadOnAThinPlate_LeavesTheOtherFaceUntouched) {
    const Model thin(plate_of(2));
    Changes changes(thin);
    Array<Vec3> positions;
    for (double z = 2; z < 5.01; z += 0.6) add_ring(positions, 4, std::min(z, 5.));
    for (double radius = 0.4; radius < 3.9; radius += 0.6) add_ring(positions, radius, 5);
    for (double radius = 4.7; radius < 7; radius += 0.7) add_ring(positions, radius, 2);
    PointCloud cloud;
    cloud.positions = std::move(positions);
    changes.add([](const Vec3& p) { return p.z() > 1.5 && distance_from_axis(p) < 7; }, cloud);
    const LocalRebuild result = changes.rebuild();
    const TriangleMesh mesh = expect_promised(changes, result);
    EXPECT_EQ(topology(mesh).euler, 2);
    expect_like_whole(changes, mesh);
    EXPECT_NEAR(volume(mesh) - volume(thin.mesh), 3 * pi * 16, 0.7 * (2 * pi * 4 * 3 + pi * 16) / 2);
    for (const u32 row : result.replaced)
        for (const u32 vertex : thin.mesh.triangles[row]) EXPECT_GT(thin.mesh.positions[vertex].z(), 1.5);
}

TEST(LocalRebuild, WallOfACavity_StaysAWallOfACavity) {
    const TriangleMesh inner = inside_out(scaled(sphere().mesh, 0.6));
    const Model hollow(both(sphere().mesh, inner));
    Changes changes(hollow);
    changes.add([](const Vec3& p) { return p.norm() < 0.8 && is_near(p / p.norm(), Vec3::UnitZ()); },
                points_where(moved(fibonacci_sphere(7000, 1e-3, 5), 0.6), [](const Vec3& p) { return p.z() > 0.45; }));
    const TriangleMesh mesh = expect_promised(changes, changes.rebuild());
    EXPECT_EQ(topology(mesh).euler, 4);
    EXPECT_NEAR(volume(mesh), volume(hollow.mesh), 1e-3);
    EXPECT_LT(farthest(mesh, hollow.mesh), changes.changes[0].spacing);
}

std::multiset<std::array<std::array<double, 3>, 3>> places(const Changes& changes, const LocalRebuild& result) {
    std::multiset<std::array<std::array<double, 3>, 3>> all;
    const u32 vertices = static_cast<u32>(changes.model.mesh.positions.size());
    for (const Triangle& triangle : result.triangles) {
        std::array<std::array<double, 3>, 3> corners;
        for (std::size_t k = 0; k < 3; ++k) {
            const u32 vertex = triangle[k];
            const Vec3& p =
                vertex < vertices ? changes.model.mesh.positions[vertex] : changes.points[vertex - vertices];
            corners[k] = {p.x(), p.y(), p.z()};
        }
        std::ranges::rotate(corners, std::ranges::min_element(corners));
        all.insert(corners);
    }
    return all;
}

TEST(LocalRebuild, ChangesFarFromEachOther_GiveWhatEachGivesAlone) {
    const auto near_top = [](const Vec3& p) { return is_near(p, Vec3::UnitZ()); };
    const auto near_bottom = [](const Vec3& p) { return is_near(p, -Vec3::UnitZ()); };
    const PointCloud bump = cap(Vec3::UnitZ(), 0.3, true, 1), dent = cap(-Vec3::UnitZ(), 0.25, false, 7);
    Changes both(sphere()), top(sphere()), bottom(sphere());
    both.add(near_top, bump);
    both.add(near_bottom, dent);
    top.add(near_top, bump);
    bottom.add(near_bottom, dent);
    const LocalRebuild at_once = both.rebuild(), first = top.rebuild(), second = bottom.rebuild();
    expect_promised(both, at_once);
    auto expected = places(top, first);
    expected.merge(places(bottom, second));
    EXPECT_EQ(places(both, at_once), expected);
    std::vector<u32> replaced = first.replaced;
    replaced.insert(replaced.end(), second.replaced.begin(), second.replaced.end());
    std::ranges::sort(replaced);
    EXPECT_EQ(at_once.replaced, replaced);
}

/// Neither change leaves a surface around the other one's removed facets.
TEST(LocalRebuild, ChangesThatTouch_AreOneRegion) {
    Changes changes(sphere());
    const PointCloud fresh = fibonacci_sphere(7000, 1e-3, 11);
    changes.add([](const Vec3& p) { return p.z() > 0.9; },
                points_where(fresh, [](const Vec3& p) { return p.z() > 0.9; }));
    changes.add([](const Vec3& p) { return p.z() > 0.7 && p.z() <= 0.9; },
                points_where(fresh, [](const Vec3& p) { return p.z() > 0.68 && p.z() <= 0.9; }));
    const TriangleMesh mesh = expect_promised(changes, changes.rebuild());
    EXPECT_EQ(topology(mesh).euler, 2);
    expect_like_whole(changes, mesh);
    EXPECT_LT(farthest(mesh, sphere().mesh), sphere_spacing);
}

TEST(LocalRebuild, PartOfTheCloudWithoutASeam_IsLeftOut) {
    Changes changes(sphere());
    const PointCloud ball = moved(fibonacci_sphere(200, 1e-3), 0.12, Vec3(0, 0, 1.5));
    changes.add([](const Vec3& p) { return is_near(p, Vec3::UnitZ()); },
                joined(cap(Vec3::UnitZ(), 0.3, true, 1), ball));
    const LocalRebuild result = changes.rebuild();
    const TriangleMesh mesh = expect_promised(changes, result);
    EXPECT_EQ(topology(mesh).components, 1u);
    EXPECT_EQ(result.unused_points, ball.size());
}

TEST(LocalRebuild, RemovedFacetsThatTouchInAVertex_AreReplaced) {
    // Two opposite quarters of a disc; their common vertex remains.
    const TriangleMesh& mesh = sphere().mesh;
    const auto in_quarters = [](const Vec3& p) { return p.z() > 0.9 && p.x() * p.y() > 0; };
    const u32 centre = static_cast<u32>(
        std::ranges::min_element(mesh.positions, {}, [](const Vec3& p) { return (p - Vec3(0.02, 0.02, 1)).norm(); }) -
        mesh.positions.begin());
    const Vec3 shift = mesh.positions[centre];
    const auto is_gone = [&](const Vec3& p) {
        const Vec3 q(p.x() - shift.x(), p.y() - shift.y(), p.z());
        return p != shift && in_quarters(q);
    };
    Changes changes(sphere());
    changes.add(is_gone, points_where(fibonacci_sphere(7000, 1e-3, 13), is_gone));
    const TriangleMesh updated = expect_promised(changes, changes.rebuild());
    EXPECT_EQ(topology(updated).euler, 2);
    EXPECT_LT(farthest(updated, mesh), sphere_spacing);
}

void expect_refusal(const Error& error) {
    EXPECT_THAT(error.sentence(), AllOf(HasSubstr("seam"), testing::ContainsRegex("\\(-?[0-9].*, .*, .*\\)")));
    EXPECT_THAT(error.hint(), HasSubstr("rebuild: whole"));
}

TEST(LocalRebuild, RemovedComponent_IsRefused) {
    const Model two(both(sphere().mesh, shifted(geodesic_sphere(0.5, 6), {3, 0, 0})));
    for (const Model* model : {&sphere(), &two}) {
        Changes changes(*model);
        const double least = model == &two ? 2 : -2;
        changes.add([&](const Vec3& p) { return p.x() > least; },
                    moved(fibonacci_sphere(2000, 1e-3), 0.5, Vec3(3, 0, 0)));
        const Error error = error_of([&] { changes.rebuild(); });
        expect_refusal(error);
        EXPECT_THAT(error.sentence(),
                    AllOf(HasSubstr("nothing"), HasSubstr(std::to_string(changes.changes[0].removed.size()))));
    }
}

/// One change removes a component and a part of another one.
TEST(LocalRebuild, RemovedComponentBesideAnotherOne_IsRefused) {
    const TriangleMesh small = shifted(geodesic_sphere(0.1, 3), {0, 0, 1.2});
    const Model model(both(sphere().mesh, small));
    Changes changes(model);
    changes.add([](const Vec3& p) { return is_near(p, Vec3::UnitZ()); }, cap(Vec3::UnitZ(), 0.3, true, 1));
    const Error error = error_of([&] { changes.rebuild(); });
    expect_refusal(error);
    EXPECT_THAT(error.sentence(), AllOf(HasSubstr("nothing"), HasSubstr(std::to_string(small.triangles.size()))));
}

TEST(LocalRebuild, DentThroughTheOtherFace_IsRefused) {
    Changes changes(plate());
    Array<Vec3> positions;
    for (double radius = 0.4; radius < 7; radius += 0.6) add_ring(positions, radius, 6 - 2 * (7 - radius));
    PointCloud cloud;
    cloud.positions = std::move(positions);
    changes.add([](const Vec3& p) { return p.z() > 5.5 && distance_from_axis(p) < 7; }, cloud);
    expect_refusal(error_of([&] { changes.rebuild(); }));
}

/// The bump passes between the corners of a triangle that are too far away to be seen.
TEST(LocalRebuild, BumpThroughALargeTriangle_IsRefused) {
    const TriangleMesh wall =
        soup({{-3, -2, 1.1}, {3, -2, 1.1}, {0, 3, 1.1}, {0, 0, 4}}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
    const Model model(both(sphere().mesh, wall));
    Changes changes(model);
    changes.add([](const Vec3& p) { return p.norm() < 1.05 && is_near(p, Vec3::UnitZ()); },
                cap(Vec3::UnitZ(), 0.3, true, 1));
    expect_refusal(error_of([&] { changes.rebuild(); }));
}

/// A change around a facet: the vertices within `radius` are replaced by samples of the facets there, moved along their
/// common normal by up to `height` in the middle. Empty if there are too few points.
std::optional<Changes> random_change(const Model& model, Random& random, double radius, double height,
                                     double distance) {
    const TriangleMesh& mesh = model.mesh;
    const u32 facet = static_cast<u32>(random.index(mesh.triangles.size()));
    const auto& [a, b, c] = mesh.triangles[facet];
    const Vec3 centre = (mesh.positions[a] + mesh.positions[b] + mesh.positions[c]) / 3;
    const auto is_close = [&](u32 vertex) { return (mesh.positions[vertex] - centre).norm() < radius; };
    std::vector<u32> patch{facet};
    std::set<u32> seen{facet};
    Vec3 normal = Vec3::Zero();
    std::vector<double> sums;
    for (std::size_t i = 0; i < patch.size(); ++i) {
        const Vec3 area = area_vector(mesh.positions.span(), mesh.triangles[patch[i]]);
        normal += area;
        sums.push_back((sums.empty() ? 0 : sums.back()) + area.norm());
        for (u32 h = 3 * patch[i]; h < 3 * patch[i] + 3; ++h) {
            const u32 beside = model.opposite[h] / 3;
            if (std::ranges::any_of(mesh.triangles[beside], is_close) && seen.insert(beside).second)
                patch.push_back(beside);
        }
    }
    normal.normalize();
    Array<Vec3> positions;
    for (int dart = 0; dart < 20000 && positions.size() < 1000; ++dart) {
        const auto slot = std::ranges::lower_bound(sums, random.uniform() * sums.back()) - sums.begin();
        const Triangle& t = mesh.triangles[patch[static_cast<std::size_t>(slot)]];
        double u = random.uniform(), v = random.uniform();
        if (u + v > 1) u = 1 - u, v = 1 - v;
        Vec3 p = mesh.positions[t[0]] + u * (mesh.positions[t[1]] - mesh.positions[t[0]]) +
                 v * (mesh.positions[t[2]] - mesh.positions[t[0]]);
        const double share = (p - centre).norm() / radius;
        if (share > 1) continue;
        p += height * (1 - share * share) * (1 - share * share) * normal;
        if (std::ranges::all_of(positions, [&](const Vec3& q) { return (p - q).norm() >= distance; }))
            positions.push_back(p);
    }
    if (positions.size() < 20) return {};
    PointCloud cloud;
    cloud.positions = std::move(positions);
    // As the steps before, remove the facets between the region and the rest, too.
    std::vector<bool> gone(mesh.positions.size());
    for (const u32 row : patch)
        for (const u32 vertex : mesh.triangles[row])
            if ((mesh.positions[vertex] - centre).norm() < radius - 0.5 * distance) gone[vertex] = true;
    Changes changes(model);
    changes.add(gone, seen, cloud);
    return changes;
}

struct Trials {
    int all = 0, refused = 0;
};

/// Random changes with radii up to `largest` edges. Those that are not refused keep what is promised.
Trials trials(const Model& model, double edge, double largest, int count, double steepness = 0.3) {
    Random random(21);
    Trials trials;
    for (int i = 0; i < count; ++i) {
        const double radius = edge * random.uniform(3, largest);
        const std::optional<Changes> changes = random_change(
            model, random, radius, radius * random.uniform(-steepness, steepness), edge * random.uniform(0.5, 0.9));
        if (!changes) continue;
        SCOPED_TRACE(i);
        ++trials.all;
        try {
            expect_promised(*changes, changes->rebuild(2));
        } catch (const Error& error) {
            expect_refusal(error);
            ++trials.refused;
        }
    }
    return trials;
}

TEST(LocalRebuild, RandomChangesOfDelaunaySurfaces_AreRarelyRefused) {
    const Model torus(closed_through(poisson_torus(0.07)).mesh);
    const Model block(closed_through(l_block_surface(15, 30, 20, 0.1)).mesh);
    for (const Trials& found :
         {trials(sphere(), sphere_spacing, 10, 20), trials(torus, 0.09, 4, 20), trials(block, 1, 5, 20)}) {
        EXPECT_GE(found.all, 15);
        EXPECT_LE(20 * found.refused, found.all);
    }
}

TEST(LocalRebuild, RandomChangesOfOtherModels_NeverLeaveACrack) {
    trials(Model(torus(1, 0.4, 90, 36)), 0.07, 5, 15);  // planar quadrangles, in which either diagonal is Delaunay
    trials(Model(geodesic_sphere(1, 15)), 0.07, 8, 15);
    trials(Model(torus(1, 0.4, 12, 9)), 0.2, 3, 15);  // coarse
    trials(Model(cube(1)), 0.1, 5, 15);  // long triangles
    trials(Model(l_block(1)), 0.1, 5, 15);
    trials(Model(plate_of(2)), 1, 7, 40, 0.7);  // some dents pass through the plate
}

TEST(LocalRebuild, AnyNumberOfThreads_GivesTheSameBytes) {
    Changes changes(sphere());
    changes.add([](const Vec3& p) { return is_near(p, Vec3::UnitZ()); }, cap(Vec3::UnitZ(), 0.3, true, 1));
    changes.add([](const Vec3& p) { return is_near(p, Vec3::UnitX()); }, cap(Vec3::UnitX(), 0.3, false, 3));
    const LocalRebuild one = changes.rebuild(1), two = changes.rebuild(2);
    EXPECT_TRUE(std::ranges::equal(one.triangles, two.triangles));
    EXPECT_EQ(one.replaced, two.replaced);
    EXPECT_EQ(one.dropped, two.dropped);
}

TEST(LocalRebuild, WhenCancelled_StopsWithCancelled) {
    Changes changes(sphere());
    changes.add([](const Vec3& p) { return is_near(p, Vec3::UnitZ()); }, cap(Vec3::UnitZ(), 0.3, true, 1));
    for (const int limit : {0, 5, 50}) {
        int asked = 0;
        ContextOptions options;
        options.is_cancelled = [&] { return ++asked > limit; };
        Context context(options);
        EXPECT_THROW(updating::rebuild_locally(sphere().mesh, sphere().opposite, sphere().tree, changes.points,
                                               changes.changes, changes.discarded, TightCoconeParams(), context),
                     Cancelled);
    }
}

TEST(LocalRebuild, PointsAtRemainingVertices_AreUnused) {
    Changes changes(sphere());
    const auto is_gone = [](const Vec3& p) { return is_near(p, Vec3::UnitZ()); };
    changes.add(is_gone, points_where(fibonacci_sphere(7000, 1e-3, 5), [](const Vec3& p) { return p.z() > 0.8; }));
    const LocalRebuild without = changes.rebuild();
    std::size_t repeated = 0;
    for (const Vec3& p : sphere().mesh.positions)
        if (p.z() > 0.8 && !is_gone(p)) {
            changes.changes[0].points.push_back(static_cast<u32>(changes.points.size()));
            changes.points.push_back(p);
            ++repeated;
        }
    const LocalRebuild result = changes.rebuild();
    EXPECT_GT(repeated, 100u);
    EXPECT_EQ(result.unused_points, without.unused_points + repeated);
    EXPECT_TRUE(std::ranges::equal(result.triangles, without.triangles));
    EXPECT_EQ(result.replaced, without.replaced);
}

TEST(LocalRebuild, WithoutRemovedFacets_ReplacesNothing) {
    Changes changes(sphere());
    changes.add([](const Vec3&) { return false; }, moved(fibonacci_sphere(100), 3));
    const LocalRebuild result = changes.rebuild();
    EXPECT_TRUE(result.replaced.empty());
    EXPECT_TRUE(result.triangles.empty());
    EXPECT_EQ(result.unused_points, 100u);
}

TEST(LocalRebuild, ParametersOutOfRange_AreRefused) {
    Changes changes(sphere());
    changes.add([](const Vec3& p) { return is_near(p, Vec3::UnitZ()); }, cap(Vec3::UnitZ(), 0.3, true, 1));
    CoconeParams params;
    params.ratio = 0.5;
    Context context;
    EXPECT_THAT(sentence_of([&] {
                    updating::rebuild_locally(sphere().mesh, sphere().opposite, sphere().tree, changes.points,
                                              changes.changes, changes.discarded, params, context);
                }),
                HasSubstr("ratio"));
}

TEST(LocalRebuild, WithoutChanges_ReplacesNothing) {
    Changes changes(sphere());
    const LocalRebuild result = changes.rebuild();
    EXPECT_TRUE(result.replaced.empty());
    EXPECT_TRUE(result.dropped.empty());
    EXPECT_TRUE(result.triangles.empty());
}

}  // namespace
}  // namespace scanmill
