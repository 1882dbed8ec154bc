// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/mesh/feature_lines.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <optional>
#include <tuple>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/geometry/mesh/boundary_loops.hpp"
#include "scanmill/geometry/mesh/creases.hpp"
#include "scanmill/geometry/mesh/facet_normals.hpp"
#include "scanmill/geometry/mesh/noisy_normals.hpp"
#include "scanmill/geometry/spatial/angle.hpp"
#include "scanmill/geometry/spatial/lists.hpp"

namespace scanmill {

namespace {

/// A chain of half-edges: each starts where the previous one ends. If closed, the last one ends where the first starts.
struct FeatureLine {
    FeatureType type;
    bool closed;
    Array<u32> half_edges;
};

/// The boundary and sharp edges of a mesh as a graph of numbered vertices, divided into lines.
class FeatureNet {
public:
    /// `sharp`: whether the edge of a half-edge is sharp; equal for opposite half-edges, false on the boundary.
    /// `reach`: distance on each side of a vertex over which the turn of a crease is measured.
    FeatureNet(const TriangleMesh& mesh, std::span<const u32> opposite, const std::vector<bool>& sharp,
               double corner_angle, double reach)
        : mesh_(mesh),
          opposite_(opposite),
          loops_(boundary_loops(mesh, opposite)) {
        number_vertices(sharp);
        find_creases(sharp);
        find_corners(corner_angle, reach);
        for (Array<u32>& loop : loops_) start_at_lowest(loop);
    }

    /// The mesh's vertex of every number; numbers ascend by position, then by vertex.
    std::span<const u32> vertices() const { return vertices_; }
    u32 number_at_start(u32 half_edge) const { return number_[half_edges::start(mesh_, half_edge)]; }
    u32 number_at_end(u32 half_edge) const { return number_[half_edges::end(mesh_, half_edge)]; }
    bool is_corner(u32 number) const { return is_corner_[number]; }

    /// Returns the boundary loops, then the creases. Loops and creases are each sorted by the numbers of their first
    /// two vertices. All loops have the preliminary type outer boundary.
    std::vector<FeatureLine> lines() const {
        std::vector<FeatureLine> lines;
        for (const Array<u32>& loop : loops_) lines.push_back({FeatureType::outer_boundary, true, loop});
        std::vector<bool> visited(opposite_.size(), false);
        for (const bool at_corners : {true, false})  // then closed creases without corners, from their lowest vertex
            for (u32 number = 0; number < vertices_.size(); ++number) {
                if (is_corner_[number] != at_corners) continue;
                for (const Crease& crease : creases_[number])
                    if (!visited[crease.half_edge]) lines.push_back(crease_from(crease, visited));
            }
        std::ranges::sort(lines, {}, [&](const FeatureLine& line) {
            return std::tuple(line.type, number_at_start(line.half_edges[0]), number_at_end(line.half_edges[0]));
        });
        return lines;
    }

private:
    struct Crease {
        u32 end;  ///< number of the vertex where the sharp edge ends
        u32 half_edge;
    };

    void number_vertices(const std::vector<bool>& sharp) {
        constexpr u32 none = ~u32(0);
        number_.assign(mesh_.positions.size(), none);
        for (u32 half_edge = 0; half_edge < opposite_.size(); ++half_edge) {
            if (opposite_[half_edge] != half_edges::boundary && !sharp[half_edge]) continue;
            for (const u32 vertex : {half_edges::start(mesh_, half_edge), half_edges::end(mesh_, half_edge)}) {
                if (number_[vertex] == none) vertices_.push_back(vertex);
                number_[vertex] = 0;
            }
        }
        std::ranges::sort(vertices_, {}, [&](u32 vertex) {
            const Vec3& p = mesh_.positions[vertex];
            return std::tuple(p.x(), p.y(), p.z(), vertex);
        });
        for (u32 number = 0; number < vertices_.size(); ++number) number_[vertices_[number]] = number;
    }

    /// Lists every sharp edge twice, at each of its vertices with the half-edge that starts at this vertex.
    void find_creases(const std::vector<bool>& sharp) {
        creases_ = Lists<Crease>(vertices_.size(), [&](auto&& add) {
            for (u32 half_edge = 0; half_edge < opposite_.size(); ++half_edge)
                if (sharp[half_edge]) add(number_at_start(half_edge), {number_at_end(half_edge), half_edge});
        });
        for (std::size_t number = 0; number < vertices_.size(); ++number)
            std::ranges::sort(creases_[number], {}, &Crease::end);
    }

