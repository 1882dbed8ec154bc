// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <limits>

#include "filters/edge_flip/cases.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Error refusal(const TriangleMesh& mesh, const EdgeFlipParams& params = {}) {
    return error_of([&] { flipped(mesh, params); });
}

TEST(EdgeFlipRefuses, NoTriangles) {
    const Error error = refusal(TriangleMesh{});
    EXPECT_THAT(error.sentence(), HasSubstr("the mesh has no triangles"));
    EXPECT_THAT(error.hint(), HasSubstr("scanmill info"));
}

TEST(EdgeFlipRefuses, AnEdgeInThreeTriangles) {
    const Error error =
        refusal(mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}}, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}));
    EXPECT_THAT(error.sentence(), AllOf(HasSubstr("between vertex 0 (0, 0, 0) and vertex 1 (1, 0, 0)"),
                                        HasSubstr("in 3 triangles, among them 0, 1 and 2")));
    EXPECT_FALSE(error.hint().empty());
}

TEST(EdgeFlipRefuses, AVertexWithTwoFans) {
    const Error error =
        refusal(mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}, {{0, 1, 2}, {0, 3, 4}}));
    EXPECT_THAT(error.sentence(), HasSubstr("vertex 0 (0, 0, 0) form several fans"));
    EXPECT_FALSE(error.hint().empty());
}

TEST(EdgeFlipRefuses, NeighboursOrientedDifferently) {
    const Error error = refusal(mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}}, {{0, 1, 2}, {0, 1, 3}}));
    EXPECT_THAT(error.sentence(), HasSubstr("in the same direction"));
    EXPECT_FALSE(error.hint().empty());
}

TEST(EdgeFlipRefuses, ATriangleWithARepeatedVertex) {
    const Error error = refusal(mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {1, 1, 2}}));
    EXPECT_THAT(error.sentence(), HasSubstr("triangle 1 has the vertices 1, 1 and 2"));
    EXPECT_FALSE(error.hint().empty());
}

std::vector<std::string> warnings_of_flip(const TriangleMesh& mesh) {
    Context context;
    edge_flip(mesh, {}, context);
    return context.warnings();
}

TEST(EdgeFlipWarns, OfVerticesAtOnePosition_UnusedOnesExcepted) {
    TriangleMesh mesh =
        mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 0, 0}, {5, 0, 0}, {1, 0, 0}, {5, 1, 0}}, {{0, 1, 2}, {1, 3, 2}});
    EXPECT_THAT(warnings_of_flip(mesh), IsEmpty()) << "vertices 4 to 6 are in no triangle";
    mesh.triangles = {{0, 1, 2}, {5, 3, 6}};
    EXPECT_THAT(warnings_of_flip(mesh),
                ElementsAre(AllOf(HasSubstr("1 vertex has the position of another"), HasSubstr("stays open"))));
    mesh = mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0, 0, -0.0}}, {{0, 1, 2}, {2, 1, 3}});
    EXPECT_THAT(warnings_of_flip(mesh), ElementsAre(HasSubstr("1 vertex has"))) << "-0 is 0";
}

TEST(EdgeFlipWarns, OfASeam_AndFlipsNothingAcrossIt) {
    // The kite of two triangles, each with its own vertices: its long diagonal is a boundary of both.
    const TriangleMesh joined = kite();
    ASSERT_EQ(flipped(joined).flips.size(), 1u);
    std::vector<Vec3> positions;
    for (const Triangle& triangle : joined.triangles)
        for (const u32 vertex : triangle) positions.push_back(joined.positions[vertex]);
    const TriangleMesh soup = mesh_of(positions, {{0, 1, 2}, {3, 4, 5}});
    EXPECT_THAT(warnings_of_flip(soup), ElementsAre(HasSubstr("2 vertices have the position of another")));
    EXPECT_TRUE(flipped(soup).flips.empty());
}

TEST(EdgeFlip, EdgesWithoutLength_AreNeitherFlippedNorMade) {
    for (const Criterion criterion : all_criteria) {
        // The inner edge has no length; in the second mesh its other diagonal has none.
        const TriangleMesh short_edge =
            mesh_of({{0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {-1, 0.5, 0}}, {{0, 1, 2}, {1, 0, 3}});
        EXPECT_TRUE(flipped(short_edge, criterion).flips.empty());
        const TriangleMesh pocket = mesh_of({{0, 0, 0}, {2, 0, 0}, {1, 0.2, 0}, {1, 0.2, 0}}, {{0, 1, 2}, {1, 0, 3}});
        EXPECT_TRUE(flipped(pocket, criterion).flips.empty());
    }
}

TEST(EdgeFlipRefuses, AVertexThatIsNotFinite) {
    for (const double value : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        const Error error = refusal(mesh_of({{0, 0, 0}, {1, 0, 0}, {0, value, 0}}, {{0, 1, 2}}));
        EXPECT_THAT(error.sentence(), AllOf(HasSubstr("vertices"), HasSubstr("1")));
        EXPECT_FALSE(error.hint().empty() && error.remedy() == Remedy::none);
    }
}

TEST(EdgeFlipRefuses, SharpEdgesThatNoTriangleHas) {
    TriangleMesh mesh = kite();
    mesh.sharp_edges = {{0, 1}, {2, 3}};
    const Error error = refusal(mesh);
    EXPECT_THAT(error.sentence(), HasSubstr("1 of the mesh's 2 sharp edges is an edge of no triangle; the first is "
                                            "between vertices 2 and 3"));
    EXPECT_FALSE(error.hint().empty());
}

TEST(EdgeFlipRefuses, IndicesOutOfRange) {
    EXPECT_THAT(refusal(mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 3}})).sentence(), HasSubstr("3"));
    TriangleMesh mesh = kite();
    mesh.sharp_edges = {{0, 4}};
    EXPECT_THAT(refusal(mesh).sentence(), HasSubstr("4"));
}

TEST(EdgeFlipRefuses, ParametersOutOfRange) {
    EdgeFlipParams params;
    for (const double keep : {-1.0, 60.5, std::numeric_limits<double>::quiet_NaN()}) {
        params.keep_angle = Angle::degrees(keep);
        EXPECT_FALSE(refusal(kite(), params).hint().empty());
        EXPECT_THAT(refusal(kite(), params).sentence(), HasSubstr("keep-angle must be from 0 to 60 deg; it is"));
    }
    params = {};
    for (const double noise :
         {-0.1, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
        params.noise = Length(noise);
        EXPECT_FALSE(refusal(kite(), params).hint().empty());
        EXPECT_THAT(refusal(kite(), params).sentence(), HasSubstr("noise must be 0 or more; it is"));
    }
    params = {};
    for (const double deviation : {-0.1, std::numeric_limits<double>::quiet_NaN()}) {
        params.deviation = Ratio::fraction(deviation);
        EXPECT_FALSE(refusal(kite(), params).hint().empty());
        EXPECT_THAT(refusal(kite(), params).sentence(), HasSubstr("deviation must be 0 or more; it is"));
    }
    params = {};
    for (const double length : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
        params.max_edge = Length(length);
        EXPECT_FALSE(refusal(kite(), params).hint().empty());
        EXPECT_THAT(refusal(kite(), params).sentence(), HasSubstr("max-edge must be above 0; it is"));
    }
}

}  // namespace
}  // namespace scanmill
