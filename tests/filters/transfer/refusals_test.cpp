// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <limits>

#include "filters/transfer/cases.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

PointCloud coloured() { return with(cloud_of({{0, 0, 0}, {1, 0, 0}}), column_of<u8>("colour", 3, {1, 2, 3, 4, 5, 6})); }

template <class From, class To>
std::string refusal(const From& from, const To& to, const TransferParams& params = {}) {
    const Error error = error_of([&] { carried(from, to, params); });
    EXPECT_FALSE(error.hint().empty()) << error.sentence();
    return error.sentence();
}

TEST(TransferRefusals, AMissingColumn_NamesThoseThatExist) {
    EXPECT_THAT(refusal(coloured(), coloured(), columns_within({"colours"}, 1)),
                AllOf(HasSubstr("'colours'"), HasSubstr("'colour'")));
    TriangleMesh mesh = cube();
    EXPECT_THAT(refusal(mesh, mesh, columns_within({"colour"}, 1)), HasSubstr("no columns"));
    mesh.face_columns.add(column_of<u8>("part", 1, std::vector<u8>(12, 0)));
    EXPECT_THAT(refusal(mesh, mesh, columns_within({"colour"}, 1)), HasSubstr("'part' (faces)"));
}

TEST(TransferRefusals, AnEmptyList_ARepeatedName_AndTheMark) {
    EXPECT_THAT(refusal(coloured(), coloured(), columns_within({}, 1)), HasSubstr("empty list"));
    EXPECT_THAT(refusal(coloured(), coloured(), columns_within({"colour", "colour"}, 1)), HasSubstr("twice"));
    const PointCloud marked = with(coloured(), column_of<u8>("transferred", 1, {1, 1}));
    EXPECT_THAT(refusal(marked, marked, columns_within({"transferred"}, 1)), HasSubstr("'transferred'"));
}

TEST(TransferRefusals, AColumnOfAnotherLength) {
    PointCloud from = coloured();
    from.columns = {};
    from.columns.add(column_of<u8>("colour", 3, {1, 2, 3}));
    EXPECT_THAT(refusal(from, coloured()), AllOf(HasSubstr("1 row"), HasSubstr("2 points")));
}

TEST(TransferRefusals, NoPoints_NoTriangles_NoVertices) {
    PointCloud none;
    none.columns.add(column_of<u8>("colour", 3, {}));
    EXPECT_THAT(refusal(none, coloured()), AllOf(HasSubstr("0 points"), HasSubstr("`from`")));
    EXPECT_THAT(refusal(coloured(), PointCloud{}), AllOf(HasSubstr("0 points"), HasSubstr("`to`")));
    EXPECT_THAT(refusal(coloured(), TriangleMesh{}), AllOf(HasSubstr("0 vertices"), HasSubstr("`to`")));
    TriangleMesh bare;
    bare.positions = {Vec3(0, 0, 0)};
    bare.vertex_columns.add(column_of<u8>("colour", 3, {1, 2, 3}));
    EXPECT_THAT(refusal(bare, coloured()), AllOf(HasSubstr("no triangles"), HasSubstr("`from`")));
}

TEST(TransferRefusals, MaxDistance) {
    for (const double distance : {0.0, -1.0, std::numeric_limits<double>::infinity()})
        EXPECT_THAT(refusal(coloured(), coloured(), columns_within({"colour"}, distance)), HasSubstr("max-distance"));
    const PointCloud same = with(cloud_of({{0, 0, 0}, {0, 0, 0}}), column_of<u8>("colour", 3, std::vector<u8>(6)));
    EXPECT_THAT(refusal(same, coloured()), HasSubstr("spacing of `from` is 0"));
}

TEST(TransferRefusals, NothingWithinTheDistance) {
    EXPECT_THAT(refusal(coloured(), cloud_of({{9, 0, 0}, {8, 0, 0}}), columns_within({"colour"}, 2)),
                AllOf(HasSubstr("2 rows"), HasSubstr("2 u")));
}

TEST(TransferRefusals, UnitsFramesAndNan) {
    PointCloud to = coloured();
    to.frame.unit = LengthUnit::millimetre;
    EXPECT_THAT(sentence_of([&] { carried(coloured(), to, {}); }), HasSubstr("mm"));
    PointCloud here = coloured(), there = coloured();
    here.frame.name = "here", there.frame.name = "there";
    EXPECT_THAT(sentence_of([&] { carried(here, there, {}); }), AllOf(HasSubstr("here"), HasSubstr("there")));
    const PointCloud broken = cloud_of({{0, 0, std::numeric_limits<double>::quiet_NaN()}});
    EXPECT_THAT(sentence_of([&] { carried(coloured(), broken, {}); }), HasSubstr("1"));
}

}  // namespace
}  // namespace scanmill::test
