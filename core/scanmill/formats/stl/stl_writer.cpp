// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>

#include "scanmill/base/error.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/common/writing.hpp"
#include "scanmill/formats/stl/stl.hpp"
#include "scanmill/io/output_buffer.hpp"

namespace scanmill {

namespace {

/// Unit, or zero for a triangle without area or with coordinates that are no numbers.
Vec3 facet_normal(const Vec3& a, const Vec3& b, const Vec3& c) {
    Vec3 u = b - a, v = c - a;
    // Scaled first: the cross product of tiny or huge edges would leave double's range.
    const double scale = std::max(u.cwiseAbs().maxCoeff(), v.cwiseAbs().maxCoeff());
    if (!(scale > 0) || !std::isfinite(scale)) return Vec3::Zero();
    u /= scale;
    v /= scale;
    const Vec3 normal = u.cross(v);
    const double length = normal.stableNorm();
    if (!(length > 0)) return Vec3::Zero();
    return normal / length;
}

void put(const Eigen::Vector3f& p, OutputBuffer& out) {
    for (int axis = 0; axis < 3; ++axis) out.binary(p[axis]);
}

Eigen::Vector3f written(const TriangleMesh& mesh, u32 vertex) {
    return world(mesh.frame, mesh.positions[vertex]).cast<float>();
}

/// Triangles with two corners that differ in the mesh and coincide in single precision.
std::size_t collapsed_triangles(const TriangleMesh& mesh) {
    std::size_t count = 0;
    for (const Triangle& triangle : mesh.triangles) {
        bool collapsed = false;
        for (int corner = 0; corner < 3; ++corner) {
            const u32 a = triangle[corner], b = triangle[(corner + 1) % 3];
            collapsed |= mesh.positions[a] != mesh.positions[b] && written(mesh, a) == written(mesh, b);
        }
        count += collapsed;
    }
    return count;
}

}  // namespace

void write_stl(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    const TriangleMesh& whole = *value.get<TriangleMesh>();
    if (whole.triangles.empty()) throw Error("nothing to write: the mesh has no triangles, and STL holds nothing else");
    require_countable(whole.triangles.size(), "triangles");
    const TriangleMesh mesh = with_used_vertices(whole, "STL", options);
    warn_lost_precision(mesh.frame, mesh.positions.span(), true, "STL", options);
    warn_bare_triangles(mesh, "STL", options);
    if (const std::size_t collapsed = collapsed_triangles(mesh); collapsed > 0)
        warn(options.on_warning,
             "{} collapsed: corners that differ are equal in STL's single precision; PLY "
             "keeps them apart",
             count_text(collapsed, "triangle", "triangles"));

    Frame frame = mesh.frame;
    frame.name = one_line(frame.name);
    const std::string header = stl_header(frame);
    const std::vector<std::string> kept = stl_header_comments(header);
    if (!frame.name.empty() && (kept.empty() || kept.back() != "frame " + frame.name))
        warn(options.on_warning,
             "the frame's name of {} bytes does not fit into STL's header and was cut; PLY keeps it",
             frame.name.size());

    out.text(header);
    out.binary(static_cast<u32>(mesh.triangles.size()));
    for (const Triangle& triangle : mesh.triangles) {
        const Vec3 &a = mesh.positions[triangle[0]], &b = mesh.positions[triangle[1]], &c = mesh.positions[triangle[2]];
        put(facet_normal(a, b, c).cast<float>(), out);
        for (u32 vertex : triangle) put(written(mesh, vertex), out);
        out.binary(std::uint16_t(0));
    }
}

}  // namespace scanmill
