// SPDX-License-Identifier: GPL-3.0-or-later
// Features as VTP and tetrahedra as VTU, as read by VTK.

#include <vtkTetra.h>

#include "formats/vtk_support.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// An open crease 0-1-2 that ends in the corner 2, and a closed hole 2-3-1; vertex 4 is in neither.
FeatureGraph crease_and_hole() {
    FeatureGraph graph;
    graph.frame = {LengthUnit::inch, Vec3(0, 0, 8), "part"};
    graph.positions = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(2, 0, 0), Vec3(3, 1, 0), Vec3(9, 9, 9)};
    graph.polylines = {{FeatureType::crease, false, 0, 3}, {FeatureType::hole, true, 3, 6}};
    graph.vertices = {0, 1, 2, 2, 3, 1};
    const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ(), none = Vec3::Zero();
    graph.left_normals = {x, y, none, z, z, x};
    graph.right_normals = {y, z, none, none, none, none};
    graph.corners = {2};
    return graph;
}

TEST(VtpFeatures, PolylinesAndCorners_AreCellsWithTheirTypes) {
    Warnings warnings;
    const auto data = through_vtp(crease_and_hole(), &warnings);
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("1 vertex outside all polylines and corners")));
    EXPECT_EQ(data->GetNumberOfPoints(), 7);
    EXPECT_THAT(cells_in(data->GetVerts()), ElementsAre(ElementsAre(6)));
    EXPECT_THAT(cells_in(data->GetLines()), ElementsAre(ElementsAre(0, 1, 2), ElementsAre(3, 4, 5, 3)));
    // In VTK, data of cells follow the order vertices, lines.
    EXPECT_THAT(numbers_in(data->GetCellData()->GetArray("type")), ElementsAre(3, 2, 1));
    EXPECT_THAT(numbers_in(data->GetCellData()->GetArray("closed")), ElementsAre(0, 0, 1));
    EXPECT_THAT(texts_in(data->GetFieldData(), "type_names"),
                ElementsAre("outer boundary", "hole", "crease", "corner"));
    EXPECT_THAT(texts_in(data->GetFieldData(), "unit"), ElementsAre("in"));
    EXPECT_THAT(texts_in(data->GetFieldData(), "frame"), ElementsAre("part"));
}

TEST(VtpFeatures, EveryPoint_HasItsVertexAndTheNormalsOnBothSides) {
    const auto data = through_vtp(crease_and_hole());
    vtkPointData* columns = data->GetPointData();
    EXPECT_THAT(numbers_in(columns->GetArray("vertex")), ElementsAre(0, 1, 2, 2, 3, 1, 2));
    EXPECT_EQ(point_in(data, 4), Vec3(3, 1, 8));
    EXPECT_EQ(point_in(data, 6), Vec3(2, 0, 8));
    EXPECT_THAT(numbers_in(columns->GetArray("left_normal")),
                ElementsAre(1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 0));
    EXPECT_THAT(numbers_in(columns->GetArray("right_normal")),
                ElementsAre(0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0));
}

TEST(VtpFeatures, CornersAlone_AreWritten) {
    FeatureGraph graph;
    graph.positions = {Vec3(1, 2, 3)};
    graph.corners = {0};
    const auto data = through_vtp(graph);
    EXPECT_EQ(data->GetNumberOfLines(), 0);
    EXPECT_THAT(cells_in(data->GetVerts()), ElementsAre(ElementsAre(0)));
}

TEST(VtpFeatures, WithoutALine_AreAFileWithoutAPoint) {
    const auto data = through_vtp(FeatureGraph());
    EXPECT_EQ(data->GetNumberOfPoints(), 0);
    EXPECT_EQ(data->GetNumberOfCells(), 0);
    EXPECT_EQ(texts_in(data->GetFieldData(), "type_names").size(), 4u);
}

