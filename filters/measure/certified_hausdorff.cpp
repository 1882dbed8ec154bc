// SPDX-License-Identifier: GPL-3.0-or-later
#include "measure/certified_hausdorff.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <vector>

#include "scanmill/filter/parallel.hpp"

namespace scanmill {

namespace {

using measuring::rounding_of;

/// Below this share of the diagonal distances are as good as 0: refining them further is nobody's wish.
constexpr double negligible = 1e-9;
/// Pieces cut between two looks at the lower bound; the same for any number of threads.
constexpr std::size_t round_size = 1024;

struct Corner {
    Vec3 position;
    /// The nearest triangle of the other surface, as a place in its tree, and the distance to it.
    u32 nearest;
    double distance;
};

/// A part of a triangle, with what is known of its distances to the other surface.
struct Piece {
    std::array<Corner, 3> corners;
    double upper;
    /// Where `upper` comes from, or a near triangle: the children try it too.
    u32 near;
    const TriangleTree* other;
};

/// A piece and the distance at its centre, a lower bound.
struct Bounded {
    Piece piece;
    double seen;
};

Corner corner_at(const Vec3& position, const TriangleTree& other, u32 hint) {
    const NearestTriangle found = other.nearest(position, hint);
    return {position, found.place, std::sqrt(found.squared_distance)};
}

/// Fills `upper` and `near` of a piece from its corners; `inherited` is the bound of what it was cut from.
Bounded bounded(Piece piece, double inherited) {
    auto& [a, b, c] = piece.corners;
    const Vec3 centre = (a.position + b.position + c.position) / 3;
    const Corner middle = corner_at(centre, *piece.other, piece.near);
    double reach = 0;
    for (const Corner& corner : piece.corners) reach = std::max(reach, (corner.position - centre).norm());
    piece.upper = std::min(inherited, middle.distance + reach);
    const u32 parents = piece.near;
    piece.near = middle.nearest;
    double least = std::numeric_limits<double>::infinity();
    for (const u32 place : {middle.nearest, a.nearest, b.nearest, c.nearest, parents}) {
        if (place == NearestTriangle::none) continue;
        double farthest = 0;
        for (const Corner& corner : piece.corners)
            farthest = std::max(farthest, piece.other->squared_distance(corner.position, place));
        if (farthest < least) {
            least = farthest;
            piece.near = place;
        }
    }
    piece.upper = std::min(piece.upper, std::sqrt(least));
    return {piece, middle.distance};
}

std::array<Bounded, 2> cut(const Piece& piece) {
    std::size_t longest = 0;
    double length = -1;
    for (std::size_t i = 0; i < 3; ++i) {
        const double edge = (piece.corners[(i + 1) % 3].position - piece.corners[i].position).squaredNorm();
        if (edge > length) {
            length = edge;
            longest = i;
        }
    }
    const Corner& from = piece.corners[longest];
    const Corner& to = piece.corners[(longest + 1) % 3];
    const Corner middle = corner_at(from.position + (to.position - from.position) / 2, *piece.other, from.nearest);
    Piece first = piece, second = piece;
    first.corners[(longest + 1) % 3] = middle;
    second.corners[longest] = middle;
    return {bounded(first, piece.upper), bounded(second, piece.upper)};
}

/// All pieces that may still hold the largest distance, and what is known of it.
class Search {
public:
    Search(double floor, double gap) : floor_(floor), gap_(gap) {}

    /// A piece below this need not be looked at.
    double enough() const { return std::max(lower_ / (1 - gap_), floor_); }
    void see(double distance) { lower_ = std::max(lower_, distance); }
    /// A piece with this bound, near enough, is not kept.
    void pass_over(double upper) { passed_over_ = std::max(passed_over_, upper); }

    void add(const Piece& piece) {
        if (piece.upper <= enough()) {
            pass_over(piece.upper);
            return;
        }
        u32 slot = static_cast<u32>(pieces_.size());
        if (free_.empty()) {
            pieces_.push_back(piece);
        } else {
            slot = free_.back();
            free_.pop_back();
            pieces_[slot] = piece;
        }
        heap_.push_back({piece.upper, slot});
        std::ranges::push_heap(heap_);
    }

    /// The pieces with the largest bounds, at most `most`; empty when the rest is near enough.
    std::vector<Piece> take(std::size_t most) {
        std::vector<Piece> taken;
        while (!heap_.empty() && taken.size() < most && heap_.front().upper > enough()) {
            std::ranges::pop_heap(heap_);
            taken.push_back(pieces_[heap_.back().slot]);
            free_.push_back(heap_.back().slot);
            heap_.pop_back();
        }
        return taken;
    }

