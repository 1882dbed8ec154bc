// SPDX-License-Identifier: GPL-3.0-or-later
// Creases: closed, with vertices exactly on them, and normals of both sides.
#include "filters/a_patch/sharp_cases.hpp"
#include "filters/tessellate/cases.hpp"
#include "scanmill/geometry/distance/self_intersections.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::HasSubstr;

/// The normal in a triangle's row of the column `corner-normals`.
Vec3 corner_normal(const TriangleMesh& mesh, std::size_t triangle, std::size_t corner) {
    const auto numbers = mesh.face_columns.find("corner-normals")->values<double>();
    return Eigen::Map<const Vec3>(numbers.data() + 9 * triangle + 3 * corner);
}

/// Largest |F| / |grad F| at points.
double off_surface(std::span<const Vec3> points, const PatchComplex& patches) {
    const PatchSurface surface(patches);
    double off = 0;
    for (const Vec3& p : points) {
        const auto tet = surface.locate(p);
        EXPECT_TRUE(tet);
        if (tet) off = std::max(off, std::abs(surface.cell(*tet).first_order_distance(p)));
    }
    return off;
}

/// The two triangles at every crease edge, and the two corners of the edge in each.
struct CreaseSide {
    u32 triangle;
    std::array<u32, 2> corners;
};
std::map<Edge, std::vector<CreaseSide>> sides_of_creases(const TriangleMesh& mesh) {
    std::map<Edge, std::vector<CreaseSide>> sides;
    for (const Edge& edge : mesh.sharp_edges) sides[edge];
    for (u32 f = 0; f < mesh.triangles.size(); ++f)
        for (u32 i = 0; i < 3; ++i) {
            const u32 a = mesh.triangles[f][i], b = mesh.triangles[f][(i + 1) % 3];
            const auto found = sides.find(make_edge(a, b));
            if (found == sides.end()) continue;
            found->second.push_back(a < b ? CreaseSide{f, {i, (i + 1) % 3}} : CreaseSide{f, {(i + 1) % 3, i}});
        }
    return sides;
}

TEST(TessellateSharp, ACube_IsItself) {
    for (const double angle : {0.0, 1.0}) {
        const TriangleMesh mesh = sharp_cube(angle);
        const PatchComplex patches = patched(mesh).result.patches;
        for (const TriangleMesh& result : {tessellated(patches, 1), tessellated(patches, 4, Length(1e-6))}) {
            expect_closed(result, mesh);
            // Every triangle's base point, and no strips.
            EXPECT_EQ(result.triangles.size(), 36u);
            EXPECT_TRUE(std::ranges::equal(result.sharp_edges, mesh.sharp_edges));
            for (u32 f = 0; f < result.triangles.size(); ++f) {
                const Triangle& t = result.triangles[f];
                const Vec3 n = (result.positions[t[1]] - result.positions[t[0]])
                                   .cross(result.positions[t[2]] - result.positions[t[0]])
                                   .normalized();
                for (std::size_t i = 0; i < 3; ++i) EXPECT_LT((corner_normal(result, f, i) - n).norm(), 1e-14);
            }
        }
        const TriangleMesh fine = tessellated(patches, 5);
        expect_closed(fine, mesh);
        EXPECT_EQ(fine.sharp_edges.size(), 12u * 5);
        EXPECT_NEAR(area(fine), 6, 1e-13);
    }
}

struct Round {
    const char* name;
    TriangleMesh mesh;
    double (*distance)(const Vec3&);
    double worst;  ///< distance of the surface from the object
    /// The creases: radius and height.
    std::vector<std::array<double, 2>> rims;
};

double cone_distance(const Vec3& p) {
    return std::min(std::abs(std::hypot(p.x(), p.y()) + p.z() - 1) / std::sqrt(2.0), std::abs(p.z()));
}

std::vector<Round> rounds() {
    // The outer radius of the plates is 3, so their errors are those of 8, 12, … segments times 3.
    return {{"cylinder of 16", cylinder(16), cylinder_distance, 1.9e-4, {{1, -1}, {1, 1}}},
            {"cylinder of 32", cylinder(32), cylinder_distance, 1.2e-5, {{1, -1}, {1, 1}}},
            {"cone of 16", cone(16), cone_distance, 1.3e-6, {{1, 0}}},
            {"hole of 16", plate_with_hole(16), hole_distance, 3 * 2e-4, {{1, -1}, {1, 1}, {3, -1}, {3, 1}}},
            {"hole of 24", plate_with_hole(24), hole_distance, 3 * 5e-5, {{1, -1}, {1, 1}, {3, -1}, {3, 1}}},
            {"pocket of 16", plate_with_pocket(16), boss_distance, 3 * 2e-4, {{1, 0}, {1, 1}, {3, -1}, {3, 1}}},
            {"boss of 16", plate_with_boss(16), boss_distance, 3 * 2e-4, {{1, 0}, {1, 1}, {3, -1}, {3, 0}}},
            {"boss of 24", plate_with_boss(24), boss_distance, 3 * 5e-5, {{1, 0}, {1, 1}, {3, -1}, {3, 0}}}};
}

