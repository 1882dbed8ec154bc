// SPDX-License-Identifier: GPL-3.0-or-later
#include <tiny_gltf.h>

#include <limits>
#include <ostream>
#include <streambuf>

#include "glb/attributes.hpp"
#include "glb/glb.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/common/rounding.hpp"
#include "scanmill/formats/common/writing.hpp"
#include "scanmill/io/output_buffer.hpp"

namespace scanmill::glb {

namespace {

/// A stream that passes the output of tinygltf to an OutputBuffer without a copy.
class Passing : public std::streambuf {
public:
    explicit Passing(OutputBuffer& out) : out_(out) {}

private:
    std::streamsize xsputn(const char* bytes, std::streamsize count) override {
        out_.text({bytes, static_cast<std::size_t>(count)});
        return count;
    }
    int_type overflow(int_type byte) override {
        const char c = traits_type::to_char_type(byte);
        out_.text({&c, 1});
        return byte;
    }
    OutputBuffer& out_;
};

/// A glTF scene of one node with one mesh of one primitive, and its binary data.
class GlbModel {
public:
    /// `kind` is the name of the node if the frame has no name.
    GlbModel(const Frame& frame, std::string_view kind);

    tinygltf::Primitive& primitive() { return model_.meshes[0].primitives[0]; }
    tinygltf::Node& node() { return model_.nodes[0]; }
    tinygltf::Material& material() { return model_.materials[0]; }

    void reserve(std::size_t size) { bytes().reserve(size); }
    /// Adds `count` rows of `stride` bytes, all zero, and returns their address. The next call makes the address
    /// invalid unless memory was reserved. The other arguments are tinygltf's constants.
    unsigned char* add_accessor(std::size_t count, std::size_t stride, int type, int component_type, int target);
    tinygltf::Accessor& last_accessor() { return model_.accessors.back(); }
    int last_index() const { return static_cast<int>(model_.accessors.size()) - 1; }

    /// Throws Error if tinygltf fails; passes on exceptions of `out`.
    void write(OutputBuffer& out) const;

private:
    std::vector<unsigned char>& bytes() { return model_.buffers[0].data; }
    void add_extras(const Frame& frame);
    void add_material();

