// SPDX-License-Identifier: GPL-3.0-or-later
// Measured points from the output of measuring machines.

#include "formats/dmis_plans.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::span<const u32> touches_of(const PointCloud& cloud) { return cloud.columns.find("touch")->values<u32>(); }
std::span<const double> approaches_of(const PointCloud& cloud) {
    return cloud.columns.find("approach")->values<double>();
}

TEST(DmisResults, OfAMachine_ArePoints) {
    Warnings warnings;
    const auto cloud = points_in(
        "$$ printed by a machine\r\n"
        "filnam/'part 7',05.2\r\n"
        "$$ frame machine\r\n"
        "units/Inch,angdec\r\n"
        "TEXT/OPER,'Pr\xfc"
        "fer: M\xfcller $$ 7'\r\n"
        "fa(p000012a) = Feat/Point , Cart , 1.5, -2, 3e1, 0.6, $\r\n"
        "   0, 0.8\r\n"
        "\r\n"
        "FA(C1)=FEAT/CIRCLE,INNER,CART,0,0,0,0,0,1,5\r\n"
        "FA(P000012B)=FEAT/POINT,CART,1,2,3,-.707,0,.707 $$ the other side\r\n"
        "TEXT/OPER,'done'\r\n"
        "FA(7)=FEAT/POINT,CART,+4,5,6,0,0,1\r\n"
        "ENDFIL\r\n",
        "results.txt", &warnings);
    ASSERT_EQ(cloud->size(), 3u);
    EXPECT_EQ(cloud->frame.unit, LengthUnit::inch);
    EXPECT_EQ(cloud->frame.name, "machine");
    EXPECT_EQ(cloud->frame.origin + cloud->positions[0], Vec3(1.5, -2, 30));
    EXPECT_EQ(cloud->frame.origin + cloud->positions[2], Vec3(4, 5, 6));
    EXPECT_THAT(touches_of(*cloud), ElementsAre(12, 12, 7));
    const auto u = approaches_of(*cloud);
    EXPECT_DOUBLE_EQ(u[0], 0.6);
    EXPECT_DOUBLE_EQ(u[2], 0.8);
    EXPECT_DOUBLE_EQ(u[3], -std::sqrt(0.5)) << "scaled to length 1";
    EXPECT_THAT(warnings.sentences, ElementsAre(AllOf(HasSubstr("passed over 3 statements (1 FA=FEAT/CIRCLE, 2 TEXT)"),
                                                      HasSubstr("2 bytes that are not ASCII"))));
}

TEST(DmisResults, InTheWholeProgram_AreReadWithoutWarnings) {
    const ProbePlan plan = many_touches();
    std::string output = program_of(plan);
    std::string results;
    std::size_t at = 0;
    // What an exact machine adds after each OUTPUT: the nominal point.
    const ProbePlan program = DmisProgram(output).plan();
    std::vector<const ProbeTouch*> made;
    for (const ProbeTouch& touch : program.touches)
        if (touch.is_made()) made.push_back(&touch);
    const std::vector<std::string> labels = DmisProgram(output).labels();
    std::ranges::sort(made, {}, &ProbeTouch::order);
    for (std::size_t i = 0; i < made.size(); ++i) {
        const std::size_t end = output.find('\n', output.find("OUTPUT/FA(" + labels[i], at)) + 1;
        results += output.substr(at, end - at);
        at = end;
        const Vec3 &p = made[i]->position, &u = made[i]->approach;
        results += fmt::format("FA({})=FEAT/POINT,CART,{:.4f},{:.4f},{:.4f},$\n{:.4f},{:.4f},{:.4f}\n", labels[i],
                               p.x(), p.y(), p.z(), u.x(), u.y(), u.z());
    }
    results += output.substr(at);
    Warnings warnings;
    const auto cloud = points_in(results, "results.dmi", &warnings);
    EXPECT_THAT(warnings.sentences, IsEmpty());
    ASSERT_EQ(cloud->size(), made.size());
    EXPECT_EQ(cloud->frame.name, "machine");
    for (std::size_t i = 0; i < made.size(); ++i) {
        EXPECT_EQ(touches_of(*cloud)[i], made[i]->touch);
        EXPECT_EQ(cloud->frame.origin + cloud->positions[i], made[i]->position);
        for (int axis = 0; axis < 3; ++axis)
            EXPECT_NEAR(approaches_of(*cloud)[3 * i + axis], made[i]->approach[axis], 1e-4);
    }
}

const std::string dmis_head = "UNITS/MM,ANGDEC\n", dmis_point = "FA(P1)=FEAT/POINT,CART,1,2,3,0,0,1\n";

