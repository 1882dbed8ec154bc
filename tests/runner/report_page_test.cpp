// SPDX-License-Identifier: GPL-3.0-or-later
// `report --html`: the data of the page are those of the records, whatever the names are and whatever files are gone.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "scanmill/session/report_page.hpp"
#include "support/folders.hpp"
#include "support/program.hpp"
#include "support/report_page.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

class ReportPage : public testing::Test {
protected:
    void SetUp() override {
        if (!has_report_page()) GTEST_SKIP() << no_report_page;
        folder_.write("scan.yaml",
                      "scanmill: 1\nname: scan\nparameters: {shape: sphere}\nsteps:\n  - virtual-scan: {shape: $shape, "
                      "views: [12], resolution: 3 %diag}\noutputs: {'{workflow}.ply': virtual-scan}\n");
        folder_.write("mesh.yaml",
                      "scanmill: 1\nname: mesh\ninputs: {scan: points}\nparameters: {bin-size: 6 %diag}\nsteps:\n"
                      "  - voxel-thin: {bin-size: $bin-size}\n  - delaunay:\n  - id: surface\n    alpha-solid:\n"
                      "outputs: {'{scan}.ply': surface}\n");
        ASSERT_EQ(scanmill({"run", "scan.yaml", "-o", "made"}).exit_code, 0);
        ASSERT_EQ(scanmill({"run", "mesh.yaml", "made/scan.ply", "-o", "truth"}).exit_code, 0);
        fs::create_directories(folder_ / "scans");
        fs::create_directories(folder_ / "models");
    }
    void add_scan(const std::string& name) {
        fs::copy_file(folder_ / "made/scan.ply", folder_ / ("scans/" + name + ".ply"));
        fs::copy_file(folder_ / "truth/scan.ply", folder_ / ("models/" + name + ".ply"));
    }
    void write_batch() {
        folder_.write("b.yaml",
                      "scanmill: 1\nbatch: b\nscans: [{path: \"scans/*.ply\", truth: \"models/{stem}.ply\"}]\n"
                      "workflows: [mesh.yaml]\nmeasure: {samples: 500}\ngate: {hausdorff: +1 %, genus: exact}\n");
    }
    ProgramResult scanmill(const std::vector<std::string>& arguments) {
        return scanmill_program(arguments, {.folder = folder_.path(), .cache = folder_ / "home"});
    }
    ProgramResult night() { return scanmill({"batch", "b.yaml", "-o", "out", "-q", "--no-cache"}); }
    /// The data in the page that the command writes.
    nlohmann::json page_data(int exit_code = 0) {
        const ProgramResult written = scanmill({"report", "out", "--html", "page.html"});
        EXPECT_EQ(written.exit_code, exit_code) << written.err;
        page_ = content_of(folder_ / "page.html");
        const std::string mark = "<script type=\"application/json\" id=\"data\">";
        const std::size_t begin = page_.find(mark) + mark.size();
        return nlohmann::json::parse(page_.substr(begin, page_.find("</script>", begin) - begin));
    }

    TemporaryFolder folder_;
    std::string page_;
};

TEST_F(ReportPage, NumbersAreThoseOfTheReport) {
    add_scan("a");
    add_scan("b");
    write_batch();
    night();
    scanmill({"report", "out", "--accept", "--who", "Ann", "--why", "looked at it"});
    folder_.write("mesh.yaml", [&] {
        std::string text = content_of(folder_ / "mesh.yaml");
        return text.replace(text.find("6 %diag"), 7, "9 %diag");
    }());
    night();
    const nlohmann::json page = page_data(4);
    const nlohmann::json report = nlohmann::json::parse(scanmill({"report", "out", "--json"}).out)["report"];
    EXPECT_EQ(page["verdict"], report["verdict"]);
    EXPECT_EQ(page["run"]["id"], 2);
    EXPECT_EQ(page["accepted"]["id"], 1);
    EXPECT_EQ(page["acceptance"]["who"], "Ann");
    ASSERT_EQ(page["cells"].size(), report["cells"].size());
    for (std::size_t i = 0; i < page["cells"].size(); ++i) {
        const nlohmann::json &cell = page["cells"][i], &compared = report["cells"][i];
        for (const char* member : {"scan", "variant", "verdict", "reasons", "causes", "command"})
            EXPECT_EQ(cell[member], compared[member]) << member;
        std::set<std::string> names;
        for (const nlohmann::json& value : cell["values"]) {
            const std::string name = value["source"].get<std::string>() + "." + value["name"].get<std::string>();
            names.insert(name);
            if (value["source"] == "read") continue;  // two files, the scan and the truth
            EXPECT_EQ(value["value"], compared["values"][name]) << name;
        }
        EXPECT_EQ(names.size(), compared["values"].size());
        EXPECT_THAT(cell["causes"].dump(), HasSubstr("voxel-thin: bin-size 6 %diag → 9 %diag"));
        for (const char* picture : {"truth", "scan", "result", "deviation"})
            EXPECT_TRUE(page["images"].contains(cell["pictures"].value(picture, ""))) << picture;
        EXPECT_TRUE(page["meshes"].contains(cell["mesh"].get<std::string>()));
    }
    EXPECT_EQ(page["runs"].size(), 2u);
    EXPECT_TRUE(page["runs"][0]["accepted"]);
    for (const nlohmann::json& trend : page["trends"]) EXPECT_THAT(trend["values"], SizeIs(2));
    EXPECT_GE(page["trends"].size(), 2u * 3) << "hausdorff, genus and seconds of each cell";
    EXPECT_EQ(page["changes"][0]["effect"], "regression");
}

