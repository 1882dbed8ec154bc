// SPDX-License-Identifier: GPL-3.0-or-later
// Probe plans as DMIS programs, read back by an independent strict reader.

#include "formats/dmis_plans.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

TEST(DmisProgram, OfOneTouch_IsTheProgramByHand) {
    Warnings warnings;
    EXPECT_EQ(program_of(one_touch(), &warnings),
              "DMISMN/'PROBES',05.2\n"
              "FILNAM/'PROBES',05.2\n"
              "UNITS/MM,ANGDEC\n"
              "DECPL/ALL,4\n"
              "$$ frame machine\n"
              "$$ radius 1\n"
              "$$ scanner-error 0.25\n"
              "$$ stylus-length 20\n"
              "S(TIP1)=SNSDEF/PROBE,FIXED,CART,0.0000,0.0000,-20.0000,0.0000,0.0000,-1.0000,$\n"
              "2.0000\n"
              "SNSLCT/S(TIP1)\n"
              "PRCOMP/ON\n"
              "MODE/PROG,MAN\n"
              "SNSET/APPRCH,4.0000\n"
              "SNSET/RETRCT,4.0000\n"
              "SNSET/SEARCH,1.5000\n"
              "SNSET/CLRSRF,2.0000\n"
              "GOTO/0.0000,0.0000,50.0000\n"
              "GOTO/0.0000,0.0000,18.0000\n"
              "GOTO/1.0000,2.0000,8.0000\n"
              "F(P000012)=FEAT/POINT,CART,1.0000,2.0000,3.0000,0.0000,0.0000,1.0000\n"
              "MEAS/POINT,F(P000012),1\n"
              "PTMEAS/CART,1.0000,2.0000,3.0000,0.0000,0.0000,1.0000\n"
              "ENDMES\n"
              "OUTPUT/FA(P000012)\n"
              "GOTO/1.0000,2.0000,8.0000\n"
              "ENDFIL\n");
    EXPECT_THAT(warnings.sentences, IsEmpty());
}

void expect_plan_of_program(const ProbePlan& written, const ProbePlan& read, double step) {
    EXPECT_EQ(read.frame.unit, written.frame.unit);
    EXPECT_EQ(read.frame.name, written.frame.name);
    EXPECT_EQ(read.radius, written.radius);
    EXPECT_EQ(read.scanner_error, written.scanner_error);
    EXPECT_EQ(read.stylus_length, written.stylus_length);
    EXPECT_NEAR(read.clearance, written.clearance, step / 2);
    EXPECT_LE((read.machine_axis - written.machine_axis).norm(), 1e-4);
    std::vector<const ProbeTouch*> made;
    for (const ProbeTouch& touch : written.touches)
        if (touch.is_made()) made.push_back(&touch);
    ASSERT_EQ(read.touches.size(), written.touches.size());
    // Each coordinate is rounded to the step, and to double.
    const double rounding = 0.501 * step + 4e-16 * written.frame.origin.cwiseAbs().maxCoeff();
    const auto far = [&](const Vec3& a, const Vec3& b) { return (a - b).cwiseAbs().maxCoeff(); };
    for (std::size_t row = 0; row < made.size(); ++row) {
        const ProbeTouch &one = *made[row], &other = read.touches[row];
        EXPECT_EQ(one.touch, other.touch);
        EXPECT_EQ(one.order, other.order);
        EXPECT_LE(far(written.frame.origin + one.position, other.position), rounding);
        EXPECT_LE(far(written.frame.origin + one.start, other.start), rounding);
        EXPECT_LE(far(one.approach, other.approach), 0.501e-4);
    }
}

