// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>
#include <map>
#include <random>

#include "core/formats/support.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::size_t header_size = 80, facet_size = 50;

struct Facet {
    std::array<std::array<float, 3>, 3> corners;
    std::uint16_t attribute = 0;
};

std::string binary(const std::vector<Facet>& facets, std::string header = "") {
    header.resize(header_size, '\0');
    std::string file = header + bytes_of(static_cast<u32>(facets.size()));
    for (const Facet& facet : facets) {
        for (int i = 0; i < 3; ++i) file += bytes_of(7.0f);
        for (const auto& corner : facet.corners)
            for (float coordinate : corner) file += bytes_of(coordinate);
        file += bytes_of(facet.attribute);
    }
    return file;
}

const std::vector<Facet> two_facets{{{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}}, {{{{1, 0, 0}, {1, 1, 0}, {0, 1, 0}}}}};

/// The header that a written file of this frame has.
std::string stl_header(const Frame& frame) {
    TriangleMesh mesh = *mesh_in(binary(two_facets), "a.stl");
    mesh.frame = frame;
    return write_bytes("a.stl", std::make_shared<const TriangleMesh>(mesh)).substr(0, header_size);
}

TEST(StlReader_Binary, EqualCorners_BecomeOneVertex_NumberedByFirstAppearance) {
    const auto mesh = mesh_in(binary(two_facets), "a.stl");
    EXPECT_THAT(rows_of(mesh->positions), ElementsAre(Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(1, 1, 0)));
    EXPECT_THAT(rows_of(mesh->triangles), ElementsAre(Triangle{0, 1, 2}, Triangle{1, 3, 2}));
    EXPECT_TRUE(mesh->face_columns.empty());
}

TEST(StlReader_Binary, MinusZeroEqualsZero_NeighbouringFloatsDiffer) {
    const float next = std::nextafter(1.0f, 2.0f);
    const auto mesh = mesh_in(
        binary({{{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}}, {{{{-0.0f, 0, -0.0f}, {next, 0, 0}, {0, 1, 0}}}}}), "a.stl");
    EXPECT_THAT(rows_of(mesh->triangles), ElementsAre(Triangle{0, 1, 2}, Triangle{0, 3, 2}));
}

TEST(StlReader_Binary, BeginningWithSolid_IsStillBinaryWhenItsSizeSaysSo) {
    EXPECT_EQ(read_bytes(binary(two_facets, "solid but binary"), "a.stl").encoding, "binary");
    EXPECT_EQ(read_bytes(binary(two_facets, "solid"), "noname").format, "STL");
}

TEST(StlReader_Binary, TrailingBytes_AreReported_EvenBehindTheWordSolid) {
    Warnings warnings;
    EXPECT_EQ(mesh_in(binary(two_facets, "solid") + "xyz", "a.stl", &warnings)->triangles.size(), 2u);
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("3 bytes after the last facet")));
}

TEST(StlReader_Binary, AttributeBytes_AreAColumnWhenOneIsNotZero) {
    auto facets = two_facets;
    facets[1].attribute = 0x8421;
    EXPECT_THAT(numbers_of<std::uint16_t>(mesh_in(binary(facets), "a.stl")->face_columns.find("attribute")),
                ElementsAre(0, 0x8421));
}

TEST(StlReader_Binary, DegenerateFacets_AreKeptAndCounted) {
    Warnings warnings;
    auto facets = two_facets;
    facets.push_back({{{{0, 0, 0}, {1, 0, 0}, {0, 0, 0}}}});
    const auto mesh = mesh_in(binary(facets), "a.stl", &warnings);
    EXPECT_EQ(mesh->triangles[2], (Triangle{0, 1, 0}));
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("1 of 3 facets is degenerate")));

    // Facets with NaN are not counted: what checks coordinates reports them.
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    facets.push_back({{{{0, 0, 0}, {nan, 0, 0}, {0, 0, 0}}}});
    mesh_in(binary(facets), "a.stl", &warnings);
    EXPECT_THAT(warnings.sentences.back(), HasSubstr("1 of 4 facets is degenerate"));
}

TEST(StlReader_Binary, InvalidCoordinates_AreReadAsTheyAre) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    const auto mesh =
        mesh_in(binary({{{{{nan, 0, 0}, {1, 0, 0}, {0, std::numeric_limits<float>::infinity(), 0}}}}}), "a.stl");
    EXPECT_TRUE(std::isnan(mesh->positions[0].x()));
    EXPECT_TRUE(std::isinf(mesh->positions[2].y()));
}

