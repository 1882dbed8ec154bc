// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/mesh/feature_lines.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/geometry/mesh/boundary_loops.hpp"
#include "scanmill/geometry/mesh/facet_normals.hpp"
#include "scanmill/geometry/mesh/feature_net.hpp"
#include "scanmill/geometry/mesh/half_edges.hpp"
#include "scanmill/geometry/spatial/angle.hpp"

namespace scanmill {

namespace {

void require_sound(const FeatureParams& params) {
    const auto require_angle = [](const char* name, const Angle& angle) {
        if (!(angle.in_radians() >= 0 && angle.in_degrees() <= 180))
            throw Error("{} must be from 0 to 180 deg; it is {}", name, angle.text());
    };
    require_angle("sharp-angle", params.sharp_angle);
    require_angle("corner-angle", params.corner_angle);
    const double length = params.min_length.value();
    if (!(length >= 0 && std::isfinite(length))) throw Error("min-length must be 0 or more; it is {} u", length);
}

void require_measurable(const TriangleMesh& mesh) {
    for (u32 t = 0; t < mesh.triangles.size(); ++t)
        for (const u32 vertex : mesh.triangles[t])
            if (!mesh.positions[vertex].allFinite())
                throw Error("vertex {} of triangle {} is not finite; features need the position of every vertex",
                            vertex, t)
                    .hint("remove the triangles at such vertices");
}

/// Marks both sides of the mesh's own sharp edges; those on the boundary are feature lines anyhow.
void mark_own(const TriangleMesh& mesh, std::span<const u32> opposite, std::vector<bool>& sharp) {
    if (mesh.sharp_edges.empty()) return;
    struct Own {
        Edge edge;
        bool found;
    };
    std::vector<Own> own;
    for (const Edge& edge : mesh.sharp_edges) own.push_back({make_edge(edge[0], edge[1]), false});
    std::ranges::sort(own, {}, &Own::edge);
    for (u32 half_edge = 0; half_edge < opposite.size(); ++half_edge) {
        if (opposite[half_edge] == half_edges::no_half_edge) continue;
        const Edge edge = make_edge(half_edges::start(mesh, half_edge), half_edges::end(mesh, half_edge));
        for (auto it = std::ranges::lower_bound(own, edge, {}, &Own::edge); it != own.end() && it->edge == edge; ++it) {
            it->found = true;
            sharp[half_edge] = opposite[half_edge] != half_edges::boundary;
        }
    }
    const auto missing = std::ranges::count(own, false, &Own::found);
    if (missing == 0) return;
    const Edge& first = std::ranges::find(own, false, &Own::found)->edge;
    throw Error("{} of the mesh's {} {} of no triangle; the first is between vertices {} and {}", missing,
                count_text(own.size(), "sharp edge", "sharp edges"),
                by_count(static_cast<std::size_t>(missing), "is an edge", "are edges"), first[0], first[1])
        .hint("write the mesh again with the sharp edges of its own triangles, or without any");
}

std::vector<bool> sharp_half_edges(const TriangleMesh& mesh, std::span<const u32> opposite,
                                   std::span<const Vec3> normals, double sharp_angle, unsigned threads) {
    Array<u8> bends(opposite.size());
    constexpr std::size_t chunk = 3 << 13;
    for_each_chunk(threads, opposite.size(), chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t half_edge = begin; half_edge < end; ++half_edge) {
            const u32 other = opposite[half_edge];
            bends[half_edge] = other < half_edges::no_half_edge &&
                               angle_between(normals[half_edge / 3], normals[other / 3]) > sharp_angle;
        }
    });
    std::vector<bool> sharp(bends.begin(), bends.end());
    mark_own(mesh, opposite, sharp);
    return sharp;
}

double length_of(const TriangleMesh& mesh, std::span<const u32> half_edges) {
    double length = 0;
    for (const u32 half_edge : half_edges)
        length +=
            (mesh.positions[half_edges::end(mesh, half_edge)] - mesh.positions[half_edges::start(mesh, half_edge)])
                .norm();
    return length;
}

/// Unmarks the creases that are too short; returns how many.
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

/// Returns the number of loops whose area does not tell what they are. Pre: the loops come first.
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

FeatureGraph graph_of(const TriangleMesh& mesh, std::span<const u32> opposite, std::span<const Vec3> normals,
                      const FeatureNet& net, std::span<const FeatureLine> lines) {
    FeatureGraph graph;
    graph.frame = mesh.frame;
    graph.positions = gather(mesh.positions, net.vertices());
    Array<u32> vertices, corners;
    Array<Vec3> left, right;
    for (const FeatureLine& line : lines) {
        const u32 begin = static_cast<u32>(vertices.size());
        for (const u32 half_edge : line.half_edges) {
            vertices.push_back(net.number_at_start(half_edge));
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

FeatureLines find_features(const TriangleMesh& mesh, const FeatureParams& params, unsigned threads) {
    require_sound(params);
    const Array<u32> opposite = half_edges::opposites(mesh);
    require_measurable(mesh);
    const FacetNormals normals = facet_normals(mesh, opposite, threads);
    const double corner_angle = params.corner_angle.in_radians() + angle_tie;
    std::vector<bool> sharp =
        sharp_half_edges(mesh, opposite, normals.unit, params.sharp_angle.in_radians() + angle_tie, threads);

    FeatureLines result;
    FeatureCounts& counts = result.counts;
    counts.without_area = normals.without_area;
    std::optional<FeatureNet> net(std::in_place, mesh, opposite, sharp, corner_angle);
    std::vector<FeatureLine> lines = net->lines();
    counts.dropped = drop_short(mesh, opposite, lines, params.min_length.value(), sharp);
    if (counts.dropped > 0) {
        net.emplace(mesh, opposite, sharp, corner_angle);
        lines = net->lines();
    }
    counts.ambiguous = classify_loops(mesh, opposite, normals.unit, lines);
    result.graph = graph_of(mesh, opposite, normals.unit, *net, lines);

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
        sentences.push_back(count_text(counts.without_area, "triangle", "triangles") +
                            " without area: counted to a neighbour's plane");
    if (counts.ambiguous > 0)
        sentences.push_back(count_text(counts.ambiguous, "boundary loop", "boundary loops") +
                            " whose area does not tell outer boundaries from holes: the longest of a piece was taken "
                            "for its outer boundary");
    return sentences;
}

}  // namespace scanmill
