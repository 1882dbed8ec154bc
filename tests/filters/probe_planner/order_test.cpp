// SPDX-License-Identifier: GPL-3.0-or-later
/// The tour over the touches, and its moves.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "filters/probe_planner/cases.hpp"
#include "probe_planner/tour.hpp"
#include "scanmill/base/random.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill::test {
namespace {

using probing::TouchLine;

struct Lines {
    std::vector<ProbeTouch> touches;
    std::vector<TouchLine> lines;
};

Lines random_lines(std::uint64_t seed, std::size_t count) {
    Random random(seed);
    Lines result;
    const auto add = [&](const Vec3& start) {
        ProbeTouch touch;
        touch.start = start;
        result.lines.back().rows.push_back(static_cast<u32>(result.touches.size()));
        result.touches.push_back(touch);
    };
    for (std::size_t i = 0; i < count; ++i) {
        const bool closed = random.index(2) == 0;
        result.lines.push_back({closed, {}});
        const Vec3 at = 20 * Vec3(random.uniform(), random.uniform(), random.uniform());
        const auto size = 1 + random.index(8);
        for (std::size_t j = 0; j < size; ++j) {
            const double angle = 2 * pi * static_cast<double>(j) / static_cast<double>(size);
            add(at + (closed ? Vec3(std::cos(angle), std::sin(angle), 0) : Vec3(static_cast<double>(j), 0.1, 0)));
        }
    }
    return result;
}

double length_of(const Lines& lines, const std::vector<u32>& tour, const Vec3& home) {
    double length = 0;
    Vec3 from = home;
    for (const u32 row : tour) {
        length += (lines.touches[row].start - from).norm();
        from = lines.touches[row].start;
    }
    return length;
}

/// The tour cut into its lines.
std::vector<std::vector<u32>> passages(const Lines& lines, const std::vector<u32>& tour) {
    std::vector<u32> line_of(lines.touches.size());
    for (u32 i = 0; i < lines.lines.size(); ++i)
        for (const u32 row : lines.lines[i].rows) line_of[row] = i;
    std::vector<std::vector<u32>> result;
    for (std::size_t i = 0; i < tour.size(); ++i) {
        if (i == 0 || line_of[tour[i]] != line_of[tour[i - 1]]) result.emplace_back();
        result.back().push_back(tour[i]);
    }
    return result;
}

std::vector<u32> tour_of(const Lines& lines, const Vec3& home) {
    return tour_over(lines.lines, lines.touches, home, 30, Context());
}

TEST(Tour, OverRandomLines_TakesEachTouchOnce_LineByLine_AndNoExchangeShortensIt) {
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        const Lines lines = random_lines(seed, 12);
        const Vec3 home(10, 10, 30);
        const std::vector<u32> tour = tour_of(lines, home);
        EXPECT_EQ(std::set<u32>(tour.begin(), tour.end()).size(), lines.touches.size());
        EXPECT_EQ(tour.size(), lines.touches.size());
        std::vector<std::vector<u32>> parts = passages(lines, tour);
        ASSERT_EQ(parts.size(), lines.lines.size()) << "the touches of one line stay together";
        for (const auto& part : parts) {
            const TouchLine& line = *std::ranges::find_if(
                lines.lines, [&](const TouchLine& l) { return std::ranges::find(l.rows, part[0]) != l.rows.end(); });
            std::vector<u32> rows = line.rows;
            if (line.closed) {
                std::ranges::rotate(rows, std::ranges::find(rows, part[0]));
                std::vector<u32> back(rows.begin() + 1, rows.end());
                std::ranges::reverse(back);
                back.insert(back.begin(), rows[0]);
                EXPECT_TRUE(part == rows || part == back);
            } else {
                std::vector<u32> back(rows.rbegin(), rows.rend());
                EXPECT_TRUE(part == rows || part == back);
            }
        }
        const double length = length_of(lines, tour, home);
        for (std::size_t i = 0; i < parts.size(); ++i)
            for (std::size_t j = i; j < parts.size(); ++j) {
                auto changed = parts;
                std::reverse(changed.begin() + static_cast<std::ptrdiff_t>(i),
                             changed.begin() + static_cast<std::ptrdiff_t>(j) + 1);
                std::vector<u32> rows;
                for (std::size_t k = 0; k < changed.size(); ++k) {
                    if (k >= i && k <= j) std::ranges::reverse(changed[k]);
                    rows.insert(rows.end(), changed[k].begin(), changed[k].end());
                }
                EXPECT_GE(length_of(lines, rows, home), length - 1e-6) << seed << ' ' << i << ' ' << j;
            }
    }
}

