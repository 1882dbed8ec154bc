// SPDX-License-Identifier: GPL-3.0-or-later
#include "transfer/samples.hpp"

#include <algorithm>
#include <cmath>

#include "scanmill/base/parallel.hpp"
#include "scanmill/data/spacing.hpp"
#include "scanmill/geometry/mesh/facet_normals.hpp"
#include "scanmill/geometry/spatial/unit_vectors.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill::transferring {

namespace {

/// More neighbours reduce the noise of the colours, fewer keep corners between colours. On a raw sphere of 6 views, 8,
/// 12, 16 and 24 neighbours leave 0.42, 0.34, 0.29 and 0.24 of the noise of one view, and give 1.8, 2.0, 2.4 and 3.1 %
/// of the vertices within two spacings of an edge the wrong side's colour. Along straight edges of a virtually scanned
/// box, within two spacings of a view, 12 neighbours give 2.4 % and 24 give 1.9 %.
constexpr std::size_t neighbours = 12;
/// How far samples may be, in max-distances, if the nearest is within one. The spacing of merged views is far below
/// that of each view: on the raw sphere, samples within twice 3 spacings leave 0.82 of the noise.
constexpr double reach = 4;
/// Points at one position that count. Scans have few; a search must not slow down where a file has thousands.
constexpr std::size_t most_at_one_position = 8;
/// The cosine at which a surface faces away, and the least weight of one that does not. Vertex normals of noisy meshes
/// and at sharp corners may be far from those of the points beside them.
constexpr double least_cosine = -0.2, least_weight = 0.05;
/// Positions of which medians are taken.
constexpr std::size_t most_noise_samples = 100'000;
constexpr double default_radii = 1.5, default_spacings = 3;

/// The median of a number of every position, or of evenly chosen ones. Pre: at least one position.
template <class Number>
double median_of(std::size_t positions, unsigned threads, const Number& number) {
    const std::size_t step = (positions - 1) / most_noise_samples + 1, count = (positions - 1) / step + 1;
    Array<double> numbers(count);
    for_each_chunk(threads, count, 1024, [&](std::size_t begin, std::size_t end) {
        NeighbourBuffer buffer;
        for (std::size_t i = begin; i < end; ++i) numbers[i] = number(static_cast<u32>(i * step), buffer);
    });
    const auto middle = numbers.begin() + static_cast<std::ptrdiff_t>(count / 2);
    std::nth_element(numbers.begin(), middle, numbers.end());
    return *middle;
}

/// The median distance of a position from its last of `neighbours` nearest other positions; 0 for a single one.
double neighbourhood_radius(const PointTree& tree, unsigned threads) {
    return std::sqrt(median_of(tree.positions().size(), threads, [&](u32 index, NeighbourBuffer& buffer) {
        const std::span<const Neighbour> near = tree.nearest(index, neighbours, buffer);
        return near.empty() ? 0 : near.back().squared;
    }));
}

/// The weight of a direction for a normal; 0 if it faces away, 1 if one of them is unknown.
double facing_weight(const Vec3& direction, const Vec3& normal) {
    const double cosine = direction.dot(normal);
    if (cosine == 0 && (direction.isZero(0) || normal.isZero(0))) return 1;
    return cosine <= least_cosine ? 0 : std::max(cosine, least_weight);
}

void normalise(Array<Sample>& samples) {
    double sum = 0;
    for (const Sample& sample : samples) sum += sample.weight;
    for (Sample& sample : samples) sample.weight /= sum;
}

}  // namespace

Array<Vec3> normals_of(const PointCloud& cloud) { return unit_vectors(cloud.columns, "normal"); }

Array<Vec3> normals_of(const TriangleMesh& mesh) {
    Array<Vec3> normals = vertex_area_vectors(mesh);
    for (Vec3& normal : normals) normal = unit_or_zero(normal);
    return normals;
}

PointSamples::PointSamples(const PointCloud& cloud, std::optional<double> max_distance, unsigned threads)
    : tree_(cloud.positions.span(), threads),
      rows_(tree_.positions().size(),
            [&](const auto& add) {
                for (u32 row = 0; row < cloud.size(); ++row) add(tree_.index_of_row()[row], row);
            }),
      normals_(normals_of(cloud)),
      approaches_(unit_vectors(cloud.columns, "approach")),
      max_distance_(max_distance ? *max_distance : default_radii * neighbourhood_radius(tree_, threads)) {}

double PointSamples::facing(u32 row, const Vec3& normal) const {
    double weight = 1;
    if (!normals_.empty()) weight *= facing_weight(normals_[row], normal);
    if (!approaches_.empty()) weight *= facing_weight(approaches_[row], normal);
    return weight;
}

