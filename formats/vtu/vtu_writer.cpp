// SPDX-License-Identifier: GPL-3.0-or-later
#include <vtkCellData.h>
#include <vtkCellType.h>
#include <vtkFieldData.h>
#include <vtkPointData.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include "scanmill/formats/common/writing.hpp"
#include "vtk/vtk_arrays.hpp"
#include "vtu/vtu.hpp"

namespace scanmill::vtk {

namespace {

constexpr std::string_view format = "VTU";

/// `weights`, or a longer name if a column has this name.
std::string name_for_weights(const ColumnTable& columns) {
    std::string name = "weights";
    while (columns.find(name)) name += "-of-tets";
    return name;
}

}  // namespace

void write_vtu(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    const TetMesh& tets = *value.get<TetMesh>();
    warn_lost_precision(tets.frame, tets.positions.span(), false, format, options);
    const auto data = vtkSmartPointer<vtkUnstructuredGrid>::New();
    data->SetPoints(points_of(tets.frame, tets.positions.span()));
    const std::span vertices(reinterpret_cast<const u32*>(tets.cells.data()), 4 * tets.cells.size());
    // VTK orders corners like TetMesh: the normal of the first three points is directed to the side of the fourth.
    data->SetCells(VTK_TETRA, cells_of(vertices, 4, tets.positions.size()));
    add_columns(tets.vertex_columns, format, options, *data->GetPointData());
    if (!tets.weights.empty())
        data->GetPointData()->AddArray(array_of(tets.weights.span(), 1, name_for_weights(tets.vertex_columns)));
    if (!tets.inside.empty()) data->GetCellData()->AddArray(array_of(tets.inside.span(), 1, "inside"));
    add_frame(tets.frame, Text::as_numbers, *data->GetFieldData());
    write(*vtkSmartPointer<vtkXMLUnstructuredGridWriter>::New(), *data, out);
}

}  // namespace scanmill::vtk
