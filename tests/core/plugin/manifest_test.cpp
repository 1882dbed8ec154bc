// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/manifest.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;
using Json = nlohmann::ordered_json;

ParameterSpec parameter(std::string name, ParameterType type, ParameterValue default_value) {
    ParameterSpec spec;
    spec.name = std::move(name);
    spec.help = "Says \"what\" it is for — in a sentence.";
    spec.type = type;
    spec.default_value = std::move(default_value);
    return spec;
}

/// Uses every field and every type at least once.
Manifest everything() {
    using List = std::vector<ParameterScalar>;
    Manifest manifest;
    manifest.abi = "scanmill 0.1.0, compiler abi 1017";
    FilterSpec& spec = manifest.spec;
    spec.name = "all-sorts";
    spec.version = 12;
    spec.summary = "Uses \\ everything, \n and ünïcode.";
    spec.source = "Hand-made";
    spec.ties = "The first of equals stays.";
    spec.not_finite = "Refused with their number.";
    for (const Kind kind : {kind_of<PointCloud>(), kind_of<TriangleMesh>(), kind_of<TetMesh>(), kind_of<FeatureGraph>(),
                            kind_of<Transforms>(), kind_of<Metrics>(), kind_of<Picture>()})
        spec.outputs.push_back({std::string(name_of(kind)), kind, "Gives one of these.", false, false});
    spec.inputs = {
        {"plain", kind_of<PointCloud>(), "Takes points.", false, false},
        {"some", kind_of<TriangleMesh>(), "Takes meshes.", true, false},
        {"maybe", kind_of<TetMesh>(), "Takes tets.", false, true},
        {"both", kind_of<TetMesh>(), "Takes tets.", true, true},
        {"either", kind_of<TriangleMesh>(), "Takes meshes or points.", false, false, {kind_of<PointCloud>()}}};
    spec.parameters = {parameter("flag", ParameterType::boolean, ParameterScalar(false)),
                       parameter("count", ParameterType::integer, ParameterScalar(std::int64_t(-9007199254740993))),
                       parameter("weight", ParameterType::number, ParameterScalar(0.1 + 0.2)),
                       parameter("rule", ParameterType::choice, ParameterScalar(std::string("b"))),
                       parameter("label", ParameterType::text, ParameterScalar(std::string("a \"b\" [c]"))),
                       parameter("file", ParameterType::path, ParameterScalar(std::string("/tmp/x"))),
                       parameter("alpha", ParameterType::length, ParameterScalar(Word{"auto"})),
                       parameter("bend", ParameterType::angle, ParameterScalar(Angle::degrees(40))),
                       parameter("share", ParameterType::ratio, ParameterScalar(Ratio::percent(5))),
                       parameter("axis", ParameterType::number, List{0.0, 0.0, 1.0}),
                       parameter("names", ParameterType::text, List{}),
                       parameter("max-error", ParameterType::length, std::monostate{})};
    spec.parameters[1].high = Bound{-0.5, false};
    spec.parameters[2].low = Bound{1e-300, true};
    spec.parameters[2].high = Bound{1, true};
    spec.parameters[3].choices = {{"a", "The first."}, {"b", "The second."}};
    spec.parameters[6].word = "auto";
    spec.parameters[6].low = Bound{0, false};
    spec.parameters[9].list = true;
    spec.parameters[9].size = 3;
    spec.parameters[10].list = true;
    spec.parameters[11].required = true;
    spec.parameters[6].takes_spacings = true;
    spec.parameters[2].unless_given = "alpha";
    using enum Unit;
    for (const Unit unit : {count, length, area, volume, angle, ratio, seconds, number, boolean})
        spec.metrics.push_back({"in-" + std::string(name_of(unit)), unit, "Measures something.", unit == ratio});
    return manifest;
}

/// The sentence of parse_manifest() after `spoil` changed the JSON.
template <class Spoil>
std::string refusal_after(Spoil&& spoil) {
    Json json = Json::parse(to_json_text(everything()));
    spoil(json);
    return sentence_of([&] { parse_manifest(json.dump()); });
}

TEST(Manifest, NumbersThatAreNoWholeOnesOrDoNotFit_AreRefused) {
    for (const Json& number : {Json(1e300), Json(1.5), Json(std::int64_t(1) << 40), Json(~std::uint64_t(0))}) {
        EXPECT_THAT(refusal_after([&](Json& json) { json["scanmill-manifest"] = number; }),
                    HasSubstr("'scanmill-manifest'"));
        EXPECT_THAT(refusal_after([&](Json& json) { json["version"] = number; }), HasSubstr("'version'"));
    }
    for (const Json& number : {Json(1e300), Json(-1)})
        EXPECT_THAT(refusal_after([&](Json& json) { json["parameters"][9]["size"] = number; }), HasSubstr("size'"));
}

