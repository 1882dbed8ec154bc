// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/mesh/creases.hpp"

#include <gmock/gmock.h>

#include <numbers>
#include <random>
#include <set>

#include "scanmill/data/half_edges.hpp"
#include "support/mesh_operations.hpp"
#include "support/numbers.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::HasSubstr;
using testing::IsEmpty;

Execution with_threads(unsigned threads) {
    ExecutionOptions options;
    options.threads = threads;
    return Execution(options);
}

/// The edges of the half-edges that are marked; checks that opposite half-edges agree and boundary edges are not
/// marked.
std::set<Edge> edges_of(const TriangleMesh& mesh, const std::vector<bool>& sharp) {
    const Array<u32> opposite = half_edges::opposites(mesh);
    EXPECT_EQ(sharp.size(), opposite.size());
    std::set<Edge> edges;
    for (u32 half_edge = 0; half_edge < sharp.size(); ++half_edge) {
        if (!sharp[half_edge]) continue;
        EXPECT_NE(opposite[half_edge], half_edges::boundary);
        EXPECT_TRUE(sharp[opposite[half_edge]]);
        edges.insert(make_edge(half_edges::start(mesh, half_edge), half_edges::end(mesh, half_edge)));
    }
    return edges;
}

Creases creases_of(const TriangleMesh& mesh, const CreaseParams& params, unsigned threads = 1) {
    return find_creases(mesh, half_edges::opposites(mesh), params, with_threads(threads));
}
std::set<Edge> crease_edges(const TriangleMesh& mesh, std::optional<double> noise, double degrees = 40) {
    return edges_of(mesh, creases_of(mesh, {degrees * degree, noise, 0}).sharp);
}

/// 20 by 20 squares with the vertex (column, row) at place(column, row). Vertex numbers are 21 row + column.
constexpr u32 size = 20;
u32 vertex_at(u32 column, u32 row) { return row * (size + 1) + column; }
template <class Place>
TriangleMesh sheet(Place&& place) {
    Array<Vec3> positions;
    Array<Triangle> triangles;
    for (u32 row = 0; row <= size; ++row)
        for (u32 column = 0; column <= size; ++column) positions.push_back(place(column, row));
    for (u32 row = 0; row < size; ++row)
        for (u32 column = 0; column < size; ++column) {
            const u32 a = vertex_at(column, row), b = a + 1, c = vertex_at(column, row + 1), d = c + 1;
            triangles.push_back({a, b, d});
            triangles.push_back({a, d, c});
        }
    TriangleMesh mesh;
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(triangles);
    return mesh;
}
TriangleMesh plane() {
    return sheet([](u32 column, u32 row) { return Vec3(column, row, 0); });
}
/// A sheet of rows of length 1 whose columns turn by the angles at their left: by angle(column), in degrees.
template <class Angle>
TriangleMesh bent(Angle&& angle) {
    std::vector<Vec3> profile{Vec3::Zero()};
    double direction = 0;
    for (u32 column = 0; column < size; ++column) {
        direction -= angle(column) * degree;
        profile.push_back(profile.back() + Vec3(std::cos(direction), 0, std::sin(direction)));
    }
    return sheet([&](u32 column, u32 row) { return Vec3(profile[column] + Vec3(0, row, 0)); });
}
TriangleMesh rounded_roof() {
    return bent([](u32 column) { return column >= 9 && column <= 11 ? 30.0 : 0.0; });
}
/// The edges in column 10 from each row of `rows` to the next one.
std::vector<Edge> middle_edges(std::initializer_list<std::pair<u32, u32>> rows) {
    std::vector<Edge> edges;
    for (const auto& [begin, end] : rows)
        for (u32 row = begin; row < end; ++row) edges.push_back(make_edge(vertex_at(10, row), vertex_at(10, row + 1)));
    return edges;
}
TriangleMesh declaring(TriangleMesh mesh, std::vector<Edge> edges) {
    mesh.sharp_edges = Array<Edge>(edges.begin(), edges.end());
    return mesh;
}
TriangleMesh sampled(TriangleMesh mesh, double bin_size) {
    mesh.vertex_columns.add(
        Column("bin-size", 1, Buffer<double>(Array<double>(mesh.positions.size(), bin_size))).with_length_exponent(1));
    return mesh;
}

TEST(CreasesOfACleanMesh, AreItsSharpEdges) {
    EXPECT_EQ(crease_edges(cube(), std::nullopt).size(), 12u);
    EXPECT_EQ(crease_edges(cube(), 0, 89).size(), 12u);
    EXPECT_THAT(crease_edges(cube(), 0, 90), IsEmpty()) << "an angle equal to the limit is not above it";
    EXPECT_THAT(crease_edges(rounded_roof(), std::nullopt), IsEmpty());
    EXPECT_EQ(crease_edges(rounded_roof(), std::nullopt, 29).size(), 3 * size);
    const std::vector<Edge> one = middle_edges({{8, 9}});
    EXPECT_THAT(crease_edges(declaring(plane(), one), 0), testing::ElementsAreArray(one));
}