TEST_F(ReportPage, PreviewsAreKept_AndTheAcceptedRunsPictureIsBesideTonights) {
    add_scan("a");
    write_batch();
    night();
    page_data();
    const auto previews = [&] {
        std::map<std::string, fs::file_time_type> files;
        for (const auto& entry : fs::directory_iterator(folder_ / "out/previews"))
            files[entry.path().filename()] = entry.last_write_time();
        return files;
    };
    const auto before = previews();
    EXPECT_GE(before.size(), 4u);
    page_data();
    EXPECT_EQ(previews(), before);
    scanmill({"report", "out", "--accept", "--who", "Ann", "--why", "x"});
    folder_.write("mesh.yaml", [&] {
        std::string text = content_of(folder_ / "mesh.yaml");
        return text.replace(text.find("6 %diag"), 7, "9 %diag");
    }());
    night();
    const nlohmann::json page = page_data(4);
    const nlohmann::json& pictures = page["cells"][0]["pictures"];
    EXPECT_NE(pictures["accepted"], pictures["result"]);
    EXPECT_TRUE(page["images"].contains(pictures["accepted"].get<std::string>()));
}

TEST_F(ReportPage, HostileNamesBrokenScansAndMissingTruths_AreShownWithTheirReasons) {
    add_scan("we ird'<script>");
    add_scan("no-truth");
    fs::remove(folder_ / "models/no-truth.ply");
    folder_.write("scans/broken.ply", content_of(folder_ / "made/scan.ply").substr(0, 2000));
    write_batch();
    night();
    const nlohmann::json page = page_data(1);
    EXPECT_THAT(page_, Not(HasSubstr("ird'<script>"))) << "escaped";
    ASSERT_EQ(page["cells"].size(), 3u);
    std::map<std::string, nlohmann::json> cells;
    for (const nlohmann::json& cell : page["cells"]) cells[cell["scan"]] = cell;
    EXPECT_EQ(cells.at("scans/we ird'<script>.ply")["outcome"], "ok");
    EXPECT_EQ(cells.at("scans/broken.ply")["verdict"], "failed");
    EXPECT_THAT(cells.at("scans/broken.ply")["error"].get<std::string>(), HasSubstr("the header promises"));
    EXPECT_EQ(cells.at("scans/no-truth.ply")["verdict"], "failed");
    EXPECT_THAT(cells.at("scans/no-truth.ply")["error"].get<std::string>(), HasSubstr("no-truth"));
}

TEST_F(ReportPage, FilesThatAreGone_LeaveOutTheirPicturesAndNothingElse) {
    add_scan("a");
    write_batch();
    night();
    for (const char* gone : {"scans", "models", "out/a.ply"}) fs::remove_all(folder_ / gone);
    const nlohmann::json page = page_data();
    ASSERT_EQ(page["cells"].size(), 1u);
    EXPECT_FALSE(page["cells"][0]["values"].empty());
    EXPECT_TRUE(page["cells"][0]["pictures"].empty());
    EXPECT_TRUE(page["cells"][0]["mesh"].is_null());
    EXPECT_THAT(page["notes"].dump(), HasSubstr("a preview is missing"));
}

