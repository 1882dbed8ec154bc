// SPDX-License-Identifier: GPL-3.0-or-later
// Probe plans as VTP, as read by VTK.

#include "formats/vtk_support.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::IsNan;

TEST(VtpProbes, TouchesDirectionsAndMoves_AreCellsWithTheirTypes) {
    ProbePlan plan;
    plan.frame = {LengthUnit::inch, Vec3(0, 0, 8), "part"};
    plan.touches.resize(2);
    plan.touches[0].touch = 4;
    plan.touches[0].feature = 2;
    plan.touches[0].approach = Vec3::UnitZ();
    plan.touches[0].start = Vec3(0, 0, 3);
    plan.touches[0].order = 0;
    plan.touches[0].interior_angle = 1.5;
    plan.touches[0].assumed = true;
    plan.touches[0].phi = 0.25;
    plan.touches[0].contact = ProbeContact::elsewhere;
    plan.touches[0].contact_distance = 0.5;
    plan.touches[1].touch = 5;
    plan.touches[1].position = Vec3(1, 0, 0);
    plan.touches[1].reason = ProbeReason::concave;
    plan.moves = {{ProbeMoveType::clearance, 0, {Vec3(9, 0, 9), Vec3(0, 0, 9), Vec3(0, 0, 3)}},
                  {ProbeMoveType::approach, 0, {Vec3(0, 0, 3), Vec3(0, 0, 1)}}};
    const auto data = through_vtp(plan);
    EXPECT_THAT(cells_in(data->GetVerts()), ElementsAre(ElementsAre(0), ElementsAre(1)));
    EXPECT_THAT(cells_in(data->GetLines()), ElementsAre(ElementsAre(2, 3), ElementsAre(4, 5, 6), ElementsAre(7, 8)));
    EXPECT_EQ(point_in(data, 1), Vec3(1, 0, 8));
    EXPECT_EQ(point_in(data, 3), Vec3(0, 0, 11));
    EXPECT_EQ(point_in(data, 4), Vec3(9, 0, 17));
    const auto cell_data = [&](const char* name) { return numbers_in(data->GetCellData()->GetArray(name)); };
    EXPECT_THAT(cell_data("type"), ElementsAre(0, 0, 1, 2, 3));
    EXPECT_THAT(cell_data("touch"), ElementsAre(4, 5, 4, 4, 4));
    EXPECT_THAT(cell_data("feature"), ElementsAre(2, 0, 2, 2, 2));
    EXPECT_THAT(cell_data("reason"), ElementsAre(0, 1, 0, 0, 0));
    EXPECT_THAT(cell_data("assumed"), ElementsAre(1, 0, 1, 1, 1));
    EXPECT_THAT(cell_data("contact"), ElementsAre(2, 0, 2, 2, 2));
    EXPECT_THAT(cell_data("interior_angle"), ElementsAre(1.5, IsNan(), 1.5, 1.5, 1.5));
    EXPECT_THAT(cell_data("phi"), ElementsAre(0.25, IsNan(), 0.25, 0.25, 0.25));
    EXPECT_THAT(cell_data("contact_distance"), ElementsAre(0.5, IsNan(), 0.5, 0.5, 0.5));
    EXPECT_THAT(cell_data("order"), ElementsAre(0, IsNan(), 0, 0, 0)) << "the second touch is not made";
    const std::vector<double> direction = numbers_in(data->GetPointData()->GetArray("direction"));
    ASSERT_EQ(direction.size(), 27u);
    EXPECT_EQ(direction[2], 1);
    EXPECT_EQ(direction[5], 0);
    EXPECT_THAT(texts_in(data->GetFieldData(), "type_names"),
                ElementsAre("touch", "direction", "clearance", "approach", "retract"));
    EXPECT_THAT(texts_in(data->GetFieldData(), "reason_names"),
                ElementsAre("none", "concave", "too-narrow", "too-tilted", "obstructed"));
    EXPECT_THAT(texts_in(data->GetFieldData(), "contact_names"), ElementsAre("none", "edge", "elsewhere", "missed"));
    EXPECT_THAT(texts_in(data->GetFieldData(), "unit"), ElementsAre("in"));
}

}  // namespace
}  // namespace scanmill::test
