// SPDX-License-Identifier: GPL-3.0-or-later
// Hostile surroundings and names: full disks, folders without rights, odd names, things that are not files.
// Each gives one clear error with its exit code and leaves nothing half-written.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "scanmill/records/run_records.hpp"
#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

namespace fs = std::filesystem;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

const std::string four_points = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";

std::string many_points() {
    std::string text;
    for (int i = 0; i < 3000; ++i) text += std::to_string(i) + ".25 0.1 0\n";
    return text;
}

std::string workflow(const std::string& output) {
    return "scanmill: 1\ninputs: {scan: points}\nsteps: [{voxel-thin: {bin-size: 0.1 u}}]\noutputs: {\"" + output +
           "\": voxel-thin}\n";
}

std::size_t times(const std::string& text, std::string_view part) {
    std::size_t count = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
    return count;
}

/// All files below a folder but the records of its runs and the descriptions of files that are there.
std::size_t files_below(const fs::path& folder) {
    std::size_t files = 0;
    if (fs::exists(folder))
        for (const auto& entry : fs::recursive_directory_iterator(folder)) {
            fs::path described = entry.path();
            described.replace_extension();
            const bool is_description = entry.path().extension() == ".json" && fs::exists(described);
            files += !entry.is_directory() && entry.path().filename() != records_file && !is_description;
        }
    return files;
}

class Hostile : public testing::Test {
protected:
    ProgramResult run(const std::vector<std::string>& arguments, ProgramOptions options = {}) const {
        options.folder = folder_.path();
        return scanmill_program(arguments, options);
    }
    ProgramResult run_scan(const std::string& scan, ProgramOptions options = {}) const {
        return run({"run", "-o", "out", "--", "w.yaml", scan}, options);
    }
    void expect_refused(const ProgramResult& ran, int exit_code, const std::string& message) const {
        EXPECT_EQ(ran.exit_code, exit_code) << ran.err;
        EXPECT_THAT(ran.err, HasSubstr(message));
        EXPECT_EQ(times(ran.err, "error: "), 1u) << ran.err;
        EXPECT_THAT(ran.err, Not(HasSubstr("unexpected")));
        EXPECT_EQ(files_below(folder_ / "out"), 0u);
    }

    TemporaryFolder folder_;
};

TEST_F(Hostile, LibrariesInTheWorkingFolder_AreNeverLoaded) {
    for (const char* name :
         {"libfmt.so.9", "libstdc++.so.6", "libtbb.so.12", "libscanmill-core.so." SCANMILL_VERSION, "libxxhash.so.0"})
        folder_.write(name, "this module cannot be loaded");
    folder_.write("w.yaml", workflow("{scan}.ply"));
    folder_.write("a.xyz", four_points);
    const ProgramResult ran = run_scan("a.xyz");
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
}

TEST_F(Hostile, FullDisk_FailsTheScanThatDoesNotFit_AndLeavesNothingOfIt) {
    folder_.write("w.yaml", workflow("{scan}.ply"));
    folder_.write("large.xyz", many_points());
    folder_.write("small.xyz", four_points);
    const ProgramOptions full{.file_limit = 8192};
    expect_refused(run_scan("large.xyz", full), 1, "the file was not made");
    const ProgramResult both = run({"run", "w.yaml", "large.xyz", "small.xyz", "-o", "out"}, full);
    EXPECT_EQ(both.exit_code, 1);
    EXPECT_TRUE(fs::exists(folder_ / "out/small.ply"));
    EXPECT_EQ(files_below(folder_ / "out"), 1u);
    EXPECT_EQ(run_scan("large.xyz").exit_code, 0) << "without the limit there is room";
}

TEST_F(Hostile, FullDisk_MovesTheResultOfAnEarlierRunAside) {
    folder_.write("w.yaml", workflow("{scan}.ply"));
    folder_.write("large.xyz", many_points());
    folder_.write("out/large.ply", "from yesterday");
    const ProgramResult ran = run_scan("large.xyz", {.file_limit = 8192});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_THAT(ran.err, HasSubstr("the file was not made"));
    EXPECT_EQ(content_of(folder_ / "out/large.ply.previous"), "from yesterday");
    EXPECT_EQ(files_below(folder_ / "out"), 1u);
}

