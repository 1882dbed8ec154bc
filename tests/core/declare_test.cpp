// SPDX-License-Identifier: GPL-3.0-or-later
// From a params struct to a specification, and from values back to the struct.

#include "scanmill/filter/declare.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;

enum class Rule { nearest, random, densest };

/// One member of every type that a parameter can have.
struct AllParams {
    bool flag = true;
    int count = 3;
    u32 seeds = 8;
    std::int64_t big = std::int64_t(1) << 40;
    double weight = 0.25;
    std::string label = "part";
    std::filesystem::path file = "a/b.txt";
    Length size = Length::percent_of_diagonal(0.1);
    Angle bend = Angle::degrees(40);
    Ratio share = Ratio::percent(5);
    Rule rule = Rule::random;
    std::vector<double> axis{0, 0, 1};
    std::vector<Length> sizes{Length(1), Length::spacings(2)};
    std::vector<std::string> names;
    std::vector<bool> flags{true, false};
    std::vector<std::filesystem::path> files{"x"};
    std::optional<Length> alpha;
    std::optional<double> fairing = 0.5;
    std::optional<std::filesystem::path> log;
    std::optional<std::vector<int>> picks;
    Length max_error;
};

const char* const help = "As its name says.";

Declare<AllParams> declaration() {
    using P = AllParams;
    return Declare<P>("all-sorts", 7)
        .summary("Has a parameter of every type.")
        .source("Hand-made")
        .ties("There are none.")
        .not_finite(help)
        .in<PointCloud>("points", help)
        .in<TriangleMesh>("mesh", help, optional)
        .in<PointCloud>("others", help, list)
        .in<TetMesh>("tets", help, list, optional)
        .in<TriangleMesh, PointCloud>("truth", help)
        .out<TriangleMesh>("mesh", help)
        .out<Metrics>("numbers", help)
        .param("flag", &P::flag, help)
        .param("count", &P::count, help, at_least(1), at_most(9))
        .param("seeds", &P::seeds, help)
        .param("big", &P::big, help)
        .param("weight", &P::weight, help, above(0), below(1))
        .param("label", &P::label, help)
        .param("file", &P::file, help)
        .param("size", &P::size, help, above(0))
        .param("bend", &P::bend, help, at_most(180))
        .param("share", &P::share, help)
        .choice("rule", &P::rule,
                {{"nearest", Rule::nearest, "The nearest."},
                 {"random", Rule::random, "Any of them."},
                 {"densest", Rule::densest, "The densest."}},
                help)
        .param("axis", &P::axis, help, size(3))
        .param("sizes", &P::sizes, help)
        .param("names", &P::names, help)
        .param("flags", &P::flags, help)
        .param("files", &P::files, help)
        .param("alpha", &P::alpha, help, above(0), word("auto"))
        .param("fairing", &P::fairing, help)
        .param("log", &P::log, help)
        .param("picks", &P::picks, help)
        .param("max-error", &P::max_error, help, above(0), required)
        .metric("kept", Unit::count, help, headline, numbered)
        .metric("error", Unit::length, help);
}

const ParameterSpec& parameter(const FilterDeclaration& declared, std::string_view name) {
    return *declared.spec.parameter(name);
}

ParameterValue one(ParameterScalar value) { return value; }

/// The params that a run gets from these values.
AllParams params_from(std::vector<std::pair<std::string, ParameterValue>> values) {
    AllParams seen;
    const FilterDeclaration declared =
        declaration().run([&](const Inputs&, const AllParams& params, Context&) { return seen = params, Outputs(); });
    Context context;
    declared.run({}, {std::move(values)}, context);
    return seen;
}

TEST(Declare, Declaration_IsSound) { EXPECT_NO_THROW(require_sound(FilterDeclaration(declaration()).spec)); }

