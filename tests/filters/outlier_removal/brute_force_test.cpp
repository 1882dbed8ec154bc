// SPDX-License-Identifier: GPL-3.0-or-later
/// outlier-removal against an implementation of its header's rules that compares all pairs of points.
#include <gmock/gmock.h>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "filters/outlier_removal/cases.hpp"
#include "scanmill/geometry/fit/covariance.hpp"
#include "support/point_sets.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

using Method = OutlierRemovalParams::Method;

double distance(const Vec3& a, const Vec3& b) { return (a - b).norm(); }

/// For each row, whether it is an outlier.
std::vector<bool> outliers_of(const PointCloud& cloud, const OutlierRemovalParams& params) {
    const std::size_t rows = cloud.size();
    std::vector<double> distances(rows);
    for (std::size_t row = 0; row < rows; ++row) {
        std::vector<double> others;
        for (std::size_t other = 0; other < rows; ++other)
            if (other != row) others.push_back(distance(cloud.positions[row], cloud.positions[other]));
        std::ranges::sort(others);
        if (params.method == Method::radius) {
            distances[row] = others.size() < params.neighbours ? std::numeric_limits<double>::infinity()
                                                               : others[params.neighbours - 1];
            continue;
        }
        others.resize(std::min<std::size_t>(others.size(), params.neighbours));
        for (const double other : others) distances[row] += other / static_cast<double>(others.size());
    }

    double limit = params.radius.value();
    if (params.method == Method::statistical) {
        double mean = 0, squares = 0;
        for (const double d : distances) mean += d / static_cast<double>(rows);
        for (const double d : distances) squares += (d - mean) * (d - mean);
        limit = mean + params.factor * std::sqrt(squares / std::max(1.0, static_cast<double>(rows) - 1));
        limit *= 1 + 1e-12;
    }
    std::vector<bool> result(rows);
    for (std::size_t row = 0; row < rows; ++row) result[row] = distances[row] > limit;
    if (params.min_component.value() == 0) return result;

    const auto before = [](const Vec3& a, const Vec3& b) {
        return std::ranges::lexicographical_compare(std::span(a.data(), 3), std::span(b.data(), 3));
    };
    std::map<Vec3, bool, decltype(before)> suspects(before);
    for (std::size_t row = 0; row < rows; ++row) suspects[cloud.positions[row]] = result[row];
    std::vector<Vec3> positions;
    std::vector<bool> is_suspect;
    for (const auto& [position, suspect] : suspects) positions.push_back(position), is_suspect.push_back(suspect);
    const std::size_t size = positions.size();
    const auto larger_middle = [](std::vector<double> values) {
        std::ranges::sort(values);
        return values[values.size() / 2];
    };
    std::vector<std::vector<std::size_t>> nearest(size);
    std::vector<double> means(size, 0), around_means(size), variations(size), heights(size);
    for (std::size_t i = 0; i < size; ++i) {
        for (std::size_t j = 0; j < size; ++j)
            if (j != i) nearest[i].push_back(j);
        std::ranges::stable_sort(nearest[i], {}, [&](std::size_t j) {
            const Vec3 d = positions[i] - positions[j];
            return (d.x() * d.x() + d.y() * d.y()) + d.z() * d.z();
        });
        nearest[i].resize(std::min<std::size_t>(nearest[i].size(), params.neighbours));
        std::vector<Vec3> around;
        for (const std::size_t j : nearest[i]) {
            around.push_back(positions[j] - positions[i]);
            means[i] += around.back().norm();
        }
        means[i] /= static_cast<double>(nearest[i].size());
        const Scatter scatter = scatter_of(around);
        heights[i] = std::abs(scatter.normal.dot(scatter.centroid));
        around.push_back(Vec3::Zero());
        variations[i] = scatter_of(around).surface_variation;
    }
    std::vector<double> flat_means, logs(size);
    for (std::size_t i = 0; i < size; ++i) {
        std::vector<double> others;
        for (const std::size_t j : nearest[i]) others.push_back(means[j]);
        around_means[i] = larger_middle(others);
        logs[i] = std::log(means[i] / around_means[i]);
        if (variations[i] <= 0.05) flat_means.push_back(means[i]);
    }
    if (params.method == Method::statistical) {
        const double middle = larger_middle(logs);
        std::vector<double> deviations;
        for (const double ratio : logs) deviations.push_back(std::abs(ratio - middle));
        const double most = std::max(0.25, middle + params.factor * 1.4826 * larger_middle(deviations));
        for (std::size_t i = 0; i < size; ++i) is_suspect[i] = logs[i] > most;
    }
    const double usual = larger_middle(flat_means.empty() ? means : flat_means), sparse = 2.5 * usual;

    std::vector<bool> hovers(size), scattered(size), in_surface(size), cut_off(size, false), member(size, false);
    for (std::size_t i = 0; i < size; ++i) {
        const double first = distance(positions[i], positions[nearest[i][0]]);
        hovers[i] = is_suspect[i] && means[i] > usual && first > 0.6 * means[i] && heights[i] > 0.6 * means[i];
        scattered[i] = means[i] > sparse && variations[i] > 0.05;
        in_surface[i] =
            (!is_suspect[i] && means[i] <= sparse) || (variations[i] <= 0.0125 && heights[i] <= 0.5 * around_means[i]);
    }
    const auto among = [&](std::size_t i, std::size_t j) {
        return std::ranges::find(nearest[j], i) != nearest[j].end();
    };
    const auto components = [&](const auto& connected) {
        std::vector<std::size_t> component(size, size);
        std::size_t count = 0;
        for (std::size_t seed = 0; seed < size; ++seed) {
            if (component[seed] != size) continue;
            std::vector<std::size_t> open{seed};
            component[seed] = count;
            while (!open.empty()) {
                const std::size_t i = open.back();
                open.pop_back();
                for (std::size_t j = 0; j < size; ++j)
                    if (component[j] == size && connected(i, j)) component[j] = count, open.push_back(j);
            }
            ++count;
        }
        return component;
    };
    for (std::size_t i = 0; i < size; ++i) {
        const auto others = std::ranges::count_if(nearest[i], [&](std::size_t j) { return bool(scattered[j]); });
        member[i] = scattered[i] && !hovers[i] && 2 * (static_cast<std::size_t>(others) + 1) > nearest[i].size() + 1;
    }
    const std::vector<std::size_t> cluster =
        components([&](std::size_t i, std::size_t j) { return member[i] && member[j] && among(i, j) && among(j, i); });
    std::vector<double> members(size, 0), linked(size, 0);
    for (std::size_t i = 0; i < size; ++i) {
        if (!member[i]) continue;
        ++members[cluster[i]];
        linked[cluster[i]] += std::ranges::any_of(
            nearest[i], [&](std::size_t j) { return !scattered[j] && !is_suspect[j] && among(i, j); });
    }
    for (std::size_t i = 0; i < size; ++i) cut_off[i] = member[i] && linked[cluster[i]] < 0.15 * members[cluster[i]];

    const auto usable = [&](std::size_t i) { return !hovers[i] && !cut_off[i]; };
    const auto connects = [&](std::size_t i) {
        return usable(i) && (!is_suspect[i] || means[i] <= sparse || in_surface[i]);
    };
    std::vector<std::size_t> component = components([&](std::size_t i, std::size_t j) {
        if (!connects(i) || !connects(j)) return false;
        const double d = distance(positions[i], positions[j]);
        if (!is_suspect[i] && !is_suspect[j] && d <= params.radius.value()) return true;
        if (d > 6 * std::min(means[i], means[j])) return false;
        if (params.method == Method::radius && d > 2 * limit) return false;
        const bool of_i = among(j, i), of_j = among(i, j);
        return (of_i && of_j) || (of_i && in_surface[i]) || (of_j && in_surface[j]);
    });
    for (std::size_t i = 0; i < size; ++i) {
        if (connects(i) || !usable(i)) continue;
        for (const std::size_t j : nearest[i]) {
            const double d = distance(positions[i], positions[j]);
            const bool is_near =
                d <= 6 * std::min(means[i], means[j]) && (params.method == Method::statistical || d <= 2 * limit);
            if (!connects(j) || !is_near || !among(i, j)) continue;
            component[i] = component[j];
            break;
        }
    }
    std::vector<double> sizes(size, 0), areas(size, 0), scatters(size, 0);
    double whole = 0;
    for (std::size_t i = 0; i < size; ++i) {
        const double area = in_surface[i] && usable(i) ? means[i] * means[i] : 0;
        ++sizes[component[i]];
        areas[component[i]] += area;
        scatters[component[i]] += scattered[i];
        whole += area;
    }
    const double largest = std::ranges::max(sizes), share = params.min_component.value();
    const double fewest = std::min(largest, params.neighbours + 1.0);
    std::vector<bool> kept(size);
    for (std::size_t c = 0; c < size; ++c)
        kept[c] = sizes[c] >= std::max(1.0, fewest) && 2 * scatters[c] <= sizes[c] &&
                  (sizes[c] >= share * static_cast<double>(size) || (whole > 0 && areas[c] >= share * whole));
    if (std::ranges::count(kept, true) == 0 && largest >= share * static_cast<double>(size))
        kept[static_cast<std::size_t>(std::ranges::max_element(sizes) - sizes.begin())] = true;
    std::set<Vec3, decltype(before)> removed(before);
    for (std::size_t i = 0; i < size; ++i)
        if (!kept[component[i]]) removed.insert(positions[i]);
    for (std::size_t row = 0; row < rows; ++row) result[row] = removed.contains(cloud.positions[row]);
    return result;
}

