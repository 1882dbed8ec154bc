// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/mesh/handles.hpp"

#include <gmock/gmock.h>

#include <numbers>
#include <set>

#include "scanmill/data/half_edges.hpp"
#include "scanmill/data/topology.hpp"
#include "scanmill/formats/files.hpp"
#include "support/known_models.hpp"
#include "support/shapes.hpp"

namespace scanmill {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Execution& run() {
    static Execution execution;
    return execution;
}
std::vector<std::string> judged(const TriangleMesh& mesh, const std::function<bool(u32)>& is_invented = {}) {
    return doubts_about_handles(mesh, run(), is_invented);
}

/// Whether the edges of the loop are edges of the mesh, and the mesh without them is one component.
bool is_non_separating(const TriangleMesh& mesh, const HandleLoop& loop) {
    std::set<Edge> cut;
    for (std::size_t i = 0; i < loop.vertices.size(); ++i)
        cut.insert(make_edge(loop.vertices[i], loop.vertices[(i + 1) % loop.vertices.size()]));
    const Array<u32> opposite = half_edges::opposites(mesh);
    std::vector<bool> seen(mesh.triangles.size(), false);
    std::vector<u32> todo{0};
    seen[0] = true;
    std::size_t reached = 1;
    std::set<Edge> met;
    while (!todo.empty()) {
        const u32 row = todo.back();
        todo.pop_back();
        for (u32 h = 3 * row; h < 3 * row + 3; ++h) {
            const Edge edge = make_edge(half_edges::start(mesh, h), half_edges::end(mesh, h));
            if (cut.contains(edge)) {
                met.insert(edge);
                continue;
            }
            const u32 other = opposite[h] / 3;
            if (seen[other]) continue;
            seen[other] = true;
            ++reached;
            todo.push_back(other);
        }
    }
    return met.size() == cut.size() && reached == mesh.triangles.size();
}

/// Two parallel grids of `size` × `size` unit squares, joined along their borders, and by a tube with a square cross
/// section of `width` in the middle: a flat box with one hole through it. The distance of the grids is 1.
TriangleMesh box_with_hole(u32 size, u32 width) {
    TriangleMesh mesh;
    Array<Vec3> positions;
    for (const double z : {0.0, 1.0})
        for (u32 y = 0; y <= size; ++y)
            for (u32 x = 0; x <= size; ++x) positions.push_back(Vec3(x, y, z));
    const u32 first = (size - width) / 2, last = first + width;
    const auto at = [&](u32 x, u32 y, u32 z) { return (z * (size + 1) + y) * (size + 1) + x; };
    Array<Triangle> triangles;
    const auto quad = [&](u32 a, u32 b, u32 c, u32 d) {
        triangles.push_back({a, b, c});
        triangles.push_back({a, c, d});
    };
    for (u32 y = 0; y < size; ++y)
        for (u32 x = 0; x < size; ++x) {
            if (x >= first && x < last && y >= first && y < last) continue;
            quad(at(x, y, 1), at(x + 1, y, 1), at(x + 1, y + 1, 1), at(x, y + 1, 1));
            quad(at(x, y, 0), at(x, y + 1, 0), at(x + 1, y + 1, 0), at(x + 1, y, 0));
        }
    const auto walls = [&](u32 low, u32 high, bool outward) {
        for (u32 i = low; i < high; ++i)
            for (const auto& [a, b] :
                 {std::pair(at(i, low, 0), at(i + 1, low, 0)), std::pair(at(high, i, 0), at(high, i + 1, 0)),
                  std::pair(at(i + 1, high, 0), at(i, high, 0)), std::pair(at(low, i + 1, 0), at(low, i, 0))}) {
                const u32 up = (size + 1) * (size + 1);
                outward ? quad(a, b, b + up, a + up) : quad(b, a, a + up, b + up);
            }
    };
    walls(0, size, true);
    walls(first, last, false);
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(triangles);
    return without_unused_vertices(mesh);
}

TEST(HandleLoops, TorusHasTheLoopRoundItsTube) {
    const TriangleMesh mesh = test::torus(1, 0.4, 64, 24);
    const double round = 2 * std::numbers::pi * 0.4;
    EXPECT_THAT(handle_loops(mesh, 0.98 * round, 100, run()), IsEmpty());
    const std::vector<HandleLoop> one = handle_loops(mesh, 1.2 * round, 100, run());
    ASSERT_EQ(one.size(), 1u);
    EXPECT_NEAR(one[0].length, round, 0.02);
    EXPECT_TRUE(is_non_separating(mesh, one[0]));
    EXPECT_EQ(handle_loops(mesh, 10, 100, run()).size(), 1u)
        << "loops along the tube are longer at each of their vertices";
}

TEST(HandleLoops, SurfacesWithoutHandlesHaveNone) {
    EXPECT_THAT(handle_loops(test::cube(), 100, 100, run()), IsEmpty());
    EXPECT_THAT(handle_loops(test::geodesic_sphere(1, 8), 100, 100, run()), IsEmpty());
    EXPECT_THAT(handle_loops({}, 100, 100, run()), IsEmpty());
}

TEST(HandleLoops, HoleThroughABox_HasItsCircumferenceAndTheWayRoundItsWall) {
    const TriangleMesh mesh = box_with_hole(21, 3);
    ASSERT_EQ(topology(mesh).genus, 1);
    const std::vector<HandleLoop> loops = handle_loops(mesh, 30, 100, run());
    ASSERT_EQ(loops.size(), 2u);
    EXPECT_DOUBLE_EQ(loops[0].length, 4 * 3) << "round the hole";
    EXPECT_DOUBLE_EQ(loops[1].length, 2 * (9 + 1)) << "through the hole and round the box";
    for (const HandleLoop& loop : loops) EXPECT_TRUE(is_non_separating(mesh, loop));
}

TEST(HandleLoops, RealModels_HaveLoopsThatDoNotSeparate) {
    for (const test::Model& model : test::dense_models) {
        if (model.genus == 0) continue;
        const auto path = test::found(model);
        if (!path) GTEST_SKIP() << test::missing_data(model.file);
        const Value value = read_file(*path).value;
        const TriangleMesh& mesh = *value.get<TriangleMesh>();
        const std::vector<HandleLoop> loops = handle_loops(mesh, surface_box(mesh).diagonal(), 20, run());
        EXPECT_GE(loops.size(), static_cast<std::size_t>(model.genus)) << model.file;
        for (const HandleLoop& loop : loops) EXPECT_TRUE(is_non_separating(mesh, loop)) << model.file;
    }
}

TEST(DoubtsAboutHandles, WideHandlesAreFine) {
    EXPECT_THAT(judged(test::torus(1, 0.4, 64, 24)), IsEmpty());
    EXPECT_THAT(judged(test::geodesic_sphere(1, 8)), IsEmpty());
}

/// `count` copies of the mesh beside each other.
TriangleMesh copies(const TriangleMesh& one, u32 count) {
    TriangleMesh all;
    Array<Vec3> positions;
    Array<Triangle> triangles;
    for (u32 i = 0; i < count; ++i) {
        const u32 shift = static_cast<u32>(positions.size());
        for (const Vec3& p : one.positions) positions.push_back(p + Vec3(100.0 * i, 0, 0));
        for (const Triangle& t : one.triangles) triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
    }
    all.positions = std::move(positions);
    all.triangles = std::move(triangles);
    return all;
}

TEST(DoubtsAboutHandles, FewNarrowHandlesMayBeReal_ManyOnFewVerticesAreNot) {
    const TriangleMesh one = box_with_hole(21, 1);
    EXPECT_THAT(judged(one), IsEmpty());
    EXPECT_THAT(judged(copies(one, 2)), IsEmpty());
    EXPECT_THAT(judged(copies(one, 3)), ElementsAre(testing::AllOf(HasSubstr("genus 3"), HasSubstr("12 spacings"))));
}

TEST(DoubtsAboutHandles, NarrowHandleThroughInventedSurfaceIsDoubtful_AWideOneIsNot) {
    const TriangleMesh narrow = box_with_hole(21, 1), wide = box_with_hole(41, 13);
    const auto all = [](u32) { return true; };
    const auto none = [](u32) { return false; };
    EXPECT_THAT(judged(narrow, all), ElementsAre(testing::AllOf(HasSubstr("genus 1"), HasSubstr("no point shows"))));
    EXPECT_THAT(judged(narrow, none), IsEmpty());
    EXPECT_THAT(judged(wide, all), IsEmpty());
}

TEST(DoubtsAboutHandles, FilledFacesAreInvented) {
    TriangleMesh mesh = box_with_hole(21, 1);
    mesh.face_columns.add(Column("filled", 1, Buffer<u8>(Array<u8>(mesh.triangles.size(), u8(1)))));
    EXPECT_THAT(judged(mesh), ElementsAre(HasSubstr("no point shows")));
}

TEST(DoubtsAboutHandles, OpenSurfacesAreNotJudged) {
    EXPECT_THAT(judged(test::without_triangles(box_with_hole(21, 1), {0})), IsEmpty());
}

}  // namespace
}  // namespace scanmill