TEST_F(ReportPage, UnitsThatDifferBetweenScans_StayWithTheirNumbers) {
    add_scan("a");
    add_scan("b");
    write_batch();
    folder_.write(
        "b.yaml",
        "scanmill: 1\nbatch: b\nscans:\n  - {path: scans/a.ply, unit: mm, truth: {path: models/a.ply, unit: mm}}\n"
        "  - {path: scans/b.ply, unit: in, truth: {path: models/b.ply, unit: in}}\n"
        "workflows: [mesh.yaml]\nmeasure: {samples: 500}\n");
    night();
    std::map<std::string, std::string> texts;
    const nlohmann::json page = page_data();
    for (const nlohmann::json& cell : page["cells"])
        for (const nlohmann::json& value : cell["values"])
            if (value["name"] == "hausdorff") texts[cell["scan"]] = value["text"];
    EXPECT_THAT(texts["scans/a.ply"], testing::EndsWith(" mm"));
    EXPECT_THAT(texts["scans/b.ply"], testing::EndsWith(" in"));
    EXPECT_EQ(page["cells"][1]["deviation-unit"], "in");
    EXPECT_THAT(page["cells"][0]["pictures"], testing::Contains(testing::_).Times(4));
}

TEST_F(ReportPage, ABatchWritesItsPage) {
    add_scan("a");
    write_batch();
    const ProgramResult ran = scanmill({"batch", "b.yaml", "-o", "out", "-q", "--html", "pages/night.html"});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_THAT(ran.out, HasSubstr("the page of b is pages/night.html\n"));
    EXPECT_THAT(content_of(folder_ / "pages/night.html"), HasSubstr("\"batch\":\"b\""));
    EXPECT_EQ(scanmill({"batch", "b.yaml", "-o", "out", "--html", "x.html", "--json"}).exit_code, 2);
}

TEST_F(ReportPage, LargeRun_ShowsTheCellsWithTheWorstVerdictsAndCountsAll) {
    for (const char* name : {"a", "b", "c"}) add_scan(name);
    folder_.write("scans/c.ply", content_of(folder_ / "made/scan.ply").substr(0, 2000));
    write_batch();
    night();
    FilterLibrary library{{plugin_folder()}};
    const auto page = [&](const PageLimits& limits) {
        return page_document(
            {folder_ / "out", std::nullopt}, std::nullopt, {}, library, {}, [](std::string) {}, limits);
    };
    const PageDocument two = page({.cells = 2, .pictured = 2});
    ASSERT_EQ(two.cells.size(), 2u);
    EXPECT_EQ(two.cells[0].scan, "scans/a.ply");
    EXPECT_EQ(two.cells[1].scan, "scans/c.ply");
    EXPECT_EQ(two.counts, (std::map<std::string, std::size_t>{{"failed", 1}, {"new", 2}}));
    for (const PageTrend& trend : two.trends) EXPECT_LT(trend.cell, 2u);
    EXPECT_THAT(two.notes, testing::Contains(HasSubstr("shows 2 of 3 cells, those with the worst verdicts")));
    EXPECT_FALSE(two.cells[0].pictures.empty());

    const PageDocument pictured = page({.cells = 3, .pictured = 2});
    ASSERT_EQ(pictured.cells.size(), 3u);
    EXPECT_FALSE(pictured.cells[0].pictures.empty());
    EXPECT_TRUE(pictured.cells[1].pictures.empty());
    EXPECT_THAT(pictured.notes, testing::Contains(HasSubstr("2 of 3 cells have pictures")));
}

TEST_F(ReportPage, RefusalsLeaveAnEarlierPageAlone) {
    folder_.write("page.html", "mine");
    EXPECT_THAT(scanmill({"report", "out", "--html", "new.html"}).err, HasSubstr("there are no records in 'out'"));
    EXPECT_THAT(scanmill({"report", "out", "--html", "page.html"}).err,
                HasSubstr("exists and is not a page of this program"));
    EXPECT_EQ(content_of(folder_ / "page.html"), "mine");
    add_scan("a");
    write_batch();
    night();
    EXPECT_EQ(scanmill({"report", "out", "--html", "page.html", "--json"}).exit_code, 2);
    EXPECT_EQ(scanmill({"report", "out", "-j", "2"}).exit_code, 2) << "only a page needs previews";
    EXPECT_EQ(scanmill({"report", "out", "--html", "one.html", "-j", "1"}).exit_code, 0);
    EXPECT_EQ(scanmill({"report", "out", "--html", "none.html", "-j", "0"}).exit_code, 0);
    for (const char* file : {"out/scanmill.sqlite", "out/a.ply"}) {
        const std::string before = content_of(folder_ / file);
        EXPECT_THAT(scanmill({"report", "out", "--html", file}).err,
                    HasSubstr("exists and is not a page of this program"));
        EXPECT_EQ(content_of(folder_ / file), before);
    }
    fs::create_directories(folder_ / "folder");
    EXPECT_THAT(scanmill({"report", "out", "--html", "folder"}).err,
                HasSubstr("'folder' exists and is not a page of this program"));
    folder_.write("file", "x");
    EXPECT_THAT(scanmill({"report", "out", "--html", "file/page.html"}).err, HasSubstr("file/page.html"));
}

}  // namespace
}  // namespace scanmill::test
