// SPDX-License-Identifier: GPL-3.0-or-later
// Comparisons as other programs read them: every form stays valid for names with any bytes.

#include "scanmill/compare/formats.hpp"
#include "scanmill/compare/documents.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <regex>

#include "engine/compare/made_runs.hpp"
#include "scanmill/compare/tables.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

const std::string hostile = "jobs/<script>alert(1)</script> | \"q\" 'a' & `b` @x #1\n\x1b[31m\xff.ply";

/// One cell of every verdict, with hostile names.
Comparison every_verdict() {
    RunDetails before = made_run(1), now = made_run(2, {{"hausdorff", "+1 %", {}}});
    for (const char* scan : {"jobs/pass.ply", "jobs/better.ply", "jobs/gone.ply"}) add_cell(before, scan);
    add_cell(before, hostile);
    add_cell(now, "jobs/pass.ply");
    add_cell(now, "jobs/better.ply", "default", 0.25);
    add_cell(now, hostile, "default", 1);
    add_cell(now, "jobs/new.ply");
    CellRecord& failed = add_cell(now, "jobs/failed.ply");
    failed.outcome = Outcome::failed;
    failed.failure = {Cause::signal, 11, "it crashed on '" + hostile + "'\n  in step 'x'"};
    CellRecord& doubtful = add_cell(now, "jobs/doubtful.ply", "va|ri`ant");
    doubtful.outcome = Outcome::doubtful;
    doubtful.doubts = {"]]> is <no> end"};
    return compared(now, before);
}

struct XmlElement {
    std::string name, text;
    std::map<std::string, std::string> attributes;
    std::vector<XmlElement> children;
};

