// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <limits>

#include "core/formats/support.hpp"
#include "scanmill/formats/files.hpp"
#include "support/real_data.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
const std::string three_vertices = "element vertex 3\n" + xyz;
const std::string corners = "property list uchar int vertex_indices\n";

std::string ascii(const std::string& elements, const std::string& body) {
    return "ply\nformat ascii 1.0\n" + elements + "end_header\n" + body;
}

TEST(PlyReader_Ascii, NormalsAndColours_BecomeOneColumnEach_OthersKeepNameAndType) {
    const auto cloud = points_in(
        ascii("element vertex 2\nproperty uchar red\nproperty double x\nproperty double y\nproperty double z\n"
              "property float nz\nproperty float nx\nproperty float ny\nproperty uchar green\nproperty uchar blue\n"
              "property uchar alpha\nproperty ushort row\nproperty float64 weight\n",
              "10 1 2 3 0.5 0.25 0.125 20 30 40 65535 0.1\n11 4 5 6 -0.5 -0.25 -0.125 21 31 41 7 1e300\n"),
        "a.ply");
    EXPECT_EQ(cloud->positions[1], Vec3(4, 5, 6));
    EXPECT_EQ(cloud->columns.size(), 4u);
    EXPECT_THAT(numbers_of<float>(cloud->columns.find("normal")),
                ElementsAre(0.25f, 0.125f, 0.5f, -0.25f, -0.125f, -0.5f));
    EXPECT_THAT(numbers_of<u8>(cloud->columns.find("colour")), ElementsAre(10, 20, 30, 40, 11, 21, 31, 41));
    EXPECT_EQ(cloud->columns.find("colour")->components(), 4u);
    EXPECT_THAT(numbers_of<std::uint16_t>(cloud->columns.find("row")), ElementsAre(65535, 7));
    EXPECT_THAT(numbers_of<double>(cloud->columns.find("weight")), ElementsAre(0.1, 1e300));
}

TEST(PlyReader_Ascii, FloatColours_StayColumnsOfTheirOwn) {
    const auto cloud =
        points_in(ascii("element vertex 1\n" + xyz + "property float red\nproperty float green\nproperty float blue\n",
                        "0 0 0 0 0.5 1\n"),
                  "a.ply");
    EXPECT_EQ(cloud->columns.find("colour"), nullptr);
    EXPECT_THAT(numbers_of<float>(cloud->columns.find("green")), ElementsAre(0.5f));
}

TEST(PlyReader_Ascii, CoordinatesDeclaredFloat_KeepAllTheirDigits) {
    const auto cloud = points_in(ascii("element vertex 1\n" + xyz, "0.1 0.123456789012345 -0.2\n"), "a.ply");
    EXPECT_EQ(world_of(*cloud, 0), Vec3(0.1, 0.123456789012345, -0.2));
}

TEST(PlyReader_Ascii, Polygon_BecomesAFan_ItsColumnsRepeated) {
    Warnings warnings;
    const auto mesh =
        mesh_in(ascii("element vertex 5\n" + xyz + "element face 4\n" + corners + "property short part\n",
                      "0 0 0\n2 0 0\n3 1 0\n2 2 0\n0 2 0\n5 0 1 2 3 4 70\n3 0 1 2 71\n2 0 1 72\n4 4 3 2 1 73\n"),
                "a.ply", &warnings);
    EXPECT_THAT(rows_of(mesh->triangles), ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}, Triangle{0, 3, 4},
                                                      Triangle{0, 1, 2}, Triangle{4, 3, 2}, Triangle{4, 2, 1}));
    EXPECT_THAT(numbers_of<std::int16_t>(mesh->face_columns.find("part")), ElementsAre(70, 70, 70, 71, 73, 73));
    EXPECT_THAT(warnings.sentences,
                ElementsAre(HasSubstr("2 faces of more than three corners"), HasSubstr("1 face of fewer")));
}

TEST(PlyReader_Ascii, CarriageReturnsInHeaderAndBody_AreBlanks) {
    std::string text = ascii(three_vertices + "element face 1\n" + corners, right_triangle + "3 0 1 2\n");
    std::string dos, mac;
    for (char c : text) {
        dos += c == '\n' ? "\r\n" : std::string(1, c);
        mac += c == '\n' ? '\r' : c;
    }
    for (const std::string& variant : {dos, mac}) {
        const auto mesh = mesh_in(variant, "a.ply");
        EXPECT_EQ(mesh->positions[1], Vec3(1, 0, 0));
        EXPECT_THAT(rows_of(mesh->triangles), ElementsAre(Triangle{0, 1, 2}));
    }
}

