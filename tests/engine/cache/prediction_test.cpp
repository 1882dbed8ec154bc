// SPDX-License-Identifier: GPL-3.0-or-later
// What will run, and why, before anything does.

#include "scanmill/cache/prediction.hpp"

#include <gmock/gmock.h>

#include "engine/run/cached_run_fixture.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST_F(CachedRun, Prediction_ContainsWhatWillRunAndWhy) {
    run_two("factor: 2", "factor: 3");
    prepare("  - id: first\n    test-step: {factor: 2}\n  - id: second\n    test-step: {factor: 4}\n", {scan("a.xyz")},
            "outputs: {'{scan}.ply': second.points}\n");
    const std::vector<NodePrediction> predicted = predict(graph_, &cache_);
    EXPECT_FALSE(predicted[0].will_run);
    EXPECT_FALSE(predicted[1].will_run);
    EXPECT_THAT(predicted[1].needed, ElementsAre("points"));
    EXPECT_TRUE(predicted[2].will_run);
    EXPECT_THAT(predicted[2].why, HasSubstr("has not run with these inputs"));
    EXPECT_THAT(predict(graph_, nullptr)[0].why, HasSubstr("no cache"));
}

TEST_F(CachedRun, Prediction_ContainsWhyAValueIsMissing) {
    keep_ = KeepRule::Policy::never;
    run_two("factor: 2", "factor: 3");
    EXPECT_THAT(predict(graph_, &cache_, KeepRule::Policy::never)[2].why,
                testing::AllOf(HasSubstr("'points' is not in the cache"), HasSubstr("the policy 'never'"),
                               testing::Not(HasSubstr("quick"))));
}

TEST_F(CachedRun, PredictionOfAValueThatTookLong_DoesNotCallItQuick) {
    keep_ = KeepRule::Policy::never;
    run("  - test-step: {mode: slow}\n", {scan("a.xyz")}, "outputs: {'{scan}.ply': test-step.points}\n");
    EXPECT_THAT(predict(graph_, &cache_)[1].why, testing::AllOf(HasSubstr("did not store it, or it was removed later"),
                                                                testing::Not(HasSubstr("quick"))));
    StepResult quick = *predict(graph_, &cache_)[1].cached;
    quick.seconds = 0;
    const std::string run_key(32, 'a');
    cache_.clear();
    cache_.keep_run_key(graph_.nodes[1].key, run_key);
    cache_.keep_step(run_key, quick);
    EXPECT_EQ(predict(graph_, &cache_)[1].why, "its 'points' was not stored, because it is quick to compute again");
}

}  // namespace
}  // namespace scanmill::test