TEST(DmisProgram, ReadWrittenAgain_IsEqualByteForByte) {
    std::map<std::string, ProbePlan> plans{{"one", one_touch()}, {"many", many_touches()}};
    plans["inches"] = many_touches();
    plans["inches"].frame.unit = LengthUnit::inch;
    plans["cart"] = many_touches();
    plans["cart"].dmis.moves = DmisGoto::cart;
    plans["small ball"] = many_touches();
    plans["small ball"].radius = 0.00123;
    plans["few decimals"] = many_touches();
    plans["few decimals"].dmis.decimals = 1;
    plans["none"] = one_touch();
    plans["none"].dmis.decimals = 0;
    plans["most"] = many_touches();
    plans["most"].dmis.decimals = DmisOptions::most_decimals;
    plans["no name"] = many_touches();
    plans["no name"].frame.name.clear();
    plans["far"] = many_touches();
    plans["far"].frame.origin = Vec3(5e8, -5e8, 5e8);
    for (const auto& [name, plan] : plans) {
        SCOPED_TRACE(name);
        const std::string once = program_of(plan);
        const DmisProgram program(once);
        expect_plan_of_program(plan, program.plan(), std::pow(10.0, -double(program.decimals())));
        EXPECT_EQ(program_of(program.plan()), once);
    }
}

TEST(DmisProgram, TwoDirections_EndWithAAndB) {
    ProbePlan plan = empty_plan();
    add_touch(plan, 1, Vec3(1, 2, 3), Vec3(1, 0, 1), 5);
    add_touch(plan, 1, Vec3(1, 2, 3), Vec3(-1, 0, 1), 5);
    add_touch(plan, 1234567, Vec3(9, 2, 3), Vec3(-1, 0, 1), 5);
    EXPECT_THAT(DmisProgram(program_of(plan)).labels(), ElementsAre("P000001A", "P000001B", "P1234567"));
    plan.touches[1].reason = ProbeReason::obstructed;
    EXPECT_THAT(DmisProgram(program_of(plan)).labels(), ElementsAre("P000001", "P1234567"));
}

TEST(DmisProgram, HasAsManyDecimals_AsKeepAShareOfTheRadius) {
    const auto decimals = [](double radius) {
        ProbePlan plan = one_touch();
        plan.radius = radius;
        Warnings warnings;
        const std::size_t found = DmisProgram(program_of(plan, &warnings)).decimals();
        EXPECT_THAT(warnings.sentences, IsEmpty()) << radius;
        return found;
    };
    EXPECT_EQ(decimals(4), 4u);
    EXPECT_EQ(decimals(1), 4u);
    EXPECT_EQ(decimals(0.5), 5u);
    EXPECT_EQ(decimals(0.001), 7u);
    ProbePlan plan = one_touch();
    plan.dmis.decimals = 2;
    Warnings warnings;
    EXPECT_EQ(DmisProgram(program_of(plan, &warnings)).decimals(), 2u);
    EXPECT_THAT(warnings.sentences, ElementsAre(AllOf(HasSubstr("2 decimals"), HasSubstr("0.01 of the ball's"))));
}

TEST(DmisProgram, HasNoNegativeZero) {
    ProbePlan plan = empty_plan();
    add_touch(plan, 0, Vec3(-1e-9, -0.0, -4e-5), Vec3(-1e-9, 0, 1), 5);
    const std::string text = program_of(plan);
    EXPECT_THAT(text, HasSubstr("CART,0.0000,0.0000,0.0000,0.0000,0.0000,1.0000"));
    EXPECT_THAT(text, Not(HasSubstr("-0.0000")));
}

TEST(DmisProgram, TheApproachDistance_IsTheShortest) {
    ProbePlan plan = one_touch();
    add_touch(plan, 13, Vec3(5, 5, 5), Vec3::UnitX(), 3.5);
    EXPECT_EQ(DmisProgram(program_of(plan)).approach(), 2.5) << "the way beyond a start is not checked";
}

TEST(DmisProgram, UnmadeTouches_AreCounted) {
    ProbePlan plan = one_touch();
    add_unmade(plan, 13);
    add_unmade(plan, 14);
    Warnings warnings;
    EXPECT_THAT(program_of(plan, &warnings), HasSubstr("\n$$ touches left out: 2\n"));
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("2 touches that cannot be made were left out")));
}

