// SPDX-License-Identifier: GPL-3.0-or-later
// `report --sheet`: the data of the sheets are those of the inspection, and every part has a sheet or a reason.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "support/folders.hpp"
#include "support/program.hpp"
#include "support/report_page.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

/// Two boxes of 60 x 40 x 20 mm, of which one is 0.3 mm too long, and a broken scan.
class ReportSheet : public testing::Test {
protected:
    void SetUp() override {
        if (!has_report_page()) GTEST_SKIP() << no_report_page;
        folder_.write("block.off",
                      "OFF\n8 12 0\n-30 -20 -10\n30 -20 -10\n30 20 -10\n-30 20 -10\n-30 -20 10\n30 -20 10\n30 20 10\n"
                      "-30 20 10\n3 0 2 1\n3 0 3 2\n3 4 5 6\n3 4 6 7\n3 0 1 5\n3 0 5 4\n3 1 2 6\n3 1 6 5\n3 2 3 7\n"
                      "3 2 7 6\n3 3 0 4\n3 3 4 7\n");
        folder_.write("scan.yaml",
                      "scanmill: 1\nname: scan\nparameters: {length: 60 u}\nsteps:\n"
                      "  - virtual-scan: {shape: box, size: [$length, 40 u, 20 u], views: [12], resolution: 1.5 u}\n"
                      "outputs: {\"{workflow}.ply\": virtual-scan}\n");
        fs::create_directories(folder_ / "parts");
        make_part("60 u", "good");
        make_part("60.3 u", "we ird'<script>");
        folder_.write("b.yaml",
                      "scanmill: 1\nbatch: b\nscans: [{path: \"parts/*.ply\", unit: mm, in: {nominal: block.off}}]\n"
                      "workflows: [inspect]\nset: {tolerance: [-0.1 mm, 0.1 mm]}\n");
    }
    void make_part(const std::string& length, const std::string& name) {
        ASSERT_EQ(scanmill({"run", "scan.yaml", "--set", "length=" + length, "-o", "made"}).exit_code, 0);
        fs::copy_file(folder_ / "made/scan.ply", folder_ / ("parts/" + name + ".ply"));
    }
    ProgramResult scanmill(const std::vector<std::string>& arguments) {
        return scanmill_program(arguments, {.folder = folder_.path(), .cache = folder_ / "home"});
    }
    ProgramResult sheet_of(const std::string& parts) {
        return scanmill({"report", "out", "--sheet", parts, "--html", "sheet.html"});
    }
    nlohmann::json data(const std::string& parts) {
        const ProgramResult written = sheet_of(parts);
        EXPECT_EQ(written.exit_code, exit_code_) << written.err;
        page_ = content_of(folder_ / "sheet.html");
        const std::string mark = "<script type=\"application/json\" id=\"data\">";
        const std::size_t begin = page_.find(mark) + mark.size();
        return nlohmann::json::parse(page_.substr(begin, page_.find("</script>", begin) - begin));
    }

    TemporaryFolder folder_;
    std::string page_;
    int exit_code_ = 0;  // expected
};

