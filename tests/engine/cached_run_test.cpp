// SPDX-License-Identifier: GPL-3.0-or-later
// Runs with a cache: nothing is computed twice, what changed is, results are the same bytes either way, and a cache
// that is damaged, full or not to be written to only costs time.

#include <gmock/gmock.h>

#include "engine/run_fixture.hpp"
#include "scanmill/engine/foresight.hpp"
#include "scanmill/formats/files.hpp"

namespace scanmill::test {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr Origin ran = Origin::ran, cached = Origin::cached, same_inputs = Origin::same_inputs;

class CachedRun : public Run {
protected:
    CachedRun() {
        settings_.cache = &cache_;
        keep_ = KeepRule::Policy::always;
    }
    std::vector<Origin> origins(const RunReport& report) {
        std::vector<Origin> all;
        for (const NodeReport& node : report.nodes) {
            EXPECT_EQ(node.outcome, Outcome::done) << node.failure.text;
            all.push_back(node.origin);
        }
        return all;
    }
    /// Two steps, one after the other: reading is node 0, `first` 1, `second` 2.
    RunReport run_two(const std::string& first, const std::string& second, const std::string& scan_name = "a.xyz") {
        return run("  - id: first\n    test-step: {" + first + "}\n  - id: second\n    test-step: {" + second + "}\n",
                   {scan(scan_name)}, "outputs: {'{scan}.ply': second.points}\n");
    }
    Vec3 world_of_second_point() {
        const auto written = read_points(folder_ / "out/a.ply");
        return written->frame.origin + written->positions[1];
    }
    std::vector<fs::path> values() {
        std::vector<fs::path> files;
        for (const auto& entry : fs::recursive_directory_iterator(folder_ / "cache/v1/values"))
            if (entry.is_regular_file()) files.push_back(entry.path());
        return files;
    }

