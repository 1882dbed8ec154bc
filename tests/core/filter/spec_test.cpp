// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/filter/spec.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

const char* const help = "Says what it is for.";

ParameterSpec number_parameter(const std::string& name) {
    ParameterSpec parameter;
    parameter.name = name;
    parameter.help = help;
    parameter.default_value = ParameterScalar(1.0);
    return parameter;
}

FilterSpec sound_spec() {
    FilterSpec spec;
    spec.name = "voxel-thin";
    spec.summary = "Keeps one point in every voxel.";
    spec.source = "Wang 2006";
    spec.ties = "The first of equals stays.";
    spec.not_finite = "Refused with their number.";
    spec.inputs = {{"points", kind_of<PointCloud>(), help, false, false}};
    spec.outputs = {{"points", kind_of<PointCloud>(), help, false, false},
                    {"rest", kind_of<PointCloud>(), help, false, false}};
    spec.parameters = {number_parameter("bin-size"), number_parameter("k2")};
    spec.metrics = {{"kept", Unit::count, help, true}};
    return spec;
}

/// The sentence of require_sound() for the sound spec after `spoil` changed it.
template <class Spoil>
std::string verdict(Spoil&& spoil) {
    FilterSpec spec = sound_spec();
    spoil(spec);
    return sentence_of([&] { require_sound(spec); });
}

TEST(RequireSound, SoundSpec_Passes) { EXPECT_NO_THROW(require_sound(sound_spec())); }

TEST(RequireSound, FilterName_IsLowerCaseWithHyphens) {
    for (const std::string name : {"", "Voxel", "voxel_thin", "voxel thin", "-thin", "thin-", "2d", "ä", "a/b", "a.b"})
        EXPECT_EQ(verdict([&](FilterSpec& spec) { spec.name = name; }),
                  "filter '" + name + "': the name is not lower-case-with-hyphens");
}

TEST(RequireSound, Summary_IsASentence) {
    for (const std::string summary : {"", "Thins", "Thins points", "Thinning.", "A b."})
        EXPECT_EQ(verdict([&](FilterSpec& spec) { spec.summary = summary; }),
                  "filter voxel-thin: the help of filter 'voxel-thin' is not a sentence: '" + summary + "'");
}

TEST(RequireSound, Version_IsAtLeastOne) {
    EXPECT_EQ(verdict([](FilterSpec& spec) { spec.version = 0; }), "filter voxel-thin: version 0 is below 1");
}

TEST(RequireSound, Source_IsNamed) {
    EXPECT_EQ(verdict([](FilterSpec& spec) { spec.source = ""; }), "filter voxel-thin: no source is named");
}

TEST(RequireSound, Outputs_AreNotNone) {
    EXPECT_EQ(verdict([](FilterSpec& spec) { spec.outputs.clear(); }), "filter voxel-thin: declares no output");
}

TEST(RequireSound, NamesOfEveryPart_AreLowerCaseWithHyphens) {
    EXPECT_EQ(verdict([](FilterSpec& spec) { spec.inputs[0].name = "Points"; }),
              "filter voxel-thin: input 'Points' is not lower-case-with-hyphens");
    EXPECT_EQ(verdict([](FilterSpec& spec) { spec.outputs[1].name = ""; }),
              "filter voxel-thin: output '' is not lower-case-with-hyphens");
    EXPECT_EQ(verdict([](FilterSpec& spec) { spec.parameters[0].name = "bin_size"; }),
              "filter voxel-thin: parameter 'bin_size' is not lower-case-with-hyphens");
    EXPECT_EQ(verdict([](FilterSpec& spec) { spec.metrics[0].name = "kept points"; }),
              "filter voxel-thin: metric 'kept points' is not lower-case-with-hyphens");
}

TEST(RequireSound, NamesOfEveryPart_AreUnique) {
    EXPECT_EQ(verdict([](FilterSpec& spec) { spec.inputs.push_back(spec.inputs[0]); }),
              "filter voxel-thin: input 'points' is declared twice");
    EXPECT_EQ(verdict([](FilterSpec& spec) { spec.outputs[1].name = "points"; }),
              "filter voxel-thin: output 'points' is declared twice");
    EXPECT_EQ(verdict([](FilterSpec& spec) { spec.parameters[1].name = "bin-size"; }),
              "filter voxel-thin: parameter 'bin-size' is declared twice");
    EXPECT_EQ(verdict([](FilterSpec& spec) { spec.metrics.push_back(spec.metrics[0]); }),
              "filter voxel-thin: metric 'kept' is declared twice");
}

TEST(RequireSound, InputAndOutputOfOneName_AreTwoThings) {
    EXPECT_NO_THROW(require_sound(sound_spec())) << "both are called points";
}

