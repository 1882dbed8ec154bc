// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Our values as VTK's arrays, and VTK's XML files as bytes. Shared by VTP and VTU.
///
/// Columns, and other data whose layout in memory is VTK's, are viewed and not copied: the value must outlive the data
/// set. Column names are kept, but control characters and invalid UTF-8 become '_', with a warning. `normal` (3
/// numbers), `colour` (3 or 4 uint8) and `texture` (2 numbers) are also marked as VTK's normals, scalars and texture
/// coordinates. VTK has no lists, so list columns are left out, with a warning.
///
/// The field data contain, as far as known: `unit` (a text such as `mm`), `frame` (its name), and `origin` (three
/// doubles near the data). Positions include the origin; a viewer with single precision may subtract it.

#include <vtkCellArray.h>
#include <vtkDataSetAttributes.h>
#include <vtkPointSet.h>
#include <vtkSmartPointer.h>
#include <vtkXMLWriter.h>

#include <span>
#include <string>

#include "scanmill/data/columns.hpp"
#include "scanmill/data/frame.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/io/output_buffer.hpp"

namespace scanmill::vtk {

/// A view of `rows` × `components` numbers.
vtkSmartPointer<vtkDataArray> array_of(ScalarType type, const void* numbers, std::size_t rows, u32 components,
                                       std::string_view name);
template <class T>
vtkSmartPointer<vtkDataArray> array_of(std::span<const T> numbers, u32 components, std::string_view name) {
    return array_of(scalar_type_of<T>(), numbers.data(), numbers.size() / components, components, name);
}

/// Adds the columns; `format` is the name of the format in warnings.
void add_columns(const ColumnTable& columns, std::string_view format, const WriteOptions& options,
                 vtkDataSetAttributes& attributes);
/// The same for field data, which belong to the whole file; `prefix` precedes each name.
void add_columns(const ColumnTable& columns, std::string_view prefix, std::string_view format,
                 const WriteOptions& options, vtkFieldData& field);

/// The positions in world coordinates, as double.
vtkSmartPointer<vtkPoints> points_of(const Frame& frame, std::span<const Vec3> positions);

/// Cells of `corners` vertices each, with 32-bit numbers if these suffice.
vtkSmartPointer<vtkCellArray> cells_of(std::span<const u32> vertices, vtkIdType corners, std::size_t points);
/// The cells { first }, { first + 1 }, … , `count` of them. Such cells make points visible.
vtkSmartPointer<vtkCellArray> single_points(u32 first, std::size_t count);

/// The form of a text in the file. `as_numbers` writes one uint8 for each byte of its UTF-8, because meshio does not
/// read files with strings.
enum class Text { as_string, as_numbers };
void add_frame(const Frame& frame, Text text, vtkFieldData& field);
void add_text(std::string_view name, std::span<const std::string> texts, vtkFieldData& field);

/// Writes the data set: XML followed by one block of raw binary, not compressed, so that equal data give equal bytes
/// everywhere. Throws Error when VTK fails.
void write(vtkXMLWriter& writer, vtkPointSet& data, OutputBuffer& out);

}  // namespace scanmill::vtk
