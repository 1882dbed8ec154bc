// SPDX-License-Identifier: GPL-3.0-or-later
#include "measure/certify_piece.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>

namespace scanmill::measuring {

namespace {

/// A piece that reaches less far over an edge is not worth a cut there: a share of its distance, over which that
/// distance hardly grows, and of its size, so that cuts leave pieces worth having.
constexpr double harmless_of_distance = 0.05;
constexpr double harmless_of_size = 1e-3;

PieceCorner asked(const Vec3& position, const TriangleTree& other, u32 hint) {
    const NearestTriangle found = other.nearest(position, hint);
    return {position, found.place, std::sqrt(found.squared_distance)};
}

/// The distance to one triangle is convex: nowhere on the piece is it larger than at one of the corners.
void try_triangle(Piece& piece, u32 place) {
    if (place == NearestTriangle::none) return;
    const double least = piece.upper * piece.upper;
    double farthest = 0;
    for (const PieceCorner& corner : piece.corners) {
        farthest = std::max(farthest, piece.other->squared_distance(corner.position, place));
        if (farthest > least) return;
    }
    if (std::sqrt(farthest) >= piece.upper) return;
    piece.upper = std::sqrt(farthest);
    piece.bounding = place;
}

Vec3 centre_of(const Piece& piece) {
    return (piece.corners[0].position + piece.corners[1].position + piece.corners[2].position) / 3;
}

std::size_t longest_edge(const Piece& piece) {
    std::size_t longest = 0;
    double length = -1;
    for (std::size_t i = 0; i < 3; ++i) {
        const double edge = (piece.corners[(i + 1) % 3].position - piece.corners[i].position).squaredNorm();
        if (edge > length) {
            length = edge;
            longest = i;
        }
    }
    return longest;
}

/// Signed distances of a piece's corners to a plane: positive outside.
using Sides = std::array<double, 3>;

double overhang(const Sides& sides) { return std::min(std::ranges::max(sides), -std::ranges::min(sides)); }

/// Of the planes through the edges of the triangle under the piece the one that the piece reaches over most.
Sides best_sides(const Piece& piece) {
    const std::array<Vec3, 3> under = piece.other->corners(piece.under);
    const Vec3 normal = (under[1] - under[0]).cross(under[2] - under[0]);
    Sides best{};
    for (std::size_t edge = 0; edge < 3; ++edge) {
        const Vec3 outwards = (under[(edge + 1) % 3] - under[edge]).cross(normal);
        const double length = outwards.norm();
        if (!(length > 0)) continue;
        Sides sides;
        for (std::size_t i = 0; i < 3; ++i) sides[i] = outwards.dot(piece.corners[i].position - under[edge]) / length;
        if (overhang(sides) > overhang(best)) best = sides;
    }
    return best;
}

PieceCorner between(const PieceCorner& from, const PieceCorner& to, double share) {
    return {from.position + share * (to.position - from.position)};
}

Piece part(const Piece& piece, const PieceCorner& a, const PieceCorner& b, const PieceCorner& c) {
    Piece result = piece;
    result.corners = {a, b, c};
    result.seen = 0;
    return result;
}

/// Along the plane at which `sides` are 0. Pre: corners on both sides of it.
Cut cut_along(const Piece& piece, const Sides& sides) {
    // The corner that is alone on its side; one on the plane counts to the larger group.
    std::size_t alone = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const double next = sides[(i + 1) % 3], last = sides[(i + 2) % 3];
        if ((sides[i] > 0 && next <= 0 && last <= 0) || (sides[i] < 0 && next >= 0 && last >= 0)) alone = i;
    }
    const PieceCorner& a = piece.corners[alone];
    const PieceCorner& b = piece.corners[(alone + 1) % 3];
    const PieceCorner& c = piece.corners[(alone + 2) % 3];
    const auto share = [&](std::size_t to) { return sides[alone] / (sides[alone] - sides[to]); };
    const PieceCorner on_ab = between(a, b, share((alone + 1) % 3)), on_ac = between(a, c, share((alone + 2) % 3));
    return {{part(piece, a, on_ab, on_ac), part(piece, on_ab, b, c), part(piece, on_ab, c, on_ac)}, 3};
}

Cut cut_across_longest_edge(const Piece& piece) {
    const std::size_t longest = longest_edge(piece);
    const PieceCorner& a = piece.corners[longest];
    const PieceCorner& b = piece.corners[(longest + 1) % 3];
    const PieceCorner& c = piece.corners[(longest + 2) % 3];
    const PieceCorner middle = between(a, b, 0.5);
    return {{part(piece, a, middle, c), part(piece, middle, b, c)}, 2};
}

}  // namespace

void bound(Piece& piece, double enough) {
    for (u32 place :
         {piece.under, piece.bounding, piece.corners[0].nearest, piece.corners[1].nearest, piece.corners[2].nearest}) {
        try_triangle(piece, place);
        if (piece.upper <= enough) return;
    }

    const Vec3 centre = centre_of(piece);
    const PieceCorner middle = asked(centre, *piece.other, piece.under);
    double reach = 0;
    for (const PieceCorner& corner : piece.corners) reach = std::max(reach, (corner.position - centre).norm());
    piece.upper = std::min(piece.upper, middle.distance + reach);
    piece.under = middle.nearest;
    piece.seen = middle.distance;
    try_triangle(piece, piece.under);
    for (PieceCorner& corner : piece.corners) {
        if (corner.nearest != NearestTriangle::none || piece.upper <= enough) continue;
        corner = asked(corner.position, *piece.other, piece.under);
        piece.seen = std::max(piece.seen, corner.distance);
        try_triangle(piece, corner.nearest);
    }
}

Cut cut(const Piece& piece, double enough) {
    assert(piece.under != NearestTriangle::none);
    const std::size_t longest = longest_edge(piece);
    const double size = (piece.corners[(longest + 1) % 3].position - piece.corners[longest].position).norm();
    const double harmless = std::max(harmless_of_distance * piece.seen, harmless_of_size * size);
    const Sides sides = best_sides(piece);
    Cut result = overhang(sides) > harmless ? cut_along(piece, sides) : cut_across_longest_edge(piece);
    for (std::size_t i = 0; i < result.count; ++i) bound(result.pieces[i], enough);
    return result;
}

}  // namespace scanmill::measuring
