// SPDX-License-Identifier: GPL-3.0-or-later
// Bad scans are everyday: each is one clear sentence that names the file, says what was found and what is needed, and
// exit code 1. The address space is limited, so that believing a header's promise would show.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>

#include "support/folders.hpp"
#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;

struct BadScan {
    std::string test_name;
    std::string file;
    std::string content;
    std::vector<std::string> parts;  ///< parts of the message, besides the file's name
};

void PrintTo(const BadScan& scan, std::ostream* stream) { *stream << scan.test_name; }

std::string ply_header(const std::string& count, const std::string& format = "binary_little_endian") {
    return "ply\nformat " + format + " 1.0\nelement vertex " + count +
           "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
}

std::string repeated(const std::string& line, int times) {
    std::string text;
    for (int i = 0; i < times; ++i) text += line;
    return text;
}

const std::vector<BadScan> bad_scans{
    {"Empty", "scan.ply", "", {"empty"}},
    {"EmptyText", "scan.xyz", "", {"empty"}},
    {"HeaderOnly", "scan.ply", ply_header("5"), {"5"}},
    {"HeaderCutShort", "scan.ply", "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\n", {"end_header"}},
    {"TruncatedBody", "scan.ply", ply_header("5") + std::string(40, 'a'), {"5", "40"}},
    {"TruncatedAscii", "scan.ply", ply_header("3", "ascii") + "0 0 0\n1 1 1\n", {"3"}},
    {"PromisesTwoToTheForty", "scan.ply", ply_header("1099511627776") + std::string(120, 'a'), {"1099511627776"}},
    {"PromisesTwoToTheFortyAscii", "scan.ply", ply_header("1099511627776", "ascii") + "0 0 0\n", {"1099511627776"}},
    {"PromisesBeyondSixtyFourBits",
     "scan.ply",
     ply_header("99999999999999999999999") + "abc",
     {"99999999999999999999999"}},
    {"BinaryStlPromisesMore",
     "scan.stl",
     std::string(80, ' ') + "\xff\xff\xff\xff" + std::string(50, 'a'),
     {"4294967295"}},
    {"NotANumber", "scan.xyz", "0 0 0\n1 nan 0\n0 1 0\n0 0 1\n1 1 1\n", {"1 of 5", "NaN", "--invalid drop"}},
    {"OneFinitePoint", "scan.xyz", "nan nan nan\n1 2 3\n", {"1 of 2", "NaN", "--invalid drop"}},
    {"Infinity", "scan.xyz", "0 0 0\n1 0 0\n0 inf 0\n0 0 1\n-inf 1 1\n", {"2 of 5", "infinity"}},
    {"AllPointsEqual", "scan.xyz", repeated("1 2 3\n", 9), {"9"}},
    {"Collinear", "scan.xyz", "0 0 0\n1 1 1\n2 2 2\n3 3 3\n5 5 5\n", {"line"}},
    {"Coplanar", "scan.xyz", "0 0 0\n1 0 0\n0 1 0\n1 1 0\n3 5 0\n", {"plane"}},
    {"ThreePoints", "scan.xyz", "0 0 0\n1 0 0\n0 1 0\n", {"4", "3"}},
    {"OnePoint", "scan.xyz", "0 0 0\n", {"1"}},
    {"WordsInsteadOfNumbers", "scan.xyz", "0 0 0\nzero one two\n", {"line 2"}},
    {"UnknownFormat",
     "scan.bin",
     std::string("\x7f"
                 "ELF\x02\x01\x01",
                 7) +
         std::string(99, '\0'),
     {"format"}},
};

class BadScanTest : public testing::TestWithParam<BadScan> {};

/// One refusal: the exit code, one error that names the file, nothing written.
void expect_one_clear_sentence(const ProgramResult& ran, const std::string& file,
                               const std::vector<std::string>& parts) {
    EXPECT_EQ(ran.exit_code, 1) << ran.err;
    EXPECT_THAT(ran.err, HasSubstr(file));
    for (const std::string& part : parts) EXPECT_THAT(ran.err, HasSubstr(part));
    EXPECT_THAT(ran.err, testing::Not(HasSubstr("bad_alloc")));
    EXPECT_THAT(ran.err, testing::Not(HasSubstr("out of memory")));
    std::size_t errors = 0;
    for (std::size_t at = ran.err.find("error: "); at != std::string::npos; at = ran.err.find("error: ", at + 1))
        ++errors;
    EXPECT_EQ(errors, 1u) << ran.err;
}

TEST_P(BadScanTest, Run_SaysOneClearSentenceAndEndsWith1) {
    const BadScan& bad = GetParam();
    const TemporaryFolder folder;
    folder.write(bad.file, bad.content);
    folder.write("w.yaml",
                 "scanmill: 1\ninputs: {scan: points}\nsteps: [{delaunay: }, {alpha-solid: }]\noutputs: "
                 "{\"{scan}.stl\": alpha-solid}\n");
    ProgramOptions options{.folder = folder.path(), .environment = {}};
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    options.memory_limit = std::size_t(1) << 31;
#endif
    const ProgramResult ran = scanmill_program({"run", "w.yaml", bad.file, "-o", "out"}, options);
    expect_one_clear_sentence(ran, bad.file, bad.parts);
    EXPECT_FALSE(std::filesystem::exists(folder / "out/scan.stl"));
}

TEST_P(BadScanTest, Quickstart_SaysOneClearSentenceAndEndsWith1) {
    const BadScan& bad = GetParam();
    const TemporaryFolder folder;
    folder.write(bad.file, bad.content);
    const std::string quickstart = test::source_folder() + "/workflows/quickstart.yaml";
    const ProgramResult ran =
        scanmill_program({"run", quickstart, bad.file, "-o", "out"}, {.folder = folder.path(), .environment = {}});
    expect_one_clear_sentence(ran, bad.file, bad.parts);
}