    const Vec3& position(u32 number) const { return mesh_.positions[vertices_[number]]; }

    /// Follows a line of creases from `from` on, first along `crease`, and calls visit with the number of every vertex
    /// reached. Ends at the first vertex that is at least `reach` away from `from` or that is not between two creases.
    /// Also ends on returning to `from`.
    template <class Visit>
    void walk(u32 from, Crease crease, double reach, Visit&& visit) const {
        while (crease.end != from) {
            visit(crease.end);
            const std::span<const Crease> two = creases_[crease.end];
            if (two.size() != 2 || !((position(crease.end) - position(from)).norm() < reach)) return;
            crease = two[0].half_edge == opposite_[crease.half_edge] ? two[1] : two[0];
        }
    }

    bool turns(u32 before, u32 at, u32 after, double corner_angle) const {
        const Vec3& here = mesh_.positions[vertices_[at]];
        const Vec3 arriving = here - mesh_.positions[vertices_[before]],
                   leaving = mesh_.positions[vertices_[after]] - here;
        return angle_between(arriving, leaving) > corner_angle;
    }

    void find_corners(double corner_angle, double reach) {
        Array<u32> boundary_edges(vertices_.size(), 0);
        for (const Array<u32>& loop : loops_)
            for (const u32 half_edge : loop) {
                ++boundary_edges[number_at_start(half_edge)];
                ++boundary_edges[number_at_end(half_edge)];
            }
        is_corner_.assign(vertices_.size(), false);
        Array<double> angles(vertices_.size(), 0.0);  // turn of the line at every vertex between two creases
        for (u32 number = 0; number < vertices_.size(); ++number) {
            const std::span<const Crease> creases = creases_[number];
            is_corner_[number] = creases.size() + boundary_edges[number] != 2;
            if (is_corner_[number] || creases.size() != 2) continue;
            const Vec3& here = position(number);
            const auto far_end = [&](const Crease& crease) {
                u32 end = crease.end;
                walk(number, crease, reach, [&](u32 next) { end = next; });
                return position(end);
            };
            angles[number] = angle_between(here - far_end(creases[0]), far_end(creases[1]) - here);
        }
        for (u32 number = 0; number < vertices_.size(); ++number) {
            if (!(angles[number] > corner_angle)) continue;
            bool is_largest = true;  // ties: the lower number
            for (const Crease& crease : creases_[number])
                walk(number, crease, reach, [&](u32 other) {
                    const bool is_near = (position(other) - position(number)).norm() < reach;
                    if (is_near && std::pair(-angles[other], other) < std::pair(-angles[number], number))
                        is_largest = false;
                });
            if (is_largest) is_corner_[number] = true;
        }
        for (const Array<u32>& loop : loops_)
            for (std::size_t i = 0; i < loop.size(); ++i) {
                const u32 arriving = loop[i], leaving = loop[i + 1 == loop.size() ? 0 : i + 1];
                const u32 here = number_at_start(leaving);
                if (turns(number_at_start(arriving), here, number_at_end(leaving), corner_angle))
                    is_corner_[here] = true;
            }
    }

    void start_at_lowest(Array<u32>& loop) const {
        const auto rank = [&](u32 half_edge) {
            const u32 start = number_at_start(half_edge);
            return std::tuple(!is_corner_[start], start, number_at_end(half_edge));
        };
        std::ranges::rotate(loop, std::ranges::min_element(loop, {}, rank));
    }

    FeatureLine crease_from(const Crease& first, std::vector<bool>& visited) const {
        FeatureLine line{FeatureType::crease, false, {}};
        const u32 begin = number_at_start(first.half_edge);
        for (Crease crease = first;;) {
            assert(!visited[crease.half_edge]);
            visited[crease.half_edge] = visited[opposite_[crease.half_edge]] = true;
            line.half_edges.push_back(crease.half_edge);
            line.closed = crease.end == begin;
            if (line.closed || is_corner_[crease.end]) return line;
            const std::span<const Crease> two = creases_[crease.end];
            crease = two[0].half_edge == opposite_[crease.half_edge] ? two[1] : two[0];
        }
    }

