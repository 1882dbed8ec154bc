// SPDX-License-Identifier: GPL-3.0-or-later
#include "a_patch/checks.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "scanmill/base/parallel.hpp"
#include "scanmill/geometry/distance/self_intersections.hpp"
#include "scanmill/geometry/patches/a_patch.hpp"
#include "tessellate/tessellate.hpp"

namespace scanmill::a_patches {

namespace {

constexpr std::size_t chunk = 1024;

/// Samples tetrahedra with two functions. Checks whether every line from the mesh to an apex, or to the segment between
/// two apexes, meets the surface once. Also checks whether a triangle's own function alone determines the surface where
/// the tetrahedron meets the triangle's other thirds.
class CreaseCheck {
public:
    explicit CreaseCheck(const PatchComplex& patches) : patches_(patches) {}

    /// Checks the tetrahedron of a row together with its partner.
    bool is_sound(u32 row) const {
        if (patches_.partners[row] == PatchComplex::no_partner || patches_.partners[row] > row) return true;
        return patches_.kinds[row] == PatchKind::sharp ? is_sound_gap(row) : is_sound_third(row);
    }

private:
    static constexpr int steps = 16, parts = 32;  // intervals of a line, and of the segment between two apexes
    static constexpr double rounding = 1e-12;  // share of the largest weight
    /// Distances from either end of an edge at which lines begin, as shares of its length. Creases deviate most near
    /// the ends.
    static constexpr std::array shares = {0.001, 0.003, 0.01, 0.02, 0.04, 0.08, 0.12, 0.17,
                                          0.21,  0.25,  0.29, 0.33, 0.37, 0.42, 0.46, 0.5};

    using Cubic = std::array<double, 4>;

    /// The apexes of a tetrahedron beside an edge.
    inline static const Barycentric first = Barycentric::Unit(3), second = Barycentric::Unit(0);

    static double value_of(const Cubic& c, double t) {
        const double s = 1 - t;
        return s * s * (s * c[0] + 3 * t * c[1]) + t * t * (3 * s * c[2] + t * c[3]);
    }

    /// The function along lines from a point to the segment between the apexes.
    class Fan {
    public:
        Fan(const PatchWeights& w, const Barycentric& from, const Cubic& between)
            : at_point_(patch_blossom(w, from, from, from)),
              towards_{patch_blossom(w, from, from, first), patch_blossom(w, from, from, second)},
              beyond_{patch_blossom(w, from, first, first), patch_blossom(w, from, first, second),
                      patch_blossom(w, from, second, second)},
              between_(between) {}

        Cubic line_to(double share) const {
            const double s = 1 - share;
            return {at_point_, s * towards_[0] + share * towards_[1],
                    s * s * beyond_[0] + 2 * s * share * beyond_[1] + share * share * beyond_[2],
                    value_of(between_, share)};
        }

    private:
        double at_point_;
        std::array<double, 2> towards_;
        std::array<double, 3> beyond_;
        const Cubic& between_;  ///< weights of the function on the segment between the apexes
    };

    double largest_weight(u32 row) const {
        double largest = 0;
        for (const u32 each : {row, patches_.partners[row]})
            for (const double weight : patches_.weights[each]) largest = std::max(largest, std::abs(weight));
        return largest;
    }

    /// Whether the weights, times `sign`, change their sign at most once: from negative to positive.
    static bool rises(const Cubic& c, double sign) {
        bool is_above = false;
        for (const double weight : c) {
            if (is_above && sign * weight < 0) return false;
            is_above = is_above || sign * weight > 0;
        }
        return true;
    }

    /// Whether the combined function, times the sign of the side, becomes positive along the line and does not become
    /// negative afterwards. `one` and `other` are the weights of the two functions on the line.
    bool is_single(u32 row, const Cubic& one, const Cubic& other, double least) const {
        const double sign = patches_.sides[row] == 1 ? 1 : -1;
        const auto combined = [&](double a, double b) {
            return sign * (patches_.combine[row] == Combine::max ? std::max(a, b) : std::min(a, b));
        };
        if (combined(one[3], other[3]) > least && rises(one, sign) && rises(other, sign)) return true;
        bool is_above = false;
        for (int step = 0; step <= steps; ++step) {
            const double t = static_cast<double>(step) / steps, found = combined(value_of(one, t), value_of(other, t));
            if (is_above && found < -least) return false;
            is_above = is_above || found > least;
        }
        return is_above;
    }

