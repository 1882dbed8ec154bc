// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of numbers: separators, comments, counts, the layouts of PTS and PWN, Hoppe's points.
#include <random>

#include "core/formats/support.hpp"
#include "support/real_data.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(TextRows_Bars, Separate) {
    EXPECT_THAT(rows_of(points_in("1|2|3\n4 | 5 | 6\n", "a.txt")->positions),
                ElementsAre(Vec3(1, 2, 3), Vec3(4, 5, 6)));
}

TEST(TextRows, TwoKindsOfSeparators_AreRefused) {
    EXPECT_THAT(refusal_of("1,5;2,5\n", "a.csv"), HasSubstr("line 1: the numbers have different separators"));
    EXPECT_THAT(refusal_of("1 2 3\n1.5|2.5 3.5\n", "a.csv"),
                HasSubstr("line 2: the numbers have different separators"));
    EXPECT_THAT(refusal_of("1,5.5\t2.5\n", "a.csv"), HasSubstr("line 1: the numbers have different separators"));
}

TEST(TextRows, QuotedNumbers_AreRefused) {
    EXPECT_THAT(refusal_of("\"X\",\"Y\",\"Z\"\n\"1\",\"-2.5\",\"3\"\n", "a.csv"),
                HasSubstr("line 2: '\"1\"' is not a number"));
}

TEST(TextRows, Comments_BeginWithSlashesToo) {
    const auto cloud = points_in("// unit mm\n1 2 3 // first\n//\n4 5 6\n", "a.asc");
    EXPECT_EQ(cloud->size(), 2u);
    EXPECT_EQ(cloud->frame.unit, LengthUnit::millimetre);
    EXPECT_THAT(refusal_of("1 2 /3\n", "a.asc"), HasSubstr("line 1: '/3' is not a number"));
    EXPECT_THAT(refusal_of("1 2 3\n/\n", "a.asc"), HasSubstr("line 2: '/' is not a number"));
}

TEST(TextRows_Width, ThatChanges_IsRefusedWithItsLine) {
    EXPECT_THAT(refusal_of("1 2 3\n1 2 3\n1 2 3 4\n", "a.xyz"),
                HasSubstr("line 3: found 4 columns; the rows before have 3"));
    EXPECT_THAT(refusal_of("1 2 3 4\n7\n", "a.xyz"), HasSubstr("line 2: found 1 column; the rows before have 4"));
}

TEST(TextRows, CountAndNames_ComeInEitherOrder) {
    for (const char* text :
         {"2\nx y z t\n1 2 3 4\n5 6 7 8\n", "//x y z t\n2\n1 2 3 4\n5 6 7 8\n", "x y z t\n2\n1 2 3 4\n5 6 7 8\n"}) {
        const auto cloud = points_in(text, "a.txt");
        EXPECT_EQ(cloud->size(), 2u) << text;
        EXPECT_THAT(numbers_of<double>(cloud->columns.find("t")), ElementsAre(4, 8)) << text;
    }
}

TEST(TextRows, Count_OfManyPoints_TakesNoMemoryForThem) {
    Warnings warnings;
    EXPECT_EQ(points_in("1099511627776\n1 2 3\n", "a.pts", &warnings)->size(), 1u);
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("line 1 declares 1099511627776 points; 1 follows")));
}

TEST(PtsLayout, FourColumns_AreIntensity_SevenWithColour) {
    const auto four = points_in("2\n1 2 3 -1613\n4 5 6 7\n", "a.pts");
    EXPECT_THAT(numbers_of<double>(four->columns.find("intensity")), ElementsAre(-1613, 7));
    const auto seven = points_in("1\n1 2 3 0.5 10 20 30\n", "a.PTS");
    EXPECT_THAT(numbers_of<double>(seven->columns.find("intensity")), ElementsAre(0.5));
    EXPECT_THAT(numbers_of<u8>(seven->columns.find("colour")), ElementsAre(10, 20, 30));
}

TEST(PtsLayout, SevenColumnsWithoutBytes_KeepTheirNumbers_Reported) {
    Warnings warnings;
    const auto cloud = points_in("1\n1 2 3 0.5 10 20 300\n", "a.pts", &warnings);
    EXPECT_THAT(numbers_of<double>(cloud->columns.find("c7")), ElementsAre(300));
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("c5, c6, c7 are not colours")));
}

TEST(PtsLayout, SixColumns_AreNormalsWhenUnit_ElseColours) {
    EXPECT_NE(points_in("0 0 0 0 0 1\n", "a.pts")->columns.find("normal"), nullptr);
    const auto cloud = points_in("0 0 0 0 0 1\n0 0 0 9 8 7\n", "a.pts");
    EXPECT_THAT(numbers_of<u8>(cloud->columns.find("colour")), ElementsAre(0, 0, 1, 9, 8, 7));
}