/// Reads XML 1.0 without comments, CDATA and namespaces; fails the test where it is not well-formed.
class XmlReader {
public:
    explicit XmlReader(const std::string& text) : text_(text) {
        for (const char c : text)
            if (static_cast<unsigned char>(c) < ' ' && c != '\n' && c != '\t') ADD_FAILURE() << "a control character";
    }
    XmlElement document() {
        expect("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
        XmlElement root = element();
        expect("\n");
        EXPECT_EQ(at_, text_.size());
        return root;
    }

private:
    void expect(std::string_view wanted) {
        if (text_.compare(at_, wanted.size(), wanted) != 0)
            throw std::runtime_error("not XML at " + text_.substr(at_, 40));
        at_ += wanted.size();
    }
    std::string until(const std::string& ends) {
        const std::size_t end = text_.find_first_of(ends, at_);
        if (end == std::string::npos) throw std::runtime_error("the file ends too early");
        std::string part = text_.substr(at_, end - at_);
        at_ = end;
        return part;
    }
    static std::string decoded(const std::string& text) {
        std::string plain;
        for (std::size_t i = 0; i < text.size(); ++i) {
            if (text[i] == '<') throw std::runtime_error("< in text");
            if (text[i] != '&') {
                plain += text[i];
                continue;
            }
            const std::size_t end = text.find(';', i);
            if (end == std::string::npos) throw std::runtime_error("& in text");
            const std::string name = text.substr(i + 1, end - i - 1);
            static const std::map<std::string, char> known{{"amp", '&'},  {"lt", '<'},   {"gt", '>'},
                                                           {"quot", '"'}, {"#10", '\n'}, {"#9", '\t'}};
            plain += known.at(name);
            i = end;
        }
        return plain;
    }
    XmlElement element() {
        expect("<");
        XmlElement element;
        element.name = until(" />");
        while (text_[at_] == ' ') {
            expect(" ");
            const std::string name = until("=");
            expect("=\"");
            if (!element.attributes.emplace(name, decoded(until("\""))).second) ADD_FAILURE() << name << " twice";
            expect("\"");
        }
        if (text_[at_] == '/') {
            expect("/>");
            return element;
        }
        expect(">");
        for (;;) {
            element.text += decoded(until("<"));
            if (text_.compare(at_, 2, "</") == 0) break;
            element.children.push_back(this->element());
        }
        expect("</" + element.name + ">");
        return element;
    }

    const std::string& text_;
    std::size_t at_ = 0;
};

/// The rules of Ant's schema for JUnit, which those of Jenkins include.
void expect_junit(const XmlElement& root) {
    ASSERT_EQ(root.name, "testsuites");
    EXPECT_TRUE(root.attributes.empty());
    const auto names_of = [](const XmlElement& element) {
        std::set<std::string> names;
        for (const auto& [name, value] : element.attributes) names.insert(name);
        return names;
    };
    const std::regex decimal("[0-9]+(\\.[0-9]+)?"), number("[0-9]+");
    for (const XmlElement& suite : root.children) {
        ASSERT_EQ(suite.name, "testsuite");
        EXPECT_EQ(names_of(suite), (std::set<std::string>{"id", "package", "name", "timestamp", "hostname", "tests",
                                                          "failures", "errors", "time"}));
        EXPECT_TRUE(std::regex_match(suite.attributes.at("timestamp"),
                                     std::regex("\\d{4}-\\d\\d-\\d\\dT\\d\\d:\\d\\d:\\d\\d")));
        EXPECT_TRUE(std::regex_match(suite.attributes.at("time"), decimal));
        for (const char* each : {"id", "tests", "failures", "errors"})
            EXPECT_TRUE(std::regex_match(suite.attributes.at(each), number)) << each;
        EXPECT_FALSE(suite.attributes.at("name").empty());
        ASSERT_GE(suite.children.size(), 3u);
        EXPECT_EQ(suite.children.front().name, "properties");
        for (const XmlElement& property : suite.children.front().children)
            EXPECT_EQ(names_of(property), (std::set<std::string>{"name", "value"}));
        EXPECT_EQ(suite.children[suite.children.size() - 2].name, "system-out");
        EXPECT_EQ(suite.children.back().name, "system-err");
        std::map<std::string, int> results;
        for (std::size_t i = 1; i + 2 < suite.children.size(); ++i) {
            const XmlElement& test = suite.children[i];
            ASSERT_EQ(test.name, "testcase");
            EXPECT_EQ(names_of(test), (std::set<std::string>{"name", "classname", "time"}));
            EXPECT_TRUE(std::regex_match(test.attributes.at("time"), decimal));
            ASSERT_LE(test.children.size(), 1u);
            for (const XmlElement& result : test.children) {
                EXPECT_TRUE(result.name == "failure" || result.name == "error");
                EXPECT_EQ(names_of(result), (std::set<std::string>{"message", "type"}));
                ++results[result.name];
            }
        }
        EXPECT_EQ(suite.attributes.at("tests"), std::to_string(suite.children.size() - 3));
        EXPECT_EQ(suite.attributes.at("failures"), std::to_string(results["failure"]));
        EXPECT_EQ(suite.attributes.at("errors"), std::to_string(results["error"]));
    }
}

const XmlElement& case_of(const XmlElement& root, const std::string& name) {
    for (const XmlElement& suite : root.children)
        for (const XmlElement& test : suite.children)
            if (test.name == "testcase" && test.attributes.at("name") == name) return test;
    throw std::runtime_error("no test case " + name);
}

TEST(JUnit, EveryVerdict_IsValidByTheSchema) {
    const std::string xml = junit_xml(every_verdict(), false);
    const XmlElement root = XmlReader(xml).document();
    expect_junit(root);
    EXPECT_TRUE(case_of(root, "pass.ply").children.empty());
    EXPECT_TRUE(case_of(root, "better.ply").children.empty());
    EXPECT_TRUE(case_of(root, "new.ply").children.empty());
    EXPECT_TRUE(case_of(root, "doubtful.ply").children.empty());
    EXPECT_EQ(case_of(root, "failed.ply").children[0].name, "error");
    EXPECT_EQ(case_of(root, "gone.ply").children[0].attributes.at("type"), "missing");
    EXPECT_THAT(root.children[0].children[root.children[0].children.size() - 2].text, HasSubstr("]]> is <no> end"));
    const XmlElement strict = XmlReader(junit_xml(every_verdict(), true)).document();
    expect_junit(strict);
    EXPECT_EQ(case_of(strict, "doubtful.ply").children[0].name, "failure");
}

TEST(JUnit, AnyBytesInNames_StayReadable) {
    const std::string xml = junit_xml(every_verdict(), false);
    EXPECT_THAT(xml, Not(HasSubstr("<script>")));
    const XmlElement root = XmlReader(xml).document();
    const XmlElement& test =
        case_of(root, "<script>alert(1)</script> | \"q\" 'a' & `b` @x #1\n\\x1b[31m\xEF\xBF\xBD.ply");
    EXPECT_EQ(test.children[0].name, "failure");
    EXPECT_EQ(test.children[0].attributes.at("message"), "hausdorff 0.5 mm → 1 mm (+1 %)");
    EXPECT_THAT(test.children[0].text, HasSubstr("reproduce: scanmill batch"));
}

TEST(JUnit, InvalidUtf8AndNonCharacters_AreReplaced) {
    for (const std::string bad :
         {"\xc0\x80", "\xed\xa0\x80", "\xef\xbf\xbe", "\xf5\x80\x80\x80", "\xe2\x82", "\x80", "\xff"}) {
        RunDetails run = made_run(1);
        add_cell(run, "a" + bad + "z");
        const std::string xml = junit_xml(compare(run, nullptr), false);
        EXPECT_THAT(xml, AllOf(HasSubstr("\xEF\xBF\xBD"), Not(HasSubstr("a" + bad))));
    }
    RunDetails run = made_run(1);
    add_cell(run, "jobs/öé€😀");
    EXPECT_THAT(junit_xml(compare(run, nullptr), false), HasSubstr("name=\"öé€😀\""));
}

TEST(JUnit, OneSuitePerWorkflow_AndNoneWithoutCells) {
    RunDetails run = made_run(1);
    add_cell(run, "a.ply");
    add_cell(run, "a.ply").workflow = "other";
    const std::string xml = junit_xml(compare(run, nullptr), false),
                      empty = junit_xml(compare(made_run(1), nullptr), false);
    const XmlElement root = XmlReader(xml).document();
    expect_junit(root);
    ASSERT_EQ(root.children.size(), 2u);
    EXPECT_EQ(root.children[1].attributes.at("id"), "1");
    EXPECT_TRUE(XmlReader(empty).document().children.empty());
}

TEST(ReportJson, HoldsEverything_AndReadsBack) {
    const Comparison comparison = every_verdict();
    const std::string text =
        report_json(comparison).dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
    const nlohmann::json json = nlohmann::json::parse(text);
    EXPECT_EQ(json["scanmill"], 1);
    const nlohmann::json& report = json["report"];
    EXPECT_EQ(report["verdict"], "regressed");
    EXPECT_EQ(report["tripped"], true);
    EXPECT_EQ(report["run"]["id"], 2);
    EXPECT_EQ(report["accepted"]["id"], 1);
    EXPECT_EQ(report["accepted"]["who"], "Ann");
    EXPECT_EQ(report["gate"]["rules"]["hausdorff"], "+1 %");
    for (const char* verdict : {"failed", "missing", "regressed", "doubtful", "improved", "new", "passed"})
        EXPECT_EQ(report["counts"][verdict], 1) << verdict;
    ASSERT_EQ(report["cells"].size(), 7u);
    const nlohmann::json& regressed = report["cells"][2];
    EXPECT_EQ(regressed["metrics"][0]["accepted"], 0.5);
    EXPECT_EQ(regressed["metrics"][0]["found"], 1);
    EXPECT_EQ(regressed["metrics"][0]["share"], 1);
    EXPECT_EQ(regressed["metrics"][0]["length-unit"], "mm");
    EXPECT_EQ(regressed["values"]["measure-surface.hausdorff"], 1);
    EXPECT_EQ(report["changes"][0], nlohmann::json({{"cell", 2}, {"metric", 0}}));
}

TEST(ReportJson, InfinityAndAbsence_AreNull) {
    RunDetails run = run_of_one(2, std::numeric_limits<double>::infinity(), {{"hausdorff", "+1 %", {}}});
    const nlohmann::json json = nlohmann::json::parse(report_json(compared(run, run_of_one(1, 0.5))).dump());
    EXPECT_TRUE(json["report"]["cells"][0]["metrics"][0]["found"].is_null());
    EXPECT_TRUE(json["report"]["cells"][0]["metrics"][0]["share"].is_null());
    EXPECT_TRUE(nlohmann::json::parse(report_json(compare(run, nullptr)).dump())["report"]["accepted"].is_null());
}

TEST(VerdictJson, ListsTheCellsThatDidNotPass) {
    const Json json = json_of(verdict_event(every_verdict()));
    EXPECT_EQ(json["verdict"], "regressed");
    EXPECT_EQ(json["counts"]["failed"], 1);
    EXPECT_EQ(json["cells"].size(), 5u);
}

TEST(Markdown, EveryVerdict_KeepsItsTables) {
    const std::string text = markdown(every_verdict(), "hausdorff");
    EXPECT_THAT(text, StartsWith("### nightly: regressed\n"));
    EXPECT_THAT(text, AllOf(HasSubstr("**What changed**"), HasSubstr("**Why**"), HasSubstr("**hausdorff**"),
                            HasSubstr("<details>"), HasSubstr("scanmill batch jobs/nightly.yaml --scan failed.ply")));
    EXPECT_THAT(text.substr(0, text.find("<details>")),
                AllOf(Not(HasSubstr("<script>")), Not(HasSubstr("@x")), Not(HasSubstr("#1"))));
    EXPECT_THAT(text, AllOf(Not(HasSubstr("\x1b")), Not(HasSubstr("\xff"))));
    // Every row of a table has as many cells as its header.
    std::istringstream lines(text);
    std::size_t columns = 0, rows = 0;
    for (std::string line; std::getline(lines, line);) {
        if (!line.starts_with("|")) {
            columns = 0;
            continue;
        }
        std::size_t bars = 0;
        for (std::size_t i = 0; i < line.size(); ++i) bars += line[i] == '|' && (i == 0 || line[i - 1] != '\\');
        if (columns == 0) columns = bars;
        EXPECT_EQ(bars, columns) << line;
        ++rows;
    }
    EXPECT_GT(rows, 12u);
}

TEST(Markdown, BackticksInCommands_DoNotEndTheBlock) {
    RunDetails run = made_run(1);
    add_cell(run, "jobs/a.ply", "a```b").outcome = Outcome::failed;
    EXPECT_THAT(markdown(compare(run, nullptr, made_command), "seconds"),
                AllOf(HasSubstr("````sh\n"), HasSubstr("\n````\n")));
}

TEST(Markdown, LongReports_AreCut) {
    RunDetails before = made_run(1), now = made_run(2, {{"hausdorff", "+1 %", {}}});
    for (int i = 0; i < 100; ++i) {
        add_cell(before, "jobs/" + std::to_string(i) + ".ply");
        add_cell(now, "jobs/" + std::to_string(i) + ".ply", "default", 1);
    }
    EXPECT_THAT(markdown(compared(now, before), "hausdorff"),
                AllOf(HasSubstr("and 80 more\n"), HasSubstr("and 80 more cells\n"), HasSubstr("and 80 more scans\n")));
}

/// The records of RFC 4180.
std::vector<std::vector<std::string>> parsed_csv(const std::string& text) {
    std::vector<std::vector<std::string>> records(1, {""});
    bool is_quoted = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (is_quoted) {
            if (c != '"')
                records.back().back() += c;
            else if (i + 1 < text.size() && text[i + 1] == '"')
                records.back().back() += text[++i];
            else
                is_quoted = false;
        } else if (c == '"') {
            is_quoted = true;
        } else if (c == ',') {
            records.back().emplace_back();
        } else if (c == '\r' && text[i + 1] == '\n') {
            records.push_back({""});
            ++i;
        } else {
            records.back().back() += c;
        }
    }
    records.pop_back();
    return records;
}

