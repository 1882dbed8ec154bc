// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/spacing.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <numeric>
#include <vector>

#include "scanmill/base/statistics.hpp"
#include "scanmill/data/point_tree.hpp"

namespace scanmill {

namespace {

constexpr std::size_t most_queries = 100'000;

double length(const Vec3& v) { return std::sqrt(v.x() * v.x() + v.y() * v.y() + v.z() * v.z()); }

/// The hash of a position; 0.0 and -0.0 have the same hash.
std::uint64_t hash_of(const Vec3& p) {
    std::uint64_t hash = 0;
    for (int axis = 0; axis < 3; ++axis) {
        hash += std::bit_cast<std::uint64_t>(p[axis] + 0.0) + 0x9e3779b97f4a7c15u;
        hash = (hash ^ (hash >> 30)) * 0xbf58476d1ce4e5b9u;  // the finaliser of splitmix64
        hash = (hash ^ (hash >> 27)) * 0x94d049bb133111ebu;
        hash ^= hash >> 31;
    }
    return hash;
}

/// A sample of rows of `points`, chosen by a hash of the coordinates. Pre: more than most_queries points.
std::vector<u32> sampled_rows(std::span<const Vec3> points) {
    std::vector<u32> rows(points.size());
    std::iota(rows.begin(), rows.end(), u32(0));
    std::vector<std::uint64_t> hashes(points.size());
    std::ranges::transform(points, hashes.begin(), hash_of);
    std::ranges::sort(rows, [&](u32 a, u32 b) {
        if (hashes[a] != hashes[b]) return hashes[a] < hashes[b];
        return std::ranges::lexicographical_compare(std::span(points[a].data(), 3), std::span(points[b].data(), 3));
    });
    std::vector<u32> sample(most_queries);
    for (std::size_t query = 0; query < most_queries; ++query) sample[query] = rows[query * rows.size() / most_queries];
    return sample;
}

}  // namespace

double point_spacing(std::span<const Vec3> positions) {
    std::vector<Vec3> points;
    std::ranges::copy_if(positions, std::back_inserter(points), [](const Vec3& p) { return p.allFinite(); });
    if (points.size() < 2) return 0;

    const PointTree tree(points);
    std::vector<u32> rows_at(tree.positions().size(), 0);
    for (const u32 index : tree.index_of_row()) ++rows_at[index];
    std::vector<double> distances;
    if (points.size() <= most_queries) {
        distances.resize(points.size(), 0);  // distances of repeated points stay 0
        tree.for_each_nearest(1, 1, [&](const NeighbourBatch& batch) {
            for (std::size_t i = 0; i < batch.each * batch.indices.size(); ++i)
                if (rows_at[batch.indices[i]] == 1)
                    distances[batch.indices[i]] = std::sqrt(batch.neighbours[i].squared);
        });
        return median(distances);
    }
    NeighbourBuffer buffer;
    for (const u32 row : sampled_rows(points)) {
        const u32 index = tree.index_of_row()[row];
        distances.push_back(rows_at[index] > 1 ? 0 : std::sqrt(tree.nearest(index, 1, buffer).front().squared));
    }
    return median(distances);
}

double edge_spacing(const TriangleMesh& mesh) {
    std::vector<double> lengths;
    lengths.reserve(3 * mesh.triangles.size());
    for (const Triangle& triangle : mesh.triangles)
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const Vec3& from = mesh.positions[triangle[(corner + 1) % 3]];
            const Vec3& to = mesh.positions[triangle[corner]];
            if (from.allFinite() && to.allFinite()) lengths.push_back(length(to - from));
        }
    return lengths.empty() ? 0 : median(lengths);
}

}  // namespace scanmill
