// SPDX-License-Identifier: GPL-3.0-or-later
// Every seed of the fuzzers, and every input that once broke something, goes through its target in each test run: what
// was found stays mended, without a fuzzer at hand.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>

#include "fuzz/seeds.hpp"
#include "fuzz/targets.hpp"
#include "support/folders.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {

/// gtest's own way would print addresses, which no two builds share.
static void PrintTo(const FuzzTarget& target, std::ostream* stream) { *stream << target.name; }

namespace {

namespace fs = std::filesystem;

const fs::path corpus = fs::path(test::source_folder()) / "tests/fuzz/corpus";

class FuzzCorpus : public testing::TestWithParam<FuzzTarget> {};

/// The seeds that must be refused; all others must be accepted, so that no target gets clean by refusing everything.
const std::set<std::string> refused{
    "batch/leads_out.yaml",
    "batch/mistakes.yaml",
    "csv/decimal_commas_and_points.csv",
    "csv/empty_field.csv",
    "csv/name_twice.csv",
    "csv/utf16_odd.csv",
    "dmi/cut_short.dmi",
    "dmi/units_change.dmi",
    "document/nested.json",
    "document/no_list.json",
    "document/patches_half_a_group.json",
    "document/patches_partner_twice.json",
    "document/patches_point_missing.json",
    "document/patches_weight_missing.json",
    "e57/images_only.e57",
    "format-manifest/half_a_version.json",
    "format-manifest/kind_unknown.json",
    "las/compressed.las",
    "las/cut_short.las",
    "laz/table_cut_short.laz",
    "manifest/no_json.json",
    "manifest/numbers_too_large.json",
    "manifest/of_another_version.json",
    "obj/index_too_large.obj",
    "obj/row_too_short.obj",
    "off/four_dimensions.off",
    "pcd/no_points.pcd",
    "pcd/sizes_without_types.pcd",
    "ply/face_names_no_vertex.ply",
    "ply/gzip_cut_short.ply",
    "ply/truncated_in_a_list.ply",
    "png/cut_short.png",
    "png/huge.png",
    "png/palette.png",
    "poses/nested.json",
    "poses/no_pose.json",
    "poses/word_unknown.conf",
    "pts/count_only.pts",
    "ptx/singular.ptx",
    "setting/comma",
    "setting/dollar_alone",
    "setting/nothing",
    "setting/reference",
    "stl/more_promised_than_there.stl",
    "stl/truncated.stl",
    "workflow/comma.yaml",
    "workflow/default_is_a_reference.yaml",
    "workflow/dollar_alone.yaml",
    "workflow/mistakes.yaml",
    "workflow/not_yaml.yaml",
    "workflow/two_documents.yaml",
    "xyz/gzip_of_nothing.xyz",
    "xyz/row_too_short.xyz",
};

/// From memory that ends where the bytes end, so that a sanitizer sees who reads on.
void feed(const FuzzTarget& target, const std::string& file, std::string_view bytes) {
    const std::vector<char> exact(bytes.begin(), bytes.end());
    bool accepted = false;
    ASSERT_NO_THROW(accepted = target.run({exact.data(), exact.size()})) << file;
    EXPECT_NE(accepted, refused.contains(file)) << file;
}

TEST_P(FuzzCorpus, EverySeed_IsReadOrRefusedAndBreaksNoLaw) {
    const FuzzTarget& target = GetParam();
    const std::string target_name(target.name);
    std::size_t seeds = 0;
    for (const auto& file : fs::directory_iterator(corpus / target.name)) {
        feed(target, target_name + "/" + file.path().filename().string(), content_of(file.path()));
        ++seeds;
    }
    EXPECT_GT(seeds, 0u);
    for (const Seed& seed : binary_seeds())
        if (seed.target == target.name) feed(target, target_name + "/" + seed.file, seed.bytes);
}

INSTANTIATE_TEST_SUITE_P(All, FuzzCorpus, testing::ValuesIn(fuzz_targets().begin(), fuzz_targets().end()),
                         [](const auto& target) {
                             std::string name(target.param.name);
                             std::ranges::replace(name, '-', '_');
                             return name;
                         });

TEST(FuzzTargets, AreTheFoldersOfSeeds) {
    std::set<std::string> folders, targets;
    for (const auto& folder : fs::directory_iterator(corpus)) folders.insert(folder.path().filename().string());
    for (const FuzzTarget& target : fuzz_targets()) targets.insert(std::string(target.name));
#ifndef SCANMILL_LAZ
    folders.erase("laz");
#endif
    EXPECT_EQ(folders, targets);
}

TEST(FuzzTargets, SomeSeeds_AreStreams) {
    std::vector<const char*> streamed{"ply", "xyz", "csv", "las"};
#ifdef SCANMILL_LAZ
    streamed.push_back("laz");
#endif
    for (const char* format : streamed) {
        std::size_t streams = 0;
        for (const auto& file : fs::directory_iterator(corpus / format))
            streams += read_stream(format, content_of(file.path()));
        for (const Seed& seed : binary_seeds())
            if (seed.target == format) streams += read_stream(format, seed.bytes);
        EXPECT_GT(streams, 0u) << format;
    }
}

TEST(FuzzTargets, ALawThatIsBroken_IsSaid) {
    EXPECT_NO_THROW(require_law(true, "never"));
    EXPECT_THROW(require_law(false, "always"), LawBroken);
}

}  // namespace
}  // namespace scanmill::test