TEST(Tour, OrderOfTheLines_DoesNotMatter) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        Lines lines = random_lines(seed, 9);
        const Vec3 home(10, 10, 30);
        const double before = length_of(lines, tour_of(lines, home), home);
        std::ranges::reverse(lines.lines);
        std::ranges::rotate(lines.lines, lines.lines.begin() + 4);
        EXPECT_NEAR(length_of(lines, tour_of(lines, home), home), before, 1e-9);
    }
}

TEST(Tour, Cancelled_EndsInEveryLoop) {
    // Cancelled after some checks: in the greedy tour, and while it is shortened.
    const Lines lines = random_lines(3, 12);
    for (const int after : {0, 5, 13, 20}) {
        ContextOptions options;
        int checks = 0;
        options.is_cancelled = [&] { return checks++ >= after; };
        const Context context(options);
        EXPECT_THROW(tour_over(lines.lines, lines.touches, Vec3(10, 10, 30), 30, context), Cancelled) << after;
    }
}

/// Two rims with a wall between them.
TriangleMesh walled(double height) {
    return joined(joined(box(Vec3(0, 0, 0), Vec3(10, 10, 4), 4), box(Vec3(30, 0, 0), Vec3(40, 11, 4), 4)),
                  box(Vec3(19, -20, 0), Vec3(21, 30, height), 4));
}

/// The least distances of ball and stylus from the mesh, sampled along a move.
std::pair<double, double> least_distances(const TriangleTree& tree, const ProbePlan& plan, const Vec3& from,
                                          const Vec3& to) {
    std::pair<double, double> least(1e9, 1e9);
    constexpr int steps = 40;
    for (int i = 0; i <= steps; ++i) {
        const Vec3 centre = from + (to - from) * i / steps;
        least.first = std::min(least.first, std::sqrt(tree.nearest(centre).squared_distance) - plan.radius);
        for (int j = 0; j <= steps; ++j) {
            const double along = plan.radius + (plan.stylus_length - plan.radius) * j / steps;
            const Vec3 p = centre + along * plan.machine_axis;
            least.second = std::min(least.second, std::sqrt(tree.nearest(p).squared_distance) - plan.stylus_radius);
        }
    }
    return least;
}

TEST(ProbePlannerMoves, KeepTheirClearance_AndLeadFromTouchToTouch) {
    const TriangleMesh mesh = walled(20);
    const Planned result = planned(mesh, probe_of(0.5, 0.05, 3));
    const ProbePlan& plan = result.plan;
    const TriangleTree tree(mesh.positions.span(), mesh.triangles.span(), 1);
    std::size_t made = plan.touches.size() - result.unreachable;
    ASSERT_GT(made, 40u);
    ASSERT_EQ(plan.moves.size(), 3 * made);
    double travel = 0;
    std::set<u32> touched;
    Vec3 at = plan.moves[0].points[0];
    int detours = 0;
    for (std::size_t i = 0; i < plan.moves.size(); ++i) {
        const ProbeMove& move = plan.moves[i];
        const ProbeTouch& touch = plan.touches[move.touch];
        const Array<Vec3>& path = move.points;
        EXPECT_EQ(static_cast<std::size_t>(move.type), i % 3);
        EXPECT_EQ(touch.order, i / 3);
        EXPECT_EQ(path.front(), at);
        at = path.back();
        EXPECT_EQ(at, move.type == ProbeMoveType::approach ? touch.centre : touch.start);
        touched.insert(move.touch);
        for (std::size_t j = 1; j < path.size(); ++j) {
            travel += (path[j] - path[j - 1]).norm();
            const auto [ball, stylus] = least_distances(tree, plan, path[j - 1], path[j]);
            if (move.type == ProbeMoveType::clearance) {
                EXPECT_GE(ball, plan.clearance - 1e-9);
                EXPECT_GE(stylus, plan.clearance - 1e-9);
            } else {
                EXPECT_GE(ball, -1e-9);
                EXPECT_GE(stylus, -1e-9);
            }
        }
        detours += move.type == ProbeMoveType::clearance && path.size() > 2;
    }
    EXPECT_EQ(touched.size(), made);
    EXPECT_NEAR(result.travel, travel, 1e-9 * travel);
    EXPECT_GE(detours, 1);
}