TEST(Csv, EveryNumberOfEveryCell_IsARow) {
    RunDetails run = made_run(3);
    add_cell(run, "jobs/a,\"b\"\nc.ply");
    CellRecord& failed = add_cell(run, "jobs/failed.ply");
    failed.outcome = Outcome::failed;
    failed.nodes.clear();
    failed.outputs.clear();
    failed.seconds = 0;
    const auto records = parsed_csv(csv_header() + csv_rows(run));
    EXPECT_THAT(records[0], ElementsAre("run", "started", "workflow", "scan", "variant", "outcome", "source", "metric",
                                        "value", "unit"));
    EXPECT_THAT(records[1], ElementsAre("3", "2026-01-03T02:00:00Z", "compare", "a,\"b\"\nc.ply", "default", "ok",
                                        "measure-surface", "hausdorff", "0.5", "mm"));
    EXPECT_THAT(records.back(),
                ElementsAre("3", "2026-01-03T02:00:00Z", "compare", "failed.ply", "default", "failed", "", "", "", ""));
    // 4 measured, 2 of the output, 3 of the step, seconds; and the failed cell.
    EXPECT_EQ(records.size(), 1u + 10u + 1u);
}

TEST(ReportTables, Matrix_ShowsScansAndVariants) {
    RunDetails before = made_run(1), now = made_run(2, {{"hausdorff", "+1 %", {}}});
    for (const char* variant : {"fine", "coarse"}) add_cell(before, "jobs/a.ply", variant, 0.5);
    add_cell(now, "jobs/a.ply", "fine", 0.5);
    add_cell(now, "jobs/a.ply", "coarse", 0.75);
    add_cell(now, "jobs/b.ply", "fine", 0.25);
    add_cell(now, "jobs/c.ply", "coarse").outcome = Outcome::failed;
    const ReportTable table = matrix(compared(now, before), "hausdorff", 10);
    EXPECT_THAT(table.headers, ElementsAre("hausdorff (mm)", "fine", "coarse"));
    EXPECT_THAT(table.rows, ElementsAre(ElementsAre("a.ply", "0.5", "0.75 !"), ElementsAre("b.ply", "0.25", "-"),
                                        ElementsAre("c.ply", "-", "failed")));
    const ReportTable cut = matrix(compared(now, before), "hausdorff", 2);
    EXPECT_THAT(cut.rows, ElementsAre(testing::Contains("a.ply"), testing::Contains("c.ply"))) << "trouble first";
    EXPECT_EQ(cut.rest, "and 1 more scans");
}

