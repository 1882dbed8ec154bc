// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/filter/context.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <limits>
#include <thread>

namespace scanmill::test {
namespace {

using testing::ElementsAre;

TEST(Context, Default_IsAQuietSurroundings) {
    Context context;
    EXPECT_EQ(context.threads(), 1u);
    EXPECT_TRUE(context.scratch().empty());
    EXPECT_FALSE(context.cancelled());
    EXPECT_NO_THROW(context.check_cancelled());
    EXPECT_NO_THROW(context.progress(0.5)) << "there is no callback";
    EXPECT_TRUE(context.metrics().values.empty());
    EXPECT_TRUE(context.warnings().empty());
}

TEST(Context, NoThreads_AreOne) {
    ContextOptions options;
    options.threads = 0;
    EXPECT_EQ(Context(options).threads(), 1u);
    options.threads = 3;
    EXPECT_EQ(Context(options).threads(), 3u);
}

TEST(Context, Progress_IsHandedOnWithinZeroAndOne) {
    std::vector<double> seen;
    ContextOptions options;
    options.on_progress = [&](double fraction) { seen.push_back(fraction); };
    Context context(std::move(options));
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double fraction : {0.0, 0.25, 1.0, 1.5, -0.5, std::numeric_limits<double>::infinity(), nan})
        context.progress(fraction);
    EXPECT_THAT(seen, ElementsAre(0, 0.25, 1, 1, 0, 1, 0));
}

TEST(Context, Warnings_AreKeptInOrderAndHandedOn) {
    std::vector<std::string> seen;
    ContextOptions options;
    options.on_warning = [&](std::string_view text) { seen.emplace_back(text); };
    Context context(std::move(options));
    context.warn("first");
    context.warn("second");
    EXPECT_THAT(seen, ElementsAre("first", "second"));
    EXPECT_THAT(context.warnings(), ElementsAre("first", "second"));
}

TEST(Context, Doubts_AreKeptInOrderWithTheirPorts) {
    Context context;
    context.doubt("far too large");
    context.doubt("not closed", "mesh");
    ASSERT_EQ(context.doubts().size(), 2u);
    EXPECT_EQ(context.doubts()[0].text, "far too large");
    EXPECT_EQ(context.doubts()[0].port, "");
    EXPECT_EQ(context.doubts()[1].port, "mesh");
    EXPECT_TRUE(context.warnings().empty());
}

TEST(Context, Metric_CountsUnlessToldOtherwise) {
    Context context;
    context.metric("kept", 3);
    context.metric("error", 0.5, Unit::length);
    context.metric("kept", 4);
    EXPECT_THAT(context.metrics().values,
                ElementsAre(Metric{"kept", 4, Unit::count}, Metric{"error", 0.5, Unit::length}));
}

TEST(Context, Cancelling_IsSeenFromThenOn) {
    bool stop = false;
    ContextOptions options;
    options.is_cancelled = [&] { return stop; };
    const Context context(std::move(options));
    EXPECT_NO_THROW(context.check_cancelled());
    stop = true;
    EXPECT_TRUE(context.cancelled());
    EXPECT_THROW(context.check_cancelled(), Cancelled);
}

TEST(Context, Random_IsTheSeedsGeneratorAtEveryCall) {
    ContextOptions options;
    options.seed = 42;
    const Context context(options);
    Random expected(42);
    const std::uint64_t first = expected.next();
    EXPECT_EQ(context.random().next(), first);
    EXPECT_EQ(context.random().next(), first);
    options.seed = 43;
    EXPECT_NE(Context(options).random().next(), first);
}

TEST(Context, ReportsFromManyThreads_ComeOneAtATimeAndAllOfThem) {
    std::atomic<int> inside = 0;
    bool overlapped = false;
    int reports = 0;
    const auto listen = [&] {
        if (++inside > 1) overlapped = true;
        ++reports;
        std::this_thread::yield();
        --inside;
    };
    ContextOptions options;
    options.on_progress = [&](double) { listen(); };
    options.on_warning = [&](std::string_view) { listen(); };
    Context context(std::move(options));
    std::vector<std::thread> threads;
    for (int thread = 0; thread < 4; ++thread)
        threads.emplace_back([&context, thread] {
            for (int i = 0; i < 200; ++i) {
                context.progress(0.5);
                context.warn("w");
                context.metric("m" + std::to_string(thread), i);
            }
        });
    for (std::thread& thread : threads) thread.join();
    EXPECT_FALSE(overlapped);
    EXPECT_EQ(reports, 4 * 200 * 2);
    EXPECT_EQ(context.warnings().size(), 800u);
    EXPECT_EQ(context.metrics().values.size(), 4u);
}

}  // namespace
}  // namespace scanmill::test
