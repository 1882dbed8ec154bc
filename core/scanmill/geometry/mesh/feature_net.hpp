// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The boundary and sharp edges of a mesh as a net of numbered vertices, and the lines that it falls into. Inner part
/// of geometry/feature_lines.hpp, which says what comes out.

#include <span>
#include <vector>

#include "scanmill/data/features.hpp"
#include "scanmill/data/mesh.hpp"

namespace scanmill {

/// Sides in a row, each beginning where the one before ends; when closed, the last ends where the first begins.
struct FeatureLine {
    FeatureType type;
    bool closed;
    Array<u32> half_edges;
};

class FeatureNet {
public:
    /// `sharp`: for every side whether its edge is a crease; equal for opposite half-edges, false on the boundary.
    FeatureNet(const TriangleMesh& mesh, std::span<const u32> twins, const std::vector<bool>& sharp,
               double corner_angle);

    /// Vertices of the mesh by their number here: by place, then by number in the mesh.
    std::span<const u32> vertices() const { return vertices_; }
    u32 number_at_start(u32 half_edge) const;
    u32 number_at_end(u32 half_edge) const;
    /// By number, whether the vertex is a corner.
    bool is_corner(u32 number) const { return is_corner_[number]; }

    /// The boundary loops (as outer boundaries: their type is not looked at), then the creases; each kind by the
    /// numbers of the first two vertices.
    std::vector<FeatureLine> lines() const;

private:
    struct Crease {
        u32 end;  ///< number
        u32 half_edge;
    };
    void number_vertices(const std::vector<bool>& sharp);
    void find_creases(const std::vector<bool>& sharp);
    void find_corners(double corner_angle);
    std::span<const Crease> creases_at(u32 number) const;
    bool turns(u32 before, u32 at, u32 after, double corner_angle) const;
    FeatureLine crease_from(const Crease& first, std::vector<bool>& seen) const;
    void begin_at_the_lowest(Array<u32>& loop) const;

    const TriangleMesh& mesh_;
    std::span<const u32> opposite_;
    Array<u32> vertices_;
    Array<u32> number_;          // by vertex of the mesh
    Array<u32> begin_;           // by number, and one more: into creases_
    Array<Crease> creases_;      // leaving a vertex, by the number at their end
    Array<u32> boundary_edges_;  // by number
    std::vector<Array<u32>> loops_;
    std::vector<bool> is_corner_;
};

}  // namespace scanmill
