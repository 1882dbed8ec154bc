// SPDX-License-Identifier: GPL-3.0-or-later
/// Lists of motions as JSON.
#include "scanmill/kinds/transform.hpp"

#include <gmock/gmock.h>

#include <cstring>
#include <functional>

#include "scanmill/formats/files.hpp"
#include "scanmill/kinds/document.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

RigidTransform motion(std::string from, const Vec3& translation) {
    RigidTransform motion;
    motion.rotation << 0.6, -0.8, 0, 0.8, 0.6, 0, 0, 0, 1;
    motion.translation = translation;
    motion.unit = LengthUnit::millimetre;
    motion.from = std::move(from);
    motion.to = "part";
    return motion;
}

Transforms registered() {
    Transforms transforms(motion("a", Vec3(0.1 + 0.2, -1. / 3, 5e-324)));
    transforms.motions[0].rms = 0.1 + 0.2;
    transforms.motions.push_back(motion("b", Vec3(-0.0, 1e300, 7)));
    transforms.refused = {{"c", "no-overlap: at most 12 % with any other view"}};
    transforms.edges = {{motion("a", Vec3(1. / 3, 0, -0.0)), 0.5, 1. / 3, 5e-324, 0.02, 0.1 + 0.2}};
    transforms.edges[0].pose.to = "b";
    return transforms;
}

Json json_of(const Transforms& transforms) {
    Json json;
    kind_of<Transforms>().info().to_json(&transforms, json);
    return json;
}

Transforms transforms_of(const Json& json) {
    return *std::static_pointer_cast<Transforms>(kind_of<Transforms>().info().from_json(json, {}));
}

bool same_bits(const auto& a, const auto& b) { return std::memcmp(a.data(), b.data(), sizeof a) == 0; }

void expect_equal(const RigidTransform& a, const RigidTransform& b) {
    EXPECT_TRUE(same_bits(a.rotation, b.rotation));
    EXPECT_TRUE(same_bits(a.translation, b.translation)) << a.translation << " and " << b.translation;
    EXPECT_EQ(a.unit, b.unit);
    EXPECT_EQ(a.from, b.from);
    EXPECT_EQ(a.to, b.to);
    EXPECT_EQ(a.rms, b.rms);
}

void expect_equal(const Transforms& a, const Transforms& b) {
    ASSERT_EQ(a.motions.size(), b.motions.size());
    for (std::size_t i = 0; i < a.motions.size(); ++i) expect_equal(a.motions[i], b.motions[i]);
    ASSERT_EQ(a.refused.size(), b.refused.size());
    for (std::size_t i = 0; i < a.refused.size(); ++i) {
        EXPECT_EQ(a.refused[i].from, b.refused[i].from);
        EXPECT_EQ(a.refused[i].reason, b.refused[i].reason);
    }
    ASSERT_EQ(a.edges.size(), b.edges.size());
    for (std::size_t i = 0; i < a.edges.size(); ++i) {
        expect_equal(a.edges[i].pose, b.edges[i].pose);
        EXPECT_EQ(a.edges[i].overlap, b.edges[i].overlap);
        EXPECT_EQ(a.edges[i].front, b.edges[i].front);
        EXPECT_EQ(a.edges[i].missing, b.edges[i].missing);
        EXPECT_EQ(a.edges[i].slide, b.edges[i].slide);
        EXPECT_EQ(a.edges[i].score, b.edges[i].score);
    }
}

std::string sentence_with(const std::function<void(Json&)>& change) {
    Json json = json_of(registered());
    change(json);
    return sentence_of([&] { transforms_of(json); });
}

TEST(TransformsJson, OneMotion_IsADocumentOfOnePose) {
    EXPECT_EQ(json_of(Transforms(motion("a", Vec3(1, 2, 3)))).dump(),
              R"({"scanmill":1,"unit":"mm","frame":"part","poses":[{"scan":"a","matrix":)"
              R"([[0.6,-0.8,0.0,1.0],[0.8,0.6,0.0,2.0],[0.0,0.0,1.0,3.0],[0,0,0,1]]}]})");
}

TEST(TransformsJson, List_IsReadBackBitForBit) {
    expect_equal(transforms_of(parse_document(json_of(registered()).dump())), registered());
    Transforms without_names(motion("", Vec3(1, 2, 3)));
    without_names.motions[0].to = "";
    without_names.motions[0].unit = LengthUnit::unknown;
    expect_equal(transforms_of(parse_document(json_of(without_names).dump())), without_names);
}

TEST(TransformsJson, RefusedFramesAndEdges_HaveTheirMembers) {
    const Json json = json_of(registered());
    ASSERT_EQ(json["poses"].size(), 3u);
    EXPECT_EQ(json["poses"][2].dump(), R"({"scan":"c","refused":"no-overlap: at most 12 % with any other view"})");
    EXPECT_EQ(json["edges"][0]["views"].dump(), R"(["a","b"])");
    EXPECT_EQ(json["edges"][0]["matrix"][3].dump(), "[0,0,0,1]");
    EXPECT_EQ(json["edges"][0]["overlap"], 0.5);
}

