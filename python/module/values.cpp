// SPDX-License-Identifier: GPL-3.0-or-later
// Values and files: the class Value, values of arrays and of documents, reading and writing.

#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <nlohmann/json.hpp>
#include <tuple>

#include "arrays.hpp"
#include "beside.hpp"
#include "module.hpp"
#include "scanmill/cache/value_file.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/kinds/document.hpp"
#include "scanmill/kinds/kind_traits.hpp"
#include "scanmill/worker/step_runner.hpp"

namespace scanmill::python {

namespace {

using GivenColumns = std::vector<std::pair<std::string, GivenArray>>;
/// Symbol of the unit, origin, name.
using GivenFrame = std::tuple<std::optional<std::string>, std::array<double, 3>, std::string>;

LengthUnit unit_of(const std::optional<std::string>& symbol) {
    if (!symbol) return LengthUnit::unknown;
    if (const std::optional<LengthUnit> unit = length_unit(*symbol)) return *unit;
    throw Error("the unit of length is '{}'", *symbol).expected(length_unit_symbols());
}

Frame frame_from(const GivenFrame& given) {
    const auto& [unit, origin, name] = given;
    return {unit_of(unit), Vec3(origin[0], origin[1], origin[2]), name};
}

nb::tuple frame_tuple(const Value& value) {
    const Frame frame = frame_of(value).value_or(Frame{});
    const nb::object unit = frame.unit == LengthUnit::unknown ? nb::none() : nb::cast(std::string(symbol(frame.unit)));
    return nb::make_tuple(unit, nb::make_tuple(frame.origin.x(), frame.origin.y(), frame.origin.z()), frame.name);
}

ColumnTable columns_from(const GivenColumns& given) {
    ColumnTable columns;
    for (const auto& [name, array] : given) columns.add(column_of(name, array));
    return columns;
}

template <class T>
constexpr bool is_buffer = false;
template <class T>
constexpr bool is_buffer<Buffer<T>> = true;

/// Name, value and unit of each number.
std::vector<std::tuple<std::string, double, std::string>> listed(const Metrics& metrics) {
    std::vector<std::tuple<std::string, double, std::string>> list;
    for (const Metric& metric : metrics.values) list.emplace_back(metric.name, metric.value, name_of(metric.unit));
    return list;
}

/// Every buffer and every table of columns among the object's fields, by the name of the field.
template <class T>
nb::dict arrays_of(const T& object) {
    nb::dict arrays;
    for_each_field<T>([&](const auto& field) {
        const auto& member = object.*field.member;
        using Member = std::remove_cvref_t<decltype(member)>;
        if constexpr (std::is_same_v<Member, ColumnTable>)
            arrays[field.name] = numpy_columns(member);
        else if constexpr (is_buffer<Member>)
            arrays[field.name] = numpy_array(member);
    });
    return arrays;
}

/// Adds the fields other than arrays.
void add_lists(const Value& value, nb::dict& arrays) {
    if (const FeatureGraph* graph = value.find<FeatureGraph>()) {
        nb::list lines;
        for (const FeaturePolyline& line : graph->polylines)
            lines.append(nb::make_tuple(std::string(name_of(line.type)), line.closed, line.begin, line.end));
        arrays["polylines"] = lines;
    }
    if (const Transforms* transforms = value.find<Transforms>()) {
        Array<double> matrices;
        nb::list names;
        for (const RigidTransform& motion : transforms->motions) {
            Eigen::Matrix<double, 4, 4, Eigen::RowMajor> matrix = Eigen::Matrix4d::Identity();
            matrix.topLeftCorner<3, 3>() = motion.rotation;
            matrix.topRightCorner<3, 1>() = motion.translation;
            matrices.insert(matrices.end(), matrix.data(), matrix.data() + matrix.size());
            names.append(nb::make_tuple(motion.from, motion.to));
        }
        const Buffer<double> numbers(std::move(matrices));
        arrays["matrices"] =
            numpy_array(numbers.owner(), numbers.data(), {transforms->motions.size(), 4, 4}, nb::dtype<double>());
        arrays["names"] = names;
    }
    if (const Metrics* metrics = value.find<Metrics>()) {
        arrays["values"] = nb::cast(listed(*metrics));
        arrays["unit"] = metrics->unit == LengthUnit::unknown
                             ? nb::none()
                             : nb::object(nb::cast(std::string(symbol(metrics->unit))));
    }
    if (const Picture* picture = value.find<Picture>()) arrays["caption"] = picture->caption;
}

nb::dict arrays_of(const Value& value) {
    nb::dict arrays;
    const auto add = [&]<class T>(const T* object) {
        if (object) arrays = arrays_of(*object);
    };
#define SCANMILL_ADD_ARRAYS(Type) add(value.find<Type>());
    SCANMILL_ALL_KINDS(SCANMILL_ADD_ARRAYS)
#undef SCANMILL_ADD_ARRAYS
    if (const Picture* picture = value.find<Picture>())
        arrays["pixels"] = numpy_array(picture->pixels.owner(), picture->pixels.data(),
                                       {picture->height, picture->width, 3}, nb::dtype<u8>());
    add_lists(value, arrays);
    return arrays;
}

/// Moves the origin near the positions, as readers do, if they are far from it.
template <class T>
std::shared_ptr<const T> near_origin(T object) {
    if (distant_origin(bounding_box(object.positions.span())) != Vec3::Zero()) use_near_origin(kind_of<T>(), &object);
    return std::make_shared<const T>(std::move(object));
}

Value points_from(const GivenArray& positions, const GivenColumns& columns, const GivenFrame& frame,
                  const std::string& invalid) {
    PointCloud cloud{frame_from(frame), buffer_of<Vec3>(positions, "positions"), columns_from(columns)};
    const InvalidRows rule = *invalid_rows_named(invalid);
    const nb::gil_scoped_release released;
    try {
        return near_origin(accepted(cloud, rule, false).result);
    } catch (const Error& error) {
        if (error.remedy() != Remedy::drop_invalid_rows) throw;
        // The sentence has no subject, because readers put the file's name before it.
        throw Error("the array " + error.sentence()).hint("invalid='drop' leaves such rows out");
    }
}

/// The value with other positions, relative to its origin. Columns and frame remain.
template <class T>
Value moved(const T& object, const GivenArray& positions) {
    T other = object;
    other.positions = buffer_of<Vec3>(positions, "positions");
    if (other.positions.size() != object.positions.size())
        throw Error("the value has {} positions; {} were given", object.positions.size(), other.positions.size());
    const nb::gil_scoped_release released;
    require_finite(other.positions.span());
    require_supported_range(bounding_box(other.positions.span()));
    return near_origin(std::move(other));
}

Value with_positions(const Value& value, const GivenArray& positions) {
    if (const PointCloud* cloud = value.find<PointCloud>()) return moved(*cloud, positions);
    return moved(*value.get<TriangleMesh>(), positions);
}

/// Throws Error for a value without a declared unit.
Value converted(const Value& value, const std::string& unit) {
    const std::optional<Frame> frame = frame_of(value);
    if (!frame || frame->unit == LengthUnit::unknown)
        throw Error("the unit of the value is not declared, so it cannot be converted").remedy(Remedy::declare_unit);
    const LengthUnit wanted = unit_of(unit);
    const nb::gil_scoped_release released;
    return in_unit(value, wanted);
}

Value mesh_from(const GivenArray& positions, const GivenArray& triangles, const GivenColumns& vertex_columns,
                const GivenColumns& face_columns, const GivenArray& sharp_edges, const GivenFrame& frame) {
    TriangleMesh mesh;
    mesh.frame = frame_from(frame);
    mesh.positions = buffer_of<Vec3>(positions, "positions");
    mesh.triangles = buffer_of<Triangle>(triangles, "triangles");
    mesh.vertex_columns = columns_from(vertex_columns);
    mesh.face_columns = columns_from(face_columns);
    mesh.sharp_edges = buffer_of<Edge>(sharp_edges, "sharp_edges");
    const nb::gil_scoped_release released;
    require_consistent(mesh);
    require_finite(mesh.positions.span(), "vertices");
    require_supported_range(bounding_box(mesh.positions.span()));
    return near_origin(std::move(mesh));
}

std::optional<std::string> document_of(const Value& value) {
    if (!value.kind().has_json()) return std::nullopt;
    Json document;
    value.kind().info().to_json(value.object(), document);
    return text_of(document);
}

Kind known_kind(const std::string& name) {
    if (const std::optional<Kind> kind = kind_named(name)) return *kind;
    throw Error("the kind is '{}'", name).expected(kind_names());
}

std::pair<Value, nb::list> value_from(const std::string& kind, const std::string& text) {
    std::vector<std::string> warnings;
    const Kind known = known_kind(kind);
    if (!known.has_json()) throw Error("values of the kind '{}' have no form in JSON", kind);
    const auto object = known.info().from_json(parse_document(text),
                                               [&](std::string sentence) { warnings.push_back(std::move(sentence)); });
    return {Value(known, object), readable(warnings)};
}

std::pair<Value, nb::list> read(const std::filesystem::path& file, const std::optional<std::string>& kind,
                                const std::optional<std::string>& unit, const std::string& frame,
                                const std::string& invalid) {
    require_own_threads();
    LeafSource leaf;
    const auto [path, view] = file_view(file);
    leaf.file = path;
    leaf.view = view;
    leaf.unit = unit_of(unit);
    leaf.frame = frame;
    if (!invalid.empty()) leaf.invalid = *invalid_rows_named(invalid);
    const std::optional<Kind> wanted = kind ? std::optional(known_kind(*kind)) : std::nullopt;
    if (wanted != kind_of<PointCloud>()) leaf.also = all_kinds();  // points are also the vertices of a mesh file
    const auto result = std::make_shared<std::pair<Value, std::vector<std::string>>>();
    const auto work = [leaf, wanted, result](Beside&) {
        result->first = read_leaf(leaf, [&](std::string sentence) { result->second.push_back(std::move(sentence)); });
        if (wanted && *wanted != result->first.kind())
            throw Error("'{}' contains {}; expected {}", leaf.name(), result->first.kind().name(), wanted->name());
    };
    run_beside(work, nb::none());
    return {result->first, readable(result->second)};
}

nb::list write(const Value& value, const std::filesystem::path& file) {
    require_own_threads();
    const auto warnings = std::make_shared<std::vector<std::string>>();
    WriteOptions options;
    options.on_warning = [warnings](std::string sentence) { warnings->push_back(std::move(sentence)); };
    run_beside([value, file, options](Beside&) { write_file(file, value, options); }, nb::none());
    return readable(*warnings);
}

nb::bytes png_of(const Value& value) {
    std::string bytes;
    {
        const nb::gil_scoped_release released;
        bytes = write_bytes("picture.png", value);
    }
    return nb::bytes(bytes.data(), bytes.size());
}

}  // namespace

void add_values(nb::module_& module) {
    nb::class_<Value>(module, "Value")
        .def_prop_ro("kind", [](const Value& value) { return std::string(value.kind().name()); })
        .def("frame", &frame_tuple)
        .def("arrays", [](const Value& value) { return arrays_of(value); })
        .def("with_positions", &with_positions)
        .def("document", &document_of)
        .def("properties", [](const Value& value) { return listed(properties_of(value)); })
        .def("in_unit", &converted)
        .def("is_same", [](const Value& value, const Value& other) { return value == other; })
        .def("store", [](const Value& value, const std::filesystem::path& file) {
            require_own_threads();
            const nb::gil_scoped_release released;
            EncodedValue(value).write(file);
        });
    module.def("points", &points_from);
    module.def("mesh", &mesh_from);
    module.def("value", &value_from);
    module.def("stored", [](const std::filesystem::path& file) { return read_value(file); });
    module.def("read", &read, nb::arg("file"), nb::arg("kind").none(), nb::arg("unit").none(), nb::arg("frame"),
               nb::arg("invalid"));
    module.def("write", &write);
    module.def("png", &png_of);
    module.def("can_write", [](const std::string& extension, const std::string& kind) {
        return can_write(extension, known_kind(kind));
    });
}

}  // namespace scanmill::python
