// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/workflow/document.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanmill {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

struct Parsed {
    YamlNode root;
    std::vector<Diagnostic> findings;
};

Parsed parse(const std::string& text) {
    Diagnostics diagnostics("f");
    YamlNode root = parse_yaml(text, diagnostics);
    return {std::move(root), diagnostics.sorted()};
}

TEST(YamlDocument, Nodes_CarryTheirPlace) {
    const Parsed parsed = parse("a: 1\nb:\n  - x\n  - {c: 'two'}\n");
    EXPECT_TRUE(parsed.findings.empty());
    ASSERT_EQ(parsed.root.entries.size(), 2u);
    EXPECT_EQ(parsed.root.entries[1].position, (Position{2, 1}));
    const YamlNode* list = parsed.root.find("b");
    ASSERT_NE(list, nullptr);
    ASSERT_EQ(list->items.size(), 2u);
    EXPECT_EQ(list->items[0].position, (Position{3, 5}));
    EXPECT_EQ(list->items[1].find("c")->text, "two");
    EXPECT_EQ(list->items[1].entries[0].position, (Position{4, 6}));
}

TEST(YamlDocument, NullAndQuotedNull_Differ) {
    const Parsed parsed = parse("a: ~\nb: '~'\nc:\nd: ''\ne: null\n");
    EXPECT_TRUE(parsed.root.find("a")->is_null());
    EXPECT_TRUE(parsed.root.find("b")->is_scalar());
    EXPECT_TRUE(parsed.root.find("c")->is_null());
    EXPECT_TRUE(parsed.root.find("d")->is_scalar());
    EXPECT_TRUE(parsed.root.find("e")->is_null());
}

TEST(YamlDocument, RepeatedKey_IsAnErrorAtTheSecondPlace) {
    const Parsed parsed = parse("a: 1\nb: 2\na: 3\n");
    ASSERT_EQ(parsed.findings.size(), 1u);
    EXPECT_EQ(parsed.findings[0].position, (Position{3, 1}));
    EXPECT_THAT(parsed.findings[0].message, HasSubstr("already at line 1"));
    EXPECT_EQ(parsed.root.find("a")->text, "1");
}

TEST(YamlDocument, NamesThatYamlTakesForSomethingElse_AskForQuotes) {
    for (const char* text : {"a: {b: c/{stem}.json, d: 1}\n", "a: [b/[cd].ply, e]\n"}) {
        const Parsed parsed = parse(text);
        ASSERT_EQ(parsed.findings.size(), 1u) << text;
        EXPECT_THAT(parsed.findings[0].message, HasSubstr("needs quotes, as \"{stem}.ply\"")) << text;
    }
    for (const char* text : {"a:\n  - *.ply\n", "a: *\n", "a: [**/*.ply]\n"})
        EXPECT_THAT(parse(text).findings.at(0).message, HasSubstr("needs quotes, as \"*.ply\"")) << text;
}

TEST(YamlDocument, RepeatedKeyInANestedFlowMap_IsFound) {
    EXPECT_EQ(parse("a: {b: [{c: 1, c: 2}]}\n").findings.size(), 1u);
}

TEST(YamlDocument, Alias_StandsForItsAnchor) {
    const Parsed parsed = parse("a: &x {n: 1}\nb: *x\n");
    EXPECT_TRUE(parsed.findings.empty());
    EXPECT_EQ(parsed.root.find("b")->find("n")->text, "1");
}

TEST(YamlDocument, AliasesThatUnfoldWithoutEnd_AreRefused) {
    std::string bomb = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
    for (int level = 1; level <= 9; ++level) {
        const std::string below = "*a" + std::to_string(level - 1);
        bomb += "a" + std::to_string(level) + ": &a" + std::to_string(level) + " [";
        for (int i = 0; i < 10; ++i) bomb += (i ? ", " : "") + below;
        bomb += "]\n";
    }
    const Parsed parsed = parse(bomb);
    ASSERT_EQ(parsed.findings.size(), 1u);
    EXPECT_THAT(parsed.findings[0].message, HasSubstr("expands to more than 1000000 nodes"));
}