TEST(PlyReader_Ascii, NumbersWrittenOddly_AreNumbers) {
    const auto cloud = points_in(ascii("element vertex 2\n" + xyz + "property int count\n",
                                       "\n  NaN\t+2.5e0 -INF 3.0\n\n nan(7) 1E-400 infinity +4"),
                                 "a.ply");
    EXPECT_TRUE(std::isnan(cloud->positions[0][0]));
    EXPECT_EQ(cloud->positions[0][1], 2.5);
    EXPECT_EQ(cloud->positions[0][2], -std::numeric_limits<double>::infinity());
    EXPECT_TRUE(std::isnan(cloud->positions[1][0]));
    EXPECT_EQ(cloud->positions[1][1], 0);
    EXPECT_EQ(cloud->positions[1][2], std::numeric_limits<double>::infinity());
    EXPECT_THAT(numbers_of<std::int32_t>(cloud->columns.find("count")), ElementsAre(3, 4));
}

TEST(PlyReader_Ascii, IntegerBeyondItsType_IsRefusedWithItsLine) {
    const std::string header = "element vertex 1\n" + xyz + "property char level\n";
    EXPECT_THAT(refusal_of(ascii(header, "0 0 0 128\n"), "a.ply"), HasSubstr("line 9: '128'"));
    EXPECT_THAT(refusal_of(ascii(header, "0 0 0 1.5\n"), "a.ply"), HasSubstr("line 9: '1.5'"));
    EXPECT_EQ(numbers_of<std::int8_t>(points_in(ascii(header, "0 0 0 -128\n"), "a.ply")->columns.find("level")).at(0),
              -128);
}

TEST(PlyReader_Ascii, UnsignedLimits_AreExact) {
    const std::string header = "element vertex 1\n" + xyz + "property uint64 id\nproperty int64 key\n";
    const auto cloud = points_in(ascii(header, "0 0 0 18446744073709551615 -9223372036854775808\n"), "a.ply");
    EXPECT_THAT(numbers_of<u64>(cloud->columns.find("id")), ElementsAre(~u64(0)));
    EXPECT_THAT(numbers_of<std::int64_t>(cloud->columns.find("key")),
                ElementsAre(std::numeric_limits<std::int64_t>::min()));
    EXPECT_THAT(refusal_of(ascii(header, "0 0 0 18446744073709551616 0\n"), "a.ply"),
                HasSubstr("'18446744073709551616'"));
}

TEST(PlyReader_Ascii, ValuesBehindTheLastProperty_ArePassedOverAndReported) {
    Warnings warnings;
    const auto mesh =
        mesh_in(ascii(three_vertices + "element face 1\n" + corners, "0 0 0 9\n1 0 0\n0 1 0 8 7\n3 0 1 2\n"), "a.ply",
                &warnings);
    EXPECT_THAT(rows_of(mesh->triangles), ElementsAre(Triangle{0, 1, 2}));
    EXPECT_THAT(warnings.sentences,
                ElementsAre(testing::AllOf(HasSubstr("2 rows of element 'vertex'"), HasSubstr("line 10"))));
}

TEST(PlyReader_Ascii, ListColumnOfVertices_BecomesAListColumn) {
    const auto cloud = points_in(
        ascii("element vertex 3\nproperty list int double near\n" + xyz, "2 0.5 1.5 0 0 0\n0 1 0 0\n1 -1 2 0 0\n"),
        "a.ply");
    const Column* near = cloud->columns.find("near");
    ASSERT_TRUE(near && near->is_list());
    EXPECT_THAT(rows_of(near->offsets()), ElementsAre(0u, 2u, 2u, 3u));
    EXPECT_THAT(numbers_of<double>(near), ElementsAre(0.5, 1.5, -1.0));
    EXPECT_EQ(cloud->positions[2], Vec3(2, 0, 0));
}

TEST(PlyReader_Ascii, RangeGridWithoutFaces_IsAPointCloudAndReported) {
    Warnings warnings;
    const auto cloud = points_in(ascii("obj_info num_cols 2\nelement vertex 1\n" + xyz +
                                           "element range_grid 3\nproperty list uchar int vertex_indices\n",
                                       "5 6 7\n0\n1 0\n0\n"),
                                 "a.ply", &warnings);
    EXPECT_EQ(world_of(*cloud, 0), Vec3(5, 6, 7));
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("'range_grid' with its 3 rows")));
}

/// A range image of 3 × 3 cells, the one in the corner without a point; `at` gives the points.
template <class At>
std::string range_image(At&& at, const std::string& columns = "3") {
    std::string points, cells;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) {
            const int number = 3 * row + column;
            if (number == 8) continue;
            const Vec3 p = at(column, row);
            points += fmt::format("{} {} {}\n", p.x(), p.y(), p.z());
            cells += fmt::format("1 {}\n", number);
        }
    return ascii("obj_info num_cols " + columns + "\nobj_info num_rows 3\nelement vertex 8\n" + xyz +
                     "element range_grid 9\nproperty list uchar int vertex_indices\n",
                 points + cells + "0\n");
}