TEST_F(ReportSheet, EveryPartHasItsNumbers_PicturesAndWhatIsExpected) {
    EXPECT_EQ(scanmill({"batch", "b.yaml", "-o", "out", "-q"}).exit_code, 1) << "the long part fails";
    exit_code_ = 1;
    const nlohmann::json all = data(".");
    EXPECT_THAT(page_, testing::Not(HasSubstr("ird'<script>"))) << "escaped";
    ASSERT_THAT(all["sheets"], SizeIs(2));
    EXPECT_EQ(all["sheets"][0]["scan"], "parts/we ird'<script>.ply") << "what failed comes first";
    for (const nlohmann::json& sheet : all["sheets"]) {
        const bool is_good = sheet["scan"] == "parts/good.ply";
        EXPECT_EQ(sheet["outcome"], is_good ? "ok" : "failed");
        const nlohmann::json& inspection = sheet["inspection"];
        EXPECT_THAT(inspection["tolerance"], ElementsAre(-0.1, 0.1));
        EXPECT_EQ(inspection["unit"], "mm");
        EXPECT_EQ(inspection["expected"][0]["name"], "in-tolerance");
        EXPECT_EQ(inspection["expected"][0]["limit"], "at least 99 %");
        EXPECT_EQ(inspection["expected"][0]["value"], inspection["rows"][0]["texts"][0]);
        EXPECT_EQ(inspection["expected"][0]["met"], is_good);
        // The same numbers as in the file that the workflow writes.
        const std::string stem = fs::path(sheet["scan"].get<std::string>()).stem();
        const fs::path file = folder_ / (is_good ? "out" : "out/failed") / "parts" / (stem + "-inspection.json");
        const fs::path beside = folder_ / (is_good ? "out" : "out/failed") / (stem + "-inspection.json");
        const nlohmann::json metrics = nlohmann::json::parse(content_of(fs::exists(file) ? file : beside))["metrics"];
        const nlohmann::json& shares = inspection["histogram"]["shares"];
        ASSERT_THAT(shares, SizeIs(41));
        EXPECT_EQ(shares[0], metrics["histogram"]);
        EXPECT_EQ(shares[40], metrics["histogram@41"]);
        EXPECT_EQ(inspection["labels"][0]["value"], metrics["label"]);
        EXPECT_EQ(inspection["columns"][0]["name"], "in-tolerance");
        ASSERT_THAT(inspection["rows"], SizeIs(1));
        EXPECT_EQ(inspection["rows"][0]["part"], "whole");
        EXPECT_EQ(inspection["rows"][0]["texts"][0] == "100 %", is_good);
        EXPECT_THAT(sheet["pictures"], SizeIs(2)) << "those of the workflow, below failed/ for the part that failed";
        for (const nlohmann::json& picture : sheet["pictures"])
            EXPECT_TRUE(all["images"].contains(picture["image"].get<std::string>()));
    }
    EXPECT_THAT(data("parts/good.ply")["sheets"], SizeIs(1));
    EXPECT_THAT(data("parts/good.ply [default]")["sheets"], SizeIs(1));
    EXPECT_THAT(data("parts/")["sheets"], SizeIs(2));
    EXPECT_THAT(data("./parts")["sheets"], SizeIs(2));
    EXPECT_THAT(data((folder_ / "parts").string())["sheets"], SizeIs(2)) << "scans are named as they are recorded";
}

TEST_F(ReportSheet, FromAnotherFolder_PicturesAreFound) {
    scanmill({"batch", "b.yaml", "-o", "out", "-q"});
    fs::create_directories(folder_ / "elsewhere");
    const ProgramResult written = scanmill_program({"report", "../out", "--html", "page.html"},
                                                   {.folder = folder_ / "elsewhere", .cache = folder_ / "home"});
    EXPECT_THAT(written.err, testing::Not(HasSubstr("missing")));
    const std::string page = content_of(folder_ / "elsewhere/page.html");
    EXPECT_THAT(page, HasSubstr("\"truth\":"));
}

TEST_F(ReportSheet, SeveralLimits_EachHaveTheirValueAndWhetherItIsMet) {
    folder_.write("own.yaml",
                  "scanmill: 1\nname: own\ninputs: {scan: points, nominal: mesh}\nsteps:\n"
                  "  - id: loose\n    inspect: {tolerance: [-1 mm, 1 mm]}\n    in: {scan: scan, nominal: nominal}\n"
                  "  - id: fine\n    inspect: {tolerance: [-0.1 mm, 0.1 mm]}\n    in: {scan: scan, nominal: nominal}\n"
                  "    expect: {rms: '< 0.2 mm', max: [0 mm, 0.01 mm], mean-above: '> 1 mm'}\n"
                  "outputs: {\"{scan}.json\": fine}\n");
    scanmill({"run", "own.yaml", "parts/we ird'<script>.ply", "--unit", "mm", "--in", "nominal=block.off", "-o", "out",
              "-q"});
    exit_code_ = 1;
    const nlohmann::json inspection = data(".")["sheets"][0]["inspection"];
    EXPECT_EQ(inspection["step"], "fine") << "the step that failed";
    std::map<std::string, nlohmann::json> limits;
    for (const nlohmann::json& limit : inspection["expected"]) limits[limit["name"]] = limit;
    EXPECT_EQ(limits.at("rms")["limit"], "below 0.2 mm");
    EXPECT_TRUE(limits.at("rms")["met"]);
    EXPECT_EQ(limits.at("max")["limit"], "0 mm to 0.01 mm");
    EXPECT_EQ(limits.at("max")["value"], "0.15 mm");
    EXPECT_FALSE(limits.at("max")["met"]);
    EXPECT_EQ(limits.at("mean-above")["limit"], "above 1 mm");
    EXPECT_THAT(limits.at("mean-above")["value"].get<std::string>(), testing::EndsWith(" mm"));
    EXPECT_FALSE(limits.at("mean-above")["met"]);
}