TEST(PtsLayout, InAnotherFile_IsNumbered) {
    EXPECT_NE(points_in("1\n1 2 3 4\n", "a.txt")->columns.find("c4"), nullptr);
}

TEST(TextRows_SecondCount, IsRefusedWithAWayOut) {
    const Error error = error_of([] { read_bytes("2\n1 2 3 9\n4 5 6 9\n1\n7 8 9 8\n", "a.pts"); });
    EXPECT_THAT(error.sentence(), HasSubstr("line 4: found 1 column; the rows before have 4"));
    EXPECT_THAT(error.hint(), HasSubstr("another scan"));
}

TEST(PwnLayout, PointsThenNormals_AreRefusedWithAWayOut) {
    const Error error = error_of([] { read_bytes("2\n1 2 3\n4 5 6\n0 0 1\n0.6 0.8 0\n", "a.pwn"); });
    EXPECT_THAT(error.sentence(), HasSubstr("line 1 declares 2 points; 4 rows follow"));
    EXPECT_THAT(error.hint(), HasSubstr("behind its coordinates"));
    EXPECT_THAT(refusal_of("1\n1 2 3\n0 0 1\n", "a.xyz"), HasSubstr("line 1 declares 1 point; 2 rows follow"));
    Warnings count;
    EXPECT_EQ(points_in("1\n1 2 3\n0 0 5\n", "a.xyz", &count)->size(), 2u);
    EXPECT_THAT(count.sentences, ElementsAre(HasSubstr("line 1 declares 1 point; 2 follow")));
}

TEST(TaggedPoints, RowsOfP_AreThePoints_OthersAreReported) {
    Warnings warnings;
    const auto cloud = points_in("# by hand\nd 0 0 0\ng 1 0 0\np 1 2 3\np 4 5 6\n", "a.pts", &warnings);
    EXPECT_THAT(rows_of(cloud->positions), ElementsAre(Vec3(1, 2, 3), Vec3(4, 5, 6)));
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("2 rows do not begin with p")));
}

TEST(TaggedPoints, Refusals_SayTheLine) {
    EXPECT_THAT(refusal_of("p 1 2 3\np 1 2\n", "a.pts"), HasSubstr("line 2: a point has three numbers, here are 2"));
    EXPECT_THAT(refusal_of("p 1 2 3\np 1 2 3 4\n", "a.pts"),
                HasSubstr("line 2: a point has three numbers, here are 4"));
    EXPECT_THAT(refusal_of("p 1 2 3\np 1 2 x\n", "a.pts"), HasSubstr("line 2: 'x' is not a number"));
    EXPECT_THAT(refusal_of("p 1 2 3\n1 2 3\n", "a.pts"), HasSubstr("line 2: '1' is not a letter"));
    EXPECT_THAT(refusal_of("d 1 2 3\n", "a.pts"), HasSubstr("no row begins with p"));
}

TEST(TaggedPoints, DistributorCap_HasItsPoints) {
    SCANMILL_REAL_SCAN(path, shared_data, "5-raw/distcap.pts");
    SCANMILL_REAL_SCAN(plain, shared_data, "8-derived/distcap.xyz");
    const auto cloud = read_points(path);
    EXPECT_EQ(cloud->size(), 12745u);
    EXPECT_TRUE(std::ranges::equal(cloud->positions, read_points(plain)->positions));
}

TEST(TextRows, DamagedBytes_AreReadOrRefused_NeverMore) {
    std::mt19937 random(5);
    const std::vector<std::pair<const char*, std::string>> seeds{
        {"a.pts", "2\n1 2 3 4 5 6 7\n1 2 3 4 5 6 7\n"},
        {"a.pwn", "2\n1 2 3 0 0 1\n4 5 6 0.6 0.8 0\n"},
        {"b.pts", "# c\nd 0 0 0\np 1 2 3\np 4 5 6\n"},
        {"a.csv", "\"t\";'Z';R;\"G\";B;X;Y\n1;2;3;4;5;6;7\n1;2;3;4;5;6;7\n"},
        {"a.txt", "//X Y Z Nx Ny Nz\n2\n1 2 3 0 0 1\n1|2|3|0|0|1 // end\n"}};
    for (const auto& [name, bytes] : seeds) {
        ASSERT_NO_THROW(read_bytes(bytes, name)) << name;
        for (int round = 0; round < 5000; ++round) {
            std::string damaged = bytes;
            for (u32 hits = 1 + random() % 3; hits > 0; --hits) {
                const std::size_t at = random() % damaged.size();
                if (random() % 2)
                    damaged[at] = static_cast<char>(random());
                else
                    damaged[at] = "0123456789-\n .#/|;,\"'"[random() % 21];
            }
            try {
                const auto cloud = points_in(damaged, name);
                EXPECT_GT(cloud->size(), 0u);
                for (const Column& column : cloud->columns) EXPECT_EQ(column.rows(), cloud->size());
            } catch (const Error&) {
            }
        }
    }
}

}  // namespace
}  // namespace scanmill::test
