// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "filters/sculpt/cases.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::HasSubstr;

TEST(SculptRefuses, NoCells) { EXPECT_THAT(sculpt_refusal(TetMesh{}), HasSubstr("this one has none")); }

TEST(SculptRefuses, UnlabelledCells) {
    EXPECT_THAT(sculpt_refusal(tets_of(dented_cube())), HasSubstr("none of the 12 is labelled"));
}

TEST(SculptRefuses, LabelsOfOtherCells) {
    TetMesh tets = hull_of(dented_cube());
    tets.inside = {1, 1, 1};
    EXPECT_THAT(sculpt_refusal(tets), HasSubstr("labels of all 12 cells; there are 3"));
}

TEST(SculptRefuses, MissingNeighbours) {
    TetMesh tets = hull_of(dented_cube());
    tets.neighbours = {};
    EXPECT_THAT(sculpt_refusal(tets), HasSubstr("neighbours of all 12 cells; there are 0"));
}

TEST(SculptRefuses, NothingInside) {
    TetMesh tets = hull_of(dented_cube());
    Array<u8> inside(12);
    std::ranges::fill(inside, u8(0));
    tets.inside = std::move(inside);
    EXPECT_THAT(sculpt_refusal(tets), HasSubstr("all 12 are outside"));
}

TEST(SculptRefuses, BoundaryThatTouchesItself) {
    // Two cubes that share a corner: only there the triangles form two fans.
    TetMesh tets = tets_of(joined(lattice_cube(2), moved(lattice_cube(2), 1, Vec3(2, 2, 2))));
    Array<u8> inside(tets.cells.size());
    for (std::size_t c = 0; c < inside.size(); ++c) {
        const auto lower = [&](u32 v) { return tets.positions[v].maxCoeff() <= 2; };
        const auto upper = [&](u32 v) { return tets.positions[v].minCoeff() >= 2; };
        inside[c] = std::ranges::all_of(tets.cells[c], lower) || std::ranges::all_of(tets.cells[c], upper);
    }
    tets.inside = std::move(inside);
    EXPECT_THAT(sculpt_refusal(tets),
                testing::AllOf(HasSubstr("boundary is a 2-manifold"), HasSubstr("0 edges have more than two"),
                               HasSubstr("at 1 vertex (first")));
}

TEST(SculptRefuses, NegativeMinGain) {
    SculptParams params;
    params.min_gain = Angle::degrees(-1);
    EXPECT_THAT(sculpt_refusal(hull_of(dented_cube()), params), HasSubstr("at least 0; it is -1 deg"));
}

}  // namespace
}  // namespace scanmill
