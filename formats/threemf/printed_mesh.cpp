// SPDX-License-Identifier: GPL-3.0-or-later
#include "threemf/printed_mesh.hpp"

#include <Eigen/Geometry>
#include <cmath>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/common/writing.hpp"
#include "scanmill/geometry/mesh/topology.hpp"

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

/// The float for which lib3mf writes the text nearest to the number.
float for_writing(double number) {
    const float nearest = static_cast<float>(number);
    float best = nearest;
    for (const double above : {0.5 / decimals, 1 / decimals}) {
        const float candidate = static_cast<float>(number + std::copysign(above, number));
        if (std::abs(as_written(candidate) - number) < std::abs(as_written(best) - number)) best = candidate;
    }
    return best;
}

/// A number near this one whose six digits, as lib3mf writes a place, are the number itself, to readers in single
/// precision as to those in double.
float short_number(double number) {
    constexpr double six_digits = 999999.5, whole_floats = 1 << 24;
    double step = 1, digits = std::abs(number), odd = digits;
    for (; digits >= six_digits; digits /= 10) step *= 10;
    // The step is 2^k 5^k; its powers of 2 are no digits of a float.
    for (double ten = 1; ten < step; ten *= 10) odd /= 2;
    for (; odd >= whole_floats; odd /= 2) step *= 2;
    return static_cast<float>(std::round(number / step) * step);
}

Eigen::Vector3f place_of(const TriangleMesh& mesh) {
    BoundingBox box = bounding_box(mesh.positions.span());
    box.low += mesh.frame.origin;
    box.high += mesh.frame.origin;
    return distant_origin(box).unaryExpr(&short_number);
}

/// Triangles of which nothing is left, because corners that differ are written alike. Throws Error when all are.
void tell_collapsed(const TriangleMesh& mesh, const std::vector<NMR::MODELMESHVERTEX>& vertices,
                    const WriteOptions& options) {
    const auto alike = [&](u32 a, u32 b) {
        if (mesh.positions[a] == mesh.positions[b]) return false;
        for (int axis = 0; axis < 3; ++axis)
            if (as_written(vertices[a].m_fPosition[axis]) != as_written(vertices[b].m_fPosition[axis])) return false;
        return true;
    };
    std::size_t collapsed = 0;
    for (const auto& [a, b, c] : mesh.triangles) collapsed += alike(a, b) || alike(b, c) || alike(c, a) ? 1 : 0;
    if (collapsed == 0) return;
    if (collapsed == mesh.triangles.size())
        throw Error("nothing is left of the object: its diagonal is {:.3g} {}, and 3MF is written with six decimals",
                    surface_box(mesh).diagonal(), symbol(mesh.frame.unit))
            .hint("convert it to a smaller unit first: scanmill convert --to-unit um IN OUT");
    warn(options.on_warning,
         "{} of {} collapsed: corners that differ are equal in 3MF's six decimals; a smaller unit "
         "keeps them apart",
         counted(collapsed, "triangle", "triangles"), mesh.triangles.size());
}

}  // namespace

void require_solid(const TriangleMesh& mesh) {
    if (mesh.triangles.empty()) throw Error("nothing to write: the mesh has no triangles, and 3MF holds solids only");
    require_finite(mesh.positions.span(), "vertices");
    const MeshTopology found = topology(mesh);
    if (!found.closed)
        throw Error(
            "3MF holds closed, oriented manifolds only; the mesh has {} in {}, {} in three or more triangles, {} "
            "disagree, {} of several fans and {} a vertex twice",
            counted(found.boundary_edges, "boundary edge", "boundary edges"),
            counted(found.boundary_loops, "loop", "loops"), counted(found.nonmanifold_edges, "edge", "edges"),
            counted(found.misoriented_edges, "edge whose two triangles", "edges whose two triangles"),
            counted(found.nonmanifold_vertices, "vertex", "vertices"),
            counted(found.degenerate_triangles, "triangle that names", "triangles that name"))
            .hint("STL, GLB and VTP hold open meshes; alpha-solid makes closed ones from points");
    const double volume = six_volumes(mesh) / 6;
    if (!std::isfinite(volume) || volume == 0)
        throw Error(
            "3MF holds solids only; the volume of the mesh comes to {:.3g} {}³, so nothing tells inside from "
            "outside",
            volume, symbol(mesh.frame.unit))
            .hint("choose a unit in which the object is neither tiny nor huge: scanmill convert --to-unit mm IN OUT");
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
    tell_collapsed(mesh, result.vertices, options);
    result.triangles.reserve(mesh.triangles.size());
    for (const Triangle& triangle : mesh.triangles)
        result.triangles.push_back({{triangle[0], triangle[1], triangle[2]}});
    return result;
}

}  // namespace scanmill::threemf