/// Everyone may look, no one may write.
void open_to_readers(const fs::path& folder) { fs::permissions(folder, fs::perms(0555)); }

TEST_F(Hostile, OutputFolderWithoutRights_IsReportedBeforeAnyStepRuns) {
    folder_.write("w.yaml", workflow("{scan}.ply"));
    folder_.write("scan.xyz", four_points);
    fs::create_directory(folder_ / "out");
    open_to_readers(folder_ / "out");
    open_to_readers(folder_.path());
    const ProgramOptions unprivileged{.without_rights = true};
    const ProgramResult ran = run_scan("scan.xyz", unprivileged);
    const ProgramResult below = run({"run", "w.yaml", "scan.xyz", "-o", "out/below"}, unprivileged);
    fs::permissions(folder_.path(), fs::perms::owner_all);
    fs::permissions(folder_ / "out", fs::perms::owner_all);
    if (ran.exit_code > 100) GTEST_SKIP() << "the program may not be run without root's rights here";
    expect_refused(ran, 2, "Permission denied");
    expect_refused(below, 2, "Permission denied");
}

struct StrangeName {
    std::string test_name, name;
};
void PrintTo(const StrangeName& name, std::ostream* stream) { *stream << name.test_name; }

class HostileName : public Hostile, public testing::WithParamInterface<StrangeName> {};

TEST_P(HostileName, OfAScan_IsThatOfItsResult) {
    const std::string& name = GetParam().name;
    folder_.write("w.yaml", workflow("{scan}.ply"));
    folder_.write(name + ".xyz", four_points);
    const ProgramResult ran = run({"run", "--json", "-o", "out", "--", "w.yaml", name + ".xyz"});
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_TRUE(nlohmann::json::accept(ran.out));
    EXPECT_TRUE(fs::exists(folder_ / ("out/" + name + ".ply")));
    EXPECT_EQ(files_below(folder_ / "out"), 1u);
}

/// Whoever names a file must not steer the terminal that shows its name.
TEST_P(HostileName, OfAScan_IsShownWithoutControlCharacters) {
    const std::string& name = GetParam().name;
    folder_.write("w.yaml", workflow("{scan}.ply"));
    folder_.write(name + ".xyz", four_points);
    folder_.write("bad/" + name + ".xyz", "0 0 0\nzero one two\n");
    const ProgramResult ran =
        run({"run", "-o", "out", "--", "w.yaml", name + ".xyz", "bad/" + name + ".xyz", "bad/none" + name + ".xyz"});
    const auto control = [](unsigned char c) { return (c < ' ' && c != '\n') || c == 0x7f; };
    EXPECT_TRUE(std::ranges::none_of(ran.out + ran.err, control));
}

INSTANTIATE_TEST_SUITE_P(All, HostileName,
                         testing::Values(StrangeName{"Blank", "a b"}, StrangeName{"Blanks", "  "},
                                         StrangeName{"Apostrophe", "a'b"}, StrangeName{"QuotationMark", "a\"b"},
                                         StrangeName{"LineEnd", "a\nb"}, StrangeName{"CarriageReturn", "a\rb"},
                                         StrangeName{"Escape", "\x1b[2J"}, StrangeName{"LeadingDash", "-a"},
                                         StrangeName{"AnOption", "--json"}, StrangeName{"Backslash", "a\\b"},
                                         StrangeName{"Placeholder", "{scan}{variant}"}, StrangeName{"Format", "%s%n{}"},
                                         StrangeName{"Dots", ".."}, StrangeName{"Pattern", "*?[a]"},
                                         StrangeName{"NoUtf8", "\xff\xfe\xc3"}, StrangeName{"Comma", "a,b=c"},
                                         StrangeName{"LongestThereIs", std::string(251, 'x')}),
                         [](const auto& name) { return name.param.test_name; });