TEST(Manifest, SpecThatUsesEverything_ReadsBackEqual) {
    const Manifest manifest = everything();
    ASSERT_NO_THROW(require_sound(manifest.spec)) << "the fixture's own soundness";
    EXPECT_EQ(parse_manifest(to_json_text(manifest)), manifest);
}

TEST(Manifest, EveryFieldThatDiffers_MakesAnotherText) {
    const std::string text = to_json_text(everything());
    const auto changed = [&](auto&& change) {
        Manifest manifest = everything();
        change(manifest.spec);
        return to_json_text(manifest) != text;
    };
    EXPECT_TRUE(changed([](FilterSpec& spec) { spec.version = 13; }));
    EXPECT_TRUE(changed([](FilterSpec& spec) { spec.source = "?"; }));
    EXPECT_TRUE(changed([](FilterSpec& spec) { spec.ties = "?"; }));
    EXPECT_TRUE(changed([](FilterSpec& spec) { spec.not_finite = "?"; }));
    EXPECT_TRUE(changed([](FilterSpec& spec) { spec.inputs[0].list = true; }));
    EXPECT_TRUE(changed([](FilterSpec& spec) { spec.inputs[0].optional = true; }));
    EXPECT_TRUE(changed([](FilterSpec& spec) { spec.inputs[0].also = {kind_of<TriangleMesh>()}; }));
    EXPECT_TRUE(changed([](FilterSpec& spec) { spec.parameters[2].low->inclusive = false; }));
    EXPECT_TRUE(changed([](FilterSpec& spec) { spec.parameters[9].size.reset(); }));
    EXPECT_TRUE(changed([](FilterSpec& spec) { spec.parameters[11].required = false; }));
    EXPECT_TRUE(changed([](FilterSpec& spec) { spec.parameters[6].takes_spacings = false; }));
    EXPECT_TRUE(changed([](FilterSpec& spec) { spec.parameters[2].unless_given = "count"; }));
    EXPECT_TRUE(changed([](FilterSpec& spec) { spec.metrics[0].headline = true; }));
    EXPECT_TRUE(changed([](FilterSpec& spec) { spec.metrics[0].numbered = true; }));
    EXPECT_TRUE(changed([](FilterSpec& spec) { spec.metrics[0].better = Better::smaller; }));
    EXPECT_TRUE(changed([](FilterSpec& spec) { spec.outputs[0].by_name = true; }));
    EXPECT_TRUE(changed([](FilterSpec& spec) { spec.measures = MeasureSpec{"mesh", "truth"}; }));
    EXPECT_TRUE(changed([](FilterSpec& spec) { spec.draws = DrawSpec{"plain"}; }));
    EXPECT_TRUE(changed([](FilterSpec& spec) { spec.simplifies.emplace(); }));
    EXPECT_TRUE(changed([](FilterSpec& spec) { spec.streams.emplace(); }));
    EXPECT_TRUE(changed([](FilterSpec& spec) { spec.adds.push_back("bin-size"); }));
    EXPECT_TRUE(changed([](FilterSpec& spec) { std::swap(spec.outputs[0], spec.outputs[1]); }));
}

TEST(Manifest, Stream_ReadsBackEqual) {
    Manifest manifest = everything();
    manifest.spec.inputs = {{"points", kind_of<PointCloud>(), "Takes points.", false, false}};
    for (const std::vector<std::string>& given : {std::vector<std::string>{}, {"alpha"}}) {
        manifest.spec.streams = StreamSpec{given};
        ASSERT_NO_THROW(require_sound(manifest.spec));
        EXPECT_EQ(parse_manifest(to_json_text(manifest)), manifest);
    }
    const std::string text = to_json_text(manifest);
    for (const Json& wrong : {Json(true), Json::object(), Json{{"given", "alpha"}}, Json{{"given", {1}}}}) {
        Json json = Json::parse(text);
        json["streams"] = wrong;
        EXPECT_THAT(sentence_of([&] { parse_manifest(json.dump()); }), StartsWith("is not a manifest")) << wrong;
    }
}

TEST(Manifest, DrawingFilter_ReadsBackEqual) {
    Manifest manifest = everything();
    manifest.spec.outputs = {{"picture", kind_of<Picture>(), "Shows the value.", false, false}};
    manifest.spec.draws = DrawSpec{"either"};
    ASSERT_NO_THROW(require_sound(manifest.spec));
    EXPECT_EQ(parse_manifest(to_json_text(manifest)), manifest);
}

