// SPDX-License-Identifier: GPL-3.0-or-later
// Which of two values of a metric is better, as the installed filters declare it.

#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "scanmill/kinds/value.hpp"
#include "support/program.hpp"

namespace scanmill::test {
namespace {

using nlohmann::json;

class MetricDirections : public testing::Test {
protected:
    MetricDirections() {
        const json listed = json::parse(scanmill_program({"list", "--json"}).out);
        for (const json& filter : listed["filters"])
            for (const json& metric : filter["metrics"])
                by_filter_[filter["name"]][metric["name"]] = metric.value("better", "neither");
    }
    std::map<std::string, std::map<std::string, std::string>> by_filter_;
};

// A filter whose numbers are signed has none: the mean of inspect is best at 0, that of measure is a distance.
TEST_F(MetricDirections, OneName_HasNotTwoDirections) {
    std::map<std::string, std::string> known;
    for (const PropertySpec& property : property_specs(kind_of<TriangleMesh>()))
        if (property.better != Better::neither) known[property.name] = name_of(property.better);
    EXPECT_EQ(known.at("closed"), "larger");
    for (const auto& [filter, metrics] : by_filter_)
        for (const auto& [name, better] : metrics) {
            if (better == "neither") continue;
            EXPECT_EQ(known.try_emplace(name, better).first->second, better) << name << " of " << filter;
        }
}

TEST_F(MetricDirections, OfErrorsAndScores_AreTheirMeaning) {
    const auto& measure = by_filter_.at("measure");
    for (const char* name : {"hausdorff", "chamfer", "mean", "max-from-truth", "p95-to-points", "hausdorff-upper",
                             "self-intersections", "nonmanifold-edges", "boundary-edges", "aspect-ratio-max"})
        EXPECT_EQ(measure.at(name), "smaller") << name;
    for (const char* name : {"f-score", "precision", "recall", "normal-consistency", "min-angle", "closed"})
        EXPECT_EQ(measure.at(name), "larger") << name;
    EXPECT_EQ(by_filter_.at("region-grow").at("unused-points"), "smaller");
    EXPECT_EQ(by_filter_.at("decimate").at("hausdorff-upper"), "smaller");
}

/// More triangles, a larger volume or another genus are neither better nor worse.
TEST_F(MetricDirections, OfSizesAndTopologyAndTheInput_AreNeither) {
    for (const char* name : {"triangles", "vertices", "area", "volume", "genus", "components", "boundary-loops",
                             "diagonal", "threshold", "mean-spread", "cuts"})
        EXPECT_EQ(by_filter_.at("measure").at(name), "neither") << name;
    for (const auto& [name, better] : by_filter_.at("measure"))
        if (name.starts_with("truth-")) {
            EXPECT_EQ(better, "neither") << name;
        }
    for (const auto& [filter, metrics] : by_filter_)
        for (const auto& [name, better] : metrics)
            if (name == "triangles" || name.ends_with("-before") || name == "duplicates" || name == "kept") {
                EXPECT_EQ(better, "neither") << name << " of " << filter;
            }
}

}  // namespace
}  // namespace scanmill::test