TEST(TessellateSharp, RoundRims_AreClosedAndExact) {
    for (const Round& round : rounds()) {
        SCOPED_TRACE(round.name);
        const PatchComplex patches = patched(round.mesh).result.patches;
        for (const TriangleMesh& result :
             {tessellated(patches, 1), tessellated(patches, 3), tessellated(patches, 16),
              tessellated(patches, 256, Length(1e-2)), tessellated(patches, 256, Length(1e-3))}) {
            expect_closed(result, round.mesh);
            EXPECT_LT(off_surface(result.positions.span(), patches), 1e-12);
            for (const Vec3& p : result.positions) EXPECT_LT(round.distance(p), round.worst);
            EXPECT_GE(result.sharp_edges.size(), round.mesh.sharp_edges.size());
            // No triangle is turned over, nor lies across a crease.
            for (u32 f = 0; f < result.triangles.size(); ++f) {
                const Triangle& t = result.triangles[f];
                const Vec3 across = (result.positions[t[1]] - result.positions[t[0]])
                                        .cross(result.positions[t[2]] - result.positions[t[0]]);
                for (std::size_t i = 0; i < 3 && across.norm() > 1e-8; ++i)
                    if (const Vec3 n = corner_normal(result, f, i); !n.isZero(0)) {
                        EXPECT_GT(across.normalized().dot(n), 0.7);
                    }
            }
            for (const auto& [edge, sides] : sides_of_creases(result)) {
                ASSERT_EQ(sides.size(), 2u);
                for (std::size_t end = 0; end < 2; ++end) {
                    const Vec3& p = result.positions[edge[end]];
                    // On the rim in both directions.
                    double off = 1;
                    for (const auto& [radius, height] : round.rims)
                        off = std::min(off,
                                       std::max(std::abs(std::hypot(p.x(), p.y()) - radius), std::abs(p.z() - height)));
                    EXPECT_LT(off, 1.5 * round.worst);
                    const Vec3 one = corner_normal(result, sides[0].triangle, sides[0].corners[end]),
                               other = corner_normal(result, sides[1].triangle, sides[1].corners[end]);
                    const double angle = std::acos(one.dot(other)) * 180 / std::numbers::pi;
                    EXPECT_NEAR(angle, std::string_view(round.name).starts_with("cone") ? 135 : 90, 1);
                }
            }
        }
    }
}

TEST(TessellateSharp, MaxError_IsKeptBesideCreases) {
    for (const Round& round : rounds()) {
        SCOPED_TRACE(round.name);
        const PatchComplex patches = patched(round.mesh).result.patches;
        for (const double error : {1e-2, 2e-3}) {
            const TriangleMesh result = tessellated(patches, 256, Length(error));
            Random random(1);
            double worst = 0;
            for (const Triangle& t : result.triangles)
                for (int i = 0; i < 5; ++i) {
                    double a = random.uniform(0, 1), b = random.uniform(0, 1);
                    if (a + b > 1) a = 1 - a, b = 1 - b;
                    const Vec3 p =
                        a * result.positions[t[0]] + b * result.positions[t[1]] + (1 - a - b) * result.positions[t[2]];
                    worst = std::max(worst, round.distance(p));
                }
            EXPECT_LT(worst, 1.5 * error + round.worst);
        }
    }
}

TEST(TessellateSharp, RoundRims_DoNotIntersect) {
    for (const Round& round : rounds()) {
        const TriangleMesh result = tessellated(patched(round.mesh).result.patches, 4);
        const TriangleTree tree(result.positions.span(), result.triangles.span(), 1);
        Execution execution;
        EXPECT_EQ(self_intersections(result.positions.span(), result.triangles.span(), tree, execution).count, 0u)
            << round.name;
    }
}

TEST(TessellateSharp, AnyMixtureOfSegments_FitsTogether) {
    for (const Round& round : rounds()) {
        const PatchComplex patches = patched(round.mesh).result.patches;
        for (std::uint64_t seed = 0; seed < 3; ++seed) {
            std::map<Edge, unsigned> segments;
            Random random(seed);
            for (const Triangle& t : round.mesh.triangles)
                for (std::size_t i = 0; i < 3; ++i)
                    segments.try_emplace(make_edge(t[i], t[(i + 1) % 3]), 1u << random.index(4));
            TessellateParams params;
            params.segments = [&](Edge edge) { return segments.at(edge); };
            expect_closed(tessellated(patches, params), round.mesh);
        }
    }
}