    std::vector<std::string> told_;
    Cache cache_{folder_ / "cache", Cache::default_limit,
                 [this](std::string text) { told_.push_back(std::move(text)); }};
};

TEST_F(CachedRun, TheSameAgain_ComputesNothingAndWritesTheSame) {
    EXPECT_THAT(origins(run_two("factor: 2", "factor: 3, mode: warn")), ElementsAre(ran, ran, ran));
    const std::string first = content_of(folder_ / "out/a.ply");
    fs::remove(folder_ / "out/a.ply");
    const RunReport again = run_two("factor: 2", "factor: 3, mode: warn");
    EXPECT_THAT(origins(again), ElementsAre(cached, cached, cached));
    EXPECT_TRUE(again.all_done());
    EXPECT_EQ(content_of(folder_ / "out/a.ply"), first);
    EXPECT_EQ(again.nodes[2].metrics.find("points")->value, 4);
    EXPECT_EQ(again.nodes[0].facts.find("points")->value, 4);
    EXPECT_THAT(again.nodes[2].warnings, ElementsAre(HasSubstr("asked to warn"))) << "a warning holds for the result";
    EXPECT_EQ(again.nodes[1].resolved.find("factor") != nullptr, true);
    EXPECT_THAT(told_, IsEmpty());
}

TEST_F(CachedRun, AnotherParameter_RunsTheStepsBelowItAndNoOthers) {
    run_two("factor: 2", "factor: 3");
    EXPECT_THAT(origins(run_two("factor: 2", "factor: 4")), ElementsAre(cached, cached, ran));
    EXPECT_THAT(origins(run_two("factor: 5", "factor: 4")), ElementsAre(cached, ran, ran));
    EXPECT_EQ(world_of_second_point(), Vec3(20, 0, 0));
}

TEST_F(CachedRun, CommentsOrderAndNames_ChangeNothing) {
    run_two("factor: 2, length: 1 u", "factor: 3");
    EXPECT_THAT(origins(run("# a comment\n  - id: other\n    test-step: {length: 1 u, factor: 2}\n"
                            "  - {test-step: {factor: 3}, id: name}\n",
                            {scan("renamed.xyz")}, "outputs: {'{scan}.ply': name.points}\n")),
                ElementsAre(cached, cached, cached));
    EXPECT_TRUE(fs::exists(folder_ / "out/renamed.ply"));
}

TEST_F(CachedRun, ChangeThatMakesNoDifference_IsCutOffBelow) {
    run_two("factor: 2, length: 1 u", "factor: 3");
    // Another mesh, which nobody takes, and the same points.
    EXPECT_THAT(origins(run_two("factor: 2, length: 2 u", "factor: 3")), ElementsAre(cached, ran, same_inputs));
    EXPECT_THAT(origins(run_two("factor: 2, length: 2 u", "factor: 3")), ElementsAre(cached, cached, cached))
        << "from then on its plan is known too";
}

TEST_F(CachedRun, LengthsThatResolveToTheSame_AreTheSame) {
    run_two("length: 50 %diag", "factor: 3");  // the diagonal is 3
    EXPECT_THAT(origins(run_two("length: 1.5 u", "factor: 3")), ElementsAre(cached, same_inputs, same_inputs));
}

TEST_F(CachedRun, AnotherContentUnderTheSameName_IsAnotherScan) {
    run_two("factor: 2", "factor: 3");
    fs::remove(folder_ / "a.xyz");
    scan("a.xyz", "0 0 0\n7 0 0\n");
    prepare("  - test-step: {factor: 2}\n", {(folder_ / "a.xyz").string()});
    EXPECT_FALSE(foresee(graph_, &cache_)[0].known);
}

TEST_F(CachedRun, ScanThatChangesAfterPlanning_Fails) {
    prepare("  - test-step:\n", {scan("a.xyz")}, "outputs: {'{scan}.ply': test-step}\n");
    scan("a.xyz", "0 0 0\n7 0 0\n");
    const RunReport report = run_graph();
    EXPECT_THAT(report.cells[0].failure.text, HasSubstr("changed while the run was going on"));
    EXPECT_FALSE(fs::exists(folder_ / "out/a.ply"));
}

TEST_F(CachedRun, Failures_AreNotRemembered) {
    const std::string bad = "  - test-step: {mode: fail}\n";
    EXPECT_EQ(run(bad, {scan("a.xyz")}).nodes[1].outcome, Outcome::failed);
    const RunReport again = run(bad, {scan("a.xyz")});
    EXPECT_EQ(again.nodes[1].outcome, Outcome::failed);
    EXPECT_EQ(again.nodes[1].origin, ran);
}

TEST_F(CachedRun, ExpectationsOfWhatIsCached_AreAskedAgain) {
    const auto expecting = [&](const std::string& points) {
        return run("  - test-step: {factor: 2}\n    expect: {points: " + points + "}\n", {scan("a.xyz")});
    };
    EXPECT_TRUE(expecting("4").all_done());
    const RunReport unmet = expecting("'> 4'");
    EXPECT_THAT(unmet.cells[0].failure.text, testing::AllOf(HasSubstr("points"), HasSubstr("in step 'test-step'")));
    EXPECT_EQ(unmet.nodes[1].origin, cached);
    EXPECT_TRUE(expecting("4").all_done());
}

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
    EXPECT_TRUE(again.all_done());
    EXPECT_EQ(again.nodes[2].origin, ran);
    EXPECT_THAT(again.nodes[2].why, HasSubstr("has lost its value"));
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
    EXPECT_TRUE(diamond("3").all_done());
    for (const fs::path& file : values()) fs::resize_file(file, fs::file_size(file) - 1);
    const RunReport again = diamond("4");
    EXPECT_TRUE(again.all_done());
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
        EXPECT_TRUE(run_two("factor: 2", "factor: 3").all_done());
        EXPECT_EQ(content_of(folder_ / "out/a.ply"), first) << kind;
        EXPECT_FALSE(told_.empty()) << kind;
    }
}

TEST_F(CachedRun, FileOfAParameterThatChangesMeanwhile_FailsTheStep) {
    // The step itself changes it: it appends to its log.
    folder_.write("log", "");
    const RunReport report = run("  - test-step: {log: " + log() + "}\n", {scan("a.xyz")});
    EXPECT_THAT(report.cells[0].failure.text, HasSubstr("log' changed while the run was going on"));
    EXPECT_FALSE(cache_.run_key(graph_.nodes[1].key));
}

TEST_F(CachedRun, StepThatReadsWhatHasNoContent_IsNeverCached) {
    const std::string steps = "  - test-step: {log: " + log() + "}\n";
    EXPECT_TRUE(run(steps, {scan("a.xyz")}).all_done());  // the log is not there yet
    fs::remove(folder_ / "log");
    const RunReport again = run(steps, {scan("a.xyz")});
    EXPECT_EQ(again.nodes[1].origin, ran);
    EXPECT_THAT(again.nodes[1].why, HasSubstr("no content to be known by"));
}

TEST_F(CachedRun, WarningsOfReading_NameTheFileThatWasRead) {
    const std::string text = "# unit furlong\n" + small_scan;
    run("  - test-step:\n", {scan("a.xyz", text)});
    const RunReport copy = run("  - test-step:\n", {scan("b.xyz", text)});
    EXPECT_EQ(copy.nodes[0].origin, cached);
    EXPECT_THAT(copy.nodes[0].warnings,
                ElementsAre(testing::AllOf(HasSubstr("/b.xyz': the unit"), testing::Not(HasSubstr("a.xyz")))));
}

