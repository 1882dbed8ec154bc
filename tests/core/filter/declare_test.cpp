// SPDX-License-Identifier: GPL-3.0-or-later
// From a params struct to a specification.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/filter/declared_params.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;

TEST(Declare, Declaration_IsSound) { EXPECT_NO_THROW(require_sound(FilterDeclaration(declaration()).spec)); }

TEST(Declare, FilterAndItsPorts_AreAsDeclaredAndInOrder) {
    const FilterSpec spec = FilterDeclaration(declaration()).spec;
    EXPECT_EQ(spec.name, "all-sorts");
    EXPECT_EQ(spec.version, 7);
    EXPECT_EQ(spec.summary, "Has a parameter of every type.");
    EXPECT_EQ(spec.ties, "There are none.");
    EXPECT_EQ(spec.not_finite, help);
    EXPECT_EQ(spec.source, "Hand-made");
    EXPECT_THAT(spec.inputs,
                ElementsAre(PortSpec{"points", kind_of<PointCloud>(), help, false, false},
                            PortSpec{"mesh", kind_of<TriangleMesh>(), help, false, true},
                            PortSpec{"others", kind_of<PointCloud>(), help, true, false},
                            PortSpec{"tets", kind_of<TetMesh>(), help, true, true},
                            PortSpec{"truth", kind_of<TriangleMesh>(), help, false, false, {kind_of<PointCloud>()}}));
    EXPECT_EQ(kinds_text(spec.inputs.back()), "mesh or points");
    EXPECT_TRUE(spec.inputs.back().takes(kind_of<PointCloud>()));
    EXPECT_FALSE(spec.inputs.back().takes(kind_of<TetMesh>()));
    EXPECT_THAT(spec.outputs, ElementsAre(PortSpec{"mesh", kind_of<TriangleMesh>(), help, false, false},
                                          PortSpec{"numbers", kind_of<Metrics>(), help, false, false}));
    EXPECT_THAT(spec.metrics, ElementsAre(MetricSpec{"kept", Unit::count, help, true, true},
                                          MetricSpec{"error", Unit::length, help, false}));
}

TEST(Declare, NumberedMetric_IsKnownByItsNumber) {
    const FilterSpec spec = FilterDeclaration(declaration()).spec;
    EXPECT_EQ(spec.metric("kept@2"), spec.metric("kept"));
    EXPECT_EQ(spec.metric("kept@10"), spec.metric("kept"));
    for (const char* other : {"kep@2", "kept@", "kept@1", "kept@02", "kept@two", "error@2", "@2"})
        EXPECT_EQ(spec.metric(other), nullptr) << other;
}

TEST(Declare, PortOfSeveralKinds_GivesWhatIsThere) {
    Inputs inputs;
    inputs.add("truth", std::make_shared<const PointCloud>());
    EXPECT_NE(inputs.find<PointCloud>("truth"), nullptr);
    EXPECT_EQ(inputs.find<TriangleMesh>("truth"), nullptr);
}

TEST(Declare, TypesAndDefaults_ComeFromTheMembers) {
    const FilterDeclaration declared = declaration();
    using enum ParameterType;
    const auto expect = [&](std::string_view name, ParameterType type, bool is_list, const ParameterValue& value) {
        EXPECT_EQ(parameter(declared, name).type, type) << name;
        EXPECT_EQ(parameter(declared, name).list, is_list) << name;
        EXPECT_EQ(parameter(declared, name).default_value, value) << name;
        EXPECT_EQ(parameter(declared, name).help, help) << name;
    };
    using List = std::vector<ParameterScalar>;
    expect("flag", boolean, false, one(true));
    expect("count", integer, false, one(std::int64_t(3)));
    expect("seeds", integer, false, one(std::int64_t(8)));
    expect("big", integer, false, one(std::int64_t(1) << 40));
    expect("weight", number, false, one(0.25));
    expect("label", text, false, one(std::string("part")));
    expect("file", path, false, one(std::string("a/b.txt")));
    expect("size", length, false, one(Length::percent_of_diagonal(0.1)));
    expect("bend", angle, false, one(Angle::degrees(40)));
    expect("share", ratio, false, one(Ratio::percent(5)));
    expect("rule", choice, false, one(std::string("random")));
    expect("axis", number, true, List{0.0, 0.0, 1.0});
    expect("sizes", length, true, List{Length(1), Length::spacings(2)});
    expect("names", text, true, List{});
    expect("flags", boolean, true, List{true, false});
    expect("files", path, true, List{std::string("x")});
    expect("alpha", length, false, one(Word{"auto"}));
    expect("fairing", number, false, one(0.5));
    expect("log", path, false, std::monostate{});
    expect("picks", integer, true, std::monostate{});
    expect("max-error", length, false, std::monostate{});
}