const std::string ascii_facet =
    "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1e0 0 0\n  vertex 0 +1 0\n endloop\nendfacet\n";

TEST(StlReader_Ascii, SeveralSolids_AreNumberedInAFaceColumn) {
    const auto mesh = mesh_in(
        "solid facet one\n" + ascii_facet + "endsolid facet one\nSOLID\n" + ascii_facet + ascii_facet + "EndSolid\n",
        "a.stl");
    EXPECT_THAT(numbers_of<u32>(mesh->face_columns.find("solid")), ElementsAre(0u, 1u, 1u));
    EXPECT_EQ(mesh->positions.size(), 3u);
    EXPECT_TRUE(mesh_in("solid\n" + ascii_facet + "endsolid", "a.stl")->face_columns.empty());
}

TEST(StlReader_Ascii, KeywordsOnOneLine_AndNormalsThatAreNoNumbers_AreRead) {
    const auto mesh = mesh_in(
        "  solid x\nfacet normal -nan(ind) 1.#QNAN ? outer loop vertex 0 0 0 vertex 1 0 0 vertex 0.1 1 0 endloop "
        "endfacet\n"
        "facet outer loop\r\nvertex 0 0 0\r\nvertex 1 0 0\r\nvertex 0 1 5\r\nendloop\r\nendfacet\nendsolid x\n",
        "a.txt");
    EXPECT_EQ(mesh->triangles.size(), 2u);
    EXPECT_EQ(mesh->positions[2], Vec3(0.1, 1, 0));
}

TEST(StlReader_Frame, OwnHeader_GivesUnitAndName_ForeignText_DoesNot) {
    const auto mesh =
        mesh_in(binary(two_facets, stl_header({LengthUnit::millimetre, Vec3::Zero(), "arm; unit in"})), "a.stl");
    EXPECT_EQ(mesh->frame.unit, LengthUnit::millimetre);
    EXPECT_EQ(mesh->frame.name, "arm; unit in");
    EXPECT_EQ(mesh_in(binary(two_facets, stl_header({LengthUnit::unknown, Vec3::Zero(), "arm"})), "a.stl")->frame.name,
              "arm");
    EXPECT_EQ(mesh_in(binary(two_facets, "somebody's STL; unit mm"), "a.stl")->frame.unit, LengthUnit::unknown);
}

TEST(StlWriter_File, HasUnitNormalsFromDoublePositions_AndZeroForDegenerate) {
    const TemporaryFolder folder;
    TriangleMesh mesh;
    mesh.frame.origin = Vec3(1000000, 0, 0);
    mesh.positions = {Vec3(0, 0, 0), Vec3(0.01, 0, 0), Vec3(0, 0.01, 0), Vec3(0, 0, 1e-30)};
    mesh.triangles = {Triangle{0, 1, 2}, Triangle{0, 2, 1}, Triangle{0, 1, 1}, Triangle{0, 1, 3}};
    write_file(folder / "a.stl", std::make_shared<const TriangleMesh>(mesh));
    const std::string file = content_of(folder / "a.stl");
    ASSERT_EQ(file.size(), 84 + 4 * facet_size);
    EXPECT_FALSE(file.starts_with("solid"));
    const auto normal = [&](std::size_t facet) {
        std::array<float, 3> numbers;
        std::memcpy(numbers.data(), file.data() + 84 + facet * facet_size, sizeof numbers);
        return numbers;
    };
    EXPECT_THAT(normal(0), ElementsAre(0, 0, 1)) << "as floats, the world coordinates of this triangle are one point";
    EXPECT_THAT(normal(1), ElementsAre(0, 0, -1));
    EXPECT_THAT(normal(2), ElementsAre(0, 0, 0));
    EXPECT_THAT(normal(3), ElementsAre(0, -1, 0));
}

TEST(StlWriter_Losses, TrianglesThatCollapseInSinglePrecision_AreCounted) {
    const TemporaryFolder folder;
    Warnings warnings;
    TriangleMesh mesh;
    // Far below a millionth of the diagonal, the loss that is reported.
    mesh.positions = {Vec3(0, 0, 0), Vec3(1000, 0, 0), Vec3(0, 1000, 0), Vec3(1000 + 1e-5, 0, 0)};
    mesh.triangles = {Triangle{0, 1, 2}, Triangle{1, 3, 2}, Triangle{1, 1, 2}};
    write_file(folder / "a.stl", std::make_shared<const TriangleMesh>(mesh), warnings.writing());
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("1 triangle collapsed and was left out")));
}

