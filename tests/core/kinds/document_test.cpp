// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/kinds/document.hpp"

#include <gmock/gmock.h>

#include "scanmill/data/transform.hpp"
#include "scanmill/filter/parameter.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::HasSubstr;

TEST(JsonForms, Parameters_AreReadBackEqual) {
    ParameterSet set;
    set.values = {{"none", std::monostate()},
                  {"word", ParameterScalar(Word{"auto"})},
                  {"count", ParameterScalar(std::int64_t(-3))},
                  {"length", ParameterScalar(Length(0.1, Length::In::percent_of_diagonal))},
                  {"angles", std::vector<ParameterScalar>{Angle::degrees(40), Angle::radians(0.7)}},
                  {"share", ParameterScalar(Ratio::percent(5))}};
    EXPECT_EQ(from_json<ParameterSet>(Json::parse(text_of(json_of(set)))).values, set.values);
}

TEST(JsonForms, Motions_KeepEveryBit) {
    RigidTransform motion;
    motion.rotation << 0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, 1;
    motion.translation = Vec3(0.1 + 0.2, -1. / 3, 5e-324);
    motion.unit = LengthUnit::inch;
    motion.from = "scan";
    motion.rms = 0.1;
    const auto read = from_json<RigidTransform>(json_from_cbor(cbor_of(json_of(motion)), "it"));
    EXPECT_EQ(read.rotation, motion.rotation);
    EXPECT_EQ(read.translation, motion.translation);
    EXPECT_EQ(read.unit, motion.unit);
    EXPECT_EQ(read.from, "scan");
    EXPECT_EQ(read.rms, 0.1);
    motion.rms.reset();
    EXPECT_EQ(from_json<RigidTransform>(json_of(motion)).rms, std::nullopt);
}

TEST(JsonForms, Metrics_AreReadBackEqual_AndShownByName) {
    Metrics metrics;
    metrics.unit = LengthUnit::millimetre;
    metrics.set("points", 3000, Unit::count);
    metrics.set("error", 0.25, Unit::length);
    metrics.set("closed", 1, Unit::boolean);
    metrics.set("spread", std::nan(""), Unit::number);
    const auto read = from_json<Metrics>(Json::parse(text_of(json_of(metrics))));
    EXPECT_EQ(read.unit, metrics.unit);
    EXPECT_EQ(read.values.at(1), metrics.values.at(1));
    EXPECT_TRUE(std::isnan(read.values.at(3).value));
    EXPECT_EQ(text_of(JsonByName<Metrics>::write(metrics)),
              R"({"points":3000,"error":0.25,"closed":true,"spread":null})");
}

TEST(JsonForms, UnknownNames_AreRefused) {
    EXPECT_THAT(sentence_of([] { from_json<Kind>("voxels"); }), HasSubstr("points, mesh"));
    EXPECT_THAT(sentence_of([] { from_json<LengthUnit>("mil"); }), HasSubstr("um, mm"));
    EXPECT_THAT(sentence_of([] { from_json<Length>("2"); }), HasSubstr("0.2 mm"));
    EXPECT_EQ(json_of(LengthUnit::unknown), Json());
}

}  // namespace
}  // namespace scanmill::test
