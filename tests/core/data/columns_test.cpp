// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/columns.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;

template <class T>
void expect_type(ScalarType type, std::string_view name) {
    EXPECT_EQ(scalar_type_of<T>(), type);
    EXPECT_EQ(size_of(type), sizeof(T));
    EXPECT_EQ(name_of(type), name);
    visit_scalar(type, [&](auto zero) { EXPECT_TRUE((std::is_same_v<decltype(zero), T>)) << name; });
}

TEST(ScalarType, EveryType_HasItsNameItsSizeAndItsCppType) {
    expect_type<std::int8_t>(ScalarType::int8, "int8");
    expect_type<std::uint8_t>(ScalarType::uint8, "uint8");
    expect_type<std::int16_t>(ScalarType::int16, "int16");
    expect_type<std::uint16_t>(ScalarType::uint16, "uint16");
    expect_type<std::int32_t>(ScalarType::int32, "int32");
    expect_type<std::uint32_t>(ScalarType::uint32, "uint32");
    expect_type<std::int64_t>(ScalarType::int64, "int64");
    expect_type<std::uint64_t>(ScalarType::uint64, "uint64");
    expect_type<float>(ScalarType::float32, "float32");
    expect_type<double>(ScalarType::float64, "float64");
}

/// Rows {1, 2}, {3, 4}, {5, 6}.
Column pairs() { return Column("pair", 2, Buffer<float>{1, 2, 3, 4, 5, 6}); }

/// Rows {}, {10}, {20, 21, 22}, {}.
Column lists() { return Column("list", Buffer<u64>{0, 0, 1, 4, 4}, Buffer<std::int16_t>{10, 20, 21, 22}); }

TEST(Column, Rows_AreValuesByComponents) {
    EXPECT_EQ(pairs().rows(), 3u);
    EXPECT_EQ(pairs().components(), 2u);
    EXPECT_EQ(pairs().type(), ScalarType::float32);
    EXPECT_FALSE(pairs().is_list());
    EXPECT_EQ(pairs().number(2, 0), 5);
    EXPECT_EQ(pairs().number(2, 1), 6);
    EXPECT_EQ(pairs().number(1), 3);
}

TEST(Column, Lists_HaveARowPerOffsetPair) {
    EXPECT_TRUE(lists().is_list());
    EXPECT_EQ(lists().rows(), 4u);
    EXPECT_THAT(lists().values<std::int16_t>(), ElementsAre(10, 20, 21, 22));
}

TEST(Column, NoValues_AreNoRows) { EXPECT_EQ(Column("x", 3, Buffer<double>()).rows(), 0u); }

TEST(Column, NumbersOfEveryType_ConvertToDouble) {
    EXPECT_EQ(Column("x", 1, Buffer<std::uint8_t>{255}).number(0), 255);
    EXPECT_EQ(Column("x", 1, Buffer<std::int8_t>{-128}).number(0), -128);
    EXPECT_EQ(Column("x", 1, Buffer<std::int64_t>{-(std::int64_t(1) << 53)}).number(0), -0x1p53);
    EXPECT_EQ(Column("x", 1, Buffer<float>{0.1f}).number(0), static_cast<double>(0.1f));
    EXPECT_EQ(Column("x", 1, Buffer<double>{0.1}).number(0), 0.1);
}

TEST(ColumnGather, RowsInAnyOrderAndRepeated_CarryAllComponents) {
    const std::vector<u32> rows{2, 0, 2};
    const Column picked = pairs().gather(rows);
    EXPECT_EQ(picked, Column("pair", 2, Buffer<float>{5, 6, 1, 2, 5, 6}));
}

TEST(ColumnGather, Lists_CarryWholeListsWithNewOffsets) {
    const std::vector<u32> rows{2, 0, 1, 2, 3};
    const Column picked = lists().gather(rows);
    EXPECT_EQ(picked, Column("list", Buffer<u64>{0, 3, 3, 4, 7, 7}, Buffer<std::int16_t>{20, 21, 22, 10, 20, 21, 22}));
}

