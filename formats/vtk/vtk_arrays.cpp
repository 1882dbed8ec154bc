// SPDX-License-Identifier: GPL-3.0-or-later
#include "vtk/vtk_arrays.hpp"

#include <vtkAOSDataArrayTemplate.h>
#include <vtkCommand.h>
#include <vtkDoubleArray.h>
#include <vtkPoints.h>
#include <vtkStringArray.h>
#include <vtkTypeInt32Array.h>
#include <vtkTypeInt64Array.h>
#include <vtkUnsignedCharArray.h>

#include <limits>
#include <numeric>

#include "scanmill/base/error.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/common/writing.hpp"

namespace scanmill::vtk {

namespace {

/// Whether the column is a list. Warns that such a column is left out.
bool is_left_out(const Column& column, std::string_view format, const WriteOptions& options) {
    if (column.is_list())
        warn(options.on_warning, "{} left out the lists of the column '{}'; PLY keeps them", format, column.name());
    return column.is_list();
}

vtkSmartPointer<vtkDataArray> view(const Column& column, std::string_view name) {
    return array_of(column.type(), column.bytes().data(), column.rows(), column.components(), name);
}

/// Marks normals, texture coordinates and colours as such for VTK.
void mark(const Column& column, const vtkSmartPointer<vtkDataArray>& array, vtkDataSetAttributes& attributes) {
    const u32 components = column.components();
    const bool is_float = column.type() == ScalarType::float32 || column.type() == ScalarType::float64;
    if (column.name() == "normal" && components == 3 && is_float) attributes.SetNormals(array);
    if (column.name() == "texture" && components == 2 && is_float) attributes.SetTCoords(array);
    if (column.name() == "colour" && column.type() == ScalarType::uint8 && (components == 3 || components == 4))
        attributes.SetScalars(array);
}

template <class Array, class Number = typename Array::ValueType>
vtkSmartPointer<vtkCellArray> cells_with(vtkSmartPointer<Array> vertices, vtkIdType corners) {
    const vtkIdType count = vertices->GetNumberOfValues() / corners;
    const auto offsets = vtkSmartPointer<Array>::New();
    offsets->SetNumberOfValues(count + 1);
    for (vtkIdType cell = 0; cell <= count; ++cell) offsets->SetValue(cell, static_cast<Number>(cell * corners));
    const auto cells = vtkSmartPointer<vtkCellArray>::New();
    cells->SetData(offsets.Get(), vertices.Get());
    return cells;
}

/// VTK has no read-only arrays. Its writers change nothing, so the cast is safe.
template <class T>
T* writable(const void* numbers) {
    return const_cast<T*>(static_cast<const T*>(numbers));
}

constexpr int keep_the_memory = 1;  // VTK calls this argument "save"

/// Collects the first error message that VTK would print.
class KeptError : public vtkCommand {
public:
    static KeptError* New() { return new KeptError; }
    void Execute(vtkObject*, unsigned long, void* text) override {
        if (sentence.empty() && text) sentence = static_cast<const char*>(text);
    }
    std::string sentence;
};

bool fits_32_bits(std::size_t count) { return count <= std::numeric_limits<vtkTypeInt32>::max(); }

}  // namespace

vtkSmartPointer<vtkDataArray> array_of(ScalarType type, const void* numbers, std::size_t rows, u32 components,
                                       std::string_view name) {
    return visit_scalar(type, [&]<class T>(T) -> vtkSmartPointer<vtkDataArray> {
        const auto array = vtkSmartPointer<vtkAOSDataArrayTemplate<T>>::New();
        array->SetName(xml_escaped(name).c_str());  // VTK does not escape names
        array->SetNumberOfComponents(static_cast<int>(components));
        array->SetArray(writable<T>(numbers), static_cast<vtkIdType>(rows * components), keep_the_memory);
        return array;
    });
}

void add_columns(const ColumnTable& columns, std::string_view format, const WriteOptions& options,
                 vtkDataSetAttributes& attributes) {
    WrittenNames names(format, options);
    for (const Column& column : columns) {
        if (is_left_out(column, format, options)) continue;
        const auto array = view(column, names.add(column.name(), valid_text(column.name())));
        attributes.AddArray(array);
        mark(column, array, attributes);
    }
}

void add_columns(const ColumnTable& columns, std::string_view prefix, std::string_view format,
                 const WriteOptions& options, vtkFieldData& field) {
    WrittenNames names(format, options);
    for (const Column& column : columns) {
        if (is_left_out(column, format, options)) continue;
        const std::string name = names.add(column.name(), valid_text(column.name()));
        field.AddArray(view(column, std::string(prefix) + name));
    }
}

vtkSmartPointer<vtkPoints> points_of(const Frame& frame, std::span<const Vec3> positions) {
    static_assert(sizeof(Vec3) == 3 * sizeof(double));
    const auto coordinates = vtkSmartPointer<vtkDoubleArray>::New();
    coordinates->SetNumberOfComponents(3);
    const auto count = static_cast<vtkIdType>(positions.size());
    if (frame.origin == Vec3::Zero()) {
        coordinates->SetArray(writable<double>(positions.data()), 3 * count, keep_the_memory);
    } else {
        coordinates->SetNumberOfTuples(count);
        for (vtkIdType i = 0; i < count; ++i)
            coordinates->SetTypedTuple(i, world(frame, positions[static_cast<std::size_t>(i)]).data());
    }
    const auto points = vtkSmartPointer<vtkPoints>::New();
    points->SetData(coordinates);
    return points;
}

vtkSmartPointer<vtkCellArray> cells_of(std::span<const u32> vertices, vtkIdType corners, std::size_t points) {
    const auto count = static_cast<vtkIdType>(vertices.size());
    if (fits_32_bits(vertices.size()) && fits_32_bits(points)) {
        const auto numbers = vtkSmartPointer<vtkTypeInt32Array>::New();
        numbers->SetArray(writable<vtkTypeInt32>(vertices.data()), count, keep_the_memory);
        return cells_with(numbers, corners);
    }
    const auto numbers = vtkSmartPointer<vtkTypeInt64Array>::New();
    numbers->SetNumberOfValues(count);
    for (vtkIdType i = 0; i < count; ++i) numbers->SetValue(i, vertices[static_cast<std::size_t>(i)]);
    return cells_with(numbers, corners);
}

vtkSmartPointer<vtkCellArray> single_points(u32 first, std::size_t count) {
    const auto fill = [&]<class Array>(vtkSmartPointer<Array> numbers) {
        numbers->SetNumberOfValues(static_cast<vtkIdType>(count));
        std::iota(numbers->GetPointer(0), numbers->GetPointer(0) + count, typename Array::ValueType(first));
        return cells_with(numbers, 1);
    };
    if (fits_32_bits(first + count)) return fill(vtkSmartPointer<vtkTypeInt32Array>::New());
    return fill(vtkSmartPointer<vtkTypeInt64Array>::New());
}

void add_text(std::string_view name, std::span<const std::string> texts, vtkFieldData& field) {
    const auto array = vtkSmartPointer<vtkStringArray>::New();
    array->SetName(std::string(name).c_str());
    for (const std::string& text : texts) array->InsertNextValue(text);
    field.AddArray(array);
}

void add_frame(const Frame& frame, Text form, vtkFieldData& field) {
    const auto add_one = [&](std::string_view name, std::string text) {
        if (form == Text::as_string) return add_text(name, {&text, 1}, field);
        const auto bytes = vtkSmartPointer<vtkUnsignedCharArray>::New();
        bytes->SetName(std::string(name).c_str());
        for (const char c : text) bytes->InsertNextValue(static_cast<unsigned char>(c));
        field.AddArray(bytes);
    };
    if (frame.unit != LengthUnit::unknown) add_one("unit", std::string(symbol(frame.unit)));
    if (!frame.name.empty()) add_one("frame", valid_text(frame.name));
    if (frame.origin == Vec3::Zero()) return;
    const auto origin = vtkSmartPointer<vtkDoubleArray>::New();
    origin->SetName("origin");
    origin->SetNumberOfComponents(3);
    origin->InsertNextTypedTuple(frame.origin.data());
    field.AddArray(origin);
}

void write(vtkXMLWriter& writer, vtkPointSet& data, OutputBuffer& out) {
    const auto kept = vtkSmartPointer<KeptError>::New();
    writer.AddObserver(vtkCommand::ErrorEvent, kept);
    writer.SetInputData(&data);
    writer.SetDataModeToAppended();
    writer.EncodeAppendedDataOff();
    writer.SetCompressorTypeToNone();
    writer.SetHeaderTypeToUInt64();
    writer.SetByteOrderToLittleEndian();
    writer.WriteToOutputStringOn();
    if (writer.Write() == 0 || !kept->sentence.empty())
        throw Error("VTK could not write the file: {}", kept->sentence.empty() ? "no reason was given" : kept->sentence)
            .hint("write PLY");
    out.text("<?xml version=\"1.0\"?>\n");
    out.text(writer.GetOutputString());
}

}  // namespace scanmill::vtk
