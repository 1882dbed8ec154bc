// SPDX-License-Identifier: GPL-3.0-or-later
/// Declarations in comments count at any position, in any number of comments.
#include "core/formats/support.hpp"

namespace scanmill::test {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

std::string comments(std::size_t count) {
    std::string text;
    for (std::size_t i = 0; i < count; ++i) text += "# remark " + std::to_string(i) + "\n";
    return text;
}

Frame frame_in(const std::string& text, const char* name, Warnings* warnings = nullptr) {
    return *frame_of(read_bytes(text, name, warnings ? warnings->reading() : ReadOptions{}).value);
}

struct Content {
    const char* name;
    std::string begin, rest;
};
const std::vector<Content> contents{
    {"a.xyz", "", "1 2 3\n4 5 6\n"},
    {"a.csv", "", "x,y,z,weight\n1,2,3,4\n"},
    {"a.off", "OFF\n", "3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"},
    {"a.obj", "", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"},
    {"a.xyz", "", "p 1 2 3\np 4 5 6\n"},
};

TEST(ManyComments, UnitAndFrameAfterTheThousandth_Count) {
    for (const std::size_t count : {0u, 998u, 999u, 1000u, 1001u, 1500u})
        for (const Content& content : contents) {
            const std::string declared = comments(count) + "# unit mm\n# frame part\n" + comments(7);
            for (const std::string& text :
                 {content.begin + declared + content.rest, content.begin + content.rest + declared}) {
                const Frame frame = frame_in(text, content.name);
                EXPECT_EQ(frame.unit, LengthUnit::millimetre) << content.name << " " << count;
                EXPECT_EQ(frame.name, "part") << content.name << " " << count;
            }
        }
}

TEST(ManyComments, OfSeveralUnits_TheLastCounts_AndDifferentOnesAreReported) {
    for (const std::size_t count : {0u, 1500u}) {
        Warnings warnings;
        const std::string text =
            "# unit m\n" + comments(count) + "# unit cm\n# unit parsec\n# unit of measure\n" + comments(3) + "1 2 3\n";
        EXPECT_EQ(frame_in(text, "a.xyz", &warnings).unit, LengthUnit::centimetre);
        EXPECT_THAT(warnings.sentences, Contains(HasSubstr("both 'unit m' and 'unit cm'; the last counts"))) << count;
        EXPECT_THAT(warnings.sentences, Contains(HasSubstr("the unit 'parsec' is unknown"))) << count;
    }
}

TEST(ManyComments, OfUnitsAllAfterTheThousandth_DifferentOnesAreReported) {
    const auto warnings_of = [](const std::string& units) {
        Warnings warnings;
        EXPECT_EQ(frame_in("1 2 3\n" + comments(1500) + units, "a.xyz", &warnings).unit, LengthUnit::centimetre)
            << units;
        return warnings.sentences;
    };
    EXPECT_THAT(warnings_of("# unit cm\n# unit cm\n"), IsEmpty());
    for (const char* units : {"# unit mm\n# unit cm\n", "# unit mm\n# unit cm\n# unit cm\n",
                              "# unit cm\n# unit mm\n# unit cm\n", "# unit m\n# unit mm\n# unit mm\n# unit cm\n"})
        EXPECT_THAT(warnings_of(units), Contains(HasSubstr("both 'unit mm' and 'unit cm'; the last counts"))) << units;
}

TEST(ManyComments, TakeLittleMemory) {
    EXPECT_EQ(read_bytes(comments(5000) + "1 2 3\n# unit mm\n", "a.xyz").comments.size(), 1001u);
}

}  // namespace
}  // namespace scanmill::test