void expect_as_brute_force(const PointCloud& cloud, OutlierRemovalParams params, std::string_view what) {
    const std::vector<bool> expected = outliers_of(cloud, params);
    if (std::ranges::count(expected, false) == 0) {
        EXPECT_THROW(clean(cloud, params), Error) << what;
    }
    params.mark = true;
    const OutlierRemovalResult result = clean(cloud, params);
    const std::span<const u8> marks = result.points.columns.find("outlier")->values<u8>();
    EXPECT_EQ(std::vector<bool>(marks.begin(), marks.end()), expected) << what;
}

/// A sphere, sparser on one side, with outliers and some duplicates.
PointCloud uneven(std::uint64_t seed) {
    Random random(seed);
    std::vector<Vec3> points;
    for (const Vec3& p : random_sphere(500, seed).positions)
        if (p.z() < 0 || random.uniform() < 0.3) points.push_back(p);
    for (int i = 0; i < 20; ++i) points.push_back(points[random.index(points.size())]);
    return with_outliers(cloud_of_points(points), 25, 2, seed + 1);
}

TEST(OutlierRemovalBruteForce, UnevenCloudsWithOutliersAndDuplicates_GiveTheSamePoints) {
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        const PointCloud cloud = uneven(seed);
        for (const u32 neighbours : {1u, 5u, 16u, 40u})
            for (const double share : {0.0, 0.001, 0.1}) {
                OutlierRemovalParams params;
                params.neighbours = neighbours;
                params.factor = seed % 2 == 0 ? 3 : 1;
                params.radius = 0.1 * static_cast<double>(seed % 4);
                params.min_component = Ratio::fraction(share);
                expect_as_brute_force(cloud, params, fmt::format("seed {}, {} neighbours", seed, neighbours));
            }
    }
}