TEST_F(Hostile, LineEndInAName_IsEscapedInWarningsAndTables) {
    folder_.write("w.yaml", workflow("{scan}.ply"));
    folder_.write("a\nb\x1b.xyz", "# unit parsec\n" + four_points);
    const ProgramResult ran = run_scan("a\nb\x1b.xyz");
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_THAT(ran.err, HasSubstr("warning: 'a\\nb\\x1b.xyz': the unit 'parsec'"));
    EXPECT_THAT(ran.out, HasSubstr("\na\\nb\\x1b.xyz  "));
    EXPECT_EQ(times(ran.out, "\n"), 2u);
}

TEST_F(Hostile, NameLongerThanFileSystemsTake_IsReported) {
    folder_.write("w.yaml", workflow("{scan}.ply"));
    expect_refused(run_scan(std::string(296, 'x') + ".xyz"), 1, "File name too long");
}

TEST_F(Hostile, ResultWhoseNameIsTooLong_FailsItsScanOnly) {
    folder_.write("w.yaml", workflow("{scan}-thinned.ply"));
    const std::string name = std::string(251, 'x') + ".xyz";
    folder_.write(name, four_points);
    folder_.write("short.xyz", four_points);
    for (int time = 0; time < 2; ++time) {  // without an output folder, and with one
        const ProgramResult ran = run({"run", "w.yaml", name, "short.xyz", "-o", "out"});
        EXPECT_EQ(ran.exit_code, 1) << ran.err;
        EXPECT_THAT(ran.err, HasSubstr("File name too long"));
        EXPECT_TRUE(fs::exists(folder_ / "out/short-thinned.ply"));
        EXPECT_EQ(files_below(folder_ / "out"), 1u);
    }
}

TEST_F(Hostile, OutputNamesThatNoFileSystemTakes_AreRefusedBeforeTheRun) {
    folder_.write("scan.xyz", four_points);
    folder_.write("w.yaml", workflow(std::string(300, 'x') + ".ply"));
    const ProgramResult ran = run_scan("scan.xyz");
    EXPECT_EQ(ran.exit_code, 2);
    EXPECT_THAT(ran.err, ContainsRegex("w.yaml:4:11: .*304 bytes.* 255"));
    EXPECT_FALSE(fs::exists(folder_ / "out"));
    folder_.write("w.yaml", workflow("{scan}.ply"));
    expect_refused(run({"run", "w.yaml", "scan.xyz", "-o", std::string(300, 'x')}), 2, "File name too long");
}

TEST_F(Hostile, ScansThatAreNoFiles_AreRefusedWithoutWaiting) {
    folder_.write("w.yaml", workflow("{scan}.ply"));
    ASSERT_EQ(::mkfifo((folder_ / "pipe.xyz").c_str(), 0600), 0);
    const int descriptor = ::socket(AF_UNIX, SOCK_STREAM, 0);
    sockaddr_un address{.sun_family = AF_UNIX, .sun_path = {}};
    (folder_ / "socket.xyz").string().copy(address.sun_path, sizeof address.sun_path - 1);
    ASSERT_EQ(::bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    for (const std::string scan : {"pipe.xyz", "socket.xyz", "/dev/zero", "/dev/null"}) {
        SCOPED_TRACE(scan);
        expect_refused(run_scan(scan), 1, "'" + scan + "': is not a regular file");
        expect_refused(run({"info", scan}), 1, "'" + scan + "': is not a regular file");
    }
    ::close(descriptor);
}

TEST_F(Hostile, ResultInPlaceOfAPipe_IsRefused) {
    folder_.write("w.yaml", workflow("{scan}.ply"));
    folder_.write("scan.xyz", four_points);
    fs::create_directory(folder_ / "out");
    ASSERT_EQ(::mkfifo((folder_ / "out/scan.ply").c_str(), 0600), 0);
    const ProgramResult ran = run_scan("scan.xyz");
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_THAT(ran.err, HasSubstr("a pipe or device has this name"));
    EXPECT_TRUE(fs::is_fifo(folder_ / "out/scan.ply"));
    EXPECT_EQ(files_below(folder_ / "out"), 1u);
}

}  // namespace
}  // namespace scanmill::test
