// SPDX-License-Identifier: GPL-3.0-or-later
/// The columns of merged clouds: none is lost or changed without a warning.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "filters/merge/cases.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

template <class... Columns>
PointCloud two_points(Columns... columns) {
    PointCloud cloud = cloud_of({{0, 0, 0}, {1, 0, 0}});
    (cloud.columns.add(std::move(columns)), ...);
    return cloud;
}

std::vector<std::string> names(const ColumnTable& table) {
    std::vector<std::string> result;
    for (const Column& column : table) result.push_back(column.name());
    return result;
}

TEST(MergeColumns, OfEqualType_AreCarriedInOrder) {
    const PointCloud a = two_points(Column("b", 1, Buffer<u8>{1, 2}), Column("a", 2, Buffer<double>{1, 2, 3, 4}));
    const PointCloud b = two_points(Column("a", 2, Buffer<double>{5, 6, 7, 8}), Column("b", 1, Buffer<u8>{3, 4}));
    const Merged result = merged({a, b});
    EXPECT_THAT(names(result.points.columns), ElementsAre("b", "a", "source"));
    EXPECT_THAT(result.points.columns.find("b")->values<u8>(), ElementsAre(1, 2, 3, 4));
    EXPECT_THAT(result.points.columns.find("a")->values<double>(), ElementsAre(1, 2, 3, 4, 5, 6, 7, 8));
    EXPECT_THAT(result.warnings, IsEmpty());
}

TEST(MergeColumns, OfLengths_KeepTheirExponent) {
    const Column narrow = Column("size", 1, Buffer<float>{1, 2}).with_length_exponent(1);
    const Column wide = Column("size", 1, Buffer<double>{3, 4}).with_length_exponent(1);
    for (const Column& second : {narrow, wide})
        EXPECT_EQ(merged({two_points(narrow), two_points(second)}).points.columns.find("size")->length_exponent(), 1);
}

TEST(MergeColumns, OfDroppedPoints_AreDropped) {
    const PointCloud a = two_points(Column("b", 1, Buffer<u8>{1, 2}));
    PointCloud b = cloud_of({{1, 0, 0}, {5, 0, 0}});
    b.columns.add(Column("b", 1, Buffer<u8>{3, 4}));
    const Merged result = merged({a, b}, within(0.5));
    EXPECT_THAT(result.points.columns.find("b")->values<u8>(), ElementsAre(1, 2, 4));
    EXPECT_THAT(result.points.columns.find("source")->values<u32>(), ElementsAre(0u, 0u, 1u));
}

TEST(MergeColumns, OfWholeNumbersThatSomeInputLacks_IsLeftOutWithAWarning) {
    const PointCloud with = two_points(Column("intensity", 1, Buffer<u8>{1, 2})), without = two_points();
    const Merged result = merged({without, with, without});
    EXPECT_THAT(names(result.points.columns), ElementsAre("source"));
    EXPECT_THAT(result.warnings, ElementsAre("the column 'intensity' is left out: 2 of 3 inputs lack it"));
}

TEST(MergeColumns, OfFloatsThatSomeInputLacks_HasNaNThereWithAWarning) {
    const PointCloud with = two_points(Column("normal", 3, Buffer<float>{1, 2, 3, 4, 5, 6}).with_length_exponent(1));
    const Merged result = merged({two_points(), with});
    const Column& column = *result.points.columns.find("normal");
    EXPECT_EQ(column.length_exponent(), 1);
    const auto values = column.values<float>();
    for (std::size_t i = 0; i < 6; ++i) EXPECT_TRUE(std::isnan(values[i])) << i;
    EXPECT_THAT(values.subspan(6), ElementsAre(1, 2, 3, 4, 5, 6));
    EXPECT_THAT(result.warnings, ElementsAre("the column 'normal' has NaN for some points: 1 of 2 inputs lacks it"));
}

TEST(MergeColumns, OfDifferentFloatsThatTheFirstInputLacks_NamesTheInputsThatHaveIt) {
    const PointCloud single = two_points(Column("a", 1, Buffer<float>{1, 2}));
    const PointCloud precise = two_points(Column("a", 1, Buffer<double>{3, 4}));
    const Merged result = merged({two_points(), single, two_points(), precise});
    const auto values = result.points.columns.find("a")->values<double>();
    EXPECT_THAT(values,
                ElementsAre(testing::IsNan(), testing::IsNan(), 1, 2, testing::IsNan(), testing::IsNan(), 3, 4));
    EXPECT_THAT(result.warnings,
                ElementsAre("the column 'a' is carried as float64: it is float32 in input 1, float64 in input 3",
                            "the column 'a' has NaN for some points: 2 of 4 inputs lack it"));
}

TEST(MergeColumns, OfFloatsOfDifferentShapesThatSomeInputLacks_IsLeftOut) {
    const PointCloud one = two_points(Column("a", 1, Buffer<float>{1, 2}));
    const PointCloud two = two_points(Column("a", 2, Buffer<float>{1, 2, 3, 4}));
    EXPECT_THAT(names(merged({one, two, two_points()}).points.columns), ElementsAre("source"));
}