TEST(Manifest, FilterForPreviews_ReadsBackEqual) {
    Manifest manifest = everything();
    std::swap(manifest.spec.outputs[0], manifest.spec.outputs[1]);
    manifest.spec.inputs[1].list = false;
    manifest.spec.adds = {"distance"};
    manifest.spec.parameters[1].low = manifest.spec.parameters[1].high = {};
    manifest.spec.parameters.push_back(parameter("largest", ParameterType::length, ParameterScalar(Length(1))));
    manifest.spec.measures = MeasureSpec{"plain", "some", manifest.spec.outputs[0].name, "distance"};
    manifest.spec.simplifies = SimplifySpec{"some", "count", "largest"};
    ASSERT_NO_THROW(require_sound(manifest.spec));
    EXPECT_EQ(parse_manifest(to_json_text(manifest)), manifest);
}

TEST(Manifest, Text_IsIndentedAndEndsTheLine) {
    const std::string text = to_json_text(everything());
    EXPECT_THAT(text, StartsWith("{\n  \"scanmill-manifest\": 1,\n"));
    EXPECT_EQ(text.back(), '\n');
}

TEST(Manifest, Garbage_IsRefused) {
    for (const std::string text : {"", "null", "[]", "7", "\"manifest\"", "{", "{}", "\xff\xfe", "not json at all"})
        EXPECT_THAT(sentence_of([&] { parse_manifest(text); }), StartsWith("is not a manifest: ")) << text;
}

TEST(Manifest, AnyTruncation_IsRefused) {
    const std::string text = to_json_text(everything());
    for (std::size_t size = 0; size + 2 < text.size(); size += 97)
        EXPECT_THROW(parse_manifest(std::string_view(text).substr(0, size)), Error) << size;
}

TEST(Manifest, AnotherVersion_IsRefusedWithBothNumbers) {
    EXPECT_EQ(refusal_after([](Json& json) { json["scanmill-manifest"] = 2; }),
              "is a manifest of version 2; this program reads version 1");
}

TEST(Manifest, MissingField_IsNamed) {
    for (const char* field : {"scanmill-manifest", "abi", "name", "version", "summary", "source", "ties", "not-finite",
                              "inputs", "outputs", "parameters", "metrics"})
        EXPECT_THAT(refusal_after([&](Json& json) { json.erase(field); }), HasSubstr(field));
    EXPECT_THAT(refusal_after([](Json& json) { json["parameters"][0].erase("help"); }), HasSubstr("help"));
    EXPECT_THAT(refusal_after([](Json& json) { json["parameters"][2]["low"].erase("inclusive"); }),
                HasSubstr("inclusive"));
}

TEST(Manifest, FieldOfAnotherType_IsRefused) {
    EXPECT_THAT(refusal_after([](Json& json) { json["version"] = "twelve"; }), StartsWith("is not a manifest: "));
    EXPECT_THAT(refusal_after([](Json& json) { json["inputs"] = {1, 2}; }), StartsWith("is not a manifest: "));
    EXPECT_THAT(refusal_after([](Json& json) { json["inputs"][0]["list"] = "yes"; }),
                StartsWith("is not a manifest: "));
    EXPECT_THAT(refusal_after([](Json& json) { json["parameters"][0]["default"] = 3; }),
                StartsWith("is not a manifest: "));
}

TEST(Manifest, UnknownNames_AreRefused) {
    EXPECT_THAT(refusal_after([](Json& json) { json["inputs"][0]["kind"] = "voxels"; }),
                AllOf(HasSubstr("'inputs[0].kind' is 'voxels'"), HasSubstr("points")));
    EXPECT_THAT(refusal_after([](Json& json) { json["parameters"][0]["type"] = "colour"; }),
                AllOf(HasSubstr("'parameters[0].type' is 'colour'"), HasSubstr("choice")));
    EXPECT_THAT(refusal_after([](Json& json) { json["metrics"][0]["unit"] = "mm"; }),
                AllOf(HasSubstr("'metrics[0].unit' is 'mm'"), HasSubstr("length")));
}

TEST(Manifest, UnknownMembers_AreRefusedWithTheirName) {
    EXPECT_THAT(refusal_after([](Json& json) { json["sumary"] = "Filters."; }),
                AllOf(HasSubstr("'sumary'"), HasSubstr("did you mean 'summary'")));
    EXPECT_THAT(refusal_after([](Json& json) { json["parameters"][3]["defaults"] = "b"; }),
                AllOf(HasSubstr("'parameters[3].defaults'"), HasSubstr("did you mean 'default'")));
    EXPECT_THAT(refusal_after([](Json& json) { json["inputs"][1]["lists"] = true; }), HasSubstr("'inputs[1].lists'"));
}

TEST(Manifest, DefaultOutsideItsRange_IsRefused) {
    EXPECT_EQ(refusal_after([](Json& json) { json["parameters"][2]["default"] = "7"; }),
              "7 is out of range; expected a number of at least 1e-300 and at most 1");
    EXPECT_EQ(refusal_after([](Json& json) { json["parameters"][0]["default"] = Json::array(); }),
              "is a list; expected true or false");
}

}  // namespace
}  // namespace scanmill::test
