// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <limits>

#include "filters/fill_holes/cases.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Error refusal(const TriangleMesh& mesh, const FillHolesParams& params = {}) {
    return error_of([&] { filled(mesh, params); });
}

TEST(FillHolesRefuses, NoTriangles) {
    const Error error = refusal({});
    EXPECT_EQ(error.sentence(), "the mesh has no triangles; fill-holes needs at least one");
    EXPECT_THAT(error.hint(), HasSubstr("scanmill info"));
}

TEST(FillHolesRefuses, LimitsOutOfRange) {
    FillHolesParams params;
    params.max_edges = 2;
    EXPECT_THAT(refusal(cube(), params).sentence(), HasSubstr("max-edges must be at least 3"));
    EXPECT_FALSE(refusal(cube(), params).hint().empty());
    for (const double length : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
        params = {};
        params.max_length = Length(length);
        EXPECT_THAT(refusal(cube(), params).sentence(), HasSubstr("max-length must be above 0"));
        EXPECT_FALSE(refusal(cube(), params).hint().empty());
    }
}

TEST(FillHolesRefuses, RequiredClosing_WithLimits) {
    FillHolesParams params;
    params.must_close = true;
    params.outer = FillHolesParams::Outer::keep;
    EXPECT_THAT(refusal(cube(), params).sentence(), HasSubstr("but `outer: keep` leaves loops open"));
    params.outer = FillHolesParams::Outer::automatic;
    params.max_edges = 9;
    EXPECT_THAT(refusal(cube(), params).sentence(), HasSubstr("but max-edges leaves loops open"));
    EXPECT_FALSE(refusal(cube(), params).hint().empty());
}

TEST(FillHolesRefuses, RequiredClosing_OfASheet) {
    FillHolesParams params;
    params.must_close = true;
    const Error error = refusal(rectangle(2, 1), params);
    EXPECT_EQ(error.sentence(), "1 loop stays open: no triangulation without intersections was found");
    EXPECT_THAT(error.hint(), HasSubstr("closed: auto"));
}

TEST(FillHolesRefuses, NaN) {
    TriangleMesh mesh = cube();
    Array<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
    for (Vec3& position : positions) position.x() = std::numeric_limits<double>::quiet_NaN();
    mesh.positions = std::move(positions);
    EXPECT_THAT(refusal(mesh).sentence(), HasSubstr("8 of 8 vertices"));
}

TEST(FillHolesRefuses, ATriangleWithARepeatedVertex) {
    const Error error = refusal(soup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {1, 1, 2}}));
    EXPECT_EQ(error.sentence(),
              "1 triangle has a repeated vertex; the first is triangle 1, with the vertices 1, 1 and 2");
    EXPECT_THAT(error.hint(), HasSubstr("repair"));
}

TEST(FillHolesRefuses, AnEdgeInThreeTriangles) {
    const Error error =
        refusal(soup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}}, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}));
    EXPECT_THAT(error.sentence(), AllOf(HasSubstr("between vertex 0"), HasSubstr("in 3 triangles")));
    EXPECT_FALSE(error.hint().empty());
}

TEST(FillHolesRefuses, NeighboursOrientedDifferently) {
    const Error error = refusal(soup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}}, {{0, 1, 2}, {0, 1, 3}}));
    EXPECT_THAT(error.sentence(), HasSubstr("in the same direction"));
    EXPECT_FALSE(error.hint().empty());
}

TEST(FillHolesRefuses, AKleinBottle) {
    const Error error = refusal(klein_bottle(24, 12));
    EXPECT_THAT(error.sentence(), HasSubstr("in the same direction"));
    EXPECT_THAT(error.hint(), HasSubstr("one-sided"));
}

}  // namespace
}  // namespace scanmill::test