TEST(DmisProgram, OfMicrometres_IsInMillimetres) {
    ProbePlan plan = one_touch();
    plan.frame.unit = LengthUnit::micrometre;
    plan.radius = 1000;
    Warnings warnings;
    const ProbePlan read = DmisProgram(program_of(plan, &warnings)).plan();
    EXPECT_EQ(read.frame.unit, LengthUnit::millimetre);
    EXPECT_EQ(read.radius, 1);
    EXPECT_EQ(read.touches[0].position, Vec3(0.001, 0.002, 0.003));
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("no micrometres")));
}

TEST(DmisProgram, AFrameOfOtherCharacters_IsNamedInAscii) {
    ProbePlan plan = one_touch();
    plan.frame.name =
        "Pr\xc3\xbc"
        "fst\xc3\xa4nde $" +
        std::string(100, 'x');
    Warnings warnings;
    const DmisProgram program(program_of(plan, &warnings));
    EXPECT_THAT(program.plan().frame.name, StartsWith("Pr__fst__nde _xx"));
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("as 'Pr__fst__nde")));
}

TEST(DmisProgram, AHeader_HasItsPlaceholdersReplaced) {
    ProbePlan plan = one_touch();
    plan.dmis.header =
        "UNITS/{unit},ANGDEC\r\n$$ r {radius}\tof {diameter}\nTEXT/MAN,'{approach} {retract}'\n"
        "SNSET/SEARCH,{search}\nSNSET/CLRSRF,{clearance}";
    EXPECT_THAT(program_of(plan), StartsWith("DMISMN/'PROBES',05.2\nFILNAM/'PROBES',05.2\nUNITS/MM,ANGDEC\n"
                                             "$$ r 1.0000 of 2.0000\nTEXT/MAN,'4.0000 4.0000'\n"
                                             "SNSET/SEARCH,1.5000\nSNSET/CLRSRF,2.0000\nGOTO/"));
    plan.dmis.header = "UNITS/MM,ANGDEC\nTEXT/MAN,'" + std::string(100, 'x') + "'\n";
    EXPECT_THAT(program_of(plan),
                HasSubstr("\nTEXT/MAN,$\n'" + std::string(78, 'x') + "$\n" + std::string(22, 'x') + "'\nGOTO/"));
}

TEST(DmisProgram, ItsOptions_AreInTheJsonOfThePlan) {
    ProbePlan plan = one_touch();
    const auto through_json = [](const ProbePlan& one) {
        const std::string text = write_bytes("plan.json", std::make_shared<const ProbePlan>(one));
        return std::pair(text, *read_bytes(text, "plan.json").value.get<ProbePlan>());
    };
    EXPECT_THAT(through_json(plan).first, Not(HasSubstr("dmis")));
    plan.dmis = {"UNITS/MM\n", DmisGoto::cart, 6};
    EXPECT_EQ(through_json(plan).second.dmis, plan.dmis);
    plan.dmis.decimals = DmisOptions::auto_decimals;
    EXPECT_EQ(through_json(plan).second.dmis, plan.dmis);
}

/// The refusal of writing; it has a hint.
std::string program_refusal(const ProbePlan& plan) {
    const Error error = error_of([&] { program_of(plan); });
    EXPECT_FALSE(error.hint().empty()) << error.sentence();
    return error.sentence();
}

