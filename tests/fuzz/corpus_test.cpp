// SPDX-License-Identifier: GPL-3.0-or-later
// Every seed of the fuzzers, and every input that once broke something, goes through its target in each test run: what
// was found stays mended, without a fuzzer at hand.

#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "fuzz/seeds.hpp"
#include "fuzz/targets.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {

/// gtest's own way would print addresses, which no two builds share.
static void PrintTo(const FuzzTarget& target, std::ostream* stream) { *stream << target.name; }

namespace {

namespace fs = std::filesystem;

const fs::path corpus = fs::path(SCANMILL_SOURCE_DIR) / "tests/fuzz/corpus";

class FuzzCorpus : public testing::TestWithParam<FuzzTarget> {};

/// From memory that ends where the bytes end, so that a sanitizer sees who reads on.
void feed(const FuzzTarget& target, const std::string& file, std::string_view bytes) {
    const std::vector<char> exact(bytes.begin(), bytes.end());
    EXPECT_NO_THROW(target.run({exact.data(), exact.size()})) << file;
}

TEST_P(FuzzCorpus, EverySeed_IsReadOrRefusedAndBreaksNoLaw) {
    const FuzzTarget& target = GetParam();
    std::size_t seeds = 0;
    for (const auto& file : fs::directory_iterator(corpus / target.name)) {
        feed(target, file.path().string(), content_of(file.path()));
        ++seeds;
    }
    EXPECT_GT(seeds, 0u);
    for (const Seed& seed : binary_seeds())
        if (seed.target == target.name) feed(target, seed.file, seed.bytes);
}

INSTANTIATE_TEST_SUITE_P(All, FuzzCorpus, testing::ValuesIn(fuzz_targets().begin(), fuzz_targets().end()),
                         [](const auto& target) { return std::string(target.param.name); });

TEST(FuzzTargets, AreTheFoldersOfSeeds) {
    std::set<std::string> folders, targets;
    for (const auto& folder : fs::directory_iterator(corpus)) folders.insert(folder.path().filename().string());
    for (const FuzzTarget& target : fuzz_targets()) targets.insert(std::string(target.name));
    EXPECT_EQ(folders, targets);
}

TEST(FuzzTargets, ALawThatIsBroken_IsSaid) {
    EXPECT_NO_THROW(require_law(true, "never"));
    EXPECT_THROW(require_law(false, "always"), LawBroken);
}

}  // namespace
}  // namespace scanmill::test