TEST(Declare, Constraints_AreRecorded) {
    const FilterDeclaration declared = declaration();
    EXPECT_EQ(parameter(declared, "count").low, (Bound{1, true}));
    EXPECT_EQ(parameter(declared, "count").high, (Bound{9, true}));
    EXPECT_EQ(parameter(declared, "weight").low, (Bound{0, false}));
    EXPECT_EQ(parameter(declared, "weight").high, (Bound{1, false}));
    EXPECT_FALSE(parameter(declared, "bend").low);
    EXPECT_EQ(parameter(declared, "axis").size, 3u);
    EXPECT_FALSE(parameter(declared, "sizes").size);
    EXPECT_EQ(parameter(declared, "alpha").word, "auto");
    EXPECT_EQ(parameter(declared, "size").word, "");
    EXPECT_TRUE(parameter(declared, "max-error").required);
    EXPECT_FALSE(parameter(declared, "alpha").required);
    EXPECT_THAT(parameter(declared, "rule").choices,
                ElementsAre(Choice{"nearest", "The nearest."}, Choice{"random", "Any of them."},
                            Choice{"densest", "The densest."}));
}

struct ViewParams {
    std::vector<Rule> rules{Rule::random, Rule::densest};
    std::size_t pixels = 640;
};

Declare<ViewParams> drawing_declaration() {
    using P = ViewParams;
    return Declare<P>("draw", 1)
        .summary("Draws a value.")
        .source("Hand-made")
        .ties("There are none.")
        .not_finite(help)
        .in<TriangleMesh, PointCloud>("scene", help)
        .in<TriangleMesh>("more", help, optional)
        .in<PointCloud>("others", help, list)
        .out<Picture>("picture", help)
        .out<TriangleMesh>("mesh", help)
        .choices("rules", &P::rules,
                 {{"nearest", Rule::nearest, "The nearest."},
                  {"random", Rule::random, "Any of them."},
                  {"densest", Rule::densest, "The densest."}},
                 help)
        .draws("scene");
}

TEST(Declare, ListOfChoices_HasItsChoicesAndDefaults) {
    const FilterDeclaration declared = drawing_declaration();
    const ParameterSpec& rules = parameter(declared, "rules");
    using List = std::vector<ParameterScalar>;
    EXPECT_EQ(rules.type, ParameterType::choice);
    EXPECT_TRUE(rules.list);
    EXPECT_EQ(rules.default_value, ParameterValue(List{std::string("random"), std::string("densest")}));
    EXPECT_THAT(rules.choices, ElementsAre(Choice{"nearest", "The nearest."}, Choice{"random", "Any of them."},
                                           Choice{"densest", "The densest."}));
    EXPECT_NO_THROW(require_sound(declared.spec));
    EXPECT_EQ(parse(rules, {{"densest", "nearest"}, true}),
              ParameterValue(List{std::string("densest"), std::string("nearest")}));
    EXPECT_THAT(sentence_of([&] { parse(rules, {{"densest", "near"}, true}); }), testing::HasSubstr("'near'"));
}

TEST(Declare, Doubts_AreClauses) {
    const FilterDeclaration declared =
        drawing_declaration().doubts({"the picture is empty"}).run([](const Inputs&, const ViewParams&, Context&) {
            return Outputs();
        });
    FilterSpec spec = declared.spec;
    EXPECT_THAT(spec.doubts, ElementsAre("the picture is empty"));
    EXPECT_NO_THROW(require_sound(spec));
    for (const char* wrong : {"", "The picture is empty."}) {
        spec.doubts = {wrong};
        EXPECT_THAT(sentence_of([&] { require_sound(spec); }), testing::HasSubstr("not a clause")) << wrong;
    }
}