TEST(DmisProgramRefuses, PlansThatNoMachineCanRun) {
    const auto changed = [](auto&& change) {
        ProbePlan plan = one_touch();
        change(plan);
        return program_refusal(plan);
    };
    EXPECT_THAT(changed([](ProbePlan& p) { p.frame.unit = LengthUnit::unknown; }), HasSubstr("unit is unknown"));
    EXPECT_THAT(changed([](ProbePlan& p) { p.touches[0].reason = ProbeReason::concave; }),
                HasSubstr("no touch of the plan is made: 1 touch"));
    EXPECT_THAT(changed([](ProbePlan& p) { p.radius = 0; }), HasSubstr("radius 0"));
    EXPECT_THAT(changed([](ProbePlan& p) { p.moves.clear(); }), HasSubstr("no clearance move leads to touch 12"));
    EXPECT_THAT(changed([](ProbePlan& p) { p.moves.push_back(p.moves[0]); }), HasSubstr("more than one clearance"));
    EXPECT_THAT(changed([](ProbePlan& p) { p.touches[0].position.x() = 1e13; }), HasSubstr("coordinate 1e+13"));
    EXPECT_THAT(changed([](ProbePlan& p) { p.moves[0].points[0].z() = NAN; }), HasSubstr("coordinate nan"));
    EXPECT_THAT(changed([](ProbePlan& p) { p.touches[0].approach *= 1.001; }), HasSubstr("length 1.001"));
    EXPECT_THAT(changed([](ProbePlan& p) { p.touches[0].touch = 1'000'000'000; }),
                AllOf(HasSubstr("P1000000000"), HasSubstr("at most 10 characters")));
    EXPECT_THAT(changed([](ProbePlan& p) { p.dmis.decimals = 13; }), HasSubstr("13 decimals"));
    EXPECT_THAT(changed([](ProbePlan& p) {
                    for (int i = 0; i < 2; ++i) add_touch(p, 12, Vec3(1, 2, 3), Vec3::UnitX(), 5);
                }),
                HasSubstr("touch 12 occurs 3 times"));
}

TEST(DmisProgramRefuses, Headers) {
    const auto of_header = [](const std::string& header) {
        ProbePlan plan = one_touch();
        plan.dmis.header = header;
        return program_refusal(plan);
    };
    EXPECT_THAT(of_header("UNITS/MM,ANGDEC\n$$ {radiu}\n"),
                AllOf(HasSubstr("line 2"), HasSubstr("'{radiu}'"), HasSubstr("did you mean 'radius'")));
    EXPECT_THAT(of_header("$$\nunits / inch,ANGDEC\n"), AllOf(HasSubstr("line 2"), HasSubstr("INCH"), HasSubstr("MM")));
    EXPECT_THAT(of_header("UNITS/MM\nUNITS/CM\n"), HasSubstr("UNITS/CM, but the plan needs UNITS/MM"));
    EXPECT_THAT(of_header("UNITS/YARD\n"), HasSubstr("YARD"));
    EXPECT_THAT(of_header("$$ UNITS/MM\n"), HasSubstr("no UNITS"));
    EXPECT_THAT(of_header("UNITS/MM\n$$ gr\xfc\xdf"
                          "e\n"),
                AllOf(HasSubstr("line 2"), HasSubstr("0xfc")));
    EXPECT_THAT(of_header("UNITS/MM\nENDFIL\n"), AllOf(HasSubstr("line 2"), HasSubstr("ENDFIL")));
    EXPECT_THAT(of_header("FILNAM/'x'\nUNITS/MM\n"), HasSubstr("FILNAM"));
    EXPECT_THAT(of_header("UNITS/MM\nMODE/PROG,$\n"), HasSubstr("not complete"));
    EXPECT_THAT(of_header("UNITS/MM\n$$ " + std::string(78, 'x')), AllOf(HasSubstr("line 2"), HasSubstr("81")));
    EXPECT_THAT(of_header("UNITS/MM\nF(P000012)=FEAT/PLANE,CART,0,0,0,0,0,1\n"), HasSubstr("P000012"));
}

/// A program of two touches of one point and another one.
std::string two_directions_program() {
    ProbePlan plan = empty_plan();
    add_touch(plan, 1, Vec3(1, 2, 3), Vec3(1, 0, 1), 5);
    add_touch(plan, 1, Vec3(1, 2, 3), Vec3(-1, 0, 1), 5);
    add_touch(plan, 2, Vec3(9, 2, 3), Vec3(0, 0, 1), 6);
    return program_of(plan);
}

/// What the strict reader says of the program in which `from` is replaced once.
std::string dmis_defect(const std::string& from, const std::string& to) {
    std::string text = two_directions_program();
    const std::size_t at = text.find(from);
    if (at == std::string::npos) return "the program has no " + from;
    text.replace(at, from.size(), to);
    try {
        const DmisProgram program(text);
    } catch (const std::runtime_error& error) {
        return error.what();
    }
    return "no defect was found";
}

TEST(StrictDmisReader, FindsEveryDefect) {
    EXPECT_EQ(dmis_defect("GOTO", "GOTO"), "no defect was found");
    EXPECT_THAT(dmis_defect("ENDMES\n", "ENDMES" + std::string(80, ' ') + "\n"), HasSubstr("more than 80"));
    EXPECT_THAT(dmis_defect("frame machine",
                            "frame m\xe4"
                            "chine"),
                HasSubstr("not printable"));
    EXPECT_THAT(dmis_defect("ENDFIL\n", "ENDFIL"), HasSubstr("no line end"));
    EXPECT_THAT(dmis_defect("ENDFIL\n", ""), HasSubstr("without ENDFIL"));
    EXPECT_THAT(dmis_defect("ENDFIL\n", "ENDFIL\nENDMES\n"), HasSubstr("after ENDFIL"));
    EXPECT_THAT(dmis_defect("ENDFIL\n", "ENDFIL$\n"), HasSubstr("not complete"));
    EXPECT_THAT(dmis_defect("P000001B)=", "P000001A)="), HasSubstr("a label twice"));
    EXPECT_THAT(dmis_defect("P000002)=", "P00000000000002)="), HasSubstr("too long"));
    EXPECT_THAT(dmis_defect("P000002)=", "p000002)="), HasSubstr("other characters"));
    EXPECT_THAT(dmis_defect("F(P000002)=FEAT/POINT,CART,9.0000,2.0000,3.0000,0.0000,0.0000,1.0000\n", ""),
                HasSubstr("'MEAS/POINT,F(P000002),1' where"));
    EXPECT_THAT(dmis_defect("MEAS/POINT,F(P000002),1", "MEAS/POINT,F(P000009),1"), HasSubstr("another feature"));
    EXPECT_THAT(dmis_defect("MEAS/POINT,F(P000002),1", "MEAS/POINT,F(P000002),2"), HasSubstr("number of touches"));
    EXPECT_THAT(dmis_defect("OUTPUT/FA(P000002)", "OUTPUT/FA(P000001)"), HasSubstr("output of another feature"));
    EXPECT_THAT(dmis_defect("PTMEAS/CART,9", "PTMEAS/CART,8"), HasSubstr("another point"));
    EXPECT_THAT(dmis_defect("9.0000,2.0000,3.0000,0.0000,0.0000,1.0000", "9.0000,2.0000,3.0000,0.0000,0.0000,1.0002"),
                HasSubstr("not a unit vector"));
    EXPECT_THAT(dmis_defect("2.0000,3.0000,0.0000,0.0000", "2.0000,3.0000,-0.0000,0.0000"), HasSubstr("negative zero"));
    EXPECT_THAT(dmis_defect("9.0000,2.0000,3.0000,", "9.0,2.0000,3.0000,"), HasSubstr("number of decimals"));
    EXPECT_THAT(dmis_defect("UNITS/MM,ANGDEC\n", ""), HasSubstr("UNITS"));
    EXPECT_THAT(dmis_defect("SNSET/APPRCH,4", "SNSET/APPRCH,5"), HasSubstr("retract distance"));
    EXPECT_THAT(dmis_defect("SNSET/SEARCH,1.5", "SNSET/SEARCH,1.4"), HasSubstr("search"));
    EXPECT_THAT(dmis_defect("2.0000\nSNSLCT", "3.0000\nSNSLCT"), HasSubstr("diameter"));
    EXPECT_THAT(dmis_defect("GOTO/9.0000,2.0000,9.0000\nENDFIL", "GOTO/9.0000,2.0000,8.0000\nENDFIL"),
                HasSubstr("return to the start"));
    EXPECT_THAT(dmis_defect("GOTO/0.0000,0.0000,50", "GOTO/CART,0.0000,0.0000,50"), HasSubstr("two spellings"));
}

}  // namespace
}  // namespace scanmill::test
