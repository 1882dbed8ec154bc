// SPDX-License-Identifier: GPL-3.0-or-later
#include "decimate/corner_normals.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "scanmill/geometry/spatial/angle.hpp"

namespace scanmill::decimating {

namespace {

/// Sectors of the original surface around one vertex at a time.
class Sectors {
public:
    Sectors(const Surface& surface, const TriangleMesh& original, std::span<const u32> opposite, const Creases& creases)
        : surface_(surface),
          features_(surface.original.features()),
          original_(original),
          opposite_(opposite),
          creases_(creases) {}

    /// Finds the sectors at the vertex. The first one begins at the vertex's first feature edge, if it has any.
    void find(u32 vertex) {
        sums_.clear();
        ends_.clear();
        const Array<Vec3>& normals =
            features_.vertex_class(vertex) == VertexClass::smooth ? creases_.own_normals : creases_.normals;
        u32 half_edge = features_.first(vertex);
        // An open fan begins at its boundary edge. In a closed fan, the search moves on to a feature edge.
        if (opposite_[half_edge] != half_edges::boundary) {
            const u32 begin = half_edge;
            while (!features_.is_feature(half_edge)) {
                half_edge = opposite_[half_edges::before(half_edge)];
                if (half_edge == begin) break;
            }
        }
        const auto is_left = [&](u32 other) { return surface_.mesh().is_used(other); };
        const u32 begin = half_edge;
        do {
            const u32 next = half_edges::end(original_, half_edge);
            if (sums_.empty() || features_.is_feature(half_edge)) {
                sums_.push_back(Vec3::Zero());
                if (features_.is_feature(half_edge))
                    ends_.push_back(features_.follow_line(vertex, next, is_left, [](u32) {}));
            }
            const Vec3& centre = original_.positions[vertex];
            const u32 last = half_edges::start(original_, half_edges::before(half_edge));
            const double angle = angle_between(original_.positions[next] - centre, original_.positions[last] - centre);
            sums_.back() += angle * normals[half_edge / 3];
            half_edge = opposite_[half_edges::before(half_edge)];
        } while (half_edge != half_edges::boundary && half_edge != begin);
        for (Vec3& sum : sums_) {
            sum.normalize();
            if (features_.is_singular(vertex)) sum.setZero();
        }
    }

    /// Calls action(half-edge of the new mesh, normal) for every corner at the vertex. Pre: find() for this vertex.
    template <class Action>
    void for_each_corner(u32 vertex, Action&& action) {
        const EditableMesh& mesh = surface_.mesh();
        corners_.clear();
        mesh.for_each_around(vertex, [&](u32 half_edge) {
            const bool begins_sector = !ends_.empty() && surface_.is_feature(half_edge);
            corners_.push_back({half_edge, begins_sector});
        });
        if (ends_.empty()) {
            for (const Corner& corner : corners_) action(corner.half_edge, sums_[0]);
            return;
        }
        std::ranges::rotate(corners_, std::ranges::find(corners_, true, &Corner::begins_sector));
        // Finds the original sector at which the new sectors begin: from there on, old and new feature edges lead to
        // the same vertices in order.
        std::vector<u32> new_ends;
        for (const Corner& corner : corners_)
            if (corner.begins_sector) new_ends.push_back(mesh.end(corner.half_edge));
        std::size_t first = 0;
        for (std::size_t shift = 0; shift < ends_.size(); ++shift) {
            bool is_same = new_ends.size() == ends_.size();
            for (std::size_t i = 0; is_same && i < ends_.size(); ++i)
                is_same = new_ends[i] == ends_[(i + shift) % ends_.size()];
            if (!is_same) continue;
            first = shift;
            break;
        }
        std::size_t sector = first + sums_.size() - 1;
        for (const Corner& corner : corners_) {
            if (corner.begins_sector) ++sector;
            action(corner.half_edge, sums_[sector % sums_.size()]);
        }
    }

private:
    struct Corner {
        u32 half_edge;
        bool begins_sector;
    };

    const Surface& surface_;
    const FeatureNetwork& features_;
    const TriangleMesh& original_;
    std::span<const u32> opposite_;
    const Creases& creases_;
    std::vector<Vec3> sums_;  ///< by sector
    /// For each feature edge that begins a sector, the remaining vertex to which its line leads.
    std::vector<u32> ends_;
    std::vector<Corner> corners_;
};

}  // namespace

Array<CornerNormals> corner_normals(const Surface& surface, const TriangleMesh& original, std::span<const u32> opposite,
                                    const Creases& creases) {
    const EditableMesh& mesh = surface.mesh();
    Array<u32> numbers(mesh.rows());
    u32 count = 0;
    for (u32 row = 0; row < mesh.rows(); ++row) numbers[row] = mesh.is_empty(row) ? EditableMesh::none : count++;
    Array<CornerNormals> result(count);
    Sectors sectors(surface, original, opposite, creases);
    for (u32 vertex = 0; vertex < mesh.vertices(); ++vertex) {
        if (!mesh.is_used(vertex)) continue;
        sectors.find(vertex);
        sectors.for_each_corner(vertex, [&](u32 half_edge, const Vec3& normal) {
            for (int axis = 0; axis < 3; ++axis)
                result[numbers[half_edge / 3]][3 * (half_edge % 3) + static_cast<u32>(axis)] = normal[axis];
        });
    }
    return result;
}

}  // namespace scanmill::decimating