/// The patches without the rows beside edges that are `removed` for their row.
PatchComplex without_gaps(const PatchComplex& whole, const std::function<bool(u32)>& removed) {
    Array<u32> rows;
    std::vector<u32> number(whole.tets.size(), PatchComplex::no_partner);
    for (u32 row = 0; row < whole.tets.size(); ++row)
        if (whole.kinds[row] == PatchKind::face || whole.kinds[row] == PatchKind::continuation || !removed(row)) {
            number[row] = static_cast<u32>(rows.size());
            rows.push_back(row);
        }
    EXPECT_LT(rows.size(), whole.tets.size());
    PatchComplex part = whole;
    part.tets = gather(whole.tets, rows);
    part.weights = gather(whole.weights, rows);
    part.kinds = gather(whole.kinds, rows);
    part.sides = gather(whole.sides, rows);
    part.triangles = gather(whole.triangles, rows);
    part.edges = gather(whole.edges, rows);
    part.combine = gather(whole.combine, rows);
    Array<u32> partners;
    for (const u32 row : rows)
        partners.push_back(whole.partners[row] == PatchComplex::no_partner ? PatchComplex::no_partner
                                                                           : number[whole.partners[row]]);
    part.partners = std::move(partners);
    return part;
}

TEST(TessellateSharp, AStraightEdgeWithoutTetrahedraBesideIt_IsTheSegmentItself) {
    const PatchComplex whole = patched(sharp_cube()).result.patches;
    const PatchComplex part = without_gaps(whole, [&](u32 row) { return whole.kinds[row] == PatchKind::sharp; });
    const TriangleMesh one = tessellated(whole, 4), other = tessellated(part, 4);
    EXPECT_TRUE(std::ranges::equal(one.positions, other.positions));
    EXPECT_TRUE(std::ranges::equal(one.triangles, other.triangles));
    EXPECT_TRUE(std::ranges::equal(one.sharp_edges, other.sharp_edges));
    EXPECT_TRUE(one.face_columns == other.face_columns);
}

TEST(Tessellate, EdgesWithoutTetrahedraBesideThem_AreClosedByStraightLinesOrAMitre) {
    // The tangent planes meet within the square of the bulge of the arcs, whose radius is 1.
    const double bulge = 1 - std::cos(std::numbers::pi / 12), most = 2 * bulge * bulge;
    for (const TriangleMesh& mesh : {exact_sphere(2), exact_torus(12, 6), cylinder(12), plate_with_hole(12)}) {
        const PatchComplex whole = patched(mesh).result.patches;
        for (u32 modulus = 1; modulus <= 3; ++modulus)
            for (const u8 side : {0, 1, 2}) {
                const PatchComplex part = without_gaps(whole, [&](u32 row) {
                    return whole.edges[row] % modulus == 0 && (side == 2 || whole.sides[row] == side);
                });
                for (const TriangleMesh& result : {tessellated(part, 1), tessellated(part, 3), tessellated(part, 4),
                                                   tessellated(part, 64, Length(1e-2))}) {
                    expect_closed(result, mesh);
                    std::vector<Vec3> on_creases, others;
                    std::vector<bool> is_on_crease(result.positions.size(), false);
                    for (const Edge& edge : result.sharp_edges) is_on_crease[edge[0]] = is_on_crease[edge[1]] = true;
                    for (std::size_t v = 0; v < is_on_crease.size(); ++v)
                        (is_on_crease[v] ? on_creases : others).push_back(result.positions[v]);
                    EXPECT_LT(off_surface(others, whole), 1e-12);
                    EXPECT_LT(off_surface(on_creases, whole), most);
                }
            }
    }
}

TEST(TessellateSharp, GapsWhoseFunctionsHaveNoSurfaceBetweenTheApexes_AreClosedByStraightLines) {
    const TriangleMesh mesh = cylinder(16);
    PatchComplex patches = patched(mesh).result.patches;
    Array<PatchWeights> weights(patches.weights.begin(), patches.weights.end());
    std::size_t changed = 0;
    for (std::size_t row = 0; row < weights.size(); ++row)
        if (patches.kinds[row] == PatchKind::sharp && patches.sides[row] == 1) {
            // Those of the other triangle's apex: outside, both functions become negative between the apexes.
            std::fill_n(weights[row].begin(), 10, -1.0);
            ++changed;
        }
    ASSERT_GT(changed, 0u);
    patches.weights = std::move(weights);
    for (const unsigned subdivision : {1u, 3u, 4u}) expect_closed(tessellated(patches, subdivision), mesh);
}

TEST(TessellateRefuses, ASideWithHalfOfItsTetrahedra) {
    const PatchComplex whole = patched(cylinder(8)).result.patches;
    u32 first = 0;
    while (whole.kinds[first] != PatchKind::edge) ++first;
    const Error error = error_of([&] { tessellated(without_gaps(whole, [&](u32 row) { return row == first; }), 4); });
    EXPECT_THAT(error.sentence(), HasSubstr("not complete"));
    EXPECT_FALSE(error.hint().empty());
}

}  // namespace
}  // namespace scanmill
