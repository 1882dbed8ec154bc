// SPDX-License-Identifier: GPL-3.0-or-later
#include "icp/target.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/data/robust_box.hpp"
#include "scanmill/filter/inputs.hpp"
#include "scanmill/geometry/fit/covariance.hpp"
#include "scanmill/geometry/spatial/triangle_distance.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill::detail {

namespace {

/// A triangle has no area if its height is below this share of its longest edge. Its normal would be rounding.
constexpr double least_height = 1e-10;
/// Feet within this share of the diagonal of a boundary are on it. Feet have errors of about 1e-14.
constexpr double rounding = 1e-12;
/// Points within this share of the diagonal of their foot are on the surface: the direction from the foot is then
/// partly rounding, and the normal of the triangle takes its place. Both have the same residual except at edges.
constexpr double on_surface = 1e-8;
/// Number of neighbours that determine a plane. They reach as far as 4 spacings. Normals then have so little noise that
/// spheres and cylinders are recognised as undetermined.
constexpr std::size_t neighbours = 50;
/// A plane is used as far beside its point as this neighbour is away, about 2 spacings. The nearest point is at most
/// one spacing beside in a sampled area.
constexpr std::size_t reach_neighbour = 12;
constexpr double least_flatness = 1e-6;  // least flatness of neighbours that determine a plane, as in normals
constexpr std::size_t least_positions = 6;

bool has_area(const Vec3& a, const Vec3& b, const Vec3& c) {
    const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
    return area_vector(a, b, c).norm() > least_height * longest;
}

/// The unit normal in a row of a column with three numbers; zero if it has no direction.
Vec3 normal_in(const Column& column, std::size_t row) {
    const Vec3 normal(column.number(row, 0), column.number(row, 1), column.number(row, 2));
    const double length = normal.stableNorm();
    return length > 0 && std::isfinite(length) ? Vec3(normal / length) : Vec3(Vec3::Zero());
}

/// Whether a row has a normal. Some files have the column, with zeros.
bool has_normal(const Column& column) {
    if (column.components() != 3) return false;
    for (std::size_t row = 0; row < column.rows(); ++row)
        if (normal_in(column, row) != Vec3::Zero()) return true;
    return false;
}

u64 key_of(u32 a, u32 b) { return static_cast<u64>(std::min(a, b)) << 32 | std::max(a, b); }

/// The edges, as keys, that only one triangle has; ascending. `joined` gives each vertex the number of its position.
Array<u64> boundary_edges(const TriangleMesh& mesh, std::span<const u32> joined) {
    Array<u64> keys;
    keys.reserve(3 * mesh.triangles.size());
    for (const Triangle& t : mesh.triangles) {
        const Triangle corners{joined[t[0]], joined[t[1]], joined[t[2]]};
        if (half_edges::has_repeated_vertex(corners)) continue;
        for (std::size_t i = 0; i < 3; ++i) keys.push_back(key_of(corners[i], corners[(i + 1) % 3]));
    }
    std::ranges::sort(keys);
    Array<u64> single;
    for (std::size_t i = 0, next; i < keys.size(); i = next) {
        for (next = i + 1; next < keys.size() && keys[next] == keys[i];) ++next;
        if (next == i + 1) single.push_back(keys[i]);
    }
    return single;
}

}  // namespace

MeshTarget::MeshTarget(const TriangleMesh& mesh, Context& context) {
    diagonal_ = surface_box(mesh).diagonal();
    const PointTree positions(mesh.positions.span(), context.threads());
    const std::span<const u32> joined = positions.index_of_row();
    const Array<u64> edges = boundary_edges(mesh, joined);
    std::vector<bool> has_vertex(positions.positions().size(), false);
    for (const u64 key : edges) has_vertex[key >> 32] = has_vertex[key & ~u32(0)] = true;
    Array<Triangle> kept;
    for (const Triangle& t : mesh.triangles) {
        if (!has_area(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]])) continue;
        kept.push_back(t);
        BoundaryBits bits = 0;
        for (int i = 0; i < 3; ++i) {
            const u32 a = joined[t[i]], b = joined[t[(i + 1) % 3]];
            if (has_vertex[a]) bits |= static_cast<BoundaryBits>(8 << i);
            if (has_vertex[a] && has_vertex[b] && std::ranges::binary_search(edges, key_of(a, b)))
                bits |= static_cast<BoundaryBits>(1 << i);
        }
        boundary_.push_back(bits);
    }
    if (kept.empty())
        throw Error("{} of the target {} no area", count_text(mesh.triangles.size(), "triangle", "triangles"),
                    by_count(mesh.triangles.size(), "has", "have"))
            .hint("wire a surface, or the points of the mesh as `points`");
    tree_ = std::make_unique<TriangleTree>(mesh.positions.span(), kept, context.threads());
}

