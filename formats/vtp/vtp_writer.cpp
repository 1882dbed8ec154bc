// SPDX-License-Identifier: GPL-3.0-or-later
#include <vtkCellData.h>
#include <vtkFieldData.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataWriter.h>

#include "scanmill/formats/common/writing.hpp"
#include "vtk/vtk_arrays.hpp"
#include "vtp/vtp.hpp"

namespace scanmill::vtk {

namespace {

constexpr std::string_view format = "VTP";

/// Simplices as the numbers of their vertices, one after the other.
template <class Simplex>
std::span<const u32> vertices_of(const Buffer<Simplex>& simplices) {
    static_assert(sizeof(Simplex) == std::tuple_size_v<Simplex> * sizeof(u32));
    return {reinterpret_cast<const u32*>(simplices.data()), simplices.size() * std::tuple_size_v<Simplex>};
}

}  // namespace

void write_vtp_points(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    const PointCloud& cloud = *value.get<PointCloud>();
    tell_lost_precision(cloud.frame, cloud.positions.span(), false, format, options);
    const auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(points_of(cloud.frame, cloud.positions.span()));
    data->SetVerts(single_points(0, cloud.size()));
    add_columns(cloud.columns, format, options, *data->GetPointData());
    add_frame(cloud.frame, Text::as_string, *data->GetFieldData());
    write(*vtkSmartPointer<vtkXMLPolyDataWriter>::New(), *data, out);
}

void write_vtp_mesh(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    const TriangleMesh& mesh = *value.get<TriangleMesh>();
    tell_lost_precision(mesh.frame, mesh.positions.span(), false, format, options);
    const auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(points_of(mesh.frame, mesh.positions.span()));
    data->SetPolys(cells_of(vertices_of(mesh.triangles), 3, mesh.positions.size()));
    add_columns(mesh.vertex_columns, format, options, *data->GetPointData());
    add_columns(mesh.face_columns, format, options, *data->GetCellData());
    vtkFieldData& field = *data->GetFieldData();
    add_frame(mesh.frame, Text::as_string, field);
    if (!mesh.edges.empty()) field.AddArray(array_of(vertices_of(mesh.edges), 2, "edges"));
    add_columns(mesh.edge_columns, "edge:", format, options, field);
    if (!mesh.sharp_edges.empty()) field.AddArray(array_of(vertices_of(mesh.sharp_edges), 2, "sharp_edges"));
    write(*vtkSmartPointer<vtkXMLPolyDataWriter>::New(), *data, out);
}

}  // namespace scanmill::vtk