TEST(MergeColumns, DefaultUncertainty_FillsMissingColumnsAndNaN) {
    MergeParams params;
    params.default_uncertainty = Length(0.1);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const PointCloud with = with_uncertainty(two_points(), {nan, 3});
    const Merged result = merged({two_points(), with}, params);
    const Column& column = *result.points.columns.find("uncertainty");
    EXPECT_THAT(column.values<float>(), ElementsAre(0.1f, 0.1f, 0.1f, 3.0f));
    EXPECT_EQ(column.length_exponent(), 1);
    EXPECT_THAT(result.warnings, IsEmpty());
    EXPECT_THAT(merged({two_points()}, params).points.columns.find("uncertainty")->values<double>(),
                ElementsAre(0.1, 0.1));
}

TEST(MergeColumns, DefaultUncertainty_IsComparedAndTiesWithAnEqualNumber) {
    MergeParams params = within(0.5, MergeParams::Prefer::lower_uncertainty);
    params.default_uncertainty = Length(0.1);
    const auto source_beside = [&](float uncertainty) {
        const Merged result =
            merged({with_uncertainty(cloud_of({{0, 0, 0}}), {uncertainty}), cloud_of({{0, 0, 0}})}, params);
        return result.points.columns.find("source")->values<u32>()[0];
    };
    EXPECT_EQ(source_beside(0.05f), 0u);
    EXPECT_EQ(source_beside(0.1f), 0u) << "a tie: the earlier input";
    EXPECT_EQ(source_beside(0.2f), 1u);
}

TEST(MergeColumns, OfDifferentTypes_BecomeFloat64WithAWarning) {
    const PointCloud a = two_points(Column("x", 1, Buffer<u8>{1, 255}));
    const PointCloud b = two_points(Column("x", 1, Buffer<float>{0.5, -3}));
    const Merged result = merged({a, b});
    EXPECT_THAT(result.points.columns.find("x")->values<double>(), ElementsAre(1, 255, 0.5, -3));
    EXPECT_THAT(result.warnings,
                ElementsAre("the column 'x' is carried as float64: it is uint8 in input 0, float32 in input 1"));
}

TEST(MergeColumns, OfLargeIntegersAndFloats_AreRoundedWithAWarning) {
    const PointCloud a = two_points(Column("t", 1, Buffer<u64>{1, 2})),
                     b = two_points(Column("t", 1, Buffer<float>{1, 2}));
    EXPECT_THAT(merged({a, b}).warnings, ElementsAre(HasSubstr("beyond 2^53 are rounded")));
}

TEST(MergeColumns, OfDifferentShapes_AreLeftOutWithAWarning) {
    const PointCloud a = two_points(Column("colour", 3, Buffer<u8>{1, 2, 3, 4, 5, 6}));
    const PointCloud b = two_points(Column("colour", 4, Buffer<u8>{1, 2, 3, 4, 5, 6, 7, 8}));
    const Merged result = merged({a, a, b});
    EXPECT_THAT(names(result.points.columns), ElementsAre("source"));
    EXPECT_THAT(result.warnings,
                ElementsAre("the column 'colour' is left out: it is 3 x uint8 in input 0, 4 x uint8 in input 2"));
}

TEST(MergeColumns, Lists_AreCarriedWhenTheirTypesAgree) {
    const Column first("l", Buffer<u64>{0, 2, 2}, Buffer<u8>{1, 2}),
        second("l", Buffer<u64>{0, 1, 3}, Buffer<u8>{3, 4, 5});
    const Column joined = *merged({two_points(first), two_points(second)}).points.columns.find("l");
    EXPECT_THAT(joined.values<u8>(), ElementsAre(1, 2, 3, 4, 5));
    EXPECT_THAT(joined.offsets().span(), ElementsAre(0u, 2u, 2u, 3u, 5u));
    const Column other("l", Buffer<u64>{0, 1, 1}, Buffer<float>{1});
    EXPECT_THAT(merged({two_points(first), two_points(other)}).warnings,
                ElementsAre(AllOf(HasSubstr("'l' is left out"), HasSubstr("lists of float32 in input 1"))));
}

TEST(MergeColumns, ExistingSources_AreRenamed) {
    const PointCloud once = merged({two_points(), two_points()}).points;
    const Merged twice = merged({once, once});
    EXPECT_THAT(names(twice.points.columns), ElementsAre("source-of-source", "source"));
    EXPECT_THAT(twice.points.columns.find("source-of-source")->values<u32>(),
                ElementsAre(0u, 0u, 1u, 1u, 0u, 0u, 1u, 1u));
    EXPECT_THAT(twice.points.columns.find("source")->values<u32>(), ElementsAre(0u, 0u, 0u, 0u, 1u, 1u, 1u, 1u));
    EXPECT_THAT(twice.warnings, ElementsAre(HasSubstr("2 of 2 inputs already have a column 'source'")));
    EXPECT_THAT(names(merged({twice.points}).points.columns),
                ElementsAre("source-of-source-of-source", "source-of-source", "source"));
    EXPECT_THAT(names(merged({two_points(Column("sources", 1, Buffer<u8>{1, 2}))}).points.columns),
                ElementsAre("sources", "source"));
}

TEST(MergeColumns, IntegerNormals_BecomeFloat64WhenRotated) {
    const PointCloud cloud = two_points(Column("normal", 3, Buffer<std::int8_t>{1, 0, 0, 0, 0, 1}));
    EXPECT_EQ(merged({cloud}, posed({RigidTransform{}})).points.columns.find("normal")->type(), ScalarType::float64);
    EXPECT_EQ(merged({cloud}).points.columns.find("normal")->type(), ScalarType::int8);
}

}  // namespace
}  // namespace scanmill::test
