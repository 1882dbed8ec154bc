// SPDX-License-Identifier: GPL-3.0-or-later
#include "alpha_solid/widest_path_sweep.hpp"

#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>

#include "alpha_solid/components.hpp"
#include "filters/alpha_solid/cases.hpp"
#include "support/point_sets.hpp"
#include "support/shapes.hpp"

namespace scanmill::alpha {
namespace {

using namespace test;
using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;

Array<SweepCell> cells_of(const TetMesh& tets) {
    Context context;
    return sweep_cells(tets, context);
}

SweepResult sweep_of(const TetMesh& tets, const SweepLimits& limits) {
    Context context;
    return sweep_from_outside(cells_of(tets), tets.positions.size(), limits, context);
}

SweepResult whole_sweep(const TetMesh& tets) { return sweep_of(tets, {.value = 0, .coverage = 1}); }

std::vector<PointCloud> various_clouds() {
    return {random_cube(150, 1), lattice_cube(3), lattice_cube(4, 0.1, true), fibonacci_sphere(200, 1e-3),
            joined(fibonacci_sphere(100), moved(fibonacci_sphere(80), 0.5, Vec3(3, 0, 0)))};
}

/// The definition, in exact arithmetic: whether the facet is a wall at squared radius `value`.
bool is_wall(const TetMesh& tets, u32 cell, int corner, double value) {
    const auto point = [&](u32 vertex) {
        const Vec3& p = tets.positions[vertex];
        return Kernel::Point_3(p.x(), p.y(), p.z());
    };
    const auto radius = [&](u32 c) {
        const auto& [i, j, k, l] = tets.cells[c];
        return CGAL::squared_radius(point(i), point(j), point(k), point(l));
    };
    const auto& [i, j, k] = outward_facet[corner];
    const auto a = point(tets.cells[cell][i]), b = point(tets.cells[cell][j]), c = point(tets.cells[cell][k]);
    const u32 across = tets.neighbours[cell][corner];
    const auto inside = [&](u32 vertex) {
        return CGAL::side_of_bounded_sphere(a, b, c, point(vertex)) == CGAL::ON_BOUNDED_SIDE;
    };
    bool attached = inside(tets.cells[cell][corner]);
    auto least = radius(cell);
    if (across != TetMesh::outside_hull) {
        for (u32 vertex : tets.cells[across])
            if (std::ranges::find(tets.cells[cell], vertex) == tets.cells[cell].end()) attached |= inside(vertex);
        least = std::min(least, radius(across));
    }
    return (attached ? least : CGAL::squared_radius(a, b, c)) <= value;
}

/// The definition: outside is everything that can be reached from outside the hull without crossing a wall.
Array<u8> brute_force_solid(const TetMesh& tets, double value) {
    Array<u8> labels(tets.cells.size());
    std::ranges::fill(labels, solid);
    std::deque<u32> open;
    for (u32 c = 0; c < labels.size(); ++c)
        for (int i = 0; i < 4; ++i)
            if (tets.neighbours[c][i] == TetMesh::outside_hull && labels[c] == solid && !is_wall(tets, c, i, value)) {
                labels[c] = outside;
                open.push_back(c);
            }
    for (; !open.empty(); open.pop_front())
        for (int i = 0; i < 4; ++i) {
            const u32 across = tets.neighbours[open.front()][i];
            if (across == TetMesh::outside_hull || labels[across] == outside || is_wall(tets, open.front(), i, value))
                continue;
            labels[across] = outside;
            open.push_back(across);
        }
    return labels;
}

Array<u8> labels_at(const TetMesh& tets, const SweepResult& sweep, double value) {
    Array<u8> labels(tets.cells.size());
    std::ranges::fill(labels, solid);
    for (std::size_t i = 0; i < sweep.outside_above(value); ++i) labels[sweep.cells[i]] = outside;
    return labels;
}

TEST(WidestPathSweep, AtManyLevels_IsTheBruteForceFloodFill) {
    for (const PointCloud& cloud : various_clouds()) {
        const TetMesh tets = tets_of(cloud);
        const SweepResult sweep = whole_sweep(tets);
        ASSERT_EQ(sweep.cells.size(), tets.cells.size());
        for (double quantile : {0.05, 0.3, 0.6, 0.9, 0.99}) {
            // Between two values that differ by more than rounding, so that exact and rounded values agree.
            std::size_t i = static_cast<std::size_t>(quantile * static_cast<double>(sweep.values.size()));
            while (i + 1 < sweep.values.size() && sweep.values[i + 1] > sweep.values[i] * (1 - 1e-6)) ++i;
            if (i + 1 == sweep.values.size()) continue;
            const double value = std::sqrt(sweep.values[i] * sweep.values[i + 1]);
            EXPECT_EQ(labels_at(tets, sweep, value), brute_force_solid(tets, value)) << quantile;
        }
    }
}

TEST(WidestPathSweep, EveryCell_ComesAtItsWidestPath) {
    for (const PointCloud& cloud : various_clouds()) {
        const TetMesh tets = tets_of(cloud);
        const Array<SweepCell> values = cells_of(tets);
        const SweepResult sweep = whole_sweep(tets);
        EXPECT_TRUE(std::ranges::is_sorted(sweep.values, std::greater<>()));
        // Bellman–Ford: relax until nothing changes.
        Array<double> out(tets.cells.size());
        std::ranges::fill(out, -1.0);
        for (bool changed = true; changed;) {
            changed = false;
            for (u32 c = 0; c < out.size(); ++c)
                for (int i = 0; i < 4; ++i) {
                    const u32 across = tets.neighbours[c][i];
                    const double beyond = across == TetMesh::outside_hull ? HUGE_VAL : out[across];
                    const double path = std::min(beyond, values[c].values[i]);
                    if (path > out[c]) {
                        out[c] = path;
                        changed = true;
                    }
                }
        }
        for (std::size_t i = 0; i < sweep.cells.size(); ++i) ASSERT_EQ(sweep.values[i], out[sweep.cells[i]]);
    }
}

TEST(WidestPathSweep, FacetValues_AreTheSameFromBothSides) {
    for (const PointCloud& cloud : various_clouds()) {
        const TetMesh tets = tets_of(cloud);
        const Array<SweepCell> values = cells_of(tets);
        for (u32 c = 0; c < tets.cells.size(); ++c)
            for (int i = 0; i < 4; ++i) {
                const u32 across = tets.neighbours[c][i];
                if (across == TetMesh::outside_hull) continue;
                const auto back = std::ranges::find(tets.neighbours[across], c) - tets.neighbours[across].begin();
                ASSERT_EQ(values[across].values[back], values[c].values[i]);
            }
    }
}

TEST(WidestPathSweep, Cover_IsTheLeastValueThatCoversTheShare) {
    for (const PointCloud& cloud : various_clouds()) {
        const TetMesh tets = tets_of(cloud);
        const SweepResult whole = whole_sweep(tets);
        std::vector<double> cover(tets.positions.size(), HUGE_VAL);  // per point, the least out of its cells
        for (std::size_t i = 0; i < whole.cells.size(); ++i)
            for (u32 vertex : tets.cells[whole.cells[i]]) cover[vertex] = std::min(cover[vertex], whole.values[i]);
        std::ranges::sort(cover);
        for (double share : {1.0, 0.9, 0.5, 1e-9}) {
            const SweepResult sweep = sweep_of(tets, {.coverage = share});
            const auto needed = static_cast<std::size_t>(std::ceil(share * static_cast<double>(cover.size())));
            EXPECT_EQ(sweep.needed, needed);
            EXPECT_EQ(sweep.cover, cover[needed - 1]);
            // It stops early, but never inside a group of equal values or before that of cover.
            EXPECT_TRUE(std::ranges::equal(sweep.values, std::span(whole.values).first(sweep.values.size())));
            EXPECT_EQ(sweep.values.back(), sweep.cover);
            if (sweep.values.size() < whole.values.size()) {
                EXPECT_LT(whole.values[sweep.values.size()], sweep.cover);
            }
        }
    }
}

TEST(WidestPathSweep, AShareThatIsAWholeNumberOfPoints_IsNotRoundedUp) {
    const TetMesh tets = tets_of(random_cube(1000, 2));
    EXPECT_EQ(sweep_of(tets, {.coverage = 0.999}).needed, 999u);
    EXPECT_EQ(sweep_of(tets, {.coverage = 0.07}).needed, 70u);
    EXPECT_EQ(sweep_of(tets, {.coverage = 0.0701}).needed, 71u);
}

}  // namespace
}  // namespace scanmill::alpha
