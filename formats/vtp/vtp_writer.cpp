// SPDX-License-Identifier: GPL-3.0-or-later
#include <vtkCellData.h>
#include <vtkFieldData.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataWriter.h>

#include <algorithm>

#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/common/writing.hpp"
#include "vtk/vtk_arrays.hpp"
#include "vtp/vtp.hpp"

namespace scanmill::vtk {

namespace {

constexpr std::string_view format = "VTP";

/// The vertex numbers of all simplices, one simplex after the other.
template <class Simplex>
std::span<const u32> vertices_of(const Buffer<Simplex>& simplices) {
    static_assert(sizeof(Simplex) == std::tuple_size_v<Simplex> * sizeof(u32));
    return {reinterpret_cast<const u32*>(simplices.data()), simplices.size() * std::tuple_size_v<Simplex>};
}

// Features.

constexpr u8 corner_type = 3;
const std::vector<std::string> type_names{"outer boundary", "hole", "crease", "corner"};

/// One row per point of the file: first the points of the polylines, then the corners.
struct FeaturePoints {
    Array<u32> vertex;
    Array<Vec3> position, left_normal, right_normal;
};

FeaturePoints points_of(const FeatureGraph& graph) {
    FeaturePoints points;
    const auto add = [&](u32 vertex, const Vec3& left, const Vec3& right) {
        points.vertex.push_back(vertex);
        points.position.push_back(graph.positions[vertex]);
        points.left_normal.push_back(left);
        points.right_normal.push_back(right);
    };
    for (std::size_t row = 0; row < graph.vertices.size(); ++row)
        add(graph.vertices[row], graph.left_normals[row], graph.right_normals[row]);
    for (const u32 corner : graph.corners) add(corner, Vec3::Zero(), Vec3::Zero());
    return points;
}

vtkSmartPointer<vtkCellArray> lines_of(const FeatureGraph& graph) {
    const auto lines = vtkSmartPointer<vtkCellArray>::New();
    lines->Use32BitStorage();
    for (const FeaturePolyline& polyline : graph.polylines) {
        lines->InsertNextCell(static_cast<int>(polyline.end - polyline.begin) + polyline.closed);
        for (u32 row = polyline.begin; row < polyline.end; ++row) lines->InsertCellPoint(row);
        if (polyline.closed) lines->InsertCellPoint(polyline.begin);
    }
    return lines;
}

void warn_of_unused(const FeatureGraph& graph, const Array<u32>& used, const WriteOptions& options) {
    std::vector<bool> is_used(graph.positions.size());
    for (const u32 vertex : used) is_used[vertex] = true;
    const auto unused = static_cast<u64>(std::ranges::count(is_used, false));
    if (unused > 0)
        warn(options.on_warning, "VTP left out {} outside all polylines and corners",
             count_text(unused, "vertex", "vertices"));
}

template <class T>
vtkSmartPointer<vtkDataArray> view(const Array<T>& rows, std::string_view name) {
    if constexpr (std::is_same_v<T, Vec3>)
        return array_of(std::span(reinterpret_cast<const double*>(rows.data()), 3 * rows.size()), 3, name);
    else
        return array_of(std::span<const T>(rows), 1, name);
}

}  // namespace

void write_vtp_points(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    const PointCloud& cloud = *value.get<PointCloud>();
    warn_lost_precision(cloud.frame, cloud.positions.span(), false, format, options);
    const auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(points_of(cloud.frame, cloud.positions.span()));
    data->SetVerts(single_points(0, cloud.size()));
    add_columns(cloud.columns, format, options, *data->GetPointData());
    add_frame(cloud.frame, Text::as_string, *data->GetFieldData());
    write(*vtkSmartPointer<vtkXMLPolyDataWriter>::New(), *data, out);
}

void write_vtp_mesh(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    const TriangleMesh& mesh = *value.get<TriangleMesh>();
    warn_lost_precision(mesh.frame, mesh.positions.span(), false, format, options);
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

void write_vtp_features(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    const FeatureGraph& graph = *value.get<FeatureGraph>();
    warn_lost_precision(graph.frame, graph.positions.span(), false, format, options);
    const FeaturePoints points = points_of(graph);
    warn_of_unused(graph, points.vertex, options);
    Array<u8> type(graph.corners.size(), corner_type), closed(graph.corners.size(), u8(0));
    for (const FeaturePolyline& polyline : graph.polylines) {
        type.push_back(static_cast<u8>(polyline.type));
        closed.push_back(polyline.closed);
    }
    const auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(points_of(graph.frame, points.position));
    data->SetVerts(single_points(static_cast<u32>(graph.vertices.size()), graph.corners.size()));
    data->SetLines(lines_of(graph));
    data->GetPointData()->AddArray(view(points.vertex, "vertex"));
    data->GetPointData()->AddArray(view(points.left_normal, "left_normal"));
    data->GetPointData()->AddArray(view(points.right_normal, "right_normal"));
    data->GetCellData()->AddArray(view(type, "type"));
    data->GetCellData()->AddArray(view(closed, "closed"));
    add_frame(graph.frame, Text::as_string, *data->GetFieldData());
    add_text("type_names", type_names, *data->GetFieldData());
    write(*vtkSmartPointer<vtkXMLPolyDataWriter>::New(), *data, out);
}

}  // namespace scanmill::vtk
