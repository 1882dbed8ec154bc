// SPDX-License-Identifier: GPL-3.0-or-later
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkFieldData.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include <numeric>

#include "scanmill/base/error.hpp"
#include "scanmill/formats/common/writing.hpp"
#include "vtk/vtk_arrays.hpp"
#include "vtu/vtu.hpp"

namespace scanmill::vtk {

namespace {

/// The exponents of the weights in VTK's order. The order is: corners, two points on each of the edges 01, 12, 20, 03,
/// 13, 23, middles of the faces 013, 123, 203, 021.
constexpr std::array<std::array<int, 4>, 20> exponents{
    {{3, 0, 0, 0}, {0, 3, 0, 0}, {0, 0, 3, 0}, {0, 0, 0, 3}, {2, 1, 0, 0}, {1, 2, 0, 0}, {0, 2, 1, 0},
     {0, 1, 2, 0}, {1, 0, 2, 0}, {2, 0, 1, 0}, {2, 0, 0, 1}, {1, 0, 0, 2}, {0, 2, 0, 1}, {0, 1, 0, 2},
     {0, 0, 2, 1}, {0, 0, 1, 2}, {1, 1, 0, 1}, {0, 1, 1, 1}, {1, 0, 1, 1}, {1, 1, 1, 0}}};

/// The number of a weight in PatchWeights.
constexpr std::size_t number_of(const std::array<int, 4>& e) {
    std::size_t number = 0;
    for (int i = 3; i >= 0; --i)
        for (int j = 3 - i; j >= 0; --j)
            for (int k = 3 - i - j; k >= 0; --k, ++number)
                if (i == e[0] && j == e[1] && k == e[2]) return number;
    return number;
}

}  // namespace

void write_vtu_patches(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    const PatchComplex& patches = *value.get<PatchComplex>();
    const std::size_t tets = patches.tets.size(), each = exponents.size();
    if (tets > ~u32(0) / each)
        throw Error("VTU patches have points with 32-bit numbers; {} tetrahedra need {} points", tets, tets * each);
    Array<Vec3> points(tets * each);
    Array<double> weights(tets * each);
    for (std::size_t tet = 0; tet < tets; ++tet)
        for (std::size_t n = 0; n < each; ++n) {
            Vec3 sum = Vec3::Zero();
            for (std::size_t i = 0; i < 4; ++i) sum += exponents[n][i] * patches.positions[patches.tets[tet][i]];
            points[each * tet + n] = sum / 3;
            weights[each * tet + n] = patches.weights[tet][number_of(exponents[n])];
        }
    warn_lost_precision(patches.frame, points, false, "VTU", options);
    const auto data = vtkSmartPointer<vtkUnstructuredGrid>::New();
    data->SetPoints(points_of(patches.frame, points));
    Array<u32> vertices(points.size());
    std::iota(vertices.begin(), vertices.end(), 0u);
    data->SetCells(VTK_BEZIER_TETRAHEDRON, cells_of(vertices, static_cast<vtkIdType>(each), points.size()));
    data->GetPointData()->AddArray(array_of(std::span<const double>(weights), 1, "weights"));
    const std::span kinds(reinterpret_cast<const u8*>(patches.kinds.data()), tets);
    data->GetCellData()->AddArray(array_of(kinds, 1, "kind"));
    data->GetCellData()->AddArray(array_of(patches.sides.span(), 1, "side"));
    data->GetCellData()->AddArray(array_of(patches.triangles.span(), 1, "patch"));
    const std::span combine(reinterpret_cast<const u8*>(patches.combine.data()), tets);
    data->GetCellData()->AddArray(array_of(combine, 1, "combine"));
    // no_edge and no_partner become -1 as signed numbers.
    const std::span edges(reinterpret_cast<const std::int32_t*>(patches.edges.data()), tets);
    data->GetCellData()->AddArray(array_of(edges, 1, "edge"));
    const std::span partners(reinterpret_cast<const std::int32_t*>(patches.partners.data()), tets);
    data->GetCellData()->AddArray(array_of(partners, 1, "partner"));
    add_frame(patches.frame, Text::as_numbers, *data->GetFieldData());
    write(*vtkSmartPointer<vtkXMLUnstructuredGridWriter>::New(), *data, out);
}

}  // namespace scanmill::vtk
