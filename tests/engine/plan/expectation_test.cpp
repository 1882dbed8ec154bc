// SPDX-License-Identifier: GPL-3.0-or-later
// What `expect` takes for metrics with a unit, and how it compares.

#include "scanmill/plan/expectation.hpp"

#include <gmock/gmock.h>

#include "scanmill/base/error.hpp"
#include "scanmill/workflow/sizes.hpp"

namespace scanmill {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Relation = Expectation::Relation;

FilterSpec filter() {
    FilterSpec spec;
    spec.name = "weigh";
    spec.outputs.push_back({.name = "points", .kind = kind_of<PointCloud>(), .help = "All."});
    spec.metrics = {
        {"volume", Unit::volume, "How much."}, {"skin", Unit::area, "How wide."}, {"edge", Unit::length, ""}};
    return spec;
}

/// What is found wrong with it.
std::vector<std::string> faults(const std::string& name, const std::string& value, Relation relation = Relation::equal,
                                const std::string& high = {}) {
    Diagnostics diagnostics("w");
    plan_expectation({name, {}, relation, value, high}, filter(), diagnostics);
    std::vector<std::string> found;
    for (const Diagnostic& each : diagnostics.sorted()) found.push_back(each.message);
    return found;
}

/// Whether a metric of this value meets it, on a scan in `unit` whose diagonal is 200 and spacing 2.
bool meets(double found, const std::string& name, Relation relation, const std::string& low,
           const std::string& high = {}, LengthUnit unit = LengthUnit::millimetre) {
    Diagnostics diagnostics("w");
    const auto planned = plan_expectation({name, {}, relation, low, high}, filter(), diagnostics);
    EXPECT_FALSE(diagnostics.has_errors());
    Metrics metrics;
    metrics.values.push_back({name, found, planned->unit});
    const LengthScale scale{unit, [] { return 200.0; }, [] { return 2.0; }};
    try {
        require_met({*planned}, metrics, scale);
    } catch (const Error& error) {
        EXPECT_THAT(error.sentence(), HasSubstr("expected " + name));
        return false;
    }
    return true;
}

TEST(Expectation, VolumesAndAreas_AreNeverBare) {
    EXPECT_THAT(faults("volume", "12"),
                ElementsAre("expect volume: '12' has no unit; expected 12 mm3, 0.5 u3 or 20 spacing3"));
    EXPECT_THAT(faults("volume", "1e3", Relation::above), ElementsAre(HasSubstr("'1e3' has no unit")));
    EXPECT_THAT(faults("skin", "4", Relation::below),
                ElementsAre("expect skin: '4' has no unit; expected 12 mm2, 0.5 u2 or 20 spacing2"));
    EXPECT_THAT(faults("volume", "12 mm2"), ElementsAre(HasSubstr("'12 mm2' is not a volume; expected 12 mm3")));
    EXPECT_THAT(faults("volume", "12 mm"), ElementsAre(HasSubstr("'12 mm' is not a volume")));
    EXPECT_THAT(faults("skin", "12 mm3"), ElementsAre(HasSubstr("'12 mm3' is not an area; expected 12 mm2")));
    EXPECT_THAT(faults("volume", "12 ell3"),
                ElementsAre(HasSubstr("'ell' is not a unit of length; expected u, %diag")));
    EXPECT_THAT(faults("volume", "much"), ElementsAre(HasSubstr("'much' is not a volume")));
    EXPECT_THAT(faults("volume", "3"), ElementsAre(HasSubstr("has no unit")));
    EXPECT_THAT(faults("volume", ""), ElementsAre(HasSubstr("'' is not a volume")));
    for (const char* text : {"12 mm3", "12mm^3", "12 mm³", "-0.5 u3", "2 %diag3", "20 spacing3", "1e-3 in3"})
        EXPECT_THAT(faults("volume", text), IsEmpty()) << text;
    EXPECT_THAT(faults("skin", "12 cm²"), IsEmpty());
}

TEST(Expectation, Ends_AreInOrderWhereTheyCanBeCompared) {
    EXPECT_THAT(faults("volume", "2 u3", Relation::between, "1 u3"),
                ElementsAre("expect volume: the range [2 u3, 1 u3] is empty; expected the lower end first"));
    EXPECT_THAT(faults("edge", "2 mm", Relation::between, "1 mm"), ElementsAre(HasSubstr("the lower end first")));
    EXPECT_THAT(faults("edge", "2 cm", Relation::between, "1 mm"), ElementsAre(HasSubstr("the lower end first")));
    EXPECT_THAT(faults("volume", "1 cm3", Relation::between, "2 mm3"), ElementsAre(HasSubstr("the lower end first")));
    EXPECT_THAT(faults("volume", "2 mm3", Relation::between, "1 cm3"), IsEmpty());
    EXPECT_THAT(faults("volume", "2 u3", Relation::between, "1 cm3"), IsEmpty()) << "it depends on the scan";
    EXPECT_THAT(faults("volume", "-2 u3", Relation::between, "-1 u3"), IsEmpty());
}

TEST(Expectation, UnitsAreRaisedToTheirPower) {
    // 1 cm³ is 1000 mm³, 1 cm² 100 mm².
    EXPECT_TRUE(meets(2000, "volume", Relation::equal, "2 cm3"));
    EXPECT_TRUE(meets(200, "skin", Relation::equal, "2 cm2"));
    EXPECT_TRUE(meets(2000, "volume", Relation::equal, "2000 u3"));
    EXPECT_FALSE(meets(2000, "volume", Relation::equal, "20 u3"));
    EXPECT_TRUE(meets(1e-9, "volume", Relation::between, "0.9 mm3", "1.1 mm3", LengthUnit::metre));
    // The spacing is 2, 1 % of the diagonal too.
    EXPECT_TRUE(meets(24, "volume", Relation::equal, "3 spacing3"));
    EXPECT_TRUE(meets(12, "skin", Relation::equal, "3 %diag2"));
    EXPECT_FALSE(meets(24, "volume", Relation::below, "3 spacing3"));
    EXPECT_TRUE(meets(-24, "volume", Relation::below, "-1 spacing3"));
    EXPECT_TRUE(meets(0, "volume", Relation::between, "0 mm3", "1 mm3"));
}

TEST(Expectation, AnAbsoluteVolumeOnAScanOfUnknownUnit_IsRefusedWithAHint) {
    Diagnostics diagnostics("w");
    const auto planned = plan_expectation({"volume", {}, Relation::above, "1 mm3", {}}, filter(), diagnostics);
    Metrics metrics;
    metrics.values.push_back({"volume", 3, Unit::volume});
    try {
        require_met({*planned}, metrics, {});
        FAIL() << "accepted";
    } catch (const Error& error) {
        EXPECT_THAT(error.sentence(), HasSubstr("1 mm3 needs a scan of known unit"));
        EXPECT_THAT(error.hint(), AllOf(HasSubstr("unit: mm"), HasSubstr("as 0.5 u3")));
    }
}

}  // namespace
}  // namespace scanmill