TEST(RequireSound, HelpOfEveryPart_IsASentence) {
    const std::string tail = " is not a sentence: 'size'";
    EXPECT_EQ(verdict([](FilterSpec& spec) { spec.inputs[0].help = "size"; }),
              "filter voxel-thin: the help of input 'points'" + tail);
    EXPECT_EQ(verdict([](FilterSpec& spec) { spec.outputs[0].help = "size"; }),
              "filter voxel-thin: the help of output 'points'" + tail);
    EXPECT_EQ(verdict([](FilterSpec& spec) { spec.parameters[0].help = "size"; }),
              "filter voxel-thin: the help of parameter 'bin-size'" + tail);
    EXPECT_EQ(verdict([](FilterSpec& spec) { spec.metrics[0].help = "size"; }),
              "filter voxel-thin: the help of metric 'kept'" + tail);
}

TEST(RequireSound, HelpThatOnlyRepeatsTheName_IsRefused) {
    EXPECT_EQ(verdict([](FilterSpec& spec) { spec.parameters[0].help = "Bin size."; }),
              "filter voxel-thin: the help of parameter 'bin-size' only repeats the name: 'Bin size.'");
    EXPECT_NO_THROW([] {
        FilterSpec spec = sound_spec();
        spec.parameters[0].help = "Bin size, in x.";
        require_sound(spec);
    }());
}

TEST(RequireSound, TiesAndNan_AreSpokenOfWhereTheyCanCome) {
    EXPECT_EQ(verdict([](FilterSpec& spec) { spec.ties = ""; }), "filter voxel-thin: the remark on ties is missing");
    EXPECT_EQ(verdict([](FilterSpec& spec) { spec.not_finite = ""; }),
              "filter voxel-thin: the remark on NaN is missing");
    EXPECT_EQ(verdict([](FilterSpec& spec) { spec.ties = "lowest"; }),
              "filter voxel-thin: the help of remark on 'ties' is not a sentence: 'lowest'");
    FilterSpec spec = sound_spec();
    spec.inputs.clear();
    spec.ties = spec.not_finite = "";
    EXPECT_NO_THROW(require_sound(spec));
    spec.inputs.push_back({"tets", kind_of<TetMesh>(), help, false, false});
    spec.ties = "The first of equals stays.";
    EXPECT_NO_THROW(require_sound(spec));
}

TEST(RequireSound, NumberOfNeighbours_SaysWhetherThePointItselfIsOne) {
    EXPECT_EQ(
        verdict([](FilterSpec& spec) {
            spec.parameters[0].name = "neighbours";
            spec.parameters[0].help = "How many points are looked at.";
        }),
        "filter voxel-thin: the help of parameter 'neighbours' does not state whether the point itself is counted: "
        "'How many points are looked at.'");
    EXPECT_NO_THROW([] {
        FilterSpec spec = sound_spec();
        spec.parameters[0].name = "neighbours";
        spec.parameters[0].help = "How many points are looked at, the point itself included.";
        require_sound(spec);
    }());
}

TEST(RequireSound, Choices_AreAtLeastTwoAndDiffer) {
    const auto with_choices = [](std::vector<Choice> choices) {
        return [choices](FilterSpec& spec) {
            spec.parameters[0].type = ParameterType::choice;
            spec.parameters[0].choices = choices;
            spec.parameters[0].default_value = std::monostate{};
        };
    };
    EXPECT_EQ(verdict(with_choices({{"only", help}})),
              "filter voxel-thin: parameter 'bin-size' has fewer than two choices");
    EXPECT_EQ(verdict(with_choices({{"one", help}, {"two", help}, {"one", help}})),
              "filter voxel-thin: parameter 'bin-size' has the choice 'one' twice");
}

TEST(RequireSound, Default_LiesInItsOwnRange) {
    EXPECT_EQ(verdict([](FilterSpec& spec) {
                  spec.parameters[0].low = Bound{1, false};
              }),
              "filter voxel-thin: the default of 'bin-size': 1 is out of range; expected a number above 1");
    EXPECT_EQ(verdict([](FilterSpec& spec) {
                  spec.parameters[0].default_value = ParameterScalar(std::numeric_limits<double>::infinity());
              }),
              "filter voxel-thin: the default of 'bin-size': 'inf' is not a number; expected a number");
    EXPECT_EQ(verdict([](FilterSpec& spec) {
                  spec.parameters[0].list = true;
                  spec.parameters[0].size = 3;
                  spec.parameters[0].default_value = std::vector<ParameterScalar>{1.0};
              }),
              "filter voxel-thin: the default of 'bin-size': has 1 value; expected a list of 3 values, each a number");
}

TEST(RequireSound, NoDefault_IsSound) {
    FilterSpec spec = sound_spec();
    spec.parameters[0].default_value = std::monostate{};
    spec.parameters[0].required = true;
    EXPECT_NO_THROW(require_sound(spec));
}

