// SPDX-License-Identifier: GPL-3.0-or-later
// From values to the params struct, and the other arguments of a run.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/filter/declared_params.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;

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
    EXPECT_EQ(outputs.find("points")->get<PointCloud>()->positions[0], Vec3(1, 2, 3));
    ASSERT_TRUE(outputs.find("mesh"));
    EXPECT_EQ(kind_of(*outputs.find("mesh")), kind_of<TriangleMesh>());
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