TEST_F(CachedRun, EqualStepsThatExpectOtherThings_AreAskedEach) {
    request_.inputs = {{"other", {scan("b.xyz")}}};
    const RunReport report =
        run("  - id: one\n    test-step:\n    in: {points: scan}\n    expect: {points: 4}\n"
            "  - id: two\n    test-step:\n    in: {points: other}\n    expect: {points: '> 4'}\n",
            {scan("a.xyz")}, "", "{scan: points, other: points}");
    EXPECT_THAT(report.cells[0].failure.text, HasSubstr("in step 'two'"));
}

TEST_F(CachedRun, CacheThatCannotBeWritten_CostsNothingButTime) {
    folder_.write("cache", "a file in its place");
    EXPECT_TRUE(run_two("factor: 2", "factor: 3").all_done());
    EXPECT_TRUE(run_two("factor: 2", "factor: 3").all_done());
    EXPECT_THAT(told_, ElementsAre(HasSubstr("does not keep what is new")));
}

TEST_F(CachedRun, VariantsAndScans_ShareWhatIsEqual) {
    const std::string steps =
        "  - id: shared\n    test-step: {factor: 2}\n  - id: last\n    test-step: {factor: {sweep: [3, 4]}}\n";
    const std::string tail = "outputs: {'{scan}-{variant}.ply': last.points}\n";
    EXPECT_THAT(origins(run(steps, {scan("a.xyz"), scan("b.xyz")}, tail)), ElementsAre(ran, ran, ran, ran));
    EXPECT_THAT(origins(run(steps, {scan("a.xyz"), scan("c.xyz", "0 0 0\n9 0 0\n")}, tail)),
                ElementsAre(cached, cached, cached, cached, ran, ran, ran, ran));
}

TEST_F(CachedRun, Foresight_SaysWhatWillRunAndWhy) {
    run_two("factor: 2", "factor: 3");
    prepare("  - id: first\n    test-step: {factor: 2}\n  - id: second\n    test-step: {factor: 4}\n", {scan("a.xyz")},
            "outputs: {'{scan}.ply': second.points}\n");
    const std::vector<NodeForesight> seen = foresee(graph_, &cache_);
    EXPECT_FALSE(seen[0].will_run);
    EXPECT_FALSE(seen[1].will_run);
    EXPECT_THAT(seen[1].needed, ElementsAre("points"));
    EXPECT_TRUE(seen[2].will_run);
    EXPECT_THAT(seen[2].why, HasSubstr("has not run on such inputs"));
    EXPECT_THAT(foresee(graph_, nullptr)[0].why, HasSubstr("no cache"));
}

TEST_F(CachedRun, Foresight_SaysWhyAValueIsMissing) {
    keep_ = KeepRule::Policy::never;
    run_two("factor: 2", "factor: 3");
    EXPECT_THAT(foresee(graph_, &cache_, KeepRule::Policy::never)[2].why,
                testing::AllOf(HasSubstr("'points' is not in the cache"), HasSubstr("--keep never"),
                               testing::Not(HasSubstr("quick"))));
}

TEST_F(CachedRun, ForesightOfAValueThatTookLong_DoesNotCallItQuick) {
    keep_ = KeepRule::Policy::never;
    run("  - test-step: {mode: slow}\n", {scan("a.xyz")}, "outputs: {'{scan}.ply': test-step.points}\n");
    EXPECT_THAT(foresee(graph_, &cache_)[1].why, testing::AllOf(HasSubstr("did not keep it, or it was removed since"),
                                                                testing::Not(HasSubstr("quick"))));
    StepResult quick = *foresee(graph_, &cache_)[1].known;
    quick.seconds = 0;
    const std::string run_key(32, 'a');
    cache_.clear();
    cache_.keep_run_key(graph_.nodes[1].key, run_key);
    cache_.keep_step(run_key, quick);
    EXPECT_EQ(foresee(graph_, &cache_)[1].why, "its 'points' was not kept, being quick to make again");
}

TEST(KeepRule, WeighsMakingAgainstWriting) {
    KeepRule rule;
    EXPECT_TRUE(rule.is_worth(1, 100'000'000)) << "0.2 s to write at 500 MB/s";
    EXPECT_FALSE(rule.is_worth(0.3, 100'000'000));
    rule.wrote(10'000'000, 1);  // a slow disk
    EXPECT_EQ(rule.bytes_per_second(), 1e7);
    EXPECT_FALSE(rule.is_worth(1, 100'000'000));
    rule.wrote(30'000'000, 1);
    EXPECT_EQ(rule.bytes_per_second(), 2e7);
    rule.wrote(10, 5);
    EXPECT_EQ(rule.bytes_per_second(), 2e7) << "too small to tell";
    EXPECT_TRUE(KeepRule(KeepRule::Policy::always).is_worth(0, ~u64(0)));
    EXPECT_FALSE(KeepRule(KeepRule::Policy::never).is_worth(1e9, 1));
}

}  // namespace
}  // namespace scanmill::test