TEST(OutlierRemovalBruteForce, ByRadius_GivesTheSamePoints) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed)
        for (const double share : {0.0, 0.001, 0.02})
            expect_as_brute_force(uneven(seed), by_radius(6, 0.25, Ratio::fraction(share)),
                                  fmt::format("seed {}", seed));
}

TEST(OutlierRemovalBruteForce, LatticesFullOfTies_GiveTheSamePoints) {
    // Integer coordinates, so that squared distances are exact.
    Random random(5);
    for (int round = 0; round < 12; ++round) {
        std::vector<Vec3> points;
        for (int i = 0; i < 150; ++i)
            points.emplace_back(random.index(10), random.index(10), round % 2 == 0 ? 0 : random.index(3));
        for (int i = 0; i < 6; ++i) points.emplace_back(random.index(40), random.index(40), random.index(40));
        expect_as_brute_force(cloud_of_points(points), by_radius(5, 2, Ratio::percent(3)), "radius");
        OutlierRemovalParams params = by_radius(6, 2, Ratio::percent(1));
        params.method = Method::statistical;
        expect_as_brute_force(cloud_of_points(points), params, "statistical");
    }
}

TEST(OutlierRemovalLaws, ThreadsAndOrder_DoNotMatter) {
    const PointCloud cloud = with_outliers(random_sphere(30'000, 3), 1500, 2, 4);
    const OutlierRemovalResult one = clean(cloud, {}, 1);
    EXPECT_GT(one.removed, 1000u);
    for (const unsigned threads : {2u, 5u}) {
        const OutlierRemovalResult other = clean(cloud, {}, threads);
        EXPECT_EQ(other.kept, one.kept);
        EXPECT_EQ(other.log_limit, one.log_limit);
    }
    const OutlierRemovalResult turned = clean(shuffled(cloud, 9));
    EXPECT_EQ(turned.log_limit, one.log_limit);
    const auto sorted = [](const PointCloud& points) {
        std::vector<Vec3> result(points.positions.begin(), points.positions.end());
        std::ranges::sort(result, [](const Vec3& a, const Vec3& b) {
            return std::ranges::lexicographical_compare(std::span(a.data(), 3), std::span(b.data(), 3));
        });
        return result;
    };
    EXPECT_EQ(sorted(turned.points), sorted(one.points));
}

TEST(OutlierRemovalLaws, MovedTurnedAndScaled_TheSameRowsStay) {
    const PointCloud cloud = with_outliers(fibonacci_sphere(3000, 0.01), 150, 2, 4);
    const Array<u32> kept = clean(cloud).kept;
    EXPECT_EQ(clean(moved(cloud, 2.54)).kept, kept);
    EXPECT_EQ(clean(moved(cloud, 1, Vec3(1e3, -2e3, 5e2))).kept, kept);
    EXPECT_EQ(clean(rotated(cloud, 0.7)).kept, kept);
}

TEST(OutlierRemovalLaws, HigherFactor_RemovesNoMore) {
    const PointCloud cloud = uneven(3);
    std::size_t before = cloud.size();
    for (const double factor : {0.5, 1.0, 2.0, 3.0, 6.0}) {
        const std::size_t removed = clean(cloud, suspects_only(16, factor)).removed;
        EXPECT_LE(removed, before);
        before = removed;
    }
    EXPECT_LT(before, 10u);
}

}  // namespace
}  // namespace scanmill::test