TEST(Declare, ListOfChoices_ReachesItsMember) {
    std::vector<Rule> seen;
    const FilterDeclaration declared =
        drawing_declaration().run([&](const Inputs&, const ViewParams& params, Context&) -> Outputs {
            seen = params.rules;
            return {};
        });
    Context context;
    declared.run({}, {}, context);
    EXPECT_THAT(seen, ElementsAre(Rule::random, Rule::densest)) << "the defaults";
    using List = std::vector<ParameterScalar>;
    const List three{std::string("densest"), std::string("nearest"), std::string("densest")};
    declared.run({}, {{{"rules", three}}}, context);
    EXPECT_THAT(seen, ElementsAre(Rule::densest, Rule::nearest, Rule::densest));
    declared.run({}, {{{"rules", List{}}}}, context);
    EXPECT_THAT(seen, ElementsAre());
}

TEST(Declare, DrawnInput_IsInTheSpecification) {
    const FilterSpec spec = FilterDeclaration(drawing_declaration()).spec;
    EXPECT_EQ(spec.draws, DrawSpec{"scene"});
    EXPECT_FALSE(FilterDeclaration(declaration()).spec.draws);
}

TEST(Declare, DrawnInputThatIsMissingOptionalOrAList_IsUnsound) {
    for (const char* input : {"scen", "more", "others"}) {
        FilterSpec spec = FilterDeclaration(drawing_declaration()).spec;
        spec.draws = DrawSpec{input};
        EXPECT_THAT(sentence_of([&] { require_sound(spec); }), testing::HasSubstr("a required input of one value"))
            << input;
    }
}

TEST(Declare, DrawingFilterWhoseFirstOutputIsNotAPicture_IsUnsound) {
    FilterSpec spec = FilterDeclaration(drawing_declaration()).spec;
    std::swap(spec.outputs[0], spec.outputs[1]);
    EXPECT_THAT(sentence_of([&] { require_sound(spec); }), testing::HasSubstr("first output must be a picture"));
}

struct SmallPictureParams {
    std::vector<u32> size{80, 60};
    std::optional<std::string> colour;
    std::optional<std::vector<Length>> scale;
    u64 triangles = 0;
    Length max_error = Length::percent_of_diagonal(1);
};

/// A filter that draws, measures and simplifies.
FilterSpec spec_for_previews() {
    using P = SmallPictureParams;
    return FilterDeclaration(Declare<P>("all-in-one", 1)
                                 .summary("Draws, measures and simplifies.")
                                 .source("Hand-made")
                                 .ties("There are none.")
                                 .not_finite(help)
                                 .in<TriangleMesh>("mesh", help)
                                 .in<TriangleMesh, PointCloud>("camera", help, optional)
                                 .in<TriangleMesh>("truth", help)
                                 .out<Picture>("picture", help)
                                 .out<TriangleMesh>("deviation", help)
                                 .adds({"distance"})
                                 .param("size", &P::size, help, size(2))
                                 .param("colour", &P::colour, help, word("none"))
                                 .param("scale", &P::scale, help, word("auto"), size(2))
                                 .param("triangles", &P::triangles, help)
                                 .param("max-error", &P::max_error, help)
                                 .draws(DrawSpec{"mesh", "camera", "size", "colour", "scale"})
                                 .measures(MeasureSpec{"mesh", "truth", "deviation", "distance"}))
        .spec;
}

TEST(Declare, PartsForPreviews_AreInTheSpecification) {
    FilterSpec spec = spec_for_previews();
    EXPECT_NO_THROW(require_sound(spec));
    EXPECT_EQ(spec.draws->camera, "camera");
    EXPECT_EQ(spec.measures->column, "distance");
    std::swap(spec.outputs[0], spec.outputs[1]);
    spec.draws.reset();
    spec.simplifies = SimplifySpec{"mesh", "triangles", "max-error"};
    EXPECT_NO_THROW(require_sound(spec));
}

TEST(Declare, DrawingFilterWithoutItsCameraOrParameters_IsUnsound) {
    const auto refusal = [](std::string DrawSpec::*member, const std::string& name) {
        FilterSpec spec = spec_for_previews();
        (*spec.draws).*member = name;
        return sentence_of([&] { require_sound(spec); });
    };
    for (const char* camera : {"kamera", "mesh"})
        EXPECT_THAT(refusal(&DrawSpec::camera, camera), testing::HasSubstr("must be an optional input of one value"));
    EXPECT_THAT(refusal(&DrawSpec::size, "triangles"), testing::HasSubstr("2 values of type integer"));
    EXPECT_THAT(refusal(&DrawSpec::colour, "size"), testing::HasSubstr("a value of type text"));
    EXPECT_THAT(refusal(&DrawSpec::scale, "none"), testing::HasSubstr("2 values of type length"));
}