TEST(PlyReader_RangeGrid, GivesTheDirectionToTheScanner) {
    // Seen along z, at the depths of a saddle; then the same turned, so that x becomes y, y becomes z and z becomes x.
    const auto saddle = [](int column, int row) { return Vec3(column, row, 0.3 * ((column - 1) * (row - 1) - row)); };
    Warnings warnings;
    const auto straight = points_in(range_image(saddle), "a.ply", &warnings);
    const Column* approach = straight->columns.find("approach");
    ASSERT_TRUE(approach && approach->components() == 3 && approach->rows() == 8);
    for (std::size_t i = 0; i < 8; ++i) {
        EXPECT_NEAR(approach->number(i, 0), 0, 1e-6);
        EXPECT_NEAR(approach->number(i, 1), 0, 1e-6);
        EXPECT_NEAR(approach->number(i, 2), 1, 1e-6);
    }
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("'approach' has the direction to the scanner")));
    const auto turned = points_in(range_image([&](int column, int row) {
                                      const Vec3 p = saddle(column, row);
                                      return Vec3(p.z(), p.x(), p.y());
                                  }),
                                  "a.ply");
    EXPECT_NEAR(turned->columns.find("approach")->number(0, 0), 1, 1e-6);
}

TEST(PlyReader_RangeGrid, OfAPlane_GivesItsNormal) {
    const auto plane =
        points_in(range_image([](int column, int row) { return Vec3(column, row, 0.5 * row); }), "a.ply");
    const Column* approach = plane->columns.find("approach");
    ASSERT_TRUE(approach);
    EXPECT_NEAR(approach->number(0, 1), -0.5 / std::sqrt(1.25), 0.6);
    EXPECT_GT(approach->number(0, 2), 0.5);
}

TEST(PlyReader_RangeGrid, WithoutUsableCells_IsLeftOut) {
    const auto flat = [](int column, int row) { return Vec3(column, row, 0); };
    for (const std::string columns : {"0", "1", "4", "-3", "x"}) {
        Warnings warnings;
        EXPECT_FALSE(points_in(range_image(flat, columns), "a.ply", &warnings)->columns.find("approach")) << columns;
        EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("'range_grid' with its 9 rows was left out"))) << columns;
    }
    std::string beyond = range_image(flat);
    beyond.replace(beyond.rfind("1 7"), 3, "1 8");
    EXPECT_FALSE(points_in(beyond, "a.ply")->columns.find("approach"));
    std::string two = range_image(flat);
    two.replace(two.rfind("1 7"), 3, "2 7 6");
    EXPECT_FALSE(points_in(two, "a.ply")->columns.find("approach"));
}

TEST(PlyReader_RangeGrid, OfARealScan_LooksAlongItsAxis) {
    SCANMILL_REAL_SCAN(path, shared_data, "1-bunny/raw/bun000.ply");
    const auto cloud = read_points(path);
    const Column* approach = cloud->columns.find("approach");
    ASSERT_TRUE(approach);
    EXPECT_GT(approach->number(0, 2), std::cos(0.35)) << "the Cyberware scanner looks along -z";
}

TEST(PlyReader_Edges, WithColumns_AreKeptSmallerVertexFirst) {
    const auto mesh =
        mesh_in(ascii(three_vertices +
                          "element edge 2\nproperty int vertex1\nproperty int vertex2\nproperty float bend\n"
                          "element face 1\n" +
                          corners,
                      right_triangle + "2 0 0.5\n1 2 0.25\n3 0 1 2\n"),
                "a.ply");
    EXPECT_THAT(rows_of(mesh->edges), ElementsAre(Edge{0, 2}, Edge{1, 2}));
    EXPECT_THAT(numbers_of<float>(mesh->edge_columns.find("bend")), ElementsAre(0.5f, 0.25f));
}

TEST(PlyReader_Edges, WithoutColumnsOrWithoutFaces_AreReported) {
    Warnings warnings;
    const std::string edges = "element edge 1\nproperty int vertex1\nproperty int vertex2\n";
    EXPECT_TRUE(mesh_in(ascii(three_vertices + edges + "element face 1\n" + corners, right_triangle + "0 1\n3 0 1 2\n"),
                        "a.ply", &warnings)
                    ->edges.empty());
    EXPECT_EQ(
        points_in(ascii(three_vertices + edges + "property int a\n", right_triangle + "0 1 5\n"), "a.ply", &warnings)
            ->size(),
        3u);
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("1 edge was left out"), HasSubstr("1 edge was left out")));
}