TEST_F(ReportSheet, PartsThatAreMissingOrNeverInspected_AreSheetsToo) {
    scanmill({"batch", "b.yaml", "-o", "out", "-q"});
    scanmill({"report", "out", "--accept", "--who", "Ann", "--why", "x"});
    fs::remove(folder_ / "parts/good.ply");
    scanmill({"batch", "b.yaml", "-o", "out", "-q"});
    exit_code_ = 4;
    std::map<std::string, std::string> verdicts;
    for (const nlohmann::json all = data("."); const nlohmann::json& sheet : all["sheets"])
        verdicts[sheet["scan"]] = sheet["verdict"];
    EXPECT_EQ(verdicts["parts/good.ply"], "missing");
    fs::remove(folder_ / "block.off");
    scanmill({"batch", "b.yaml", "-o", "none", "-q"});
    const ProgramResult written = scanmill({"report", "none", "--sheet", ".", "--html", "none.html"});
    EXPECT_EQ(written.exit_code, 1) << written.err;
    EXPECT_THAT(written.out, HasSubstr("the sheet of 1 part is none.html"));
}

TEST_F(ReportSheet, WithoutPicturesOfTheWorkflow_TheDeviationsAreDrawn) {
    folder_.write("own.yaml",
                  "scanmill: 1\nname: own\ninputs: {scan: points, nominal: mesh}\nsteps:\n"
                  "  - inspect: {tolerance: [-0.1 mm, 0.1 mm], by: patches}\n    in: {scan: scan, nominal: nominal}\n"
                  "outputs: {\"{scan}-map.ply\": inspect.on-nominal}\n");
    scanmill({"run", "own.yaml", "parts/good.ply", "--unit", "mm", "--in", "nominal=block.off", "-o", "out", "-q"});
    const nlohmann::json one = data("parts/good.ply")["sheets"][0];
    EXPECT_THAT(one["pictures"], SizeIs(1));
    EXPECT_THAT(one["inspection"]["expected"], IsEmpty()) << "nobody set a limit";
    EXPECT_THAT(one["inspection"]["rows"], SizeIs(1 + 6)) << "the block and its six faces";
    fs::remove(folder_ / "out/good-map.ply");
    fs::remove_all(folder_ / "out/previews");
    const ProgramResult written = sheet_of("parts/good.ply");
    EXPECT_EQ(written.exit_code, 0);
    EXPECT_THAT(written.err, HasSubstr("a picture of parts/good.ply is missing: "));
}

TEST_F(ReportSheet, ABrokenScan_HasASheetWithTheReason) {
    folder_.write("parts/broken.ply", content_of(folder_ / "made/scan.ply").substr(0, 2000));
    scanmill({"batch", "b.yaml", "-o", "out", "-q"});
    exit_code_ = 1;
    const nlohmann::json all = data(".");
    ASSERT_THAT(all["sheets"], SizeIs(3));
    std::map<std::string, nlohmann::json> sheets;
    for (const nlohmann::json& sheet : all["sheets"]) sheets[sheet["scan"]] = sheet;
    EXPECT_TRUE(sheets.at("parts/broken.ply")["inspection"].is_null());
    EXPECT_THAT(sheets.at("parts/broken.ply")["error"].get<std::string>(), HasSubstr("broken.ply"));
    EXPECT_THAT(sheets.at("parts/broken.ply")["pictures"], IsEmpty());
}

TEST_F(ReportSheet, WrongNames_AreRefusedWithTheInspectedParts) {
    scanmill({"batch", "b.yaml", "-o", "out", "-q"});
    EXPECT_THAT(sheet_of("parts/god.ply").err,
                AllOf(HasSubstr("run 1 has no scan 'parts/god.ply'; did you mean 'parts/good.ply'?"),
                      HasSubstr("inspected are ")));
    EXPECT_FALSE(fs::exists(folder_ / "sheet.html"));
    EXPECT_EQ(scanmill({"report", "out", "--sheet", "parts/good.ply"}).exit_code, 2) << "--html is missing";
    EXPECT_EQ(scanmill({"report", "out", "--sheet", ".", "--html", "x.html", "--against", "out"}).exit_code, 2);
    folder_.write("b.yaml", "mine");
    EXPECT_THAT(scanmill({"report", "out", "--sheet", ".", "--html", "b.yaml"}).err,
                HasSubstr("is not a page of this program"));
    EXPECT_EQ(scanmill({"run", "scan.yaml", "-o", "other", "-q"}).exit_code, 0);
    EXPECT_THAT(scanmill({"report", "other", "--sheet", ".", "--html", "x.html"}).err,
                HasSubstr("the workflow needs a step that compares the part with its nominal"));
}

}  // namespace
}  // namespace scanmill::test