TetMesh two_cells() {
    TetMesh tets;
    tets.frame = {LengthUnit::millimetre, Vec3(1e6, 0, 0), "rig"};
    tets.positions = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(0, 0, -2)};
    tets.vertex_columns.add(Column("weight", 1, Buffer<double>{1, 2, 3, 4, 5}));
    tets.cells = {{0, 1, 2, 3}, {0, 2, 1, 4}};
    tets.neighbours = {{TetMesh::outside_hull, TetMesh::outside_hull, TetMesh::outside_hull, 1},
                       {TetMesh::outside_hull, TetMesh::outside_hull, TetMesh::outside_hull, 0}};
    tets.inside = {1, 0};
    return tets;
}

TEST(VtuWriter, Cells_AreTetrahedraOfPositiveVolume_WithTheirLabel) {
    const auto grid = through_vtu(two_cells());
    ASSERT_EQ(grid->GetNumberOfCells(), 2);
    EXPECT_THAT(cells_in(grid->GetCells()), ElementsAre(ElementsAre(0, 1, 2, 3), ElementsAre(0, 2, 1, 4)));
    const double volumes[2] = {1.0 / 6, 2.0 / 6};
    for (vtkIdType cell = 0; cell < 2; ++cell) {
        EXPECT_EQ(grid->GetCellType(cell), VTK_TETRA);
        double corner[4][3];
        for (int i = 0; i < 4; ++i) grid->GetCell(cell)->GetPoints()->GetPoint(i, corner[i]);
        EXPECT_NEAR(vtkTetra::ComputeVolume(corner[0], corner[1], corner[2], corner[3]), volumes[cell], 1e-9);
    }
    EXPECT_THAT(numbers_in(grid->GetCellData()->GetArray("inside")), ElementsAre(1, 0));
    EXPECT_EQ(grid->GetCellData()->GetArray("inside")->GetDataType(), VTK_UNSIGNED_CHAR);
    EXPECT_THAT(numbers_in(grid->GetPointData()->GetArray("weight")), ElementsAre(1, 2, 3, 4, 5));
    EXPECT_EQ(point_in(grid, 4), Vec3(1e6, 0, -2));
    EXPECT_THAT(numbers_in(grid->GetFieldData()->GetArray("unit")), ElementsAre('m', 'm'));
    EXPECT_THAT(numbers_in(grid->GetFieldData()->GetArray("frame")), ElementsAre('r', 'i', 'g'));
    for (int i = 0; i < grid->GetFieldData()->GetNumberOfArrays(); ++i)
        EXPECT_TRUE(grid->GetFieldData()->GetArray(i)) << "no strings: meshio could not read the file";
}

TEST(VtuWriter, CellsWithoutLabel_HaveNone) {
    TetMesh tets = two_cells();
    tets.inside = {};
    EXPECT_EQ(through_vtu(tets)->GetCellData()->GetNumberOfArrays(), 0);
}

TEST(VtuWriter, Weights_ArePointData_BesideAColumnOfThatName) {
    TetMesh tets = two_cells();
    EXPECT_EQ(through_vtu(tets)->GetPointData()->GetNumberOfArrays(), 1);
    tets.weights = {0, 0.25, 1, 4, 9};
    EXPECT_THAT(numbers_in(through_vtu(tets)->GetPointData()->GetArray("weights")), ElementsAre(0, 0.25, 1, 4, 9));
    tets.vertex_columns.add(Column("weights", 1, Buffer<u8>{5, 4, 3, 2, 1}));
    const auto grid = through_vtu(tets);
    EXPECT_THAT(numbers_in(grid->GetPointData()->GetArray("weights")), ElementsAre(5, 4, 3, 2, 1));
    EXPECT_THAT(numbers_in(grid->GetPointData()->GetArray("weights-of-tets")), ElementsAre(0, 0.25, 1, 4, 9));
}

TEST(VtuReader_Refuses, ToRead_WithAMessage) {
    const std::string bytes = write_bytes("a.vtu", std::make_shared<const TetMesh>(two_cells()));
    EXPECT_EQ(bytes, write_bytes("b.vtu", std::make_shared<const TetMesh>(two_cells())));
    EXPECT_THAT(refusal_of(bytes, "a.txt"), HasSubstr("VTU is written for other programs, and not read"));
}

}  // namespace
}  // namespace scanmill::test