TEST(Declare, FilterAndItsPorts_AreAsDeclaredAndInOrder) {
    const FilterSpec spec = FilterDeclaration(declaration()).spec;
    EXPECT_EQ(spec.name, "all-sorts");
    EXPECT_EQ(spec.version, 7);
    EXPECT_EQ(spec.summary, "Has a parameter of every type.");
    EXPECT_EQ(spec.ties, "There are none.");
    EXPECT_EQ(spec.not_finite, help);
    EXPECT_EQ(spec.source, "Hand-made");
    EXPECT_THAT(spec.inputs, ElementsAre(PortSpec{"points", Kind::points, help, false, false},
                                         PortSpec{"mesh", Kind::mesh, help, false, true},
                                         PortSpec{"others", Kind::points, help, true, false},
                                         PortSpec{"tets", Kind::tets, help, true, true},
                                         PortSpec{"truth", Kind::mesh, help, false, false, {Kind::points}}));
    EXPECT_EQ(kinds_text(spec.inputs.back()), "mesh or points");
    EXPECT_TRUE(spec.inputs.back().takes(Kind::points));
    EXPECT_FALSE(spec.inputs.back().takes(Kind::tets));
    EXPECT_THAT(spec.outputs, ElementsAre(PortSpec{"mesh", Kind::mesh, help, false, false},
                                          PortSpec{"numbers", Kind::metrics, help, false, false}));
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

TEST(DeclareRun, NoValues_LeaveTheDefaults) {
    const AllParams params = params_from({});
    EXPECT_EQ(params.count, 3);
    EXPECT_EQ(params.rule, Rule::random);
    EXPECT_THAT(params.axis, ElementsAre(0, 0, 1));
    EXPECT_EQ(params.fairing, 0.5);
    EXPECT_EQ(params.alpha, std::nullopt);
}

TEST(DeclareRun, ValuesOfEveryType_ReachTheirMembers) {
    using List = std::vector<ParameterScalar>;
    const AllParams params = params_from({{"flag", one(false)},
                                          {"count", one(std::int64_t(-5))},
                                          {"seeds", one(std::int64_t(4294967295))},
                                          {"big", one(std::int64_t(-1) << 50)},
                                          {"weight", one(0.75)},
                                          {"label", one(std::string("x y"))},
                                          {"file", one(std::string("/c.txt"))},
                                          {"size", one(Length(0.5))},
                                          {"bend", one(Angle::radians(1))},
                                          {"share", one(Ratio::fraction(0.5))},
                                          {"rule", one(std::string("nearest"))},
                                          {"axis", List{1.0, 2.0, 3.0}},
                                          {"sizes", List{Length(9)}},
                                          {"names", List{std::string("a"), std::string("b")}},
                                          {"flags", List{false, true, true}},
                                          {"files", List{}},
                                          {"alpha", one(Length(2))},
                                          {"fairing", one(0.125)},
                                          {"log", one(std::string("log.txt"))},
                                          {"picks", List{std::int64_t(4), std::int64_t(2)}},
                                          {"max-error", one(Length(0.01))}});
    EXPECT_FALSE(params.flag);
    EXPECT_EQ(params.count, -5);
    EXPECT_EQ(params.seeds, 4294967295u);
    EXPECT_EQ(params.big, std::int64_t(-1) << 50);
    EXPECT_EQ(params.weight, 0.75);
    EXPECT_EQ(params.label, "x y");
    EXPECT_EQ(params.file, std::filesystem::path("/c.txt"));
    EXPECT_EQ(params.size, Length(0.5));
    EXPECT_EQ(params.bend, Angle::radians(1));
    EXPECT_EQ(params.share, Ratio::fraction(0.5));
    EXPECT_EQ(params.rule, Rule::nearest);
    EXPECT_THAT(params.axis, ElementsAre(1, 2, 3));
    EXPECT_THAT(params.sizes, ElementsAre(Length(9)));
    EXPECT_THAT(params.names, ElementsAre("a", "b"));
    EXPECT_THAT(params.flags, ElementsAre(false, true, true));
    EXPECT_TRUE(params.files.empty());
    EXPECT_EQ(params.alpha, Length(2));
    EXPECT_EQ(params.fairing, 0.125);
    EXPECT_EQ(params.log, std::filesystem::path("log.txt"));
    EXPECT_EQ(params.picks, (std::vector<int>{4, 2}));
    EXPECT_EQ(params.max_error, Length(0.01));
}

TEST(DeclareRun, WordOrNothing_IsTheEmptyOptional) {
    const AllParams params =
        params_from({{"alpha", one(Word{"auto"})}, {"fairing", std::monostate{}}, {"picks", std::monostate{}}});
    EXPECT_EQ(params.alpha, std::nullopt);
    EXPECT_EQ(params.fairing, std::nullopt) << "though the member's default is a value";
    EXPECT_EQ(params.picks, std::nullopt);
}

TEST(DeclareRun, NumberTooLargeForItsMember_IsRefusedAndNotWrapped) {
    EXPECT_EQ(sentence_of([] {
                  params_from({{"count", one(std::int64_t(1) << 32)}});
              }),
              "4294967296 is out of range; expected a whole number from -2147483648 to 2147483647");
    EXPECT_EQ(sentence_of([] {
                  params_from({{"seeds", one(std::int64_t(-1))}});
              }),
              "-1 is out of range; expected a whole number from 0 to 4294967295");
    EXPECT_THROW(params_from({{"picks", std::vector<ParameterScalar>{std::int64_t(1) << 40}}}), Error);
}

TEST(DeclareRun, EveryRun_BeginsFromTheDefaults) {
    std::vector<int> counts;
    const FilterDeclaration declared = declaration().run(
        [&](const Inputs&, const AllParams& params, Context&) { return counts.push_back(params.count), Outputs(); });
    Context context;
    declared.run({}, {{{"count", one(std::int64_t(9))}}}, context);
    declared.run({}, {}, context);
    EXPECT_THAT(counts, ElementsAre(9, 3));
}

TEST(DeclareRun, InputsAndContext_AreHandedThrough) {
    const FilterDeclaration declared = declaration().run([](const Inputs& inputs, const AllParams&, Context& context) {
        context.metric("others", static_cast<double>(inputs.list<PointCloud>("others").size()));
        EXPECT_EQ(inputs.find<TriangleMesh>("mesh"), nullptr);
        EXPECT_EQ(inputs.list<TetMesh>("tets").size(), 0u);
        PointCloud copy = inputs.get<PointCloud>("points");
        return Outputs().set("points", std::move(copy)).set("mesh", cube(2));
    });
    Inputs inputs;
    inputs.add("points", std::make_shared<const PointCloud>(cloud_of({{1, 2, 3}})));
    inputs.add("others", std::make_shared<const PointCloud>(cloud_of({{0, 0, 0}})));
    inputs.add("others", std::make_shared<const PointCloud>(cloud_of({{0, 0, 0}, {1, 1, 1}})));
    Context context;
    const Outputs outputs = declared.run(inputs, {}, context);
    EXPECT_EQ(context.metrics().find("others")->value, 2);
    ASSERT_TRUE(outputs.find("points"));
    EXPECT_EQ(std::get<std::shared_ptr<const PointCloud>>(*outputs.find("points"))->positions[0], Vec3(1, 2, 3));
    ASSERT_TRUE(outputs.find("mesh"));
    EXPECT_EQ(kind_of(*outputs.find("mesh")), Kind::mesh);
    EXPECT_EQ(outputs.find("rest"), nullptr);
}

TEST(Inputs, ListPort_KeepsTheOrderOfWiring) {
    Inputs inputs;
    const auto first = std::make_shared<const PointCloud>(cloud_of({{1, 0, 0}}));
    const auto second = std::make_shared<const PointCloud>(cloud_of({{2, 0, 0}}));
    inputs.add("points", second);
    inputs.add("points", first);
    EXPECT_THAT(inputs.list<PointCloud>("points"), ElementsAre(second, first));
    EXPECT_EQ(inputs.find<PointCloud>("points"), second.get());
    EXPECT_EQ(inputs.find<PointCloud>("others"), nullptr);
}

}  // namespace
}  // namespace scanmill::test
