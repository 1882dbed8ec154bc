// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/filter/inputs.hpp"

#include <gmock/gmock.h>

#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(FilterInputs, PointsThatAreNoneOrTooMany_AreRefused) {
    const Error none = error_of([] { require_points(PointCloud(), "thinning needs at least 1"); });
    EXPECT_THAT(none.sentence(), HasSubstr("0 points; thinning needs at least 1"));
    EXPECT_FALSE(none.hint().empty());
    const Error many = error_of([] { require_points(std::size_t(1) << 32, "thinning needs at least 1"); });
    EXPECT_THAT(many.sentence(), HasSubstr("4294967296 points; at most 4294967295"));
    EXPECT_FALSE(many.hint().empty());
    EXPECT_NO_THROW(require_points((std::size_t(1) << 32) - 1, ""));
    PointCloud cloud;
    cloud.positions = Array<Vec3>{Vec3(0, 0, std::nan(""))};
    EXPECT_THAT(sentence_of([&] { require_points(cloud, ""); }), HasSubstr("1 of 1"));
}

TEST(FilterInputs, AMeshWithoutTriangles_OrWithAnInvalidIndex_IsRefused) {
    TriangleMesh mesh;
    const Error none = error_of([&] { require_triangles(mesh, "repair needs at least one"); });
    EXPECT_THAT(none.sentence(), HasSubstr("no triangles; repair needs at least one"));
    EXPECT_FALSE(none.hint().empty());
    mesh.positions = Array<Vec3>(3, Vec3::Zero());
    mesh.triangles = Array<Triangle>{{0, 1, 3}};
    EXPECT_THAT(sentence_of([&] { require_triangles(mesh, ""); }), HasSubstr("3"));
    mesh.triangles = Array<Triangle>{{0, 1, 2}};
    EXPECT_NO_THROW(require_triangles(mesh, ""));
}

TEST(FilterInputs, AColumnReplacesAnOlderOneOfItsName_WithAWarning) {
    Context context;
    ColumnTable columns;
    columns.add(Column("a", 1, Buffer<u8>{1, 2}));
    columns.add(Column("b", 1, Buffer<u8>{3, 4}));
    add_column(columns, Column("c", 1, Buffer<u8>{5, 6}), context);
    EXPECT_TRUE(context.warnings().empty());
    add_column(columns, Column("a", 1, Buffer<float>{7, 8}), context);
    EXPECT_THAT(context.warnings(), ElementsAre(HasSubstr("'a' of the input is replaced")));
    ASSERT_EQ(columns.size(), 3u);
    EXPECT_EQ(columns.begin()->name(), "b");
    EXPECT_THAT(columns.find("a")->values<float>(), ElementsAre(7, 8));
}

TEST(FilterInputs, DroppedColumns_AreNamed) {
    Context context;
    ColumnTable columns;
    warn_of_dropped(columns, "face columns", "the triangles are new", context);
    EXPECT_TRUE(context.warnings().empty());
    columns.add(Column("a", 1, Buffer<u8>{1}));
    columns.add(Column("b", 1, Buffer<u8>{1}));
    warn_of_dropped(columns, "face columns", "the triangles are new", context);
    EXPECT_THAT(context.warnings(), ElementsAre(HasSubstr("the triangles are new: 'a', 'b'")));
}

}  // namespace
}  // namespace scanmill::test