    bool is_sound_gap(u32 row) const {
        const double least = rounding * largest_weight(row);
        if (!is_sound_end(row, 1) || !is_sound_end(row, 2)) return false;
        const PatchWeights &own = patches_.weights[row], &partner = patches_.weights[patches_.partners[row]];
        const Cubic between = patch_along(own, first, second), of_partner = patch_along(partner, first, second);
        for (const double share : shares)
            for (const double from : {share, 1 - share}) {
                const Fan one(own, {0, 1 - from, from, 0}, between), other(partner, {0, from, 1 - from, 0}, of_partner);
                for (int part = 0; part <= parts; ++part) {
                    const double to = static_cast<double>(part) / parts;
                    if (!is_single(row, one.line_to(to), other.line_to(1 - to), least)) return false;
                }
            }
        return true;
    }

    /// Near an end of a curved sharp edge, the function is that of the two tangent planes. On the segment between the
    /// apexes it must have the sign of the side.
    bool is_sound_end(u32 row, int corner) const {
        const PatchWeights& w = patches_.weights[row];
        const PatchWeights& partner = patches_.weights[patches_.partners[row]];
        const Barycentric end = Barycentric::Unit(corner), mirrored = Barycentric::Unit(3 - corner);
        const double sign = patches_.sides[row] == 1 ? 1 : -1, least = rounding * largest_weight(row);
        for (int part = 0; part <= parts; ++part) {
            const double across = static_cast<double>(part) / parts;
            const Barycentric to(across, 0, 0, 1 - across);
            const double one = patch_blossom(w, end, end, to),
                         other = patch_blossom(partner, mirrored, mirrored, to.reverse());
            if (sign * (patches_.combine[row] == Combine::max ? std::max(one, other) : std::min(one, other)) < -least)
                return false;
        }
        return true;
    }

    /// Pre: `row` is the continuation, and its partner is the tetrahedron over the triangle.
    bool is_sound_third(u32 row) const {
        constexpr int grid = 12;
        const double least = rounding * largest_weight(row);
        const Barycentric apex(0, 0, 0, 1);
        const u32 own = patches_.partners[row];
        for (int i = 0; i < grid; ++i)
            for (int j = 0; i + j <= grid && j < grid; ++j) {
                const Barycentric from = Barycentric(grid - i - j, i, j, 0) / grid;
                if (!is_single(row, patch_along(patches_.weights[row], from, apex),
                               patch_along(patches_.weights[own], from, apex), least))
                    return false;
            }
        const double side = patches_.sides[row] == 1 ? 1 : -1, sign = patches_.combine[row] == Combine::max ? 1 : -1;
        for (const int corner : {1, 2})
            for (const double share : {0.0, 0.25, 0.5, 0.75, 0.95}) {
                Barycentric from(1 - share, 0, 0, 0);
                from[corner] = share;
                // The surface is on the other side of the mesh.
                if (side * patch_value(patches_.weights[own], from) > 0) continue;
                const auto hit = patch_hit(patches_.weights[own], from, apex);
                if (!hit || sign * patch_value(patches_.weights[row], (1 - *hit) * from + *hit * apex) > least)
                    return false;
            }
        return true;
    }