TEST(DmisResults, AreRecognisedByContentOrExtension) {
    const auto format = [](const std::string& text, const char* name) { return read_bytes(text, name).format; };
    EXPECT_EQ(format("DMISMN/'A',05.2\n" + dmis_head + dmis_point, "results.xyz"), "DMIS");
    EXPECT_EQ(format("\n$$ x\n filnam/'A'\n" + dmis_head + dmis_point, "results"), "DMIS");
    EXPECT_EQ(format(dmis_head + dmis_point, "results.dmi"), "DMIS");
    EXPECT_THAT(sentence_of([] { read_bytes(dmis_head + dmis_point, "results"); }), HasSubstr("unknown format"));
}

TEST(DmisResults, RequestedInAnotherUnit_AreReadWithAWarning) {
    Warnings warnings;
    ReadOptions options = warnings.reading();
    options.unit = LengthUnit::inch;
    EXPECT_EQ(read_bytes("$$ unit m\n" + dmis_head + dmis_point, "a.dmi", options).value.get<PointCloud>()->frame.unit,
              LengthUnit::inch);
    EXPECT_THAT(warnings.sentences, ElementsAre(AllOf(HasSubstr("'unit mm'"), HasSubstr("in in"))));
}

TEST(DmisResults, LongLinesAndCentres_AreReadWithAWarning) {
    Warnings warnings;
    points_in(dmis_head + "PRCOMP/OFF\n" + "FA(P1)=FEAT/POINT,CART," + std::string(60, ' ') + "1,2,3,0,0,1\n", "a.dmi",
              &warnings);
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("1 line is longer than 80"), HasSubstr("PRCOMP/OFF")));
}

TEST(DmisResults, WithoutTheirEnd_AreReadWithAWarning) {
    Warnings warnings;
    points_in("FILNAM/'A',05.2\n" + dmis_head + dmis_point, "a.dmi", &warnings);
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("does not end with ENDFIL")));
}

TEST(DmisResults, InPolarCoordinates_ArePassedOver) {
    Warnings warnings;
    points_in(dmis_head + dmis_point + "FA(P2)=FEAT/POINT,POL,1,2,3,0,0,1\n", "a.dmi", &warnings);
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("1 statement (1 FA=FEAT/POINT,POL)")));
}

TEST(DmisResults, AfterCommentsInsideAStatement_AreWhole) {
    const auto cloud = points_in(dmis_head + "FA(P1)=FEAT/POINT,CART,1,2,$\n$$ a comment\n3,0,0,1\n", "a.dmi");
    EXPECT_EQ(cloud->frame.origin + cloud->positions[0], Vec3(1, 2, 3));
}

TEST(DmisResults, LastDigitsOfALabel_AreTheTouch) {
    const auto touch = [](const std::string& label) {
        return touches_of(*points_in(dmis_head + "FA(" + label + ")=FEAT/POINT,CART,1,2,3,0,0,1\n", "a.dmi"))[0];
    };
    EXPECT_EQ(touch("P000012"), 12u);
    EXPECT_EQ(touch("P000012B"), 12u);
    EXPECT_EQ(touch("PART3_0007"), 7u);
    EXPECT_EQ(touch("4294967295"), 4294967295u);
}

/// The refusal of the text; it has a hint.
std::string results_refusal(const std::string& text) {
    const Error error = error_of([&] { read_bytes(text, "a.dmi"); });
    EXPECT_FALSE(error.hint().empty()) << error.sentence();
    return error.sentence();
}

TEST(DmisResultsRefuse, WhatIsNoResult) {
    const std::string feature = "F(P1)=FEAT/POINT,CART,1,2,3,0,0,1\n";
    EXPECT_THAT(results_refusal(dmis_head), HasSubstr("holds no measured points"));
    EXPECT_THAT(error_of([] { read_bytes(program_of(one_touch()), "a.dmi"); }).hint(), HasSubstr("it is a program"));
    EXPECT_THAT(results_refusal(dmis_point + dmis_head), AllOf(HasSubstr("line 1"), HasSubstr("before any UNITS")));
    EXPECT_THAT(results_refusal(dmis_head + dmis_point + "UNITS/INCH\n" + dmis_point),
                AllOf(HasSubstr("line 3"), HasSubstr("from MM to INCH")));
    EXPECT_THAT(results_refusal("UNITS/FURLONG\n" + dmis_point), AllOf(HasSubstr("line 1"), HasSubstr("FURLONG")));
    EXPECT_THAT(results_refusal(dmis_head + feature + "MEAS/POINT,F(P2),1\n" + dmis_point),
                AllOf(HasSubstr("line 3"), HasSubstr("MEAS of P2"), HasSubstr("no F(P2)")));
    EXPECT_THAT(results_refusal(dmis_head + feature + dmis_point + "FA(P2)=FEAT/POINT,CART,1,2,3,0,0,1\n"),
                AllOf(HasSubstr("line 4"), HasSubstr("FA of P2")));
    EXPECT_THAT(results_refusal(dmis_head + "MEAS/POINT\n" + dmis_point),
                AllOf(HasSubstr("line 2"), HasSubstr("names no feature")));
    EXPECT_THAT(results_refusal(dmis_head + "S(L1)=SNSDEF/LASER,1\n" + dmis_point),
                AllOf(HasSubstr("line 2"), HasSubstr("L1"), HasSubstr("'LASER'")));
}