void PointSamples::find(const Vec3& position, const Vec3& normal, Samples& found) const {
    const double squared_limit = max_distance_ * max_distance_, squared_reach = reach * reach * squared_limit;
    found.nearest = found.face = no_row;
    for (std::size_t count = neighbours;; count *= 2) {
        const std::span<const Neighbour> near = tree_.nearest_to(position, count, found.buffer);
        found.is_near = near.front().squared <= squared_limit;
        found.samples.clear();
        for (const auto& [squared, index] : near) {
            if (squared > squared_reach) break;
            const std::span<const u32> rows = rows_[index];
            for (const u32 row : rows.first(std::min(rows.size(), most_at_one_position)))
                if (const double weight = facing(row, normal); weight > 0)
                    found.samples.push_back({row, squared, weight});
        }
        const bool is_all = near.size() < count || near.back().squared > squared_reach;
        if (found.samples.empty() ? is_all : found.samples.front().squared > squared_limit) return;
        // Beyond the positions that were found there may be the first that counts, or one as near as the nearest.
        if (is_all || (!found.samples.empty() && found.samples.front().squared < near.back().squared)) break;
    }
    const double nearest = found.samples.front().squared;
    for (const Sample& sample : found.samples)
        if (sample.squared == nearest) found.nearest = std::min(found.nearest, sample.row);
    found.samples.resize(std::min(found.samples.size(), neighbours * most_at_one_position));
    const double radius = found.samples.back().squared * (1 + 1.0 / neighbours);
    if (radius > 0)
        for (Sample& sample : found.samples) sample.weight *= 1 - sample.squared / radius;
    normalise(found.samples);
}

double PointSamples::colour_noise(const Column& colour, unsigned threads) const {
    if (tree_.positions().size() < 2) return 0;
    return std::sqrt(median_of(tree_.positions().size(), threads, [&](u32 index, NeighbourBuffer& buffer) {
        const u32 other = tree_.nearest(index, 1, buffer).front().index;
        return squared_colour_distance(colour, rows_[index].front(), rows_[other].front());
    }));
}

MeshSamples::MeshSamples(const TriangleMesh& mesh, std::optional<double> max_distance, unsigned threads)
    : tree_(mesh.positions.span(), mesh.triangles.span(), threads),
      triangles_(mesh.triangles),
      max_distance_(max_distance ? *max_distance : default_spacings * edge_spacing(mesh)) {}

void MeshSamples::find(const Vec3& position, const Vec3& normal, Samples& found) const {
    found.nearest = found.face = no_row;
    found.samples.clear();
    const auto faces_away = [&](u32 slot) {
        const auto& [a, b, c] = tree_.corners(slot);
        return facing_weight(unit_or_zero(area_vector(a, b, c)), normal) == 0;
    };
    NearestTriangle nearest = tree_.nearest(position, found.hint);
    found.hint = nearest.slot;
    const double limit = max_distance_ * max_distance_;
    found.is_near = nearest.squared_distance <= limit;
    if (!found.is_near) return;
    if (faces_away(nearest.slot)) {
        nearest = {};
        tree_.any_near({&position, 1}, max_distance_, [&](u32 slot) {
            const double squared = tree_.squared_distance(position, slot);
            const u32 row = tree_.row(slot);
            if (squared <= limit && std::pair(squared, row) < std::pair(nearest.squared_distance, nearest.triangle) &&
                !faces_away(slot))
                nearest = {row, slot, squared};
            return false;
        });
        if (nearest.triangle == NearestTriangle::none) return;
    }
    found.face = nearest.triangle;
    const Triangle& rows = triangles_[found.face];
    const auto& corners = tree_.corners(nearest.slot);
    const Vec3 foot = tree_.nearest_point(position, nearest.slot);
    double sum = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 &next = corners[(i + 1) % 3], &last = corners[(i + 2) % 3];
        const double opposite = (next - foot).cross(last - foot).norm();
        found.samples.push_back({rows[i], (corners[i] - position).squaredNorm(), opposite});
        sum += opposite;
    }
    std::ranges::sort(found.samples, {}, [](const Sample& sample) { return std::pair(sample.squared, sample.row); });
    found.nearest = found.samples.front().row;
    if (!(sum > 0)) {  // a triangle without area
        found.samples.resize(1);
        found.samples.front().weight = 1;
    }
    normalise(found.samples);
}

double squared_colour_distance(const Column& colour, u32 a, u32 b) {
    double sum = 0;
    for (u32 channel = 0; channel < 3; ++channel) {
        const double difference = colour.number(a, channel) - colour.number(b, channel);
        sum += difference * difference;
    }
    return sum;
}

}  // namespace scanmill::transferring