    const PatchComplex& patches_;
};

struct SharedFace {
    std::array<u32, 3> vertices;  // ascending
    u32 tet;
    auto operator<=>(const SharedFace&) const = default;
};

/// The coordinates in a tetrahedron of a point with coordinates `share` on one of its faces. Rounding of a position
/// would move the point off the face, which matters in flat tetrahedra.
Barycentric coordinates_on(const std::array<u32, 4>& tet, const std::array<u32, 3>& face, const Vec3& share) {
    Barycentric at = Barycentric::Zero();
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t v = 0; v < 3; ++v)
            if (tet[i] == face[v]) at[static_cast<Eigen::Index>(i)] = share[static_cast<Eigen::Index>(v)];
    return at;
}

/// The tetrahedra over some triangles, and between them. These triangles, which ascend, are numbered from 0 in the
/// part.
PatchComplex part_over(const PatchComplex& patches, const Hull& hull, std::span<const u32> wanted) {
    std::vector<bool> is_wanted(hull.faces.size(), false);
    std::vector<u32> number_of_triangle(hull.faces.size(), 0);
    for (u32 i = 0; i < wanted.size(); ++i) {
        is_wanted[wanted[i]] = true;
        number_of_triangle[wanted[i]] = i;
    }
    std::vector<u32> rows, numbers(patches.tets.size(), PatchComplex::no_partner);
    for (u32 row = 0; row < patches.tets.size(); ++row) {
        if (!is_wanted[patches.triangles[row]]) continue;
        if (patches.edges[row] != PatchComplex::no_edge) {
            const HullEdge& edge = hull.edges[patches.edges[row]];
            if (!is_wanted[edge.first] || !is_wanted[edge.second]) continue;
        }
        numbers[row] = static_cast<u32>(rows.size());
        rows.push_back(row);
    }
    PatchComplex part;
    part.frame = patches.frame;
    part.positions = patches.positions;
    part.tets = gather(patches.tets, rows);
    part.weights = gather(patches.weights, rows);
    part.kinds = gather(patches.kinds, rows);
    part.sides = gather(patches.sides, rows);
    Array<u32> triangles;
    for (const u32 row : rows) triangles.push_back(number_of_triangle[patches.triangles[row]]);
    part.triangles = std::move(triangles);
    part.edges = gather(patches.edges, rows);
    Array<u32> partners;
    Array<Combine> combine;
    for (const u32 row : rows) {
        const u32 partner = patches.partners[row];
        partners.push_back(partner == PatchComplex::no_partner ? partner : numbers[partner]);
        combine.push_back(partners.back() == PatchComplex::no_partner ? Combine::none : patches.combine[row]);
    }
    part.partners = std::move(partners);
    part.combine = std::move(combine);
    return part;
}

}  // namespace

std::size_t inverted_tets(const PatchComplex& patches) {
    std::size_t inverted = 0;
    for (std::size_t row = 0; row < patches.tets.size(); ++row) {
        const auto& t = patches.tets[row];
        const Vec3& o = patches.positions[t[0]];
        const double volume =
            (patches.positions[t[1]] - o).cross(patches.positions[t[2]] - o).dot(patches.positions[t[3]] - o);
        // Corners i, j and the apex turn in one direction as seen from a base point, and in the other direction as seen
        // from an edge point. Inside, both directions are the reverse of those outside.
        const bool is_over_face =
            patches.kinds[row] == PatchKind::face || patches.kinds[row] == PatchKind::continuation;
        const bool is_positive = is_over_face == (patches.sides[row] == 1);
        inverted += !((is_positive ? volume : -volume) > 0);
    }
    return inverted;
}

std::vector<u32> CreaseVerdicts::doubtful_edges(const PatchComplex& patches, Execution& execution) {
    // The rows beside an edge follow each other.
    std::vector<u32> first_rows;
    const auto edge_of = [&](std::size_t row) { return patches.edges[row]; };
    for (u32 row = 0; row < patches.tets.size(); ++row)
        if (edge_of(row) != PatchComplex::no_edge && (row == 0 || edge_of(row - 1) != edge_of(row)))
            first_rows.push_back(row);
    const CreaseCheck check(patches);
    std::vector<Verdict> found(first_rows.size());
    for_each_chunk(execution.threads(), first_rows.size(), chunk, [&](std::size_t begin, std::size_t end) {
        execution.check_cancelled();
        for (std::size_t i = begin; i < end; ++i) {
            Verdict& verdict = found[i];
            const u32 first = first_rows[i];
            u32 last = first;
            verdict.is_sound = true;
            for (; last < patches.tets.size() && edge_of(last) == edge_of(first); ++last) {
                verdict.is_sound = verdict.is_sound && wrong_signs(patches, last) == 0;
                if (patches.partners[last] == PatchComplex::no_partner) continue;
                verdict.weights.push_back(patches.weights[last]);
                verdict.weights.push_back(patches.weights[patches.partners[last]]);
            }
            if (!verdict.is_sound || verdict.weights.empty()) continue;
            const auto known = known_.find(make_edge(patches.tets[first][1], patches.tets[first][2]));
            if (known != known_.end() && known->second.weights == verdict.weights) {
                verdict.is_sound = known->second.is_sound;
                continue;
            }
            for (u32 row = first; row < last && verdict.is_sound; ++row) verdict.is_sound = check.is_sound(row);
        }
    });
    std::vector<u32> edges;
    for (std::size_t i = 0; i < found.size(); ++i) {
        const u32 first = first_rows[i];
        if (!found[i].is_sound) edges.push_back(edge_of(first));
        if (found[i].weights.empty()) continue;
        known_.insert_or_assign(make_edge(patches.tets[first][1], patches.tets[first][2]), std::move(found[i]));
    }
    return edges;
}