bool MeshTarget::is_on_boundary(u32 kept, const std::array<Vec3, 3>& corners, const Vec3& point) const {
    const BoundaryBits bits = boundary_[kept];
    if (bits == 0) return false;
    const double near = rounding * diagonal_;
    for (int i = 0; i < 3; ++i) {
        if (bits & (8 << i) && (point - corners[i]).norm() <= near) return true;
        if (bits & (1 << i) && (point - nearest_on_segment(point, corners[i], corners[(i + 1) % 3])).norm() <= near)
            return true;
    }
    return false;
}

Foot MeshTarget::foot(const Vec3& point, Search& search) const {
    const NearestTriangle nearest = tree_->nearest(point, search.hint);
    search.hint = nearest.slot;
    const std::array<Vec3, 3>& corners = tree_->corners(nearest.slot);
    const Vec3 at = tree_->nearest_point(point, nearest.slot), from = point - at;
    Foot foot;
    foot.distance = from.norm();
    foot.normal = area_vector(corners[0], corners[1], corners[2]).normalized();
    const double along = from.dot(foot.normal);
    foot.residual = along;
    if (foot.distance > on_surface * diagonal_) {
        foot.residual = along < 0 ? -foot.distance : foot.distance;
        foot.normal = from / foot.residual;
    }
    foot.is_valid = !is_on_boundary(nearest.triangle, corners, at);
    return foot;
}

PointsTarget::PointsTarget(const PointCloud& cloud, Context& context)
    : tree_(cloud.positions.span(), context.threads()) {
    diagonal_ = robust_box(cloud.positions.span()).diagonal();
    const std::span<const Vec3> positions = tree_.positions();
    if (positions.size() < least_positions)
        throw Error("the target has {}; planes need at least {}",
                    count_text(positions.size(), "position", "different positions"), least_positions)
            .hint("use more points, or a mesh as the target");
    normals_.assign(positions.size(), Vec3::Zero());
    reach_.resize(positions.size());
    const Column* column = cloud.columns.find("normal");
    if (column && !has_normal(*column)) column = nullptr;
    const std::size_t each = std::min(column ? reach_neighbour : neighbours, positions.size() - 1);
    std::atomic<std::size_t> done = 0;
    tree_.for_each_nearest(each, context.threads(), [&](const NeighbourBatch& batch) {
        context.check_cancelled();
        Array<Vec3> offsets;
        for (std::size_t i = 0; i < batch.indices.size(); ++i) {
            const u32 index = batch.indices[i];
            const std::span<const Neighbour> found = batch.of(i);
            reach_[index] = std::sqrt(found[std::min(reach_neighbour, each) - 1].squared);
            if (column) continue;
            offsets.assign(1, Vec3::Zero());
            for (const Neighbour& neighbour : found) offsets.push_back(positions[neighbour.index] - positions[index]);
            const Scatter scatter = scatter_of(offsets);
            if (scatter.flatness >= least_flatness) normals_[index] = scatter.normal;
        }
        context.progress(0.2 * static_cast<double>(done += batch.indices.size()) /
                         static_cast<double>(positions.size()));
    });
    if (!column) return;
    const std::span<const u32> index_of_row = tree_.index_of_row();
    for (std::size_t row = 0; row < cloud.size(); ++row) {
        Vec3& at_position = normals_[index_of_row[row]];
        if (at_position.isZero(0)) at_position = normal_in(*column, row);
    }
}

Foot PointsTarget::foot(const Vec3& point, Search& search) const {
    const Neighbour nearest = tree_.nearest_to(point, 1, search.buffer)[0];
    const Vec3 from = point - tree_.positions()[nearest.index];
    Foot foot;
    foot.distance = std::sqrt(nearest.squared);
    foot.normal = normals_[nearest.index];
    foot.residual = from.dot(foot.normal);
    const double beside = (from - foot.residual * foot.normal).norm();
    foot.is_valid = !foot.normal.isZero(0) && beside <= reach_[nearest.index];
    return foot;
}

}  // namespace scanmill::detail
