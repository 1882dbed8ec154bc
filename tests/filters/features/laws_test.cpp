// SPDX-License-Identifier: GPL-3.0-or-later
// Laws of feature lines on every mesh: order and threads do not matter, and an independent count agrees.

#include <gmock/gmock.h>

#include "filters/features/laws.hpp"

namespace scanmill {
namespace {

using namespace test;

struct Named {
    const char* name;
    TriangleMesh mesh;
};

void PrintTo(const Named& named, std::ostream* stream) { *stream << named.name; }

TriangleMesh uneven_sphere() {
    TriangleMesh sphere = geodesic_sphere(1, 12);
    std::mt19937 source(3);
    std::vector<Vec3> positions(sphere.positions.begin(), sphere.positions.end());
    for (Vec3& p : positions) p *= 1 + 0.02 * static_cast<double>(source() % 1000) / 1000;
    std::vector<Triangle> kept;
    for (const Triangle& t : sphere.triangles)
        if (source() % 10 > 0) kept.push_back(t);
    return mesh_of(positions, kept);
}

/// A plate with holes, and behind it another without: an outer boundary whose first vertex is higher than all holes.
TriangleMesh two_plates() {
    MeshBuilder builder;
    for (const auto& [mesh, shift] :
         {std::pair(plate_with_holes(), Vec3(0, 0, 0)), std::pair(grid(2, 1), Vec3(200, 0, 0))})
        for (const auto& [a, b, c] : mesh.triangles)
            builder.triangle(mesh.positions[a] + shift, mesh.positions[b] + shift, mesh.positions[c] + shift);
    return builder.mesh();
}

class FeatureLaws : public testing::TestWithParam<Named> {};

TEST_P(FeatureLaws, LinesAreTheSame_ForAnyOrderAndNumberOfThreads) {
    FeatureParams params;
    params.sharp_angle = Angle::degrees(20);
    const FeatureLines lines = features_of(GetParam().mesh, params);
    expect_order(lines.graph);
    EXPECT_TRUE(same_graph(lines.graph, features_of(GetParam().mesh, params, 4).graph));
    for (const unsigned seed : {1u, 2u, 3u})
        EXPECT_TRUE(same_graph(lines.graph, features_of(permuted(GetParam().mesh, seed), params, 2).graph));
}

TEST_P(FeatureLaws, LinesAgreeWithAnIndependentCount) {
    for (const double sharp : {10.0, 20.0, 40.0}) expect_counted(GetParam().mesh, sharp, 35);
}

TEST_P(FeatureLaws, NormalsAreUnitVectorsPerpendicularToTheirSegments) { expect_normals(features_of(GetParam().mesh)); }

/// By a power of two.
TriangleMesh scaled(const TriangleMesh& mesh, double scale) {
    TriangleMesh result = mesh;
    Array<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
    for (Vec3& p : positions) p *= scale;
    result.positions = std::move(positions);
    return result;
}

TEST_P(FeatureLaws, LinesAreTheSame_AtAnyScale) {
    const TriangleMesh& mesh = GetParam().mesh;
    FeatureParams params;
    for (const double min_length : {0.0, 0.3}) {
        params.min_length = min_length;
        FeatureGraph plain = features_of(mesh, params).graph;
        const Array<Vec3> positions(plain.positions.begin(), plain.positions.end());
        for (const int exponent : {-20, -7, 7, 20}) {
            const double scale = std::ldexp(1.0, exponent);
            params.min_length = min_length * scale;
            Array<Vec3> expected = positions;
            for (Vec3& p : expected) p *= scale;
            plain.positions = std::move(expected);
            EXPECT_TRUE(same_graph(features_of(scaled(mesh, scale), params).graph, plain)) << exponent;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Shapes, FeatureLaws,
                         testing::Values(Named{"cube", cube()}, Named{"l_block", l_block()},
                                         Named{"tube", frustum(1, 1, 3, 30, false)},
                                         Named{"cone", frustum(1, 0, 1, 17, true)}, Named{"plate", plate_with_holes()},
                                         Named{"grid", grid(5, 3)}, Named{"hinge", hinge(50)},
                                         Named{"uneven_sphere", uneven_sphere()}, Named{"two_plates", two_plates()}),
                         [](const auto& named) { return std::string(named.param.name); });

}  // namespace
}  // namespace scanmill
