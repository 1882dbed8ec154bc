// SPDX-License-Identifier: GPL-3.0-or-later
// Patches as VTU, as read and interpolated by VTK.

#include <vtkCell.h>

#include "formats/vtk_support.hpp"
#include "scanmill/geometry/patches/a_patch.hpp"

namespace scanmill::test {
namespace {

TEST(VtuPatches, TheFieldThatVtkInterpolates_IsThePatchesFunction) {
    PatchComplex patches;
    patches.frame = {LengthUnit::millimetre, Vec3(0, 0, 8), "part"};
    patches.positions = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0.2, 0.3, 1), Vec3(0.1, 0.2, -1)};
    patches.tets = {std::array<u32, 4>{0, 1, 2, 3}, std::array<u32, 4>{0, 1, 2, 4}, std::array<u32, 4>{3, 1, 2, 0}};
    PatchWeights one, other;
    for (std::size_t i = 0; i < one.size(); ++i) {
        one[i] = static_cast<double>(i * i % 7) - 3;
        other[i] = static_cast<double>(i * i * i % 11) - 5;
    }
    patches.weights = {one, other, other};
    patches.kinds = {PatchKind::face, PatchKind::edge, PatchKind::continuation};
    patches.sides = {1, 0, 1};
    patches.triangles = {0, 4, 0};
    patches.edges = {PatchComplex::no_edge, 7, 7};
    patches.combine = {Combine::min, Combine::none, Combine::min};
    patches.partners = {2, PatchComplex::no_partner, 0};

    const TemporaryFolder folder;
    write_file(folder / "a.vtu", std::make_shared<const PatchComplex>(patches));
    const auto data = read_by_vtk<vtkXMLUnstructuredGridReader, vtkUnstructuredGrid>(folder / "a.vtu");
    ASSERT_EQ(data->GetNumberOfCells(), 3);
    EXPECT_EQ(data->GetNumberOfPoints(), 60);
    vtkDataArray* weights = data->GetPointData()->GetArray("weights");
    ASSERT_TRUE(weights);
    for (vtkIdType tet = 0; tet < 3; ++tet) {
        vtkCell* cell = data->GetCell(tet);
        EXPECT_EQ(cell->GetCellType(), VTK_BEZIER_TETRAHEDRON);
        const PatchCell ours(patches, static_cast<std::size_t>(tet));
        const double places[][3]{{0.25, 0.25, 0.25}, {0.13, 0.27, 0.41}, {0.7, 0.1, 0.05}};
        for (const auto& place : places) {
            int part = 0;
            double point[3], shares[20], field = 0;
            cell->EvaluateLocation(part, place, point, shares);
            for (vtkIdType i = 0; i < 20; ++i)
                field += shares[i] * weights->GetComponent(cell->GetPointId(static_cast<int>(i)), 0);
            EXPECT_NEAR(field, ours.value(Vec3(point[0], point[1], point[2] - 8)), 1e-12);
        }
    }
    EXPECT_EQ(data->GetCellData()->GetArray("patch")->GetComponent(1, 0), 4);
    EXPECT_EQ(data->GetCellData()->GetArray("side")->GetComponent(0, 0), 1);
    EXPECT_EQ(data->GetCellData()->GetArray("kind")->GetComponent(1, 0), 1);
    EXPECT_EQ(data->GetCellData()->GetArray("edge")->GetComponent(0, 0), -1);
    EXPECT_EQ(data->GetCellData()->GetArray("edge")->GetComponent(1, 0), 7);
    EXPECT_EQ(data->GetCellData()->GetArray("combine")->GetComponent(0, 0), 2);
    EXPECT_EQ(data->GetCellData()->GetArray("partner")->GetComponent(0, 0), 2);
    EXPECT_EQ(data->GetCellData()->GetArray("partner")->GetComponent(1, 0), -1);
}

}  // namespace
}  // namespace scanmill::test
