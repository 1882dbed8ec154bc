// SPDX-License-Identifier: GPL-3.0-or-later
// Tables and names on terminals of every width.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "output/terminal.hpp"

namespace scanmill::runner {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

Table scans(const std::string& name) {
    Table table({"scan", "points", "files"});
    table.add({name, "12345", "out/a.ply"});
    table.add({"b.ply", "7", "out/b.ply"});
    table.may_cut("scan");
    table.may_cut("files");
    return table;
}

std::size_t widest(const std::string& text) {
    std::istringstream lines(text);
    std::size_t most = 0;
    for (std::string line; std::getline(lines, line);) most = std::max(most, columns_of(line));
    return most;
}

TEST(Table, LongNames_AreCutInTheMiddle_TheRestIsWhole) {
    const Table table = scans("a-very-long-name-of-a-scan-by-night.ply");
    EXPECT_EQ(table.text(50),
              "scan                             points  files\n"
              "a-very-long-nam…an-by-night.ply   12345  out/a.ply\n"
              "b.ply                                 7  out/b.ply\n");
    EXPECT_EQ(widest(table.text(50)), 50u);
    EXPECT_THAT(table.text(), HasSubstr("a-very-long-name-of-a-scan-by-night.ply")) << "no terminal";
    EXPECT_EQ(table.text(200), table.text());
}

TEST(Table, SecondNamedColumn_IsCutOnlyIfTheFirstIsNotEnough) {
    Table table({"scan", "n", "files"});
    table.add({std::string(30, 's'), "1", std::string(30, 'f')});
    table.may_cut("scan");
    table.may_cut("files");
    EXPECT_THAT(table.text(50), HasSubstr(std::string(30, 'f')));
    EXPECT_EQ(widest(table.text(40)), 40u);
    EXPECT_THAT(table.text(40), HasSubstr("sssss…ssssss  1  ")) << "twelve columns stay";
    EXPECT_EQ(widest(table.text(5)), 12u + 2 + 1 + 2 + 12);
}

TEST(Table, WideCharacters_CountTwice) {
    const Table table = scans("日本語の長い名前のスキャン.ply");
    EXPECT_EQ(columns_of("日本語の長い名前のスキャン.ply"), 30u);
    for (const std::size_t width : {36u, 37u, 38u, 47u}) EXPECT_EQ(widest(table.text(width)), width);
    EXPECT_EQ(widest(table.text()), 30u + 2 + 6 + 2 + 9);
    EXPECT_THAT(table.text(), HasSubstr("b.ply" + std::string(25, ' ') + "       7"));
}

TEST(Table, ColumnsAreLeftOut_BeforeNamesGetShorterThanComfortable) {
    Table table({"scan", "metric", "files"});
    table.add({std::string(40, 's'), std::string(20, '1'), std::string(40, 'f')});
    table.may_cut("scan");
    table.may_cut("files");
    table.may_leave_out("metric");
    EXPECT_EQ(table.fitted(110).left_out, 0u);
    EXPECT_EQ(table.fitted(72).left_out, 0u) << "24 + 20 + 24 and the gaps";
    EXPECT_EQ(widest(table.fitted(72).text), 72u);
    const FittedTable narrow = table.fitted(60);
    EXPECT_EQ(narrow.left_out, 1u);
    EXPECT_THAT(narrow.text, StartsWith("scan"));
    EXPECT_THAT(narrow.text, Not(HasSubstr("metric")));
    EXPECT_EQ(widest(table.fitted(30).text), 30u);
    Table wide({"scan", "metric", "files"});
    wide.add({std::string(26, 's'), std::string(40, '1'), std::string(26, 'f')});
    wide.may_cut("scan");
    wide.may_leave_out("metric");
    EXPECT_THAT(wide.fitted(60).text, HasSubstr(std::string(26, 's'))) << "not cut for a column that is left out";
}

TEST(Wrapped, BreaksLinesAtBlanks) {
    EXPECT_EQ(wrapped("warning: a scan is broken", 80), "warning: a scan is broken");
    EXPECT_EQ(wrapped("warning: a scan is broken", 15), "warning: a scan\n  is broken");
    EXPECT_EQ(wrapped("error: x\n  in step 'y'\nhint: no", 12), "error: x\n  in step\n  'y'\nhint: no");
    EXPECT_EQ(wrapped("see /a/path/that/is/longer/than/the/line now", 12),
              "see\n  /a/path/that/is/longer/than/the/line\n  now")
        << "words stay whole";
    EXPECT_EQ(wrapped("日本語 日本語 日本語", 14), "日本語 日本語\n  日本語") << "wide characters count twice";
    EXPECT_EQ(wrapped("", 10), "");
}

TEST(CutMiddle, Examples) {
    EXPECT_EQ(cut_middle("abcdefghij", 10), "abcdefghij");
    EXPECT_EQ(cut_middle("abcdefghij", 9), "abcd…ghij");
    EXPECT_EQ(cut_middle("abcdefghij", 4), "a…ij");
    EXPECT_EQ(cut_middle("abcdefghij", 2), "…j");
    EXPECT_EQ(cut_middle("日本語日本語", 7), "日…本語") << "the wide half does not fit";
    EXPECT_EQ(cut_middle("a\xff\xfe\xff\xfe\xff", 5), "a\xff…\xfe\xff") << "invalid bytes have a column each";
    EXPECT_EQ(cut_begin("abcdefghij", 4), "…hij");
}

}  // namespace
}  // namespace scanmill::runner
