// SPDX-License-Identifier: GPL-3.0-or-later
#include "cocone/candidates.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <numeric>

#include "scanmill/base/elementary.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill::cocones {

namespace {

constexpr std::size_t chunk = 1 << 12;

/// A facet at a vertex.
struct FanFacet {
    Side side;
    std::array<u32, 2> ends;  ///< its other two corners
    Vec3 normal;  ///< of unit length, for the order vertex, ends[0], ends[1]
    bool alive = true;
};

/// Whether some of the facets are such that each is continued by another one at both its edges. Removes facets without
/// a continuation at one of their two edges until there is none.
bool has_closed_fan(std::vector<FanFacet>& facets, double least_cosine) {
    const auto continues = [&](const FanFacet& facet, std::size_t end) {
        return std::ranges::any_of(facets, [&](const FanFacet& other) {
            if (!other.alive || &other == &facet) return false;
            // If two facets have one orientation, one has their common edge first and the other has it second.
            if (other.ends[1 - end] == facet.ends[end]) return other.normal.dot(facet.normal) >= least_cosine;
            return other.ends[end] == facet.ends[end] && -other.normal.dot(facet.normal) >= least_cosine;
        });
    };
    std::size_t left = facets.size();
    for (bool changes = true; changes && left > 2;) {
        changes = false;
        for (FanFacet& facet : facets)
            if (facet.alive && !(continues(facet, 0) && continues(facet, 1))) {
                facet.alive = false;
                changes = true;
                --left;
            }
    }
    return left > 2;
}

/// The facets of the set at a vertex.
void collect(const Diagram& diagram, const FacetSet& set, u32 vertex, std::vector<FanFacet>& fan) {
    const TetMesh& tets = diagram.tets;
    fan.clear();
    for (const u32 cell : diagram.cells_at[vertex])
        for (unsigned bits = set.of(cell); bits != 0; bits &= bits - 1) {
            const int i = std::countr_zero(bits);
            if (!owns_facet(tets, cell, i)) continue;
            Triangle corners = corners_of(tets, {cell, i});
            const auto own = std::ranges::find(corners, vertex);
            if (own == corners.end()) continue;
            std::ranges::rotate(corners, own);
            fan.push_back(
                {{cell, i}, {corners[1], corners[2]}, area_vector(tets.positions.span(), corners).normalized()});
        }
}

}  // namespace

bool spans_opening(const TetMesh& tets, const Sampling& sampling, double lid_factor, const Triangle& corners) {
    double spacing = 0, longest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        if (sampling.boundary[corners[k]] == 0) return false;
        spacing = std::max(spacing, sampling.spacing[corners[k]]);
        longest = std::max(longest, (tets.positions[corners[k]] - tets.positions[corners[(k + 1) % 3]]).norm());
    }
    return longest > lid_factor * spacing;
}

FacetSet candidates(const Diagram& diagram, const Sampling& sampling, double lid_factor, Context& context) {
    const TetMesh& tets = diagram.tets;
    Array<u8> bits(tets.cells.size());
    for_each_chunk(context.threads(), bits.size(), chunk, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        for (std::size_t c = begin; c < end; ++c) {
            const u32 cell = static_cast<u32>(c);
            unsigned chosen = 0;
            for (int i = 0; i < 4; ++i) {
                const unsigned hits = unsigned(diagram.hits[cell]) >> (4 * i) & 15u;
                if (hits == 0) continue;
                bool any_flat = false, flat_agree = true, all_agree = true;
                for (int j = 0; j < 4; ++j) {
                    if (j == i) continue;
                    const u32 vertex = tets.cells[cell][static_cast<std::size_t>(j)];
                    const bool agrees = (hits >> j & 1u) != 0, is_flat = sampling.flat[vertex] == 1;
                    any_flat |= is_flat;
                    flat_agree &= agrees || !is_flat;
                    all_agree &= agrees;
                }
                if ((any_flat ? flat_agree : all_agree) &&
                    !spans_opening(tets, sampling, lid_factor, corners_of(tets, {cell, i})))
                    chosen |= 1u << i;
            }
            bits[cell] = static_cast<u8>(chosen);
        }
    });
    return FacetSet(std::move(bits));
}

Array<u8> prune(const Diagram& diagram, FacetSet& set, double prune_angle, Context& context) {
    const TetMesh& tets = diagram.tets;
    const double least_cosine = elementary::turn_of(prune_angle).cosine;
    Array<u8> umbrellas(tets.positions.size());
    Array<u8> dangling(tets.cells.size(), u8(0));  // by owner cell, one bit per facet
    std::vector<u32> vertices(umbrellas.size());  // whose facets have changed
    std::iota(vertices.begin(), vertices.end(), u32(0));
    while (!vertices.empty()) {
        for_each_chunk(context.threads(), vertices.size(), chunk, [&](std::size_t begin, std::size_t end) {
            context.check_cancelled();
            std::vector<FanFacet> fan;
            for (const u32 vertex : std::span(vertices).subspan(begin, end - begin)) {
                collect(diagram, set, vertex, fan);
                umbrellas[vertex] = has_closed_fan(fan, least_cosine);
                for (const FanFacet& facet : fan)
                    if (umbrellas[vertex] == 1 && !facet.alive)
                        std::atomic_ref(dangling[facet.side.cell])
                            .fetch_or(static_cast<u8>(1 << facet.side.corner), std::memory_order_relaxed);
            }
        });
        vertices.clear();
        for (u32 cell = 0; cell < dangling.size(); ++cell)
            for (unsigned bits = std::exchange(dangling[cell], u8(0)); bits != 0; bits &= bits - 1) {
                const Side side{cell, std::countr_zero(bits)};
                set.remove(tets, side);
                for (const u32 vertex : corners_of(tets, side)) vertices.push_back(vertex);
            }
        std::ranges::sort(vertices);
        vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    }
    return umbrellas;
}

}  // namespace scanmill::cocones