    double lower() const { return lower_; }
    double upper() const { return std::max({lower_, passed_over_, heap_.empty() ? 0 : heap_.front().upper}); }

private:
    struct Waiting {
        double upper;
        u32 slot;
        auto operator<=>(const Waiting&) const = default;
    };
    double floor_, gap_;
    double lower_ = 0, passed_over_ = 0;
    std::vector<Waiting> heap_;
    std::vector<Piece> pieces_;
    std::vector<u32> free_;
};

/// Nearest triangles of all vertices that triangles use; others stay as they are.
Array<Corner> corners_of(const CertifiedSurface& surface, const TriangleTree& other, Context& context) {
    Array<u8> is_used(surface.positions.size(), u8(0));
    for (const Triangle& triangle : surface.triangles)
        for (u32 vertex : triangle) is_used[vertex] = 1;
    Array<Corner> corners(surface.positions.size());
    for_each_chunk(context.threads(), corners.size(), 1 << 10, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        u32 hint = NearestTriangle::none;
        for (std::size_t i = begin; i < end; ++i) {
            if (!is_used[i]) {
                corners[i] = {surface.positions[i], NearestTriangle::none, 0};
                continue;
            }
            corners[i] = corner_at(surface.positions[i], other, hint);
            hint = corners[i].nearest;
        }
    });
    return corners;
}

/// Bounds every triangle of a surface; those that cannot hold the largest distance are not kept.
void add_triangles(const CertifiedSurface& surface, const Array<Corner>& corners, const TriangleTree& other,
                   Search& search, Context& context) {
    constexpr std::size_t chunk = 1 << 10;
    const double enough = search.enough();
    struct Chunk {
        std::vector<Piece> kept;
        double passed_over = 0, seen = 0;
    };
    std::vector<Chunk> chunks((surface.triangles.size() + chunk - 1) / chunk);
    for_each_chunk(context.threads(), surface.triangles.size(), chunk, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        Chunk& mine = chunks[begin / chunk];
        for (std::size_t row = begin; row < end; ++row) {
            const auto& [a, b, c] = surface.triangles[row];
            const Piece piece{{corners[a], corners[b], corners[c]}, 0, corners[a].nearest, &other};
            const Bounded result = bounded(piece, std::numeric_limits<double>::infinity());
            mine.seen = std::max(mine.seen, result.seen);
            if (result.piece.upper > enough)
                mine.kept.push_back(result.piece);
            else
                mine.passed_over = std::max(mine.passed_over, result.piece.upper);
        }
    });
    for (const Chunk& part : chunks) search.see(part.seen);
    for (const Chunk& part : chunks) {
        search.pass_over(part.passed_over);
        for (const Piece& piece : part.kept) search.add(piece);
    }
}

u64 refine(Search& search, const CertifyLimits& limits, Context& context) {
    u64 cuts = 0;
    while (cuts < limits.most_cuts) {
        context.check_cancelled();
        const std::vector<Piece> pieces = search.take(std::min<u64>(round_size, limits.most_cuts - cuts));
        if (pieces.empty()) break;
        std::vector<std::array<Bounded, 2>> halves(pieces.size());
        for_each_chunk(context.threads(), pieces.size(), 32, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) halves[i] = cut(pieces[i]);
        });
        cuts += pieces.size();
        for (const auto& both : halves)
            for (const Bounded& half : both) {
                search.see(half.seen);
                for (const Corner& corner : half.piece.corners) search.see(corner.distance);
            }
        for (const auto& both : halves)
            for (const Bounded& half : both) search.add(half.piece);
    }
    return cuts;
}

}  // namespace

CertifiedHausdorff certified_hausdorff(const CertifiedSurface& one, const CertifiedSurface& other,
                                       const CertifyLimits& limits, Context& context) {
    assert(limits.gap > 0 && limits.gap < 1);
    BoundingBox box;
    double largest = 0;
    const Array<Corner> of_one = corners_of(one, other.tree, context);
    const Array<Corner> of_other = corners_of(other, one.tree, context);
    for (const Array<Corner>* corners : {&of_one, &of_other})
        for (const Corner& corner : *corners)
            if (corner.nearest != NearestTriangle::none) {
                box.low = box.low.cwiseMin(corner.position);
                box.high = box.high.cwiseMax(corner.position);
                largest = std::max(largest, corner.position.cwiseAbs().maxCoeff());
            }

    Search search(negligible * box.diagonal(), limits.gap);
    for (const Array<Corner>* corners : {&of_one, &of_other})
        for (const Corner& corner : *corners) search.see(corner.distance);
    add_triangles(one, of_one, other.tree, search, context);
    add_triangles(other, of_other, one.tree, search, context);

    CertifiedHausdorff result;
    result.cuts = refine(search, limits, context);
    result.reached = search.upper() <= search.enough();
    if (search.upper() > rounding_of(largest)) {
        result.upper = search.upper() + rounding_of(largest);
        result.lower = std::max(0.0, search.lower() - rounding_of(largest));
    }
    return result;
}

}  // namespace scanmill