INSTANTIATE_TEST_SUITE_P(All, BadScanTest, testing::ValuesIn(bad_scans),
                         [](const auto& bad) { return bad.param.test_name; });

TEST(BadScan, RawScans_WithoutASurface_SaysOneClearSentence) {
    std::string line;
    for (int i = 0; i < 400; ++i) line += fmt::format("{} {} 0\n", 0.1 * i, 0.2 * i);
    const std::string surface = "determine a surface: they are too few, or on a line";
    const std::vector<BadScan> scans{
        {"Line", "line.xyz", line, {"400", surface}},
        {"OnePosition", "one.xyz", repeated("1 2 3\n", 50), {"50 points at 1 distinct position"}}};
    for (const BadScan& bad : scans) {
        const TemporaryFolder folder;
        folder.write(bad.file, bad.content);
        const std::string workflow = test::source_folder() + "/workflows/raw-scans.yaml";
        const ProgramResult ran =
            scanmill_program({"run", workflow, bad.file, "-o", "out"}, {.folder = folder.path(), .environment = {}});
        expect_one_clear_sentence(ran, "raw-scans", bad.parts);
        EXPECT_FALSE(std::filesystem::exists(folder / "out/raw-scans.ply")) << bad.test_name;
    }
}

ProgramResult raw_scans_of(const std::string& content, const TemporaryFolder& folder,
                           const std::vector<std::string>& options = {}) {
    folder.write("view.xyz", content);
    std::vector<std::string> arguments{"run", test::source_folder() + "/workflows/raw-scans.yaml", "view.xyz", "-o",
                                       "out"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return scanmill_program(arguments, {.folder = folder.path(), .environment = {}});
}

/// Fibonacci's spiral.
std::string sphere(int count, double radius, double x) {
    std::string text;
    for (int i = 0; i < count; ++i) {
        const double z = 1 - (2 * i + 1.0) / count, around = std::sqrt(1 - z * z), turn = 2.399963229728653 * i;
        text += fmt::format("{} {} {}\n", x + radius * around * std::cos(turn), radius * around * std::sin(turn),
                            radius * z);
    }
    return text;
}

TEST(BadScan, RawScans_OfAPlane_StayOpen) {
    std::string plane;
    for (int i = 0; i < 1600; ++i) plane += fmt::format("{} {} 0\n", 0.1 * (i / 40), 0.1 * (i % 40));
    const TemporaryFolder folder;
    const ProgramResult required = raw_scans_of(plane, folder, {"--set", "closed=required"});
    expect_one_clear_sentence(required, "raw-scans", {"1 loop stays open", "closed: auto"});
    EXPECT_FALSE(std::filesystem::exists(folder / "out/raw-scans.ply"));
    const ProgramResult ran = raw_scans_of(plane, folder);
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_THAT(ran.err, HasSubstr("the surface stays open at 1 outer boundary: closed flat, it would add 100 %"));
    EXPECT_TRUE(std::filesystem::exists(folder / "out/raw-scans.ply"));
}

TEST(BadScan, RawScans_OfNaNAlone_SaysOneClearSentence) {
    const TemporaryFolder folder;
    const std::string rows = repeated("nan nan nan\n", 50);
    expect_one_clear_sentence(raw_scans_of(rows, folder), "view.xyz", {"50 of 50 points", "--invalid drop"});
    expect_one_clear_sentence(raw_scans_of(rows, folder, {"--invalid", "drop"}), "view.xyz", {"50"});
}

TEST(BadScan, RawScans_OfTwoScales_KeepTheLargerObject) {
    // The smaller sphere has 1/2,500 of the area: repair removes such components.
    const TemporaryFolder folder;
    const ProgramResult ran = raw_scans_of(sphere(3000, 1, 0) + sphere(3000, 0.02, 1.3), folder);
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_THAT(ran.err, ContainsRegex("1 of 2 components .*160 triangles.* 1 % of the area"));
    EXPECT_TRUE(std::filesystem::exists(folder / "out/raw-scans.ply"));
}

TEST(BadScan, RawScans_OfOutliersAlone_AreDoubtful) {
    std::string far_apart;
    for (int i = 0; i < 60; ++i) far_apart += fmt::format("{} {} {}\n", i * i * i % 977, i * i % 983, i * 31 % 991);
    const TemporaryFolder folder;
    folder.write("outliers.xyz", far_apart);
    const std::string workflow = test::source_folder() + "/workflows/raw-scans.yaml";
    const ProgramResult ran =
        scanmill_program({"run", workflow, "outliers.xyz", "-o", "out"}, {.folder = folder.path(), .environment = {}});
    EXPECT_THAT(ran.err, HasSubstr("they form no surface at that size"));
    EXPECT_THAT(ran.out, HasSubstr("1 of 1 doubtful"));
}

TEST(BadScan, Folder_IsRefused) {
    const TemporaryFolder folder;
    std::filesystem::create_directory(folder / "scan.ply");
    const std::string quickstart = test::source_folder() + "/workflows/quickstart.yaml";
    expect_one_clear_sentence(scanmill_program({"run", quickstart, "scan.ply", "-o", "out"}, {.folder = folder.path()}),
                              "scan.ply", {"folder"});
}

TEST(BadScan, MissingFile_IsRefused) {
    const TemporaryFolder folder;
    const std::string quickstart = test::source_folder() + "/workflows/quickstart.yaml";
    expect_one_clear_sentence(scanmill_program({"run", quickstart, "scan.ply", "-o", "out"}, {.folder = folder.path()}),
                              "scan.ply", {"no such file"});
}

}  // namespace
}  // namespace scanmill::test