    const TriangleMesh& mesh_;
    std::span<const u32> opposite_;
    Array<u32> vertices_;
    Array<u32> number_;  // number of every vertex of the mesh
    Lists<Crease> creases_;  // by the number of the start vertex; each list by `end`
    std::vector<Array<u32>> loops_;
    std::vector<bool> is_corner_;
};

void require_sound(const FeatureParams& params) {
    const auto require_angle = [](const char* name, const Angle& angle) {
        if (!(angle.in_radians() >= 0 && angle.in_degrees() <= 180))
            throw Error("{} must be from 0 to 180 deg; it is {}", name, angle.text());
    };
    require_angle("sharp-angle", params.sharp_angle);
    require_angle("corner-angle", params.corner_angle);
    const double length = params.min_length.value();
    if (!(length >= 0 && std::isfinite(length))) throw Error("min-length must be 0 or more; it is {} u", length);
    if (!params.noise) return;
    const double noise = params.noise->value();
    if (!(noise >= 0 && std::isfinite(noise))) throw Error("noise must be 0 or more; it is {} u", noise);
}

void require_measurable(const TriangleMesh& mesh) {
    for (u32 t = 0; t < mesh.triangles.size(); ++t)
        for (const u32 vertex : mesh.triangles[t])
            if (!mesh.positions[vertex].allFinite())
                throw Error("vertex {} of triangle {} is not finite; features need the position of every vertex",
                            vertex, t)
                    .hint("remove the triangles at such vertices");
}

double length_of(const TriangleMesh& mesh, std::span<const u32> half_edges) {
    double length = 0;
    for (const u32 half_edge : half_edges)
        length +=
            (mesh.positions[half_edges::end(mesh, half_edge)] - mesh.positions[half_edges::start(mesh, half_edge)])
                .norm();
    return length;
}

/// Unmarks the edges of the creases shorter than `min_length`; returns the number of these creases.
std::size_t drop_short(const TriangleMesh& mesh, std::span<const u32> opposite, std::span<const FeatureLine> lines,
                       double min_length, std::vector<bool>& sharp) {
    std::size_t dropped = 0;
    for (const FeatureLine& line : lines) {
        if (line.type != FeatureType::crease || !(length_of(mesh, line.half_edges) < min_length)) continue;
        ++dropped;
        for (const u32 half_edge : line.half_edges) sharp[half_edge] = sharp[opposite[half_edge]] = false;
    }
    return dropped;
}

/// Sets the type of the loops; returns the number of loops whose area does not decide it. Pre: loops precede creases.
std::size_t classify_loops(const TriangleMesh& mesh, std::span<const u32> opposite, std::span<const Vec3> normals,
                           std::vector<FeatureLine>& lines) {
    std::vector<std::span<const u32>> loops;
    std::vector<LoopShape> shapes;
    for (const FeatureLine& line : lines) {
        if (line.type == FeatureType::crease) break;
        loops.emplace_back(line.half_edges);
        shapes.push_back(loop_shape(mesh, line.half_edges, normals));
    }
    const std::vector<bool> outer = outer_loops(loops, shapes, opposite);
    for (std::size_t i = 0; i < outer.size(); ++i)
        lines[i].type = outer[i] ? FeatureType::outer_boundary : FeatureType::hole;
    std::ranges::stable_sort(lines, {}, &FeatureLine::type);
    return static_cast<std::size_t>(std::ranges::count(shapes, false, &LoopShape::clear));
}

/// The half-edge of the line nearest to number `i` where the normals of the two sides differ, at most a gap away; the
/// earlier one of two. `i` itself if there is none.
u32 nearest_with_turn(const FeatureLine& line, std::size_t i, std::span<const u32> opposite,
                      std::span<const Vec3> normals) {
    const auto turns = [&](std::size_t at) {
        const u32 half_edge = line.half_edges[at];
        return angle_between(normals[half_edge / 3], normals[opposite[half_edge] / 3]) > angle_tie;
    };
    for (std::size_t distance = 0; distance <= most_gap_edges; ++distance) {
        if (distance <= i && turns(i - distance)) return line.half_edges[i - distance];
        if (i + distance < line.half_edges.size() && turns(i + distance)) return line.half_edges[i + distance];
    }
    return line.half_edges[i];
}

/// `closes_gaps`: creases may have edges without a turn, which close gaps. The normals there are those of the nearest
/// edge of the line with a turn.
FeatureGraph graph_of(const TriangleMesh& mesh, std::span<const u32> opposite, std::span<const Vec3> normals,
                      bool closes_gaps, const FeatureNet& net, std::span<const FeatureLine> lines) {
    FeatureGraph graph;
    graph.frame = mesh.frame;
    graph.positions = gather(mesh.positions, net.vertices());
    Array<u32> vertices, corners;
    Array<Vec3> left, right;
    for (const FeatureLine& line : lines) {
        const u32 begin = static_cast<u32>(vertices.size());
        for (std::size_t i = 0; i < line.half_edges.size(); ++i) {
            vertices.push_back(net.number_at_start(line.half_edges[i]));
            const u32 half_edge = line.type == FeatureType::crease && closes_gaps
                                      ? nearest_with_turn(line, i, opposite, normals)
                                      : line.half_edges[i];
            left.push_back(normals[half_edge / 3]);
            right.push_back(line.type == FeatureType::crease ? normals[opposite[half_edge] / 3] : Vec3(Vec3::Zero()));
        }
        if (!line.closed) {
            vertices.push_back(net.number_at_end(line.half_edges.back()));
            left.push_back(Vec3::Zero());
            right.push_back(Vec3::Zero());
        }
        graph.polylines.push_back({line.type, line.closed, begin, static_cast<u32>(vertices.size())});
    }
    for (u32 number = 0; number < net.vertices().size(); ++number)
        if (net.is_corner(number)) corners.push_back(number);
    graph.vertices = std::move(vertices);
    graph.left_normals = std::move(left);
    graph.right_normals = std::move(right);
    graph.corners = std::move(corners);
    return graph;
}

}  // namespace

FeatureLines find_features(const TriangleMesh& mesh, const FeatureParams& params, const Execution& execution) {
    require_sound(params);
    const Array<u32> opposite = half_edges::opposites(mesh);
    require_measurable(mesh);
    const CreaseParams crease_params{
        .sharp_angle = params.sharp_angle.in_radians(),
        .noise = params.noise ? params.noise->value() : vertex_noise(mesh, opposite, execution),
        .least_size = 0,
        .exact_declared = params.exact_declared,
    };
    Creases creases = find_creases(mesh, opposite, crease_params, execution);
    std::vector<bool>& sharp = creases.sharp;
    const double corner_angle = params.corner_angle.in_radians() + angle_tie;

    execution.check_cancelled();
    FeatureLines result;
    result.noise = creases.noise;
    FeatureCounts& counts = result.counts;
    counts.unreliable = creases.unreliable;
    counts.without_area = creases.without_area;
    std::optional<FeatureNet> net(std::in_place, mesh, opposite, sharp, corner_angle, creases.reach);
    std::vector<FeatureLine> lines = net->lines();
    counts.dropped = drop_short(mesh, opposite, lines, params.min_length.value(), sharp);
    if (counts.dropped > 0) {
        net.emplace(mesh, opposite, sharp, corner_angle, creases.reach);
        lines = net->lines();
    }
    counts.ambiguous = classify_loops(mesh, opposite, creases.normals, lines);
    result.graph = graph_of(mesh, opposite, creases.normals, creases.reach > 0, *net, lines);
    result.mesh_vertices.assign(net->vertices().begin(), net->vertices().end());

    const auto count = [&](FeatureType type) {
        return static_cast<std::size_t>(std::ranges::count(lines, type, &FeatureLine::type));
    };
    counts.creases = count(FeatureType::crease);
    counts.holes = count(FeatureType::hole);
    counts.boundaries = count(FeatureType::outer_boundary);
    counts.corners = result.graph.corners.size();
    return result;
}

std::vector<std::string> doubts(const FeatureCounts& counts) {
    std::vector<std::string> sentences;
    if (counts.without_area > 0)
        sentences.push_back(count_text(counts.without_area, "triangle has no area and takes the normal of a neighbour",
                                       "triangles have no area and take the normals of neighbours"));
    if (counts.ambiguous > 0)
        sentences.push_back("the area of " + count_text(counts.ambiguous, "boundary loop", "boundary loops") +
                            " does not decide between outer boundary and hole; such a loop is an outer boundary if it "
                            "is the longest loop of its component, otherwise a hole");
    return sentences;
}

}  // namespace scanmill
