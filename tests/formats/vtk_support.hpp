// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Our files as read by VTK.

#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkStringArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkXMLPolyDataReader.h>
#include <vtkXMLUnstructuredGridReader.h>

#include "core/formats/support.hpp"

namespace scanmill::test {

template <class Reader, class Data>
vtkSmartPointer<Data> read_by_vtk(const fs::path& file) {
    const auto reader = vtkSmartPointer<Reader>::New();
    reader->SetFileName(file.c_str());
    reader->Update();
    return reader->GetOutput();
}

/// The value, written to a file and read back; warnings into `warnings`.
template <class T>
vtkSmartPointer<vtkPolyData> through_vtp(const T& object, Warnings* warnings = nullptr) {
    const TemporaryFolder folder;
    write_file(folder / "a.vtp", std::make_shared<const T>(object), warnings ? warnings->writing() : WriteOptions{});
    return read_by_vtk<vtkXMLPolyDataReader, vtkPolyData>(folder / "a.vtp");
}

inline vtkSmartPointer<vtkUnstructuredGrid> through_vtu(const TetMesh& tets) {
    const TemporaryFolder folder;
    write_file(folder / "a.vtu", std::make_shared<const TetMesh>(tets));
    return read_by_vtk<vtkXMLUnstructuredGridReader, vtkUnstructuredGrid>(folder / "a.vtu");
}

inline std::vector<double> numbers_in(vtkDataArray* array) {
    std::vector<double> numbers;
    for (vtkIdType row = 0; array && row < array->GetNumberOfTuples(); ++row)
        for (int component = 0; component < array->GetNumberOfComponents(); ++component)
            numbers.push_back(array->GetComponent(row, component));
    return numbers;
}

inline std::vector<std::string> texts_in(vtkFieldData* field, const char* name) {
    auto* const array = vtkStringArray::SafeDownCast(field->GetAbstractArray(name));
    std::vector<std::string> texts;
    for (vtkIdType row = 0; array && row < array->GetNumberOfValues(); ++row) texts.push_back(array->GetValue(row));
    return texts;
}

inline std::vector<std::vector<vtkIdType>> cells_in(vtkCellArray* cells) {
    std::vector<std::vector<vtkIdType>> all;
    for (vtkIdType cell = 0; cell < cells->GetNumberOfCells(); ++cell) {
        const vtkIdType* vertices = nullptr;
        vtkIdType count = 0;
        cells->GetCellAtId(cell, count, vertices);
        all.emplace_back(vertices, vertices + count);
    }
    return all;
}

inline Vec3 point_in(vtkPointSet* data, vtkIdType row) { return Vec3(data->GetPoint(row)); }

}  // namespace scanmill::test