TEST(PlyReader_Strips, TurnEveryOtherTriangle_RestartAtMinusOne_SkipRepeats) {
    // Strip 0 1 2 3: (0 1 2)(2 1 3). Strip 4 3 2: one. Strip 0 0 1 2: the first names 0 twice, the second is an odd
    // one.
    const auto mesh =
        mesh_in(ascii("element vertex 5\n" + xyz + "element tristrips 1\nproperty list int int vertex_indices\n",
                      "0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 2 0\n12 0 1 2 3 -1 4 3 2 -1 0 0 1\n"),
                "a.ply");
    EXPECT_THAT(rows_of(mesh->triangles), ElementsAre(Triangle{0, 1, 2}, Triangle{2, 1, 3}, Triangle{4, 3, 2}));
}

TEST(PlyReader_Faces, OfAnyIndexType_AndEitherName) {
    for (const char* type : {"char", "uchar", "short", "ushort", "int", "uint", "int64", "uint64", "float", "double"})
        for (const char* name : {"vertex_indices", "vertex_index"}) {
            const std::string list = std::string("property list int ") + type + " " + name + "\n";
            const auto mesh =
                mesh_in(ascii(three_vertices + "element face 1\n" + list, right_triangle + "3 2 1 0\n"), "a.ply");
            EXPECT_THAT(rows_of(mesh->triangles), ElementsAre(Triangle{2, 1, 0})) << type << " " << name;
        }
    EXPECT_THAT(refusal_of(ascii(three_vertices + "element face 1\nproperty list int double vertex_index\n",
                                 right_triangle + "3 2 1 0.5\n"),
                           "a.ply"),
                HasSubstr("face 0 names vertex 0.5"));
}

TEST(PlyReader_Frame, CommentsGiveUnitAndName_OptionsOverrule) {
    const std::string text = ascii(
        "comment unit mm\ncomment frame part\ncomment united we stand\n" + ("element vertex 1\n" + xyz), "1 2 3\n");
    const auto cloud = points_in(text, "a.ply");
    EXPECT_EQ(cloud->frame.unit, LengthUnit::millimetre);
    EXPECT_EQ(cloud->frame.name, "part");
    const LoadedFile inches = read_bytes(text, "a.ply", {.on_warning = {}, .unit = LengthUnit::inch});
    EXPECT_EQ(frame_of(inches.value)->unit, LengthUnit::inch);
    EXPECT_THAT(inches.comments, ElementsAre("unit mm", "frame part", "united we stand"));
}

TEST(PlyReader_Frame, UnknownUnit_IsReported) {
    Warnings warnings;
    const auto cloud = points_in(ascii("comment unit cubit\nelement vertex 1\n" + xyz, "1 2 3\n"), "a.ply", &warnings);
    EXPECT_EQ(cloud->frame.unit, LengthUnit::unknown);
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("'cubit'")));
}

TEST(PlyReader_Frame, FarFromTheOrigin_MicrometresSurvive) {
    const auto cloud = points_in(ascii("element vertex 2\nproperty double x\nproperty double y\nproperty double z\n",
                                       "4320978.613457 0.000001 -98765432.100001\n4320978.613458 2 -98765432.1\n"),
                                 "a.ply");
    EXPECT_NE(cloud->frame.origin, Vec3(0, 0, 0));
    EXPECT_LT(cloud->positions[0].norm(), 4);
    EXPECT_EQ(world_of(*cloud, 0), Vec3(4320978.613457, 0.000001, -98765432.100001));
    EXPECT_EQ(world_of(*cloud, 1), Vec3(4320978.613458, 2, -98765432.1));
}

TEST(PlyReader_Errors, BeginWithTheFile) {
    EXPECT_THAT(refusal_of("ply\nformat ascii 1.0\nend_header\n", "some/where.ply"),
                testing::StartsWith("'some/where.ply': "));
}

TEST(PlyReader_Trailing, TextOrBytesBehindTheLastElement_AreReported) {
    Warnings warnings;
    points_in(ascii("element vertex 1\n" + xyz, "1 2 3\n4 5 6\n"), "a.ply", &warnings);
    const std::string header = "ply\nformat binary_little_endian 1.0\nelement vertex 1\n" + xyz + "end_header\n";
    points_in(header + std::string(12, '\0') + "\r\n", "a.ply", &warnings);
    points_in(header + std::string(15, '\0'), "a.ply", &warnings);
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("from line 9 on"), HasSubstr("3 bytes after")));
}

TEST(PlyReader_ListsOfFaces, ThatWereCut_AreDoubtfulAndReported) {
    Warnings warnings;
    mesh_in(
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n"
        "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3 8 0 0 1 0 1 1 0 1\n",
        "a.ply", &warnings);
    EXPECT_THAT(warnings.sentences, testing::ElementsAre(testing::HasSubstr("cut into fans"),
                                                         testing::HasSubstr("'texcoord' has a list for every face")));
}

}  // namespace
}  // namespace scanmill::test