TEST(ProbePlannerMoves, AWallBetweenTwoParts_ForcesADetourOverThePlane) {
    const TriangleMesh parts = joined(box(Vec3(0, 0, 0), Vec3(10, 10, 4), 4), box(Vec3(30, 0, 0), Vec3(40, 11, 4), 4));
    // Starts are at z = 5.8. The ball of radius 0.5 keeps 0.5, and the stylus above it as well.
    const struct {
        double low, height;
        std::size_t points;
    } walls[] = {{0, 20, 4}, {0, 1, 2}, {0, 4.75, 2}, {0, 5, 4}, {8, 9, 4}, {16.2, 17, 4}, {17, 18, 2}};
    for (const auto& [low, height, points] : walls) {
        const TriangleMesh mesh = joined(parts, box(Vec3(19, -20, low), Vec3(21, 30, height), 4));
        ProbePlannerParams params = probe_of(0.5, 0.05, 3);
        params.max_tilt = Angle::degrees(60);  // the upper edges alone
        const Planned result = planned(lines_of(parts), mesh, params);
        int across = 0;
        for (const ProbeMove& move : result.plan.moves) {
            const Array<Vec3>& path = move.points;
            if (&move == &result.plan.moves.front() || (path.front().x() < 20) == (path.back().x() < 20)) continue;
            ++across;
            ASSERT_EQ(path.size(), points) << low << ' ' << height;
            if (points == 2) continue;
            EXPECT_NEAR(path[1].z(), height + 0.5 + 0.5, 1e-9) << "radius and clearance above the wall";
            EXPECT_NEAR(path[2].z(), height + 0.5 + 0.5, 1e-9);
            EXPECT_EQ(path[1].head<2>(), path[0].head<2>());
            EXPECT_EQ(path[2].head<2>(), path[3].head<2>());
        }
        EXPECT_EQ(across, 1);
    }
}

TEST(ProbePlannerMoves, OrderOfTheLinesInTheFeatures_DoesNotChangeTheTravel) {
    // Sheared, so that no two ways are equally long.
    const TriangleMesh mesh = mapped(walled(9), [](const Vec3& p) {
        return Vec3(p.x() + 0.031 * p.y() + 0.017 * p.z(), p.y() - 0.023 * p.x() + 0.0007 * p.x() * p.x(), p.z());
    });
    FeatureGraph features = lines_of(mesh);
    const double before = planned(features, mesh, probe_of(0.5, 0.05, 2)).travel;
    std::ranges::reverse(features.polylines);
    std::ranges::rotate(features.polylines, features.polylines.begin() + 7);
    EXPECT_NEAR(planned(features, mesh, probe_of(0.5, 0.05, 2)).travel, before, 1e-9 * before);
}

TEST(ProbePlannerMoves, AStartThatCannotBeLeft_IsMovedFartherOut) {
    // A beam above the rim on the right: the start with a retract of 1 is below it.
    const TriangleMesh mesh =
        joined(box(Vec3(0, 0, 0), Vec3(10, 10, 10), 5), box(Vec3(10.5, -5, 13), Vec3(13, 15, 14), 5));
    ProbePlannerParams params = probe_of(0.5, 0.05, 5);
    params.retract = 1;
    params.stylus_length = 1;
    params.clearance = 0.1;
    const Planned result = planned(mesh, params);
    int moved = 0;
    for (const ProbeTouch& touch : result.plan.touches)
        if (touch.reason == ProbeReason::none)
            moved += (touch.start - touch.position).norm() > 1 / std::cos(touch.phi) + 0.4;
    EXPECT_GT(moved, 0);
}

}  // namespace
}  // namespace scanmill::test