TEST(TransformsJson, InAFile_IsRecognised) {
    const std::string bytes = write_bytes("motions.json", std::make_shared<const Transforms>(registered()));
    const LoadedFile loaded = read_bytes(bytes, "motions.json");
    ASSERT_EQ(loaded.value.kind(), kind_of<Transforms>());
    expect_equal(*loaded.value.get<Transforms>(), registered());
}

TEST(TransformsJson, Poses_TellRefusedScansApart) {
    const auto poses = poses_from_json(json_of(registered()), {});
    ASSERT_EQ(poses.size(), 3u);
    EXPECT_EQ(poses[1].scan, "b");
    EXPECT_EQ(poses[1].refused, std::nullopt);
    EXPECT_EQ(poses[2].scan, "c");
    EXPECT_EQ(poses[2].refused, "no-overlap: at most 12 % with any other view");
}

TEST(TransformsJson, BrokenRefusals_AreRefusedWithTheirNumber) {
    const auto refused = [](Json& json) -> Json& { return json["poses"][2]; };
    EXPECT_THAT(sentence_with([&](Json& json) { refused(json)["matrix"] = json["poses"][0]["matrix"]; }),
                AllOf(HasSubstr("pose 3"), HasSubstr("'refused' and 'matrix'")));
    EXPECT_THAT(sentence_with([&](Json& json) { refused(json)["rms"] = 1; }), HasSubstr("'refused' and 'rms'"));
    EXPECT_THAT(sentence_with([&](Json& json) { refused(json).erase("scan"); }),
                AllOf(HasSubstr("pose 3"), HasSubstr("does not name its scan")));
    EXPECT_THAT(sentence_with([&](Json& json) { refused(json)["refused"] = ""; }),
                AllOf(HasSubstr("pose 3"), HasSubstr("is empty")));
    EXPECT_THAT(sentence_with([&](Json& json) { refused(json)["refused"] = nullptr; }),
                HasSubstr("'poses[2].refused' is not a text"));
}

TEST(TransformsJson, OnlyRefusedScans_AreNoTransform) {
    EXPECT_THAT(sentence_with([](Json& json) { json["poses"].erase(0), json["poses"].erase(0); }),
                AllOf(HasSubstr("no motion"), HasSubstr("'c' is refused: no-overlap")));
    EXPECT_THAT(sentence_with([](Json& json) { json["poses"] = Json::array(); }), HasSubstr("contains no pose"));
}

TEST(TransformsJson, BrokenEdges_AreRefusedWithTheirNumber) {
    const auto edge = [](Json& json) -> Json& { return json["edges"][0]; };
    EXPECT_THAT(sentence_with([&](Json& json) { edge(json)["matrix"][0][0] = 0.7; }), HasSubstr("edge 1"));
    EXPECT_THAT(sentence_with([&](Json& json) { edge(json)["views"] = {"a"}; }), HasSubstr("'edges[0].views'"));
    EXPECT_THAT(sentence_with([&](Json& json) { edge(json)["score"] = nullptr; }), HasSubstr("'edges[0].score'"));
    EXPECT_THAT(sentence_with([&](Json& json) { edge(json).erase("front"); }), HasSubstr("'edges[0].front'"));
    EXPECT_THAT(sentence_with([&](Json& json) { edge(json)["rms"] = -1; }), HasSubstr("edge 1: 'rms' is -1"));
    Json json = json_of(registered());
    json["edges"][0]["matrix"][0][0] = 0.7;
    EXPECT_THAT(sentence_of([&] { poses_from_json(json, {}); }), HasSubstr("edge 1"));
}

TEST(Transforms, OfDifferentFramesOrUnits_AreNotUsable) {
    const auto refusal = [](const std::function<void(Transforms&)>& change) {
        Transforms transforms = registered();
        change(transforms);
        return sentence_of([&] { kind_of<Transforms>().info().require_usable(&transforms); });
    };
    EXPECT_THAT(refusal([](Transforms& t) { t.motions[1].to = "lab"; }), HasSubstr("'part' and 'lab'"));
    EXPECT_THAT(refusal([](Transforms& t) { t.motions[1].unit = LengthUnit::inch; }), HasSubstr("'mm' and 'in'"));
    EXPECT_THAT(refusal([](Transforms& t) { t.edges[0].pose.unit = LengthUnit::inch; }), HasSubstr("'mm' and 'in'"));
    EXPECT_THAT(refusal([](Transforms& t) { t.motions.clear(); }), HasSubstr("no motion"));
    EXPECT_THAT(refusal([](Transforms& t) { t.refused[0].from.clear(); }), HasSubstr("no name"));
    EXPECT_THAT(refusal([](Transforms& t) { t.refused[0].reason.clear(); }), HasSubstr("no reason"));
}

}  // namespace
}  // namespace scanmill::test