std::size_t sign_violations(const PatchComplex& patches, CreaseVerdicts& verdicts, Execution& execution) {
    std::size_t violations = verdicts.doubtful_edges(patches, execution).size();
    for (std::size_t row = 0; row < patches.tets.size(); ++row)
        if (patches.kinds[row] == PatchKind::face) violations += wrong_signs(patches, row);
    return violations;
}

double c1_jump(const PatchComplex& patches, Execution& execution) {
    static const std::array<Vec3, 3> places{Vec3::Constant(1. / 3), {0.6, 0.3, 0.1}, {0.1, 0.2, 0.7}};
    std::vector<SharedFace> faces;
    faces.reserve(4 * patches.tets.size());
    for (u32 row = 0; row < patches.tets.size(); ++row)
        for (std::size_t without = 0; without < 4 && patches.kinds[row] != PatchKind::continuation; ++without) {
            SharedFace face{{}, row};
            for (std::size_t i = 0, n = 0; i < 4; ++i)
                if (i != without) face.vertices[n++] = patches.tets[row][i];
            std::ranges::sort(face.vertices);
            faces.push_back(face);
        }
    std::ranges::sort(faces);
    execution.check_cancelled();
    std::vector<double> largest(faces.size() / chunk + 1, 0.0);
    for_each_chunk(execution.threads(), faces.size(), chunk, [&](std::size_t begin, std::size_t end) {
        double& jump = largest[begin / chunk];
        for (std::size_t i = begin; i < end; ++i)
            for (std::size_t j = i; j > 0 && faces[i].vertices == faces[j - 1].vertices; --j) {
                const u32 here = faces[j - 1].tet, there = faces[i].tet;
                const bool is_sharp =
                    patches.kinds[here] == PatchKind::sharp || patches.kinds[there] == PatchKind::sharp;
                if (is_sharp && patches.triangles[here] != patches.triangles[there]) continue;
                const PatchCell one(patches, here), other(patches, there);
                for (const Vec3& share : places) {
                    const Vec3 a = one.gradient(coordinates_on(patches.tets[here], faces[i].vertices, share)),
                               b = other.gradient(coordinates_on(patches.tets[there], faces[i].vertices, share));
                    jump = std::max(jump, (a - b).norm() / std::max(a.norm(), b.norm()));
                }
            }
    });
    return std::ranges::max(largest);
}

std::vector<std::array<u32, 2>> crossing_triangles(const PatchComplex& patches, const Hull& hull,
                                                   std::span<const u32> suspects, std::span<const u32> beside_creases,
                                                   Execution& execution) {
    if (suspects.empty() && beside_creases.empty()) return {};
    const TriangleTree mesh(hull.positions, hull.triangles, execution.threads());
    Array<u32> near(beside_creases.begin(), beside_creases.end());
    for (const u32 f : suspects) {
        BoundingBox box;
        for (const u32 v : hull.triangles[f]) box.add(hull.positions[v]);
        for (const Side side : both_sides) box.add(hull.apex(f, side));
        mesh.meeting(box, near);
    }
    std::ranges::sort(near);
    near.erase(std::ranges::unique(near).begin(), near.end());
    TessellateParams params;
    params.subdivision = 4;
    const TriangleMesh surface = tessellate(part_over(patches, hull, near), params, execution);
    const TriangleTree tree(surface.positions.span(), surface.triangles.span(), execution.threads());
    const SelfIntersections found =
        self_intersections(surface.positions.span(), surface.triangles.span(), tree, execution);
    const Column& patch = *surface.face_columns.find("patch");
    std::vector<std::array<u32, 2>> crossing;
    for (const auto& pair : found.pairs) {
        std::array<u32, 2> triangles;
        for (std::size_t i = 0; i < 2; ++i) triangles[i] = near[static_cast<u32>(patch.number(pair[i], 0))];
        std::ranges::sort(triangles);
        crossing.push_back(triangles);
    }
    std::ranges::sort(crossing);
    crossing.erase(std::ranges::unique(crossing).begin(), crossing.end());
    return crossing;
}

}  // namespace scanmill::a_patches
