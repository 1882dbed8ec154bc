// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/record/json.hpp"

#include <gmock/gmock.h>

#include "scanmill/base/error.hpp"
#include "support/thrown.hpp"

namespace scanmill {
namespace {

using testing::AllOf;
using testing::HasSubstr;

enum class Outcome { ok, failed };
constexpr std::array<std::string_view, 2> names_of(const Outcome*) { return {"ok", "failed"}; }

struct Failure {
    std::string cause;
    int number = 0;
};
constexpr auto fields(const Failure*) {
    return std::tuple{field("cause", &Failure::cause, "Why it failed.").optional(),
                      field("number", &Failure::number, "Signal or exit code.").optional()};
}

struct Sample {
    Outcome outcome = Outcome::ok;
    double length = 1;
    std::vector<Failure> list;
    Failure failure;
    std::optional<std::uint32_t> order;
    std::array<double, 2> range{};
    Eigen::Vector3d point{1, 2, 3};
    std::variant<int, std::string> either;
    std::string frame;
};
constexpr auto fields(const Sample*) {
    return std::tuple{field("outcome", &Sample::outcome),
                      field("length", &Sample::length, "Of the edge.").unit("mm").nullable(),
                      field("list", &Sample::list),
                      field("failure", &Sample::failure).flat(),
                      field("order", &Sample::order),
                      field("range", &Sample::range),
                      field("point", &Sample::point).only_if([](const Sample& s) { return s.outcome == Outcome::ok; }),
                      field("either", &Sample::either),
                      field("frame", &Sample::frame).nullable()};
}

std::string refusal_of(const Json& json) {
    return test::sentence_of([&] { from_json<Sample>(json, "the sample"); });
}

TEST(RecordJson, Struct_IsWrittenMemberByMember) {
    Sample sample;
    sample.list = {{"signal", 11}, {}};
    sample.failure.cause = "time";
    sample.order = 7;
    EXPECT_EQ(text_of(json_of(sample)),
              R"({"outcome":"ok","length":1.0,"list":[{"cause":"signal","number":11},{}],"cause":"time","order":7,)"
              R"("range":[0.0,0.0],"point":[1.0,2.0,3.0],"either":[0,0],"frame":null})");
}

TEST(RecordJson, WhatIsWritten_IsReadBack_AsJsonAndAsCbor) {
    Sample sample;
    sample.outcome = Outcome::failed;
    sample.length = std::nan("");
    sample.list = {{"signal", 11}};
    sample.either = "text";
    sample.frame = "part";
    const Json json = json_of(sample);
    for (const Json& form : {json, Json::parse(text_of(json)), json_from_cbor(cbor_of(json), "it")}) {
        const Sample read = from_json<Sample>(form);
        EXPECT_TRUE(std::isnan(read.length));
        EXPECT_EQ(read.list.at(0).number, 11);
        EXPECT_EQ(std::get<std::string>(read.either), "text");
        EXPECT_EQ(text_of(json_of(read)), text_of(json));
    }
}

TEST(RecordJson, MembersOfAnotherForm_AreRefusedWithTheirPath) {
    const auto changed = [](auto&& change) {
        Json json = json_of(Sample());
        change(json);
        return refusal_of(json);
    };
    EXPECT_THAT(changed([](Json& json) { json.erase("range"); }), AllOf(HasSubstr("'range'"), HasSubstr("missing")));
    EXPECT_THAT(changed([](Json& json) { json["rang"] = 1; }),
                AllOf(HasSubstr("'rang'"), HasSubstr("unknown"), HasSubstr("did you mean 'range'")));
    EXPECT_THAT(changed([](Json& json) { json["list"] = {{{"number", 1.5}}}; }), HasSubstr("'list[0].number'"));
    EXPECT_THAT(changed([](Json& json) { json["list"] = {{{"number", 1e300}}}; }), HasSubstr("'list[0].number'"));
    EXPECT_THAT(changed([](Json& json) { json["order"] = -1; }), AllOf(HasSubstr("'order'"), HasSubstr("4294967295")));
    EXPECT_THAT(changed([](Json& json) { json["outcome"] = "faild"; }), HasSubstr("did you mean 'failed'"));
    EXPECT_THAT(changed([](Json& json) { json["range"] = {1}; }), AllOf(HasSubstr("'range'"), HasSubstr("2")));
    EXPECT_THAT(changed([](Json& json) { json["range"][1] = "a"; }), HasSubstr("'range[1]'"));
    EXPECT_THAT(changed([](Json& json) { json["outcome"] = "failed"; }), HasSubstr("'point'"));
    EXPECT_THAT(changed([](Json& json) { json["either"] = {2, 0}; }), HasSubstr("'either'"));
    EXPECT_THAT(changed([](Json& json) { json["cause"] = nullptr; }), HasSubstr("'cause'"));
    EXPECT_THAT(changed([](Json& json) { json = 3; }), HasSubstr("the sample is not an object"));
}

TEST(RecordJson, Schema_FollowsFromTheFields) {
    const Json schema = JsonForm<Sample>::schema();
    const Json& members = schema["properties"];
    EXPECT_EQ(members["length"], Json({{"type", {"number", "null"}}, {"description", "Of the edge. In mm."}}));
    EXPECT_EQ(members["outcome"], Json({{"enum", {"ok", "failed"}}}));
    EXPECT_EQ(members["order"], Json({{"type", {"integer", "null"}}, {"minimum", 0}}));
    EXPECT_EQ(members["cause"]["description"], "Why it failed.");
    EXPECT_EQ(members["list"]["items"]["properties"]["number"]["type"], "integer");
    EXPECT_EQ(members["range"]["maxItems"], 2);
    EXPECT_EQ(schema["additionalProperties"], false);
    EXPECT_EQ(schema["required"], Json({"outcome", "list", "order", "range", "either"}));
}

}  // namespace
}  // namespace scanmill
