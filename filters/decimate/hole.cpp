// SPDX-License-Identifier: GPL-3.0-or-later
#include "decimate/hole.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>

#include "scanmill/geometry/spatial/triangle_distance.hpp"

namespace scanmill::decimating {

namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

double shape_weight() {
    static const double w = std::getenv("SHAPE") ? std::atof(std::getenv("SHAPE")) : 0.1;
    return w;
}

double share_of(const SignedErrors& errors, const SignedErrors& limits) {
    return std::max(errors.outside / limits.outside, errors.inside / limits.inside);
}

}  // namespace

bool Hole::is_possible(const Surface& surface, const Limits& limits, u32 i, u32 j) {
    const u32 last = static_cast<u32>(corners.size() - 1);
    if (j == i + 1 || (i == 0 && j == last)) return true;
    Chord& chord = chords_[index(i, j)];
    if (chord.is_known) return chord.is_possible;
    chord.is_known = true;
    const u32 from = corners[i].vertex, to = corners[j].vertex;
    chord.is_possible = !surface.mesh.has_edge(from, to) &&
                        surface.original.add_path(from, to, up, limits.error, chord.path);
    return chord.is_possible;
}

void Hole::find_sides(const Surface& surface) {
    positions_.clear();
    for (const u32 point : points) positions_.push_back(surface.point(point));
    words_ = (points.size() + 63) / 64;
    const u32 size = static_cast<u32>(corners.size());
    left_.assign(size * size * words_, ~u64(0));
    for (u32 i = 0; i < size; ++i)
        for (u32 j = i + 1; j < size; ++j) {
            u64* left = &left_[index(i, j) * words_];
            if (i == 0 && j + 1 == size) {
                std::fill(left, left + words_, 0);
                continue;
            }
            if (j == i + 1) continue;
            const Vec3 sideways = up.cross(corners[j].position - corners[i].position);
            const double offset = sideways.dot(corners[i].position);
            for (std::size_t word = 0; word < words_; ++word) {
                u64 bits = 0;
                const std::size_t begin = 64 * word, end = std::min(begin + 64, points.size());
                for (std::size_t p = begin; p < end; ++p)
                    bits |= u64(sideways.dot(positions_[p]) >= offset) << (p - begin);
                left[word] = bits;
            }
        }
}

double Hole::cost(const Limits& limits, u32 i, u32 k, u32 j, SignedErrors& found) const {
    const Vec3 &a = corners[i].position, &b = corners[k].position, &c = corners[j].position;
    const Vec3 ab = b - a, ac = c - a;
    const Vec3 normal = ab.cross(ac);
    const double twice_area = normal.norm();
    if (!(twice_area > 0) || !(normal.dot(up) >= limits.normal_cosine * twice_area)) return infinite;
    const double squares[3] = {ab.squaredNorm(), ac.squaredNorm(), (c - b).squaredNorm()};
    const double shortest = std::min({squares[0], squares[1], squares[2]});
    const double product = squares[0] * squares[1] * squares[2] / shortest;
    if (twice_area * twice_area < angle_sine * angle_sine * product) return infinite;
    const Vec3 unit = normal / twice_area;
    const u64* ik = &left_[index(i, k) * words_];
    const u64* kj = &left_[index(k, j) * words_];
    const u64* ij = &left_[index(i, j) * words_];
    for (std::size_t word = 0; word < words_; ++word)
        for (u64 bits = ik[word] & kj[word] & ~ij[word]; bits != 0; bits &= bits - 1) {
            const std::size_t p = 64 * word + static_cast<std::size_t>(std::countr_zero(bits));
            if (p >= positions_.size()) break;
            const double height = unit.dot(positions_[p] - a);
            found.add(std::abs(height), height >= 0);
        }
    if (found.outside > limits.error.outside || found.inside > limits.error.inside) return infinite;
    for (const auto& [from, to] : {std::pair(i, k), std::pair(k, j), std::pair(i, j)})
        found.add(chords_[index(from, to)].path);
    const double share = share_of(found, limits.error);
    constexpr double perfect = 3.4641016151377544;  // 2 √3: of an equilateral triangle
    const double quality = perfect * twice_area / (squares[0] + squares[1] + squares[2]);
    return share * share + shape_weight() * (1 - quality);
}

bool Hole::triangulate(const Surface& surface, const Limits& limits) {
    const u32 size = static_cast<u32>(corners.size());
    chords_.assign(size * size, {});
    least_.assign(size * size, infinite);
    middles_.assign(size * size, 0);
    find_sides(surface);
    for (u32 i = 0; i + 1 < size; ++i) least_[index(i, i + 1)] = 0;
    for (u32 span = 2; span < size; ++span)
        for (u32 i = 0; i + span < size; ++i) {
            const u32 j = i + span;
            if (!is_possible(surface, limits, i, j)) continue;
            double& least = least_[index(i, j)];
            for (u32 k = i + 1; k < j; ++k) {
                const double parts = least_[index(i, k)] + least_[index(k, j)];
                if (!(parts < least)) continue;
                SignedErrors found;
                const double total = parts + cost(limits, i, k, j, found);
                if (total < least) {
                    least = total;
                    middles_[index(i, j)] = k;
                }
            }
        }
    triangles.clear();
    errors.clear();
    if (!(least_[index(0, size - 1)] < infinite)) return false;
    owners.assign(points.size(), 0);
    collect(limits, 0, size - 1);
    for (std::size_t p = 0; p < points.size(); ++p) {
        const auto& [i, k, j] = triangles[owners[p]];
        const Vec3 &a = corners[i].position, &b = corners[k].position, &c = corners[j].position;
        const Vec3 off = positions_[p] - nearest_on_triangle(positions_[p], a, b, c);
        const double distance = off.norm();
        const bool is_outside = (b - a).cross(c - a).dot(positions_[p] - a) >= 0;
        if (distance > (is_outside ? limits.error.outside : limits.error.inside)) return false;
        errors[owners[p]].add(distance, is_outside);
    }
    return true;
}

void Hole::collect(const Limits& limits, u32 i, u32 j) {
    if (j == i + 1) return;
    const u32 k = middles_[index(i, j)];
    const u32 row = static_cast<u32>(triangles.size());
    triangles.push_back({i, k, j});
    SignedErrors path;
    for (const auto& [from, to] : {std::pair(i, k), std::pair(k, j), std::pair(i, j)})
        path.add(chords_[index(from, to)].path);
    errors.push_back(path);
    for (std::size_t word = 0; word < words_; ++word) {
        u64 bits = left_[index(i, k) * words_ + word] & left_[index(k, j) * words_ + word] &
                   ~left_[index(i, j) * words_ + word];
        for (; bits != 0; bits &= bits - 1) {
            const std::size_t p = 64 * word + static_cast<std::size_t>(std::countr_zero(bits));
            if (p < points.size()) owners[p] = row;
        }
    }
    collect(limits, i, k);
    collect(limits, k, j);
}

}  // namespace scanmill::decimating