    tinygltf::Model model_;
};

GlbModel::GlbModel(const Frame& frame, std::string_view kind) {
    model_.asset.version = "2.0";
    model_.asset.generator = "Scanmill " SCANMILL_VERSION;
    model_.buffers.emplace_back();
    model_.meshes.emplace_back();
    model_.meshes[0].primitives.emplace_back();
    primitive().material = 0;
    model_.nodes.emplace_back();
    model_.nodes[0].name = frame.name.empty() ? std::string(kind) : valid_text(frame.name);
    model_.nodes[0].mesh = 0;
    model_.scenes.emplace_back();
    model_.scenes[0].nodes = {0};
    model_.defaultScene = 0;
    add_extras(frame);
    add_material();
}

unsigned char* GlbModel::add_accessor(std::size_t count, std::size_t stride, int type, int component_type, int target) {
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = bytes().size();
    view.byteLength = count * stride;
    view.target = target;
    if (target == TINYGLTF_TARGET_ARRAY_BUFFER) view.byteStride = stride;
    tinygltf::Accessor accessor;
    accessor.bufferView = static_cast<int>(model_.bufferViews.size());
    accessor.componentType = component_type;
    accessor.type = type;
    accessor.count = count;
    bytes().resize(view.byteOffset + view.byteLength);
    unsigned char* const rows = bytes().data() + view.byteOffset;
    model_.bufferViews.push_back(std::move(view));
    model_.accessors.push_back(std::move(accessor));
    return rows;
}

void GlbModel::write(OutputBuffer& out) const {
    Passing passing(out);
    std::ostream stream(&passing);
    stream.exceptions(std::ios::badbit);  // passes on exceptions of the sink, such as a full disk
    constexpr bool pretty = false, binary = true;
    if (!tinygltf::TinyGLTF().WriteGltfSceneToStream(&model_, stream, pretty, binary) || !stream)
        throw Error("tinygltf could not write the file").hint("write PLY");
}

void GlbModel::add_extras(const Frame& frame) {
    tinygltf::Value::Object extras;
    if (frame.unit != LengthUnit::unknown) extras["unit"] = tinygltf::Value(std::string(symbol(frame.unit)));
    if (!frame.name.empty()) extras["frame"] = tinygltf::Value(valid_text(frame.name));
    if (!extras.empty()) node().extras = tinygltf::Value(extras);
}

/// Adds a material that is not metallic. glTF's default material is a metal, which is black if there is no environment
/// to reflect.
void GlbModel::add_material() {
    model_.materials.emplace_back();
    material().name = "scan";
    material().pbrMetallicRoughness.metallicFactor = 0;
    material().doubleSided = true;
}

/// Throws Error if the binary data do not fit, because the format has 32-bit sizes.
void require_fits(u64 bytes) {
    constexpr u64 most = std::numeric_limits<u32>::max(), reserved_for_json = u64(1) << 20;
    if (bytes > most - reserved_for_json)
        throw Error("the file needs {} bytes; GLB allows at most {}", bytes, most)
            .hint("write PLY or VTP, or reduce the scan first");
}

/// The origin of the vertices: a point near them if they are far from zero, else zero.
Vec3 local_origin(const Frame& frame, std::span<const Vec3> positions) {
    BoundingBox box = bounding_box(positions);
    box.low += frame.origin;
    box.high += frame.origin;
    return distant_origin(box);
}

int type_of(u32 components) {
    constexpr std::array types{TINYGLTF_TYPE_SCALAR, TINYGLTF_TYPE_VEC2, TINYGLTF_TYPE_VEC3, TINYGLTF_TYPE_VEC4};
    return types[components - 1];
}

Vec3 in_metres(const Frame& frame, const Vec3& v) {
    const LengthUnit unit = frame.unit == LengthUnit::unknown ? LengthUnit::metre : frame.unit;
    return v.unaryExpr([&](double length) { return in_unit(length, unit, LengthUnit::metre); });
}

/// The position of a vertex in the file, before rounding, and without the node's translation.
Vec3 local_position(const Frame& frame, const Vec3& shift, const Vec3& position) {
    return y_up(in_metres(frame, shift + position));
}

void add_positions(GlbModel& model, const Frame& frame, std::span<const Vec3> positions) {
    const Vec3 origin = local_origin(frame, positions);
    const Vec3 shift = frame.origin - origin;
    if (origin != Vec3::Zero()) {
        const Vec3 translation = y_up(in_metres(frame, origin));
        model.node().translation.assign(translation.begin(), translation.end());
    }
    unsigned char* row = model.add_accessor(positions.size(), 3 * sizeof(float), TINYGLTF_TYPE_VEC3,
                                            TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TARGET_ARRAY_BUFFER);
    Eigen::Array3f low = Eigen::Array3f::Constant(std::numeric_limits<float>::infinity()), high = -low;
    for (const Vec3& position : positions) {
        const Eigen::Vector3f local = local_position(frame, shift, position).cast<float>();
        low = low.min(local.array());
        high = high.max(local.array());
        std::memcpy(row, local.data(), 3 * sizeof(float));
        row += 3 * sizeof(float);
    }
    model.last_accessor().minValues.assign(low.begin(), low.end());
    model.last_accessor().maxValues.assign(high.begin(), high.end());
    model.primitive().attributes["POSITION"] = model.last_index();
}

void add_attribute(GlbModel& model, const Attribute& attribute, std::size_t count) {
    attribute.fill(model.add_accessor(count, attribute.stride(), type_of(attribute.components),
                                      attribute.component_type, TINYGLTF_TARGET_ARRAY_BUFFER));
    model.last_accessor().normalized = attribute.is_normalised;
    model.primitive().attributes[attribute.name] = model.last_index();
}

bool is_see_through(const ColumnTable& columns) {
    const Column* colour = columns.find("colour");
    if (!colour || colour->type() != ScalarType::uint8 || colour->components() != 4) return false;
    const auto channels = colour->values<u8>();
    for (std::size_t row = 0; row < colour->rows(); ++row)
        if (channels[4 * row + 3] != 255) return true;
    return false;
}

/// The model of points, or of a mesh before its triangles are added. Throws Error if the data do not fit or have
/// positions that are not finite.
GlbModel model_of(const Frame& frame, std::span<const Vec3> positions, const ColumnTable& columns,
                  std::string_view kind, std::size_t triangles, const WriteOptions& options) {
    constexpr std::size_t size_of_position = 3 * sizeof(float), size_of_triangle = 3 * sizeof(u32);
    u64 bytes = positions.size() * u64(size_of_position) + triangles * u64(size_of_triangle);
    require_fits(bytes);
    require_finite(positions, kind == "mesh" ? "vertices" : "points");
    const Frame local{frame.unit, frame.origin - local_origin(frame, positions), ""};
    warn_lost_precision(local, positions, true, "GLB", options);
    if (frame.unit == LengthUnit::unknown)
        warn(options.on_warning,
             "GLB is in metres and the unit is not known: 1 was written as 1 m; declare the scan's unit to avoid "
             "this");
    const std::vector<Attribute> attributes = attributes_of(columns, options);
    for (const Attribute& attribute : attributes) bytes += u64(positions.size()) * attribute.stride();
    require_fits(bytes);

    GlbModel model(frame, kind);
    model.reserve(bytes);
    add_positions(model, frame, positions);
    for (const Attribute& attribute : attributes) add_attribute(model, attribute, positions.size());
    if (is_see_through(columns)) model.material().alphaMode = "BLEND";
    return model;
}

}  // namespace

void write_glb_points(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    const PointCloud& cloud = *value.get<PointCloud>();
    GlbModel model = model_of(cloud.frame, cloud.positions.span(), cloud.columns, "points", 0, options);
    model.primitive().mode = TINYGLTF_MODE_POINTS;
    model.write(out);
}

void write_glb_mesh(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    const TriangleMesh& whole = *value.get<TriangleMesh>();
    if (whole.triangles.empty())
        throw Error("nothing to write: the mesh has {} and no triangles, and GLB would be empty",
                    count_text(whole.positions.size(), "vertex", "vertices"))
            .hint("PLY and VTP hold vertices without triangles");
    const TriangleMesh mesh = with_used_vertices(whole, "GLB", options);
    GlbModel model =
        model_of(mesh.frame, mesh.positions.span(), mesh.vertex_columns, "mesh", mesh.triangles.size(), options);
    std::vector<std::string_view> reported;
    for (const Column& column : mesh.vertex_columns) reported.push_back(column.name());
    warn_bare_triangles(mesh, "GLB", options, reported);
    const Vec3 shift = mesh.frame.origin - local_origin(mesh.frame, mesh.positions.span());
    const auto vertex_in_file = [&](std::size_t vertex) {
        return rounded_to_float(local_position(mesh.frame, shift, mesh.positions[vertex]));
    };
    warn_collapsed(mesh, joined_vertices(mesh, vertex_in_file), "GLB", options);
    unsigned char* const rows =
        model.add_accessor(3 * mesh.triangles.size(), sizeof(u32), TINYGLTF_TYPE_SCALAR,
                           TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
    std::memcpy(rows, mesh.triangles.data(), mesh.triangles.size() * sizeof(Triangle));
    model.primitive().indices = model.last_index();
    model.primitive().mode = TINYGLTF_MODE_TRIANGLES;
    model.write(out);
}

}  // namespace scanmill::glb
