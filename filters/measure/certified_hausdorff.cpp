// SPDX-License-Identifier: GPL-3.0-or-later
#include "measure/certified_hausdorff.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <map>
#include <vector>

#include "measure/certify_piece.hpp"
#include "scanmill/base/parallel.hpp"

namespace scanmill {

namespace {

using namespace measuring;

/// Below this share of the diagonal distances are as good as 0: refining them further is nobody's wish.
constexpr double negligible = 1e-9;
/// Pieces cut between two looks at the lower bound; the same for any number of threads.
constexpr std::size_t round_size = 4096;

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
        if (piece.upper <= enough())
            pass_over(piece.upper);
        else
            waiting_[size_class(piece.upper)].push_back(piece);
    }

    /// The pieces with about the largest bounds, at most `most`; empty when the rest is near enough.
    std::vector<Piece> take(std::size_t most) {
        std::vector<Piece> taken;
        while (!waiting_.empty() && taken.size() < most) {
            std::vector<Piece>& largest = waiting_.begin()->second;
            if (largest.back().upper > enough())
                taken.push_back(largest.back());
            else
                pass_over(largest.back().upper);
            largest.pop_back();
            if (largest.empty()) waiting_.erase(waiting_.begin());
        }
        return taken;
    }

    double lower() const { return lower_; }
    double upper() const {
        double largest = std::max(lower_, passed_over_);
        if (!waiting_.empty())
            for (const Piece& piece : waiting_.begin()->second) largest = std::max(largest, piece.upper);
        return largest;
    }

private:
    /// Bounds of one class differ by 3 % at most: order enough, and cheaper than a heap of millions.
    static int size_class(double upper) {
        int exponent = 0;
        const double mantissa = std::frexp(upper, &exponent);  // in [1/2, 1)
        return 32 * exponent + static_cast<int>(64 * mantissa) - 32;
    }
    double floor_, gap_;
    double lower_ = 0, passed_over_ = 0;
    std::map<int, std::vector<Piece>, std::greater<>> waiting_;
};

/// Nearest triangles of all vertices that triangles use; others are at 0 of nothing.
Array<PieceCorner> corners_of(const CertifiedSurface& surface, const TriangleTree& other, Context& context) {
    Array<u8> is_used(surface.positions.size(), u8(0));
    for (const Triangle& triangle : surface.triangles)
        for (u32 vertex : triangle) is_used[vertex] = 1;
    Array<PieceCorner> corners(surface.positions.size());
    for_each_chunk(context.threads(), corners.size(), 1 << 10, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        u32 hint = NearestTriangle::none;
        for (std::size_t i = begin; i < end; ++i) {
            corners[i].position = surface.positions[i];
            if (!is_used[i]) continue;
            const NearestTriangle found = other.nearest(surface.positions[i], hint);
            corners[i].nearest = hint = found.place;
            corners[i].distance = std::sqrt(found.squared_distance);
        }
    });
    return corners;
}

/// Bounds every triangle of a surface; those that cannot hold the largest distance are not kept.
void add_triangles(const CertifiedSurface& surface, const Array<PieceCorner>& corners, const TriangleTree& other,
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
            Piece piece;
            piece.corners = {corners[a], corners[b], corners[c]};
            piece.other = &other;
            bound(piece, enough);
            mine.seen = std::max(mine.seen, piece.seen);
            if (piece.upper > enough)
                mine.kept.push_back(piece);
            else
                mine.passed_over = std::max(mine.passed_over, piece.upper);
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
        const double enough = search.enough();
        const std::vector<Piece> pieces = search.take(std::min<u64>(round_size, limits.most_cuts - cuts));
        if (pieces.empty()) break;
        std::vector<Cut> results(pieces.size());
        for_each_chunk(context.threads(), pieces.size(), 64, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) results[i] = cut(pieces[i], enough);
        });
        cuts += pieces.size();
        for (const Cut& result : results)
            for (std::size_t i = 0; i < result.count; ++i) search.see(result.pieces[i].seen);
        for (const Cut& result : results)
            for (std::size_t i = 0; i < result.count; ++i) search.add(result.pieces[i]);
    }
    return cuts;
}

}  // namespace

CertifiedHausdorff certified_hausdorff(const CertifiedSurface& one, const CertifiedSurface& other,
                                       const CertifyLimits& limits, Context& context) {
    assert(limits.gap > 0 && limits.gap < 1);
    BoundingBox box;
    double largest = 0;
    const Array<PieceCorner> of_one = corners_of(one, other.tree, context);
    const Array<PieceCorner> of_other = corners_of(other, one.tree, context);
    for (const Array<PieceCorner>* corners : {&of_one, &of_other})
        for (const PieceCorner& corner : *corners)
            if (corner.nearest != NearestTriangle::none) {
                box.low = box.low.cwiseMin(corner.position);
                box.high = box.high.cwiseMax(corner.position);
                largest = std::max(largest, corner.position.cwiseAbs().maxCoeff());
            }

    Search search(negligible * box.diagonal(), limits.gap);
    for (const Array<PieceCorner>* corners : {&of_one, &of_other})
        for (const PieceCorner& corner : *corners) search.see(corner.distance);
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
