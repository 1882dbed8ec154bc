// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/cache/value_fields.hpp"

#include <nlohmann/json.hpp>

#include "scanmill/base/error.hpp"

namespace scanmill {

namespace {

using Json = nlohmann::json;

Json json_of(const Vec3& v) { return Json::array({v.x(), v.y(), v.z()}); }
Vec3 vector_of(const Json& json) {
    return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

/// Takes a value apart: every field adds to the header, or to the arrays and their places to the header.
class Writer {
public:
    void field(const char* name, const Buffer<std::byte>& bytes) { add(name, bytes.data(), bytes.size(), 1); }
    template <class T>
    void field(const char* name, const Buffer<T>& elements) {
        add(name, reinterpret_cast<const std::byte*>(elements.data()), elements.size() * sizeof(T), sizeof(T));
    }
    void field(const char* name, const ColumnTable& table) {
        Json columns = Json::array();
        for (const Column& column : table)
            columns.push_back({{"name", column.name()},
                               {"type", static_cast<int>(column.type())},
                               {"components", column.components()},
                               {"data", place(column.bytes().data(), column.bytes().size(), 1)},
                               {"offsets", place(reinterpret_cast<const std::byte*>(column.offsets().data()),
                                                 column.offsets().size() * sizeof(u64), sizeof(u64))}});
        header_[name] = std::move(columns);
    }
    void field(const char* name, const Frame& frame) {
        header_[name] = {
            {"unit", static_cast<int>(frame.unit)}, {"origin", json_of(frame.origin)}, {"name", frame.name}};
    }
    void field(const char* name, const std::vector<FeaturePolyline>& polylines) {
        Json rows = Json::array();
        for (const FeaturePolyline& line : polylines)
            rows.push_back({static_cast<int>(line.type), line.closed, line.begin, line.end});
        header_[name] = std::move(rows);
    }
    void field(const char* name, const Eigen::Matrix3d& matrix) {
        header_[name] = {json_of(matrix.row(0)), json_of(matrix.row(1)), json_of(matrix.row(2))};
    }
    void field(const char* name, const Vec3& vector) { header_[name] = json_of(vector); }
    void field(const char* name, LengthUnit unit) { header_[name] = static_cast<int>(unit); }
    void field(const char* name, const std::string& text) { header_[name] = text; }
    void field(const char* name, const std::vector<Metric>& metrics) {
        Json rows = Json::array();
        for (const Metric& metric : metrics) rows.push_back({metric.name, metric.value, static_cast<int>(metric.unit)});
        header_[name] = std::move(rows);
    }

    ValueFields finish(Kind kind) {
        header_["kind"] = static_cast<int>(kind);
        fields_.header = text_of(header_);
        return std::move(fields_);
    }

private:
    static std::string text_of(const Json& json) {
        std::string bytes;
        Json::to_cbor(json, bytes);
        return bytes;
    }
    Json place(const std::byte* data, std::size_t bytes, std::size_t element) {
        const Json where{{"begin", end_}, {"bytes", bytes}, {"element", element}};
        fields_.arrays.emplace_back(data, bytes);
        end_ += aligned(bytes);
        return where;
    }
    void add(const char* name, const std::byte* data, std::size_t bytes, std::size_t element) {
        header_[name] = place(data, bytes, element);
    }

    Json header_;
    ValueFields fields_;
    std::size_t end_ = 0;
};

/// Puts it together again, field by field.
class Reader {
public:
    Reader(const Json& header, std::string_view arrays, const std::shared_ptr<const void>& owner)
        : header_(header),
          arrays_(arrays),
          owner_(owner) {}

    template <class T>
    void field(const char* name, Buffer<T>& elements) const {
        elements = buffer<T>(header_.at(name));
    }
    void field(const char* name, ColumnTable& table) const {
        for (const Json& row : header_.at(name))
            table.add(Column(row.at("name").get<std::string>(), static_cast<ScalarType>(row.at("type").get<int>()),
                             row.at("components").get<u32>(), buffer<std::byte>(row.at("data")),
                             buffer<u64>(row.at("offsets"))));
    }
    void field(const char* name, Frame& frame) const {
        const Json& json = header_.at(name);
        frame.unit = static_cast<LengthUnit>(json.at("unit").get<int>());
        frame.origin = vector_of(json.at("origin"));
        frame.name = json.at("name").get<std::string>();
    }
    void field(const char* name, std::vector<FeaturePolyline>& polylines) const {
        for (const Json& row : header_.at(name))
            polylines.push_back({static_cast<FeatureType>(row.at(0).get<int>()), row.at(1).get<bool>(),
                                 row.at(2).get<u32>(), row.at(3).get<u32>()});
    }
    void field(const char* name, Eigen::Matrix3d& matrix) const {
        for (int row = 0; row < 3; ++row)
            matrix.row(row) = vector_of(header_.at(name).at(static_cast<std::size_t>(row))).transpose();
    }
    void field(const char* name, Vec3& vector) const { vector = vector_of(header_.at(name)); }
    void field(const char* name, LengthUnit& unit) const {
        unit = static_cast<LengthUnit>(header_.at(name).get<int>());
    }
    void field(const char* name, std::string& text) const { text = header_.at(name).get<std::string>(); }
    void field(const char* name, std::vector<Metric>& metrics) const {
        for (const Json& row : header_.at(name))
            metrics.push_back(
                {row.at(0).get<std::string>(), row.at(1).get<double>(), static_cast<Unit>(row.at(2).get<int>())});
    }

private:
    template <class T>
    Buffer<T> buffer(const Json& place) const {
        const auto begin = place.at("begin").get<std::size_t>(), bytes = place.at("bytes").get<std::size_t>();
        if (begin % value_alignment != 0 || begin > arrays_.size() || bytes > arrays_.size() - begin ||
            place.at("element").get<std::size_t>() != sizeof(T) || bytes % sizeof(T) != 0)
            throw Error("an array of the value file lies where none can be");
        if (bytes == 0) return {};
        return {owner_, reinterpret_cast<const T*>(arrays_.data() + begin), bytes / sizeof(T)};
    }

    const Json& header_;
    std::string_view arrays_;
    const std::shared_ptr<const void>& owner_;
};

// What each kind consists of, for both directions.

template <class Archive, class Cloud>
void describe(Archive& archive, Cloud& cloud)
    requires std::same_as<std::remove_const_t<Cloud>, PointCloud>
{
    archive.field("frame", cloud.frame);
    archive.field("positions", cloud.positions);
    archive.field("columns", cloud.columns);
}

template <class Archive, class Mesh>
void describe(Archive& archive, Mesh& mesh)
    requires std::same_as<std::remove_const_t<Mesh>, TriangleMesh>
{
    archive.field("frame", mesh.frame);
    archive.field("positions", mesh.positions);
    archive.field("triangles", mesh.triangles);
    archive.field("vertex-columns", mesh.vertex_columns);
    archive.field("face-columns", mesh.face_columns);
    archive.field("edges", mesh.edges);
    archive.field("edge-columns", mesh.edge_columns);
    archive.field("sharp-edges", mesh.sharp_edges);
}

template <class Archive, class Tets>
void describe(Archive& archive, Tets& tets)
    requires std::same_as<std::remove_const_t<Tets>, TetMesh>
{
    archive.field("frame", tets.frame);
    archive.field("positions", tets.positions);
    archive.field("vertex-columns", tets.vertex_columns);
    archive.field("weights", tets.weights);
    archive.field("cells", tets.cells);
    archive.field("neighbours", tets.neighbours);
    archive.field("inside", tets.inside);
}

template <class Archive, class Graph>
void describe(Archive& archive, Graph& graph)
    requires std::same_as<std::remove_const_t<Graph>, FeatureGraph>
{
    archive.field("frame", graph.frame);
    archive.field("positions", graph.positions);
    archive.field("polylines", graph.polylines);
    archive.field("vertices", graph.vertices);
    archive.field("left-normals", graph.left_normals);
    archive.field("right-normals", graph.right_normals);
    archive.field("corners", graph.corners);
}

template <class Archive, class Transform>
void describe(Archive& archive, Transform& transform)
    requires std::same_as<std::remove_const_t<Transform>, RigidTransform>
{
    archive.field("rotation", transform.rotation);
    archive.field("translation", transform.translation);
    archive.field("unit", transform.unit);
    archive.field("from", transform.from);
    archive.field("to", transform.to);
}

template <class Archive, class Numbers>
void describe(Archive& archive, Numbers& numbers)
    requires std::same_as<std::remove_const_t<Numbers>, Metrics>
{
    archive.field("values", numbers.values);
    archive.field("unit", numbers.unit);
}

/// The kind whose index in Value is `kind`; the others in turn.
template <std::size_t Index = 0>
Value read_kind(std::size_t kind, const Reader& reader) {
    if constexpr (Index < std::variant_size_v<Value>) {
        if (kind != Index) return read_kind<Index + 1>(kind, reader);
        using Object = std::remove_const_t<typename std::variant_alternative_t<Index, Value>::element_type>;
        Object object;
        describe(reader, object);
        return std::make_shared<const Object>(std::move(object));
    } else {
        throw Error("the value file holds a value of the unknown kind {}", kind);
    }
}

}  // namespace

ValueFields fields_of(const Value& value) {
    Writer writer;
    std::visit([&](const auto& object) { describe(writer, *object); }, value);
    return writer.finish(kind_of(value));
}

Value value_of(std::string_view header, std::string_view arrays, const std::shared_ptr<const void>& owner) try {
    const Json json = Json::from_cbor(header);
    return read_kind(json.at("kind").get<std::size_t>(), Reader(json, arrays, owner));
} catch (const Json::exception& error) {
    throw Error("the value file's header is none: {}", error.what());
}

}  // namespace scanmill
