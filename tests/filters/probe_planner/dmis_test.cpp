// SPDX-License-Identifier: GPL-3.0-or-later
/// What a plan contains for DMIS programs, and planned touches through a program.

#include <gmock/gmock.h>

#include "filters/probe_planner/cases.hpp"
#include "formats/dmis_program.hpp"
#include "scanmill/formats/files.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

TriangleMesh box_in(LengthUnit unit = LengthUnit::millimetre) {
    TriangleMesh mesh = box(Vec3::Zero(), Vec3::Constant(10), 2);
    mesh.frame.unit = unit;
    return mesh;
}

std::string program_of(const ProbePlan& plan) {
    return write_bytes("plan.dmi", std::make_shared<const ProbePlan>(plan));
}

TEST(ProbePlannerDmis, Options_TravelWithThePlan) {
    const TemporaryFolder folder;
    ProbePlannerParams params = probe_of(1, 0.1, 2);
    EXPECT_EQ(planned(box_in(), params).plan.dmis, DmisOptions());
    params.dmis_header = folder.write("header.txt", "\xef\xbb\xbfUNITS/{unit},ANGDEC\n$$ {radius}\n");
    params.dmis_goto = DmisGoto::cart;
    params.dmis_decimals = 5;
    const ProbePlan plan = planned(box_in(), params).plan;
    EXPECT_EQ(plan.dmis, (DmisOptions{"UNITS/{unit},ANGDEC\n$$ {radius}\n", DmisGoto::cart, 5}));
    EXPECT_THAT(program_of(plan), AllOf(HasSubstr("\nUNITS/MM,ANGDEC\n$$ 1.00000\n"), HasSubstr("\nGOTO/CART,")));
    params.dmis_header = folder.write("header.txt", "UNITS/MM,ANGDEC\n");
    EXPECT_NO_THROW(planned(box_in(LengthUnit::unknown), params)) << "the unit may be declared later";
}

TEST(ProbePlannerDmis, APlan_ComesBackFromItsProgram) {
    for (const u32 directions : {1, 2}) {
        ProbePlannerParams params = probe_of(1, 0.1, 2);
        params.directions = directions;
        const ProbePlan plan = planned(box_in(), params).plan;
        const std::string program = program_of(plan);
        const ProbePlan read = DmisProgram(program).plan();
        EXPECT_EQ(program_of(read), program);
        ASSERT_EQ(read.touches.size(), plan.touches.size());
        std::size_t row = 0;
        for (const ProbeTouch& touch : plan.touches) {
            if (!touch.is_made()) continue;
            const ProbeTouch& other = read.touches[row++];
            EXPECT_EQ(other.touch, touch.touch);
            EXPECT_EQ(other.order, touch.order);
            EXPECT_LE((other.position - plan.frame.origin - touch.position).norm(), 1e-4);
            EXPECT_LE((other.start - plan.frame.origin - touch.start).norm(), 1e-4);
            EXPECT_LE((other.approach - touch.approach).norm(), 1e-4);
        }
        EXPECT_GE(row, 40u) << "five touches at each edge that does not face down";
    }
}

TEST(ProbePlannerDmis, UnusableHeaders_AreRefused) {
    const TemporaryFolder folder;
    const auto refusal = [&](std::string_view header) {
        ProbePlannerParams params = probe_of(1, 0.1, 2);
        params.dmis_header = folder.write("header.txt", header);
        const Error error = error_of([&] { planned(box_in(), params); });
        EXPECT_FALSE(error.hint().empty()) << error.sentence();
        EXPECT_THAT(error.sentence(), StartsWith("'" + params.dmis_header->string() + "': "));
        return error.sentence();
    };
    EXPECT_THAT(refusal("UNITS/MM,ANGDEC\n$$ {r}\n"), AllOf(HasSubstr("line 2"), HasSubstr("'{r}'")));
    EXPECT_THAT(refusal("UNITS/INCH,ANGDEC\n"), AllOf(HasSubstr("UNITS/INCH"), HasSubstr("UNITS/MM")));
    EXPECT_THAT(refusal("MODE/MAN\n"), HasSubstr("no UNITS"));
    ProbePlannerParams params = probe_of(1, 0.1, 2);
    params.dmis_header = folder / "missing.txt";
    EXPECT_THAT(sentence_of([&] { planned(box_in(), params); }), HasSubstr("missing.txt"));
    params = probe_of(1, 0.1, 2);
    params.dmis_decimals = 13;
    EXPECT_EQ(sentence_of([&] { planned(box_in(), params); }), "dmis-decimals must be from 0 to 12; it is 13");
}

}  // namespace
}  // namespace scanmill::test