TEST(StlWriter_Mesh, OfFloats_ComesBackTheSameWithItsFrame) {
    const TemporaryFolder folder;
    Warnings warnings;
    const auto mesh = mesh_in(binary(two_facets, stl_header({LengthUnit::inch, Vec3::Zero(), "plate"})), "a.stl");
    write_file(folder / "a.stl", mesh, warnings.writing());
    const auto back = read_mesh(folder / "a.stl");
    EXPECT_TRUE(std::ranges::equal(back->positions, mesh->positions));
    EXPECT_TRUE(std::ranges::equal(back->triangles, mesh->triangles));
    EXPECT_EQ(back->frame, mesh->frame);
    EXPECT_THAT(warnings.sentences, IsEmpty());
}

TEST(StlWriter_Losses, AreReportedOneByOne) {
    const TemporaryFolder folder;
    Warnings warnings;
    TriangleMesh mesh;
    mesh.frame = {LengthUnit::unknown, Vec3(1e6, 0, 0), std::string(100, 'n')};
    mesh.positions = {Vec3(0.01, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(5, 5, 5)};
    mesh.triangles = {Triangle{0, 1, 2}};
    mesh.vertex_columns.add(Column("weight", 1, Buffer<float>{1, 2, 3, 4}));
    mesh.face_columns.add(Column("part", 1, Buffer<u8>{1}));
    mesh.edges = {Edge{0, 1}};
    mesh.edge_columns.add(Column("bend", 1, Buffer<u8>{1}));
    mesh.sharp_edges = {Edge{0, 1}, Edge{0, 2}};
    write_file(folder / "a.stl", std::make_shared<const TriangleMesh>(mesh), warnings.writing());
    // The float nearest to 1000000.01 is 1000000: more than a hundredth of an edge is lost.
    EXPECT_THAT(warnings.sentences,
                ElementsAre(HasSubstr("1 vertex that no triangle uses"), HasSubstr("relative to 1000000 0 0"),
                            HasSubstr("1 column of the vertices (weight)"), HasSubstr("(part)"), HasSubstr("(bend)"),
                            HasSubstr("2 edges are sharp"), HasSubstr("frame's name of 100 bytes")));
}

TEST(StlWriter_Refuses, WhatStlCannotHold) {
    const TemporaryFolder folder;
    TriangleMesh mesh;
    mesh.positions = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1e39, 0)};
    EXPECT_THROW(write_file(folder / "a.stl", std::make_shared<const TriangleMesh>(mesh)), Error) << "no triangles";
    mesh.triangles = {Triangle{0, 1, 2}};
    EXPECT_THROW(write_file(folder / "a.stl", std::make_shared<const TriangleMesh>(mesh)), Error) << "beyond a float";
    EXPECT_EQ(folder.files(), 0u);
}

TEST(StlReader_RandomCorners, GiveTheVerticesOfAMap) {
    std::mt19937 random(3);
    const auto coordinate = [&](double scale) { return static_cast<double>(random() % 20) * scale; };
    std::map<std::array<double, 3>, u32> numbers;
    std::vector<Triangle> triangles;
    std::string text = "solid\n";
    for (int facet = 0; facet < 17000; ++facet) {
        text += "facet normal 0 0 1\nouter loop\n";
        for (u32& corner : triangles.emplace_back()) {
            const std::array<double, 3> p{coordinate(1), coordinate(1.0 / 3), coordinate(1e300)};
            corner = numbers.try_emplace(p, static_cast<u32>(numbers.size())).first->second;
            text += fmt::format("vertex {} {} {}\n", p[0], p[1], p[2]);
        }
        text += "endloop\nendfacet\n";
    }
    const auto mesh = mesh_in(text + "endsolid\n", "a.stl");
    EXPECT_EQ(rows_of(mesh->triangles), triangles);
    ASSERT_EQ(mesh->positions.size(), numbers.size());
    for (const auto& [p, number] : numbers)
        ASSERT_EQ(mesh->frame.origin + mesh->positions[number], Vec3(p[0], p[1], p[2]));
}

}  // namespace
}  // namespace scanmill::test