TEST(ColumnGather, NoRows_KeepNameTypeAndShape) {
    EXPECT_EQ(pairs().gather({}), Column("pair", 2, Buffer<float>()));
    EXPECT_EQ(lists().gather({}), Column("list", Buffer<u64>{0}, Buffer<std::int16_t>()));
}

TEST(Column, Equality_KnowsNameTypeShapeAndValues) {
    const Column column("x", 1, Buffer<std::int32_t>{1, 2});
    EXPECT_EQ(column, Column("x", 1, Buffer<std::int32_t>{1, 2}));
    EXPECT_NE(column, Column("y", 1, Buffer<std::int32_t>{1, 2}));
    EXPECT_NE(column, Column("x", 2, Buffer<std::int32_t>{1, 2}));
    EXPECT_NE(column, Column("x", 1, Buffer<std::uint32_t>{1, 2}));
    EXPECT_NE(column, Column("x", 1, Buffer<std::int32_t>{1, 3}));
    EXPECT_NE(Column("x", Buffer<u64>{0, 1, 2}, Buffer<u8>{5, 6}), Column("x", Buffer<u64>{0, 2, 2}, Buffer<u8>{5, 6}));
}

TEST(Column, Renamed_IsTheSameButForTheName) {
    const Column column = lists();
    const Column other = column.renamed("other");
    EXPECT_EQ(other.name(), "other");
    EXPECT_EQ(other.bytes().data(), column.bytes().data()) << "the memory is shared";
    EXPECT_EQ(other.renamed("list"), column);
}

TEST(ColumnTable, Columns_KeepTheirOrderAndAreFoundByName) {
    ColumnTable table;
    table.add(Column("zebra", 1, Buffer<u8>{1, 2}));
    table.add(Column("ape", 3, Buffer<float>{0, 0, 0, 1, 1, 1}));
    EXPECT_EQ(table.size(), 2u);
    EXPECT_EQ(table.begin()->name(), "zebra");
    ASSERT_TRUE(table.find("ape"));
    EXPECT_EQ(table.find("ape")->components(), 3u);
    EXPECT_EQ(table.find("Ape"), nullptr);
}

TEST(ColumnTable, NameThatIsTaken_IsRefusedAndChangesNothing) {
    ColumnTable table;
    table.add(Column("weight", 1, Buffer<u8>{1, 2}));
    EXPECT_EQ(sentence_of([&] {
                  table.add(Column("weight", 1, Buffer<u8>{3, 4}));
              }),
              "two columns are called 'weight'; names must differ");
    EXPECT_EQ(table.size(), 1u);
    EXPECT_EQ(table.find("weight")->number(0), 1);
}

TEST(ColumnTable, OtherNumberOfRows_IsRefusedWithBothNumbers) {
    ColumnTable table;
    table.add(Column("weight", 1, Buffer<u8>{1, 2}));
    EXPECT_EQ(sentence_of([&] {
                  table.add(Column("normal", 3, Buffer<float>{0, 0, 1}));
              }),
              "column 'normal' has 1 row, the others have 2");
    EXPECT_EQ(table.size(), 1u);
}

TEST(ColumnTable, Gather_PicksTheSameRowsOfEveryColumn) {
    ColumnTable table;
    table.add(Column("id", 1, Buffer<u32>{7, 8, 9, 10}));
    table.add(lists());
    const std::vector<u32> rows{3, 1};
    ColumnTable expected;
    expected.add(Column("id", 1, Buffer<u32>{10, 8}));
    expected.add(Column("list", Buffer<u64>{0, 0, 1}, Buffer<std::int16_t>{10}));
    EXPECT_EQ(table.gather(rows), expected);
}

}  // namespace
}  // namespace scanmill::test