TEST(Declare, DeviationThatIsNoMeshOrHasNoColumn_IsUnsound) {
    FilterSpec spec = spec_for_previews();
    spec.measures->deviation = "picture";
    EXPECT_THAT(sentence_of([&] { require_sound(spec); }), testing::HasSubstr("'picture', which must be an output"));
    spec = spec_for_previews();
    spec.measures->column = "length";
    EXPECT_THAT(sentence_of([&] { require_sound(spec); }), testing::HasSubstr("column 'length'"));
}

TEST(Declare, SimplifyingFilterWithoutItsInputParametersOrMesh_IsUnsound) {
    const auto refusal = [](const SimplifySpec& simplifies) {
        FilterSpec spec = spec_for_previews();
        std::swap(spec.outputs[0], spec.outputs[1]);
        spec.draws.reset();
        spec.simplifies = simplifies;
        return sentence_of([&] { require_sound(spec); });
    };
    EXPECT_THAT(refusal({"camera", "triangles", "max-error"}), testing::HasSubstr("a required input of one mesh"));
    EXPECT_THAT(refusal({"mesh", "max-error", "max-error"}), testing::HasSubstr("a value of type integer"));
    EXPECT_THAT(refusal({"mesh", "triangles", "size"}), testing::HasSubstr("a value of type length"));
    EXPECT_THAT(refusal({"mesh", "", "max-error"}), testing::HasSubstr("does not name the parameters"));
    FilterSpec spec = spec_for_previews();
    spec.draws.reset();
    spec.simplifies = SimplifySpec{"mesh", "triangles", "max-error"};
    EXPECT_THAT(sentence_of([&] { require_sound(spec); }), testing::HasSubstr("first output must be a mesh"));
}

FilterSpec spec_of_inspection() {
    using P = SmallPictureParams;
    return FilterDeclaration(Declare<P>("gauge", 1)
                                 .summary("Compares a part with its nominal.")
                                 .source("Hand-made")
                                 .ties("There are none.")
                                 .not_finite(help)
                                 .in<PointCloud>("part", help)
                                 .in<TriangleMesh>("nominal", help)
                                 .out<TriangleMesh>("map", help)
                                 .adds({"deviation"})
                                 .metric("low", Unit::length, help)
                                 .metric("high", Unit::length, help)
                                 .metric("share", Unit::ratio, help, numbered)
                                 .inspects({.part = "part",
                                            .nominal = "nominal",
                                            .outputs = {"map"},
                                            .column = "deviation",
                                            .tolerance = {"low", "high"},
                                            .range = {"low", "high"},
                                            .histogram = "share",
                                            .label = {"share", "share", "share", "share"},
                                            .numbers = {"share"}}))
        .spec;
}

TEST(Declare, InspectionWithoutItsPortsColumnOrMetrics_IsUnsound) {
    EXPECT_NO_THROW(require_sound(spec_of_inspection()));
    const auto refusal = [](auto&& change) {
        FilterSpec spec = spec_of_inspection();
        change(*spec.inspects);
        return sentence_of([&] { require_sound(spec); });
    };
    using testing::HasSubstr;
    EXPECT_THAT(refusal([](InspectSpec& spec) { spec.nominal = "model"; }),
                HasSubstr("'model', which must be a required input"));
    EXPECT_THAT(refusal([](InspectSpec& spec) { spec.outputs = {"part"}; }), HasSubstr("'part', which must be an output"));
    EXPECT_THAT(refusal([](InspectSpec& spec) { spec.column = "class"; }), HasSubstr("a column that the filter adds"));
    EXPECT_THAT(refusal([](InspectSpec& spec) { spec.histogram = "low"; }), HasSubstr("'low', which must be a numbered"));
    EXPECT_THAT(refusal([](InspectSpec& spec) { spec.range = {"low", "share"}; }), HasSubstr("'share', which must be a"));
    EXPECT_THAT(refusal([](InspectSpec& spec) { spec.tolerance = {"low"}; }), HasSubstr("with 1 limits"));
}

}  // namespace
}  // namespace scanmill::test
