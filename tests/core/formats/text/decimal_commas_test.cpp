// SPDX-License-Identifier: GPL-3.0-or-later
// Texts whose numbers have decimal commas.
#include "core/formats/support.hpp"

namespace scanmill::test {
namespace {

using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(DecimalCommas, BesideAnotherSeparator_AreRead) {
    for (const char* text :
         {"1,5;2,25;-3,5e2\n4;5,5;6\n", "1,5 2,25 -3,5e2\n4 5,5 6\n", "1,5\t2,25\t-3,5e2\r\n4\t5,5\t6\r\n",
          "1,5|2,25|-3,5e2\n4|5,5|6", "# exported\n1,5; 2,25; -3,5e2\n4; 5,5; 6\n"}) {
        Warnings warnings;
        EXPECT_THAT(rows_of(points_in(text, "a.csv", &warnings)->positions),
                    ElementsAre(Vec3(1.5, 2.25, -350), Vec3(4, 5.5, 6)))
            << text;
        EXPECT_THAT(warnings.sentences, IsEmpty());
    }
}

TEST(DecimalCommas, MayBeginAfterRowsOfWholeNumbers_AndAfterNamesOrACount) {
    EXPECT_THAT(rows_of(points_in("0;0;0\n1,5;2,5;3,5\n", "a.csv")->positions),
                ElementsAre(Vec3(0, 0, 0), Vec3(1.5, 2.5, 3.5)));
    const auto named = points_in("Y;X;Z;Intensity\n1,5;2,5;3,5;0,25\n", "a.csv");
    EXPECT_EQ(world_of(*named, 0), Vec3(2.5, 1.5, 3.5));
    EXPECT_THAT(numbers_of<double>(named->columns.find("Intensity")), ElementsAre(0.25));
    EXPECT_EQ(points_in("2\n1,5 2,5 3,5\n4,5 5,5 6,5\n", "a.pts")->size(), 2u);
}

TEST(DecimalCommas, AreNotStreamed_AndNeedNoExtension) {
    const TemporaryFolder folder;
    put_file(folder / "a.xyz", "1,5 2,5 3,5\n");
    EXPECT_FALSE(may_be_point_stream(folder / "a.xyz"));
    EXPECT_EQ(open_point_stream(folder / "a.xyz", {}, 1), nullptr);
    put_file(folder / "b.xyz", "0 0 0\n1,5 2,5 3,5\n");
    EXPECT_EQ(open_point_stream(folder / "b.xyz", {}, 1), nullptr);
    EXPECT_EQ(read_bytes("1,5;2,5;3,5\n", "noname").format, "XYZ");
}

TEST(DecimalCommas_Refuses, DecimalPointsInTheSameText) {
    EXPECT_THAT(refusal_of("1,5;2,5;3,5\n4;5.5;6\n", "a.csv"),
                ContainsRegex("'a.csv': line 2: '5.5' .*point.* line 1 .*comma"));
    EXPECT_THAT(refusal_of("1.5;2.5;3.5\n4,5;5,5;6,5\n", "a.csv"),
                ContainsRegex("'a.csv': line 1: '1.5' .*point.* line 2 .*comma"));
    EXPECT_THAT(refusal_of("1,5;2,5;3,5\n1.234,5;0;0\n", "a.csv"), HasSubstr("line 2: '1.234,5' has a decimal point"));
}

TEST(DecimalCommas, BetweenCommas_AreNotGuessed_ButReported) {
    Warnings warnings;
    EXPECT_EQ(world_of(*points_in("1,5,2,5,3,5\n", "a.csv", &warnings), 0), Vec3(1, 5, 2));
    EXPECT_THAT(warnings.sentences, testing::Contains(HasSubstr("are decimal commas")));
    for (const char* clear : {"1,5,2,5,3,5.5\n", "x,y,z,r,g,b\n1,5,2,5,3,5\n", "1 5 2 5 3 5\n", "1,5,2\n"}) {
        Warnings none;
        points_in(clear, "a.csv", &none);
        EXPECT_THAT(none.sentences, testing::Not(testing::Contains(HasSubstr("decimal commas")))) << clear;
    }
}

TEST(DecimalCommas_Refuses, RowsThatAreNeither) {
    EXPECT_THAT(refusal_of("1 2 3\n4,5 6\n", "a.xyz"), HasSubstr("line 2: the numbers have different separators"));
    EXPECT_THAT(refusal_of("1,2,3 4\n", "a.xyz"), HasSubstr("the numbers have different separators"));
    EXPECT_THAT(refusal_of("x,y,z\n1,5,2,5,3,5\n", "a.csv"), HasSubstr("6 columns for 3 names"));
}

TEST(TextTitle, OfNoNames_IsRefusedWithAWayOut) {
    try {
        read_bytes("Exported by a scanner\n1 2 3\n", "a.xyz");
        FAIL();
    } catch (const Error& error) {
        EXPECT_THAT(error.sentence(), HasSubstr("line 1: 'Exported' is neither"));
        EXPECT_THAT(error.hint(), HasSubstr("begin it with #"));
    }
}

}  // namespace
}  // namespace scanmill::test
