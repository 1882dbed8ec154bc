// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/registration/descriptors.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "scanmill/geometry/spatial/angle.hpp"

namespace scanmill {

namespace {

constexpr int bins = 11;
static_assert(3 * bins == descriptor_size);
/// The bins of an angle add up to this.
constexpr double total = 100;
/// Products of unit vectors are rounded to this. Parallel normals are common on flat parts; rounding must not decide
/// which comes first.
constexpr double rounding = 1e-9;

/// The bins of the three angles between two points with normals. The point whose normal is nearer to the connecting
/// line comes first; for equal angles, `from`. Empty for points whose normals lie along that line.
std::optional<std::array<int, 3>> bins_of(const Vec3& from, const Vec3& from_normal, const Vec3& to,
                                          const Vec3& to_normal) {
    Vec3 line = (to - from).normalized(), first = from_normal, second = to_normal;
    double slope = first.dot(line);
    if (const double other = second.dot(line); std::abs(slope) < std::abs(other) - rounding) {
        std::swap(first, second);
        line = -line;
        slope = -other;
    }
    Vec3 v = line.cross(first);
    const double length = v.norm();
    if (!(length > rounding)) return std::nullopt;
    v /= length;
    const double cosine = first.dot(second), sine = first.cross(v).dot(second);
    const double angle = sine < 0 ? -angle_of(cosine, -sine) : angle_of(cosine, sine);
    const auto bin = [](double share) { return std::clamp(static_cast<int>(std::floor(bins * share)), 0, bins - 1); };
    return std::array{bin((angle + std::numbers::pi) / (2 * std::numbers::pi)), bins + bin((v.dot(second) + 1) / 2),
                      2 * bins + bin((slope + 1) / 2)};
}

/// The most similar of the points offered, ascending by squared distance; ties: the lower index.
class MostSimilar {
public:
    explicit MostSimilar(std::size_t count) : best_(count, {std::numeric_limits<double>::infinity(), ~u32(0)}) {}
    /// Pre: indices ascend from call to call.
    void offer(double squared, u32 index) {
        if (!(squared < best_.back().squared)) return;
        std::size_t slot = best_.size() - 1;
        for (; slot > 0 && squared < best_[slot - 1].squared; --slot) best_[slot] = best_[slot - 1];
        best_[slot] = {squared, index};
    }
    double limit() const { return best_.back().squared; }
    std::span<const Neighbour> found() const { return best_; }

private:
    std::vector<Neighbour> best_;
};

}  // namespace

Array<Descriptor> point_descriptors(const PointTree& tree, std::span<const Vec3> normals, double radius,
                                    std::size_t most_neighbours) {
    const std::span<const Vec3> points = tree.positions();
    assert(normals.size() == points.size());
    Array<std::span<const Neighbour>> neighbours(points.size());
    Array<Neighbour> all;
    all.reserve(points.size() * most_neighbours);
    NeighbourBuffer buffer;
    for (u32 i = 0; i < points.size(); ++i) {
        const std::size_t begin = all.size();
        for (const Neighbour& n : tree.nearest(i, most_neighbours, buffer))
            if (n.squared <= radius * radius) all.push_back(n);
        neighbours[i] = {all.data() + begin, all.size() - begin};
    }

    Array<Descriptor> own(points.size());
    for (u32 i = 0; i < points.size(); ++i) {
        own[i].fill(0);
        const double share = total / static_cast<double>(std::max<std::size_t>(1, neighbours[i].size()));
        for (const Neighbour& n : neighbours[i])
            if (const auto hit = bins_of(points[i], normals[i], points[n.index], normals[n.index]))
                for (const int bin : *hit) own[i][static_cast<std::size_t>(bin)] += share;
    }

    Array<Descriptor> descriptors(points.size());
    for (u32 i = 0; i < points.size(); ++i) {
        Descriptor sum{};
        for (const Neighbour& n : neighbours[i])
            for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += own[n.index][k] / n.squared;
        for (std::size_t begin = 0; begin < sum.size(); begin += bins) {
            double size = 0;
            for (std::size_t k = begin; k < begin + bins; ++k) size += sum[k];
            for (std::size_t k = begin; k < begin + bins; ++k)
                descriptors[i][k] = own[i][k] + (size > 0 ? sum[k] * (total / size) : 0);
        }
    }
    return descriptors;
}

Array<Correspondence> similar_points(std::span<const Descriptor> first, std::span<const Descriptor> second,
                                     std::size_t nearest, std::size_t most) {
    // Distances are computed for eight points of the second set at a time, in registers.
    constexpr std::size_t lanes = 8;
    using Lanes = Eigen::Array<double, lanes, 1>;
    const std::size_t blocks = (second.size() + lanes - 1) / lanes;
    std::vector<Lanes> transposed(blocks * descriptor_size, Lanes::Constant(std::numeric_limits<double>::infinity()));
    for (std::size_t j = 0; j < second.size(); ++j)
        for (std::size_t k = 0; k < descriptor_size; ++k)
            transposed[j / lanes * descriptor_size + k][static_cast<Eigen::Index>(j % lanes)] = second[j][k];

    std::vector<MostSimilar> of_first(first.size(), MostSimilar(nearest)),
        of_second(second.size(), MostSimilar(nearest));
    for (std::size_t block = 0; block < blocks; ++block) {
        const std::size_t size = std::min(lanes, second.size() - block * lanes);
        const Lanes* const values = &transposed[block * descriptor_size];
        for (u32 i = 0; i < first.size(); ++i) {
            Lanes squares = Lanes::Zero();
            for (std::size_t k = 0; k < descriptor_size; ++k) squares += (values[k] - first[i][k]).square();
            for (std::size_t lane = 0; lane < size; ++lane) {
                const double squared = squares[static_cast<Eigen::Index>(lane)];
                const u32 j = static_cast<u32>(block * lanes + lane);
                of_first[i].offer(squared, j);
                of_second[j].offer(squared, i);
            }
        }
    }

    Array<Correspondence> pairs;
    for (u32 i = 0; i < first.size(); ++i)
        for (const Neighbour& n : of_first[i].found())
            if (n.index != ~u32(0)) pairs.push_back({i, n.index, n.squared});
    for (u32 j = 0; j < second.size(); ++j)
        for (const Neighbour& n : of_second[j].found())
            if (n.index != ~u32(0)) pairs.push_back({n.index, j, n.squared});
    const auto comes_before = [](const Correspondence& a, const Correspondence& b) {
        if (a.squared != b.squared) return a.squared < b.squared;
        return a.first != b.first ? a.first < b.first : a.second < b.second;
    };
    std::ranges::sort(pairs, comes_before);
    const auto is_same = [](const Correspondence& a, const Correspondence& b) {
        return a.first == b.first && a.second == b.second;
    };
    pairs.erase(std::unique(pairs.begin(), pairs.end(), is_same), pairs.end());
    if (pairs.size() > most) pairs.resize(most);
    return pairs;
}

}  // namespace scanmill