TEST(ReportTables, MatrixOfOneScan_HasARowPerVariant) {
    RunDetails before = made_run(1), now = made_run(2, {{"hausdorff", "+1 %", {}}});
    for (const char* variant : {"fine", "coarse", "thin"}) add_cell(before, "jobs/a.ply", variant, 0.5);
    add_cell(now, "jobs/a.ply", "fine", 0.5);
    add_cell(now, "jobs/a.ply", "coarse", 0.75);
    add_cell(now, "jobs/a.ply", "thin", 0.5);
    const ReportTable table = matrix(compared(now, before), "hausdorff", 10);
    EXPECT_THAT(table.headers, ElementsAre("hausdorff (mm)", "a.ply"));
    EXPECT_THAT(table.rows,
                ElementsAre(ElementsAre("fine", "0.5"), ElementsAre("coarse", "0.75 !"), ElementsAre("thin", "0.5")));
    const ReportTable cut = matrix(compared(now, before), "hausdorff", 2);
    EXPECT_THAT(cut.rows, ElementsAre(testing::Contains("coarse"), testing::Contains("fine"))) << "trouble first";
    EXPECT_EQ(cut.rest, "and 1 more variants");
}

TEST(ReportTables, EqualReasonsOfAScan_AreOneRow) {
    RunDetails now = made_run(2);
    for (const char* variant : {"fine", "coarse"}) {
        CellRecord& cell = add_cell(now, "jobs/broken.ply", variant);
        cell.outcome = Outcome::failed;
        cell.failure.error = "the file ends too early";
    }
    const ReportTable table = reason_table(compare(now, nullptr), 10);
    EXPECT_THAT(table.rows,
                ElementsAre(ElementsAre("failed", "broken.ply", "fine, coarse", "the file ends too early")));
}

TEST(ReportTables, Counts_AndRuns) {
    const Comparison comparison = every_verdict();
    EXPECT_EQ(counts_text(comparison),
              "7 cells: 1 failed, 1 missing, 1 regressed, 1 doubtful, 1 improved, 1 new, 1 passed");
    EXPECT_EQ(runs_text(comparison),
              "run 2 of 2026-01-02T02:00:00Z against run 1 of 2026-01-01T02:00:00Z, accepted by Ann: first");
    EXPECT_THAT(runs_text(compare(made_run(1), nullptr)), HasSubstr("no run was accepted yet"));
}

}  // namespace
}  // namespace scanmill::test