TEST(DmisResultsRefuse, TruncatedFiles) {
    EXPECT_THAT(results_refusal(dmis_head + dmis_point + "FA(P2)=FEAT/POINT,CART,1,$\n"),
                AllOf(HasSubstr("line 3"), HasSubstr("ends")));
    EXPECT_THAT(results_refusal(dmis_head + dmis_point + "FA(P2)=FEAT/POINT,CART,1,2,3,0,0,1"), HasSubstr("line 3"));
    EXPECT_THAT(results_refusal(dmis_head + dmis_point + "FA(P2)=FEAT/POINT,CART,1,2"), HasSubstr("line 3"));
    EXPECT_THAT(results_refusal(dmis_head + dmis_point + "$\n \n$"), HasSubstr("line 5"));
    EXPECT_EQ(points_in(dmis_head + dmis_point + "ENDFIL", "a.dmi")->size(), 1u);
    EXPECT_EQ(points_in(dmis_head + dmis_point + "$$ end", "a.dmi")->size(), 1u);
}

TEST(DmisResultsRefuse, BrokenPoints) {
    const auto of_point = [](const std::string& label, const std::string& numbers) {
        return results_refusal(dmis_head + "FA(" + label + ")=FEAT/POINT,CART," + numbers + "\n");
    };
    EXPECT_THAT(of_point("P1", "1,2,3,0,0"), AllOf(HasSubstr("line 2"), HasSubstr("FA(P1) has 5 numbers")));
    EXPECT_THAT(of_point("P1", "1,2,3,0,0,1,7"), HasSubstr("has 7 numbers"));
    EXPECT_THAT(of_point("P1", "1,2,nan,0,0,1"), AllOf(HasSubstr("line 2"), HasSubstr("'NAN'"), HasSubstr("finite")));
    EXPECT_THAT(of_point("P1", "1,2,1e999,0,0,1"), HasSubstr("'1E999'"));
    EXPECT_THAT(of_point("P1", "1 2,3,4,0,0,1"), HasSubstr("'1 2'"));
    EXPECT_THAT(of_point("P1", "1,2,,0,0,1"), HasSubstr("finite number"));
    EXPECT_THAT(of_point("P1", "1,2,3,0,0,0"), HasSubstr("has the length 0, not 1"));
    EXPECT_THAT(of_point("P1", "1,2,3,0,0,1.02"), HasSubstr("1.02"));
    EXPECT_THAT(of_point("EDGE", "1,2,3,0,0,1"), AllOf(HasSubstr("line 2"), HasSubstr("FA(EDGE)")));
    EXPECT_THAT(of_point("P4294967296", "1,2,3,0,0,1"), HasSubstr("too large"));
}

TEST(CsvOfResults, ColumnsIJK_AreTheApproach) {
    const auto cloud = points_in("touch,x,y,z,i,j,k\n12,1,2,3,0,0.6,0.8\n13,4,5,6,0,0,1\n", "a.csv");
    EXPECT_THAT(cloud->columns.find("touch")->values<double>(), ElementsAre(12, 13));
    EXPECT_THAT(approaches_of(*cloud), ElementsAre(0, 0.6, 0.8, 0, 0, 1));
    Warnings warnings;
    points_in("x,y,z,i,j,k\n1,2,3,0,0,2\n", "a.csv", &warnings);
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("directions (i, j, k)")));
    EXPECT_FALSE(points_in("x,y,z,I,J,K\n1,2,3,0,0,1\n", "a.csv")->columns.find("approach")) << "other names";
    EXPECT_FALSE(points_in("x,y,z,i,j\n1,2,3,0,0\n", "a.csv")->columns.find("approach"));
}

}  // namespace
}  // namespace scanmill::test