TEST(RequireSound, UnlessGiven_NamesAnotherParameter) {
    EXPECT_EQ(verdict([](FilterSpec& spec) { spec.parameters[0].unless_given = "size"; }),
              "filter voxel-thin: parameter 'bin-size' is used unless 'size' is given, which is not a parameter");
    FilterSpec spec = sound_spec();
    spec.parameters.push_back(number_parameter("size"));
    spec.parameters[0].unless_given = "size";
    EXPECT_NO_THROW(require_sound(spec));
}

TEST(RequireSound, TakesSpacings_IsForOneLength) {
    const std::string refusal = "filter voxel-thin: parameter 'bin-size' takes spacings, but is not a single length";
    EXPECT_EQ(verdict([](FilterSpec& spec) { spec.parameters[0].takes_spacings = true; }), refusal);
    const auto make_length = [](FilterSpec& spec) {
        spec.parameters[0].type = ParameterType::length;
        spec.parameters[0].default_value = ParameterScalar(Length(1));
        spec.parameters[0].takes_spacings = true;
    };
    FilterSpec spec = sound_spec();
    make_length(spec);
    EXPECT_NO_THROW(require_sound(spec));
    EXPECT_EQ(verdict([&](FilterSpec& list) {
                  make_length(list);
                  list.parameters[0].list = true;
              }),
              refusal);
}

TEST(RequireSound, Stream_IsOfOneCloudAndAsksForParametersThatMayLackAValue) {
    const auto add_stream = [](FilterSpec& spec, std::vector<std::string> given) {
        ParameterSpec optional = number_parameter("with-word"), empty = number_parameter("empty");
        optional.word = "auto";
        optional.default_value = ParameterScalar(Word{"auto"});
        empty.default_value = {};
        spec.parameters.insert(spec.parameters.end(), {optional, empty});
        spec.streams = StreamSpec{std::move(given)};
    };
    const auto with_stream = [&](std::vector<std::string> given, auto&& change) {
        return verdict([&](FilterSpec& spec) {
            add_stream(spec, given);
            change(spec);
        });
    };
    const auto nothing = [](FilterSpec&) {};
    for (const std::vector<std::string>& given : {std::vector<std::string>{}, {"with-word", "empty"}}) {
        FilterSpec spec = sound_spec();
        add_stream(spec, given);
        EXPECT_NO_THROW(require_sound(spec));
    }
    EXPECT_EQ(with_stream({"size"}, nothing), "filter voxel-thin: its stream needs 'size', which is not a parameter");
    EXPECT_EQ(with_stream({"k2"}, nothing), "filter voxel-thin: its stream needs 'k2', which always has a value");
    EXPECT_EQ(with_stream({"empty"}, [](FilterSpec& spec) { spec.parameters.back().required = true; }),
              "filter voxel-thin: its stream needs 'empty', which always has a value");
    const std::string other =
        "filter voxel-thin: cannot be streamed; its first input must be a cloud of points and its only required input";
    EXPECT_EQ(with_stream({}, [](FilterSpec& spec) { spec.inputs.clear(); }), other);
    EXPECT_EQ(with_stream({}, [](FilterSpec& spec) { spec.inputs.front().kind = kind_of<TriangleMesh>(); }), other);
    EXPECT_EQ(with_stream({}, [](FilterSpec& spec) { spec.inputs.front().list = true; }), other);
    EXPECT_EQ(with_stream({}, [](FilterSpec& spec) { spec.inputs.front().also = {kind_of<TriangleMesh>()}; }), other);
    EXPECT_EQ(with_stream({},
                          [](FilterSpec& spec) {
                              spec.inputs.push_back({"more", kind_of<PointCloud>(), help});
                          }),
              other);
    const PortSpec optional_port{.name = "more", .kind = kind_of<PointCloud>(), .help = help, .optional = true};
    EXPECT_EQ(with_stream({}, [&](FilterSpec& spec) { spec.inputs.insert(spec.inputs.begin(), optional_port); }), other)
        << "the required input is the second";
    EXPECT_EQ(with_stream({}, [&](FilterSpec& spec) { spec.inputs = {optional_port}; }), other);
    FilterSpec with_optional = sound_spec();
    add_stream(with_optional, {});
    with_optional.inputs.push_back(optional_port);
    EXPECT_NO_THROW(require_sound(with_optional));
}

TEST(FilterSpec, Parts_AreFoundByName) {
    const FilterSpec spec = sound_spec();
    EXPECT_EQ(spec.input("points"), &spec.inputs[0]);
    EXPECT_EQ(spec.output("rest"), &spec.outputs[1]);
    EXPECT_EQ(spec.parameter("k2"), &spec.parameters[1]);
    EXPECT_EQ(spec.metric("kept"), &spec.metrics[0]);
    EXPECT_EQ(spec.input("rest"), nullptr);
    EXPECT_EQ(spec.output("point"), nullptr);
    EXPECT_EQ(spec.parameter(""), nullptr);
    EXPECT_EQ(spec.metric("points"), nullptr);
}

}  // namespace
}  // namespace scanmill::test