TEST(CreasesOfASampledMesh, HaveTheWholeTurnAtOneEdge) {
    const TriangleMesh mesh = sampled(rounded_roof(), 1);
    const Creases creases = creases_of(mesh, {40 * degree, {}, 0});
    EXPECT_EQ(creases.noise, 0) << "an error of the samples is not noise of the vertices";
    std::vector<bool> rows(size, false);
    const std::set<Edge> edges = edges_of(mesh, creases.sharp);
    for (const auto& [a, b] : edges) {
        for (const u32 vertex : {a, b})
            EXPECT_THAT(vertex % (size + 1), testing::AllOf(testing::Ge(9u), testing::Le(12u)));
        if (a / (size + 1) != b / (size + 1)) rows[a / (size + 1)] = true;
    }
    EXPECT_EQ(std::ranges::count(rows, true), size);
    EXPECT_LT(edges.size(), 2 * size) << "one line";
    EXPECT_THAT(crease_edges(mesh, 0), IsEmpty()) << "a given noise takes the place of the sampling error";
}

TEST(CreasesOfASampledMesh, WhoseCreasesAreWhole_AreItsSharpEdges) {
    EXPECT_EQ(crease_edges(sampled(cube(), 1), std::nullopt).size(), 12u);
    const TriangleMesh roof = bent([](u32 column) { return column == 10 ? 60.0 : 0.0; });
    EXPECT_THAT(crease_edges(sampled(roof, 1), std::nullopt), testing::ElementsAreArray(middle_edges({{0, size}})));
}

TEST(CreasesOfASampledMesh, AreNoneWhereItCurvesEvenly) {
    const TriangleMesh arc = bent([](u32) { return 8.0; });
    EXPECT_THAT(crease_edges(sampled(arc, 1), std::nullopt), IsEmpty());
}

/// A cube of 24 by 24 by 24 squares with noise in each coordinate.
TriangleMesh noisy_box(double noise) {
    TriangleMesh mesh = cube_of_squares(24);
    Array<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
    std::mt19937_64 random(5);
    std::normal_distribution<double> normal(0, noise);
    for (Vec3& p : positions)
        for (double& coordinate : p) coordinate += normal(random);
    mesh.positions = std::move(positions);
    return mesh;
}

TEST(CreasesOfANoisyBox, AreItsTwelveEdgesOf24) {
    const TriangleMesh mesh = noisy_box(0.12);
    EXPECT_GT(crease_edges(mesh, 0).size(), 1.2 * 12 * 24) << "noise makes edges sharp";
    const Creases creases = creases_of(mesh, {40 * degree, {}, 0});
    EXPECT_GT(creases.unreliable, 0u);
    EXPECT_NEAR(creases.noise, 0.12, 0.03);
    const std::set<Edge> edges = edges_of(mesh, creases.sharp);
    EXPECT_NEAR(static_cast<double>(edges.size()), 12 * 24, 0.1 * 12 * 24);
    for (const auto& [a, b] : edges) {
        const Vec3 middle = (mesh.positions[a] + mesh.positions[b]) / 2;
        int faces = 0;
        for (const double coordinate : middle) faces += coordinate < 1.5 || coordinate > 22.5;
        EXPECT_GE(faces, 2) << middle.transpose();
    }
}

TEST(CreasesOfANoisyBox, AreTheSameForAnyNumberOfThreads) {
    for (const double noise : {0.0, 0.1}) {
        const TriangleMesh mesh = noisy_box(noise);
        const Creases one = creases_of(mesh, {40 * degree, {}, 0.5}),
                      three = creases_of(mesh, {40 * degree, {}, 0.5}, 3);
        EXPECT_EQ(one.sharp, three.sharp);
        EXPECT_EQ(one.reach, three.reach);
        EXPECT_TRUE(std::ranges::equal(one.normals, three.normals));
    }
}

TEST(NoisyCreases, ShortGapsAreClosed_LongOnesStay) {
    constexpr double noise = 0.1;
    for (const u32 gap : {1u, 2u, 3u}) {
        const TriangleMesh mesh = declaring(plane(), middle_edges({{0, 8}, {8 + gap, size}}));
        EXPECT_THAT(crease_edges(mesh, noise), testing::ElementsAreArray(middle_edges({{0, size}}))) << gap;
        EXPECT_EQ(crease_edges(mesh, 0).size(), size - gap) << "without noise, nothing is added";
    }
    EXPECT_EQ(crease_edges(declaring(plane(), middle_edges({{0, 8}, {12, size}})), noise).size(), 16u);
}

TEST(NoisyCreases, AreNotJoinedAroundACorner) {
    std::vector<Edge> edges = middle_edges({{0, 9}});
    for (u32 column = 12; column < size; ++column)
        edges.push_back(make_edge(vertex_at(column, 9), vertex_at(column + 1, 9)));
    EXPECT_EQ(crease_edges(declaring(plane(), edges), 0.1).size(), 9 + 8u);
}

