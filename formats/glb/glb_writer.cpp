// SPDX-License-Identifier: GPL-3.0-or-later
#include <limits>

#include "glb/attributes.hpp"
#include "glb/glb.hpp"
#include "glb/glb_model.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/common/writing.hpp"

namespace scanmill::glb {

namespace {

/// Throws Error when so many bytes of numbers do not fit: the format counts with 32 bits.
void require_fits(u64 bytes) {
    constexpr u64 most = std::numeric_limits<u32>::max(), room_for_the_rest = u64(1) << 20;
    if (bytes > most - room_for_the_rest)
        throw Error("it needs {} bytes; a GLB file holds at most {}", bytes, most)
            .hint("write PLY or VTP, or reduce the scan first");
}

/// Where the vertices are relative to: near them when they are far from zero, else zero.
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

void add_positions(GlbModel& model, const Frame& frame, std::span<const Vec3> positions) {
    const LengthUnit unit = frame.unit == LengthUnit::unknown ? LengthUnit::metre : frame.unit;
    const auto in_metres = [&](const Vec3& v) {
        return Vec3(v.unaryExpr([&](double length) { return in_unit(length, unit, LengthUnit::metre); }));
    };
    const Vec3 origin = local_origin(frame, positions);
    const Vec3 shift = frame.origin - origin;
    if (origin != Vec3::Zero()) {
        const Vec3 translation = y_up(in_metres(origin));
        model.node().translation.assign(translation.begin(), translation.end());
    }
    unsigned char* place = model.add_accessor(positions.size(), 3 * sizeof(float), TINYGLTF_TYPE_VEC3,
                                              TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TARGET_ARRAY_BUFFER);
    Eigen::Array3f low = Eigen::Array3f::Constant(std::numeric_limits<float>::infinity()), high = -low;
    for (const Vec3& position : positions) {
        const Eigen::Vector3f local = y_up(in_metres(shift + position)).cast<float>();
        low = low.min(local.array());
        high = high.max(local.array());
        std::memcpy(place, local.data(), 3 * sizeof(float));
        place += 3 * sizeof(float);
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

/// What points and the vertices of a mesh have in common.
GlbModel model_of(const Frame& frame, std::span<const Vec3> positions, const ColumnTable& columns,
                  std::string_view kind, std::size_t triangles, const WriteOptions& options) {
    constexpr std::size_t size_of_position = 3 * sizeof(float), size_of_triangle = 3 * sizeof(u32);
    u64 bytes = positions.size() * u64(size_of_position) + triangles * u64(size_of_triangle);
    require_fits(bytes);
    require_finite(positions, kind == "mesh" ? "vertices" : "points");
    const Frame local{frame.unit, frame.origin - local_origin(frame, positions), ""};
    tell_lost_precision(local, positions, true, "GLB", options);
    if (frame.unit == LengthUnit::unknown)
        warn(options.on_warning,
             "GLB is in metres and the unit is not known: 1 was written as 1 m; say the unit, as with --unit mm");
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
        throw Error("nothing to write: the mesh has {} and no triangles, and GLB would show nothing",
                    counted(whole.positions.size(), "vertex", "vertices"))
            .hint("PLY and VTP hold vertices without triangles");
    const TriangleMesh mesh = with_used_vertices(whole, "GLB", options);
    GlbModel model =
        model_of(mesh.frame, mesh.positions.span(), mesh.vertex_columns, "mesh", mesh.triangles.size(), options);
    std::vector<std::string_view> told_already;
    for (const Column& column : mesh.vertex_columns) told_already.push_back(column.name());
    tell_bare_triangles(mesh, "GLB", options, told_already);
    unsigned char* const place =
        model.add_accessor(3 * mesh.triangles.size(), sizeof(u32), TINYGLTF_TYPE_SCALAR,
                           TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
    std::memcpy(place, mesh.triangles.data(), mesh.triangles.size() * sizeof(Triangle));
    model.primitive().indices = model.last_index();
    model.primitive().mode = TINYGLTF_MODE_TRIANGLES;
    model.write(out);
}

}  // namespace scanmill::glb
