// SPDX-License-Identifier: GPL-3.0-or-later
// A cache that has lost something, is damaged or cannot be written to only costs time.
#include <gmock/gmock.h>

#include "engine/run/cached_run_fixture.hpp"

namespace scanmill::test {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

using enum Origin;

TEST_F(CachedRun, ValuesNotKept_AreMadeAgainWhereTheyAreNeeded) {
    keep_ = KeepRule::Policy::never;
    run_two("factor: 2", "factor: 3");
    EXPECT_FALSE(fs::exists(folder_ / "cache/v1/values"));
    const std::string first = content_of(folder_ / "out/a.ply");
    fs::remove(folder_ / "out/a.ply");
    const RunReport again = run_two("factor: 2", "factor: 3");
    EXPECT_THAT(origins(again), ElementsAre(ran, ran, ran));
    EXPECT_THAT(again.nodes[2].why, HasSubstr("'points' is not in the cache"));
    EXPECT_EQ(content_of(folder_ / "out/a.ply"), first);
    const RunReport numbers_only = run("  - test-step: {factor: 2}\n", {scan("a.xyz")});
    EXPECT_THAT(origins(numbers_only), ElementsAre(cached, cached)) << "nobody needs its value";
}

TEST_F(CachedRun, DamagedValues_AreMadeAgainAndTold) {
    run_two("factor: 2", "factor: 3");
    const std::string first = content_of(folder_ / "out/a.ply");
    for (const fs::path& file : values()) {
        std::string bytes = content_of(file);
        bytes.back() = static_cast<char>(bytes.back() ^ 1);
        folder_.write(fs::relative(file, folder_.path()).string(), bytes);
    }
    const RunReport again = run_two("factor: 2", "factor: 3");
    EXPECT_TRUE(again.outcome() == Outcome::ok);
    EXPECT_EQ(again.nodes[2].origin, ran);
    EXPECT_THAT(again.nodes[2].why, HasSubstr("its value was removed from the cache"));
    EXPECT_EQ(content_of(folder_ / "out/a.ply"), first);
    EXPECT_THAT(told_, testing::Each(HasSubstr("counts as missing")));
    EXPECT_FALSE(told_.empty());
    EXPECT_THAT(origins(run_two("factor: 2", "factor: 3")), ElementsAre(cached, cached, cached)) << "mended";
}

TEST_F(CachedRun, LostValueThatOthersWereMadeWith_IsMadeAgainWithoutLosingTheirs) {
    // `last` takes the scan and what `first` makes of it: making that again must not let go of the scan.
    const auto diamond = [&](const std::string& factor) {
        return run("  - id: first\n    test-step: {factor: 2}\n  - id: last\n    test-step: {factor: " + factor +
                       "}\n    in: {points: scan, more: [scan, first.points]}\n",
                   {scan("a.xyz")}, "outputs: {'{scan}.ply': last.points}\n");
    };
    EXPECT_TRUE(diamond("3").outcome() == Outcome::ok);
    for (const fs::path& file : values()) fs::resize_file(file, fs::file_size(file) - 1);
    const RunReport again = diamond("4");
    EXPECT_TRUE(again.outcome() == Outcome::ok);
    EXPECT_EQ(again.nodes[2].metrics.find("more")->value, 8);
    EXPECT_EQ(world_of_second_point(), Vec3(4, 0, 0));
}

TEST_F(CachedRun, EntriesOfOtherNames_AreNotTrusted) {
    run_two("factor: 2", "factor: 3");
    const std::string first = content_of(folder_ / "out/a.ply");
    for (const std::string_view kind : {"plans", "steps", "values"}) {
        std::vector<fs::path> files;
        for (const auto& entry : fs::recursive_directory_iterator(folder_ / ("cache/v1/" + std::string(kind))))
            if (entry.is_regular_file()) files.push_back(entry.path());
        ASSERT_GT(files.size(), 2u);
        // Each gets the next one's content.
        const std::string kept = content_of(files[0]);
        for (std::size_t i = 0; i < files.size(); ++i)
            folder_.write(fs::relative(files[i], folder_.path()).string(),
                          i + 1 < files.size() ? content_of(files[i + 1]) : kept);
        told_.clear();
        EXPECT_TRUE(run_two("factor: 2", "factor: 3").outcome() == Outcome::ok);
        EXPECT_EQ(content_of(folder_ / "out/a.ply"), first) << kind;
        EXPECT_FALSE(told_.empty()) << kind;
    }
}

TEST_F(CachedRun, CacheThatCannotBeWritten_CostsNothingButTime) {
    folder_.write("cache", "a file in its place");
    EXPECT_TRUE(run_two("factor: 2", "factor: 3").outcome() == Outcome::ok);
    EXPECT_TRUE(run_two("factor: 2", "factor: 3").outcome() == Outcome::ok);
    EXPECT_THAT(told_, ElementsAre(HasSubstr("does not store new results")));
}

}  // namespace
}  // namespace scanmill::test