TEST(NoisyCreases, HaveNoIsolatedShortEdges) {
    const std::vector<Edge> line = middle_edges({{0, size}});
    std::vector<Edge> both = line;
    both.push_back(make_edge(vertex_at(4, 10), vertex_at(4, 11)));
    EXPECT_EQ(crease_edges(declaring(plane(), both), 0).size(), size + 1);
    EXPECT_THAT(crease_edges(declaring(plane(), both), 0.1), testing::ElementsAreArray(line));
}

TEST(NoisyCreases, ContinueBelowTheSharpAngle_DownToHalfOfIt) {
    // A ridge along column 10 whose angle falls from 60 to 0 degrees: by 3 degrees per row.
    const TriangleMesh mesh = sheet([](u32 column, u32 row) {
        const double slope = std::tan((60 - 3.0 * row) / 2 * degree);
        return Vec3(column, row, -slope * std::abs(column - 10.0));
    });
    const auto last_row = [](const std::set<Edge>& edges) {
        u32 last = 0;
        for (const auto& [a, b] : edges) last = std::max(last, b / (size + 1));
        return last;
    };
    const u32 at_40 = 20 / 3 + 1, at_20 = 40 / 3 + 1;
    EXPECT_THAT(last_row(crease_edges(mesh, 0)), testing::AllOf(testing::Ge(at_40 - 1), testing::Le(at_40 + 1)));
    EXPECT_THAT(last_row(crease_edges(mesh, 0.1)), testing::AllOf(testing::Ge(at_40 + 3), testing::Le(at_20 + 2)));
}

TEST(NoisyCreases, AreAllEdgesIfAllAreDeclared) {
    const TriangleMesh flat = plane();
    std::set<Edge> all;
    const Array<u32> opposite = half_edges::opposites(flat);
    for (u32 half_edge = 0; half_edge < opposite.size(); ++half_edge)
        if (opposite[half_edge] != half_edges::boundary)
            all.insert(make_edge(half_edges::start(flat, half_edge), half_edges::end(flat, half_edge)));
    const TriangleMesh mesh = declaring(flat, {all.begin(), all.end()});
    EXPECT_EQ(crease_edges(mesh, 0), all);
    EXPECT_EQ(crease_edges(mesh, 0.1), all);
}

TEST(CreasesWithALeastSize, HaveNoShorterBranchesAndNoSmallerFaces) {
    std::vector<Edge> edges = middle_edges({{0, size}});
    const std::vector<Edge> line = edges;
    for (const u32 column : {10u, 11u}) edges.push_back(make_edge(vertex_at(column, 6), vertex_at(column + 1, 6)));
    edges.push_back(make_edge(vertex_at(10, 12), vertex_at(11, 13)));  // with the next: a triangle beside the line
    edges.push_back(make_edge(vertex_at(10, 13), vertex_at(11, 13)));
    const TriangleMesh mesh = declaring(plane(), edges);
    const auto found = [&](double least_size) {
        return edges_of(mesh, creases_of(mesh, {40 * degree, 0, least_size}).sharp);
    };
    EXPECT_EQ(found(0).size(), size + 4);
    EXPECT_EQ(found(0.5).size(), size + 4);
    EXPECT_EQ(found(2).size(), size + 2) << "the branch is exactly as long; the face, of area 1/2, is smaller";
    EXPECT_EQ(found(2.1).size(), size) << "or, across the small face, as many edges";
}

TEST(Creases, RefuseDeclaredEdgesOfNoTriangle) {
    const TriangleMesh mesh = declaring(cube(), {{0, 7}});
    const Error error = error_of([&] { crease_edges(mesh, 0); });
    EXPECT_THAT(error.sentence(), HasSubstr("an edge of no triangle"));
    EXPECT_THAT(error.hint(), HasSubstr("write the mesh again"));
}

TEST(Creases, CanBeCancelled) {
    ExecutionOptions options;
    options.is_cancelled = [] { return true; };
    const TriangleMesh mesh = noisy_box(0.1);
    EXPECT_THROW(find_creases(mesh, half_edges::opposites(mesh), {40 * degree, 0.1, 0}, Execution(options)), Cancelled);
}

TEST(SamplingError, IsATwelfthOfTheMedianVoxel) {
    EXPECT_EQ(sampling_error(cube()), 0);
    EXPECT_DOUBLE_EQ(sampling_error(sampled(cube(), 3)), 0.25);
    TriangleMesh mesh = cube();
    Array<double> sizes(mesh.positions.size(), 0);  // points that were not thinned
    sizes[0] = 8, sizes[1] = 24, sizes[2] = 80;
    mesh.vertex_columns.add(Column("bin-size", 1, Buffer<double>(std::move(sizes))));
    EXPECT_EQ(sampling_error(mesh), 2);
}

}  // namespace
}  // namespace scanmill
