// SPDX-License-Identifier: GPL-3.0-or-later
#include "threemf/printed_mesh.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "scanmill/filter/error.hpp"
#include "scanmill/filter/quantity.hpp"
#include "scanmill/formats/reading.hpp"
#include "scanmill/formats/writing.hpp"
#include "scanmill/geometry/topology.hpp"

namespace scanmill::threemf {

namespace {

/// Six times the volume, relative to the first vertex.
double six_volumes(const TriangleMesh& mesh) {
    const Vec3 base = mesh.positions[mesh.triangles[0][0]];
    double sum = 0;
    for (const Triangle& triangle : mesh.triangles) {
        const Vec3 a = mesh.positions[triangle[0]] - base, b = mesh.positions[triangle[1]] - base,
                   c = mesh.positions[triangle[2]] - base;
        sum += a.dot(b.cross(c));
    }
    return sum;
}

constexpr double decimals = 1e6;  // lib3mf writes six of them

/// The number that lib3mf writes for a float: it cuts behind the sixth decimal, in single precision.
double as_written(float number) {
    return std::trunc(static_cast<double>(number * static_cast<float>(decimals))) / decimals;
}

/// The float for which lib3mf writes the number rounded.
float for_writing(double number) { return static_cast<float>(number + std::copysign(0.5 / decimals, number)); }

/// The number with as many digits as lib3mf writes for a place.
float six_digits(double number) {
    double read = 0;
    parse_number(fmt::format("{:.6g}", number), read);
    return static_cast<float>(read);
}

Eigen::Vector3f place_of(const TriangleMesh& mesh) {
    BoundingBox box = bounding_box(mesh.positions.span());
    box.low += mesh.frame.origin;
    box.high += mesh.frame.origin;
    return distant_origin(box).unaryExpr(&six_digits);
}

}  // namespace

void require_solid(const TriangleMesh& mesh) {
    if (mesh.triangles.empty()) throw Error("nothing to write: the mesh has no triangles, and 3MF holds solids only");
    require_finite(mesh.positions.span(), "vertices");
    const MeshTopology found = topology(mesh);
    if (!found.closed)
        throw Error(
            "3MF holds closed, oriented manifolds only; the mesh has {} boundary edges in {} loops, {} edges in three "
            "or "
            "more triangles, {} edges whose two triangles disagree, {} vertices of several fans and {} triangles that "
            "name "
            "a vertex twice",
            found.boundary_edges, found.boundary_loops, found.nonmanifold_edges, found.misoriented_edges,
            found.nonmanifold_vertices, found.degenerate_triangles)
            .hint("STL, GLB and VTP hold open meshes; alpha-solid makes closed ones from points");
    const double volume = six_volumes(mesh) / 6;
    if (!(volume > 0))
        throw Error("3MF holds solids only; the mesh encloses the volume {:.6g}: its triangles do not face outwards",
                    volume)
            .hint("turn the triangles around, or write STL, GLB or VTP");
}

PrintedMesh printed(const TriangleMesh& mesh, const WriteOptions& options) {
    constexpr double most = 1e9, bearable = 1e-6;
    PrintedMesh result;
    result.place = place_of(mesh);
    const Vec3 shift = mesh.frame.origin - result.place.cast<double>();
    result.vertices.reserve(mesh.positions.size());
    double moved = 0;
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        const Vec3 local = shift + mesh.positions[i];
        NMR::MODELMESHVERTEX& vertex = result.vertices.emplace_back();
        for (int axis = 0; axis < 3; ++axis) {
            if (!(std::abs(local[axis]) < most))
                throw Error("vertex {} has the coordinate {}, and 3MF's library takes none beyond {}", i,
                            number_text(world(mesh.frame, mesh.positions[i])[axis]), number_text(most))
                    .hint("write STL, GLB or VTP, or change the unit");
            const float number = for_writing(local[axis]);
            vertex.m_fPosition[axis] = number;
            moved = std::max(moved, std::abs(as_written(number) - local[axis]));
        }
    }
    const double diagonal = bounding_box(mesh.positions.span()).diagonal();
    if (moved > bearable * diagonal)
        warn(options.on_warning,
             "coordinates moved by up to {:.2g}, {:.2g} of the diagonal: 3MF is written in single precision with six "
             "decimals; a smaller unit keeps more of them",
             moved, moved / diagonal);
    result.triangles.reserve(mesh.triangles.size());
    for (const Triangle& triangle : mesh.triangles)
        result.triangles.push_back({{triangle[0], triangle[1], triangle[2]}});
    return result;
}

}  // namespace scanmill::threemf