TEST(YamlDocument, AnchorsAroundAnchors_CountEveryCopyThatIsKept) {
    std::string items = "x";
    for (int i = 1; i < 10'000; ++i) items += ", x";
    std::string nested = "[" + items + "]";
    for (int level = 0; level < 200; ++level) nested = "&a" + std::to_string(level) + " [" + nested + "]";
    const Parsed parsed = parse("a: " + nested + "\n");
    ASSERT_EQ(parsed.findings.size(), 1u);
    EXPECT_THAT(parsed.findings[0].message, HasSubstr("expands to more than 1000000 nodes"));
}

TEST(YamlDocument, AliasesOfALongText_AreRefused) {
    const std::string text(1'000'000, 'x');
    std::string aliases = "*a";
    for (int i = 1; i < 100; ++i) aliases += ", *a";
    const Parsed parsed = parse("a: &a " + text + "\nb: [" + aliases + "]\n");
    ASSERT_EQ(parsed.findings.size(), 1u);
    EXPECT_EQ(parsed.findings[0].position.line, 2);
    EXPECT_THAT(parsed.findings[0].message, HasSubstr("expands to more than 67108864 bytes"));
}

TEST(YamlDocument, AliasesThatNestDeeperThanAFileCan_AreRefused) {
    const std::string open(400, '['), close(400, ']');
    const std::string first = "a: &a " + open + "x" + close + "\n";
    EXPECT_TRUE(parse(first + "b: *a\n").findings.empty());
    const Parsed parsed = parse(first + "b: " + open + "*a" + close + "\n");
    ASSERT_EQ(parsed.findings.size(), 1u);
    EXPECT_THAT(parsed.findings[0].message, HasSubstr("expands to more than 500 levels"));
}

TEST(YamlDocument, ZeroByte_IsRefusedAtItsPlace) {
    for (const auto& [text, line, column] :
         {std::tuple(std::string("\0a: 1", 5), 1, 1), std::tuple(std::string("a: 1\nb: \0", 9), 2, 4)}) {
        const Parsed parsed = parse(text);
        ASSERT_EQ(parsed.findings.size(), 1u);
        EXPECT_EQ(parsed.findings[0].position, (Position{line, column}));
        EXPECT_THAT(parsed.findings[0].message, HasSubstr("a zero byte"));
    }
}

TEST(YamlDocument, DeepNesting_IsRefusedNotFollowed) {
    const Parsed parsed = parse(std::string(100'000, '[') + std::string(100'000, ']'));
    ASSERT_FALSE(parsed.findings.empty());
}

TEST(YamlDocument, FurtherDocuments_AreRefused) {
    EXPECT_EQ(parse("a: 1\n---\nb: 2\n").findings.size(), 1u);
    EXPECT_EQ(parse("a: 1\n---\n---\nb: 2\n").findings.size(), 1u);
    EXPECT_EQ(parse("a: 1\n---\nb: 2\n---\nc: 3\n").findings.size(), 2u);
    EXPECT_EQ(parse("a: 1\n---\n").findings.size(), 0u);
}

TEST(YamlDocument, CommaOutsideAList_IsRefusedOnceAtItsPlace) {
    for (const char* text : {",", "\n,x", "a: 1\n---\n,"}) {
        const Parsed parsed = parse(text);
        ASSERT_EQ(parsed.findings.size(), 1u) << text;
        EXPECT_THAT(parsed.findings[0].message, HasSubstr("invalid YAML")) << text;
        EXPECT_EQ(parsed.findings[0].position.column, 1) << text;
    }
}

TEST(YamlDocument, ListAsKey_IsRefused) { EXPECT_FALSE(parse("? [a, b]\n: 1\n").findings.empty()); }

TEST(YamlDocument, TabsInTheIndentation_AreNamed) {
    for (const auto& [text, line, column] :
         {std::tuple("a:\n\tb: 1\n", 2, 1), std::tuple("a:\n  - b: 1\n\t  c: 2\n", 3, 1),
          std::tuple("a:\n  - b: 1\n  \tc: 2\n", 3, 3), std::tuple("steps:\n\t- b:\n", 2, 1),
          std::tuple("steps:\n\t- b:\n\t- c:\n", 2, 1), std::tuple("- a: 1\n-\tb: 2\n", 2, 2),
          std::tuple("a:\n  - b:\n\tc: 1\n", 3, 1)}) {
        const Parsed parsed = parse(text);
        ASSERT_EQ(parsed.findings.size(), 1u) << text;
        EXPECT_EQ(parsed.findings[0].position, (Position{line, column})) << text;
        EXPECT_THAT(parsed.findings[0].message, AllOf(HasSubstr("tab"), HasSubstr("spaces"))) << text;
    }
}

TEST(YamlDocument, TabsElsewhere_AreNoErrors) {
    EXPECT_TRUE(parse("a:\t1\nb: 'x\ty'\n").findings.empty());
    const Parsed parsed = parse("a: 'x\ty'\nb: [1, 2\nc: 3\n");
    ASSERT_FALSE(parsed.findings.empty());
    EXPECT_THAT(parsed.findings[0].message, Not(HasSubstr("tab")));
}

TEST(YamlDocument, BrokenSyntax_NamesItsPlace) {
    const Parsed parsed = parse("a: [1, 2\nb: 3\n");
    ASSERT_FALSE(parsed.findings.empty());
    EXPECT_GE(parsed.findings[0].position.line, 1);
}

}  // namespace
}  // namespace scanmill
