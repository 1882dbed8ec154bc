// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/metrics.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace scanmill::test {
namespace {

using testing::ElementsAre;

TEST(Unit, EveryUnit_HasANameThatNamesIt) {
    using enum Unit;
    const std::vector<std::pair<Unit, std::string_view>> names{
        {count, "count"}, {length, "length"},   {area, "area"},     {volume, "volume"},  {angle, "angle"},
        {ratio, "ratio"}, {seconds, "seconds"}, {number, "number"}, {boolean, "boolean"}};
    for (const auto& [unit, name] : names) {
        EXPECT_EQ(name_of(unit), name);
        EXPECT_EQ(value_named<Unit>(name), unit) << name;
    }
}

TEST(Unit, UnknownName_IsNone) {
    for (const char* name : {"", "mm", "Length", "metre"}) EXPECT_FALSE(value_named<Unit>(name)) << name;
}

TEST(Metrics, InTheOrderTheyWereReported) {
    Metrics metrics;
    metrics.set("zebra", 1, Unit::count);
    metrics.set("ape", 0.5, Unit::ratio);
    EXPECT_THAT(metrics.values, ElementsAre(Metric{"zebra", 1, Unit::count}, Metric{"ape", 0.5, Unit::ratio}));
}

TEST(Metrics, SameName_ReplacesValueAndUnitInItsPlace) {
    Metrics metrics;
    metrics.set("kept", 1, Unit::count);
    metrics.set("error", 2, Unit::length);
    metrics.set("kept", 0.25, Unit::ratio);
    EXPECT_THAT(metrics.values, ElementsAre(Metric{"kept", 0.25, Unit::ratio}, Metric{"error", 2, Unit::length}));
}

TEST(Metrics, Find_KnowsTheWholeNameOnly) {
    Metrics metrics;
    EXPECT_EQ(metrics.find("kept"), nullptr);
    metrics.set("kept", 3, Unit::count);
    ASSERT_TRUE(metrics.find("kept"));
    EXPECT_EQ(metrics.find("kept")->value, 3);
    EXPECT_EQ(metrics.find("kep"), nullptr);
    EXPECT_EQ(metrics.find("kept "), nullptr);
}

}  // namespace
}  // namespace scanmill::test
