// SPDX-License-Identifier: GPL-3.0-or-later
/// Voronoi edges, poles and cocones of Delaunay tetrahedralisations against brute force.

#include "scanmill/geometry/tets/voronoi.hpp"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <map>

#include "cocone/candidates.hpp"
#include "filters/cocone/cases.hpp"
#include "scanmill/geometry/tets/circumspheres.hpp"
#include "support/numbers.hpp"
#include "support/shapes.hpp"

namespace scanmill {
namespace {

using namespace test;

constexpr double cone_angle = 22.5 * degree;

struct Dual {
    explicit Dual(const PointCloud& cloud, unsigned threads = 1) : tets(tets_of(cloud)), cells_at(tets, threads) {
        ExecutionOptions options;
        options.threads = threads;
        Execution execution(options);
        centres = circumcentres(tets, execution);
        poles = scanmill::poles(tets, centres, cells_at, execution);
        hits = cocone_hits(tets, centres, poles, cone_angle, execution);
    }

    TetMesh tets;
    VertexCells cells_at;
    Array<Vec3> centres;
    Poles poles;
    Array<std::uint16_t> hits;
};

PointCloud random_ball(std::size_t count, u64 seed) {
    const PointCloud cube = random_cube(3 * count, seed, 2);
    Array<Vec3> kept;
    for (const Vec3& p : cube.positions)
        if (kept.size() < count && (p - Vec3(1, 1, 1)).norm() < 1) kept.push_back(p);
    PointCloud ball;
    ball.positions = std::move(kept);
    return ball;
}

PointCloud noisy_torus() {
    PointCloud cloud = poisson_torus(0.18);
    Random random(8);
    Array<Vec3> moved(cloud.positions.begin(), cloud.positions.end());
    for (Vec3& p : moved) p += 0.05 * Vec3(random.normal(), random.normal(), random.normal());
    cloud.positions = std::move(moved);
    return cloud;
}

/// The facet's normal that leaves the cell, from the positions alone.
Vec3 leaving_normal(const TetMesh& tets, u32 cell, int corner) {
    const Vec3& apex = tets.positions[tets.cells[cell][static_cast<std::size_t>(corner)]];
    std::vector<Vec3> others;
    for (int k = 0; k < 4; ++k)
        if (k != corner) others.push_back(tets.positions[tets.cells[cell][static_cast<std::size_t>(k)]]);
    const Vec3 normal = (others[1] - others[0]).cross(others[2] - others[0]).normalized();
    return normal.dot(apex - others[0]) > 0 ? -normal : normal;
}

/// The directions from a corner of a facet to the points of its dual edge: an arc of a great circle. A ray ends in its
/// own direction.
class Arc {
public:
    Arc(const Vec3& to_first, const Vec3& to_last, double length_of_first)
        : first_(to_first),
          last_(to_last),
          length_of_first_(length_of_first),
          angle_(std::atan2(first_.cross(last_).norm(), first_.dot(last_))) {}

    static constexpr int count = 10'000;
    /// The angle between neighbouring samples.
    double step() const { return angle_ / (count - 1); }
    /// The sum of the errors of directions: the ends are circumcentres, and an arc of nearly 180 degrees magnifies
    /// their errors.
    double rounding() const { return 1e-8 / (angle_ < std::numbers::pi / 2 ? 1 : std::sin(angle_)); }
    /// Sample i, of unit length.
    Vec3 direction(int i) const {
        const double at = i * step();
        if (angle_ < 1e-4) return (first_ + (double(i) / (count - 1)) * (last_ - first_)).normalized();
        return (std::sin(angle_ - at) * first_ + std::sin(at) * last_) / std::sin(angle_);
    }
    /// Calls visit(y) for every sample's height over the tangent plane, relative to its distance.
    template <class Visit>
    void for_each_height(const Vec3& axis, const Visit& visit) const {
        const double first = first_.dot(axis), last = last_.dot(axis);
        if (angle_ < 1e-4) {
            for (int i = 0; i < count; ++i) visit(i, direction(i).dot(axis));
            return;
        }
        // The direction turns by one step each time.
        const double sine = std::sin(angle_), turn_sine = std::sin(step()), turn_cosine = std::cos(step());
        double c = 1, s = 0;
        const double across = (last - first * std::cos(angle_)) / sine;
        for (int i = 0; i < count; ++i) {
            visit(i, first * c + across * s);
            const double next = c * turn_cosine - s * turn_sine;
            s = s * turn_cosine + c * turn_sine;
            c = next;
        }
    }
    /// The distance of sample i from the corner, on an edge in the given direction.
    double distance(int i, const Vec3& along) const {
        const Vec3 offset = length_of_first_ * first_;
        const Vec3 foot = offset - offset.dot(along) * along;
        return foot.squaredNorm() / direction(i).dot(foot);
    }

private:
    Vec3 first_, last_;
    double length_of_first_, angle_;
};

struct Decided {
    std::size_t inside = 0, outside = 0, near_limit = 0, crossing = 0;
};

/// Compares meets() and squared_reach() with samples, for every facet, each of its corners, and two axes: the pole's
/// direction and a random one.
Decided compare_with_samples(const Dual& dual, u64 seed) {
    Random random(seed);
    Decided decided;
    const TetMesh& tets = dual.tets;
    const double sine = std::sin(cone_angle);
    for (u32 cell = 0; cell < tets.cells.size(); ++cell)
        for (int corner = 0; corner < 4; ++corner) {
            if (!owns_facet(tets, cell, corner)) continue;
            const u32 across = tets.neighbours[cell][static_cast<std::size_t>(corner)];
            const VoronoiEdge edge = dual_edge(tets, dual.centres, cell, corner);
            const Vec3 along = leaving_normal(tets, cell, corner);
            EXPECT_GT(edge.normal.dot(along), 1 - 1e-9);
            EXPECT_LE(edge.from, edge.to);
            EXPECT_EQ(std::isinf(edge.to), across == TetMesh::outside_hull);
            for (int j = 0; j < 4; ++j) {
                if (j == corner) continue;
                const u32 vertex = tets.cells[cell][static_cast<std::size_t>(j)];
                const Vec3& p = tets.positions[vertex];
                const Vec3 to_first = dual.centres[cell] - p;
                const Vec3 last = across == TetMesh::outside_hull ? along : (dual.centres[across] - p).normalized();
                const Arc arc(to_first.normalized(), last, to_first.norm());
                const Vec3 other = Vec3(random.normal(), random.normal(), random.normal()).normalized();
                for (const Vec3& axis : {dual.poles.directions[vertex], other}) {
                    const Cocone cocone{p, axis, sine * sine};
                    double least = 1, previous = 0, first_height = 0, last_height = 0;
                    int crossing = -1;
                    arc.for_each_height(axis, [&](int i, double height) {
                        least = std::min(least, std::abs(height));
                        if (i == 0) first_height = height;
                        if (i > 0 && previous * height < 0) crossing = i;
                        last_height = previous = height;
                    });
                    // Between samples, a height changes at most by the angle to the nearer sample. So meets() may
                    // differ from the samples only if the least sampled height is within half a step of the limit, and
                    // rounding.
                    const bool meets = cocone.meets(edge);
                    if (least < sine - arc.rounding()) {
                        EXPECT_TRUE(meets) << cell << ' ' << corner << ' ' << j << ' ' << least;
                        ++decided.inside;
                    } else if (least > sine + arc.step() / 2 + arc.rounding()) {
                        EXPECT_FALSE(meets) << cell << ' ' << corner << ' ' << j << ' ' << least;
                        ++decided.outside;
                    } else {
                        ++decided.near_limit;
                    }
                    // A crossing within rounding of an end is undecided.
                    if (std::min(std::abs(first_height), std::abs(last_height)) < 2 * arc.rounding()) continue;
                    const double squared = cocone.squared_reach(edge);
                    if (crossing < 0) {
                        EXPECT_EQ(squared, -1) << cell << ' ' << corner << ' ' << j;
                        continue;
                    }
                    ++decided.crossing;
                    const double before = arc.distance(crossing - 1, along), after = arc.distance(crossing, along);
                    const double slack = 1e-6 + 10 * arc.rounding(), reach = std::sqrt(squared);
                    const bool at_end_of_ray = std::isinf(edge.to) && crossing == Arc::count - 1;
                    EXPECT_GE(reach, std::min(before, after) * std::cos(arc.step()) * (1 - slack));
                    if (!at_end_of_ray) {
                        EXPECT_LE(reach, std::max(before, after) * (1 + slack));
                    }
                }
            }
        }
    return decided;
}

TEST(VoronoiEdges, MeetCoconesWhereTenThousandSamplesDo) {
    const std::vector<PointCloud> clouds{random_sphere(300, 1), random_ball(300, 2), noisy_torus()};
    for (std::size_t i = 0; i < clouds.size(); ++i) {
        const Decided decided = compare_with_samples(Dual(clouds[i]), i);
        const std::size_t all = decided.inside + decided.outside + decided.near_limit;
        EXPECT_GT(decided.inside, all / 10) << i;
        EXPECT_GT(decided.outside, all / 10) << i;
        EXPECT_LT(decided.near_limit, all / 500) << i;
        EXPECT_GT(decided.crossing, all / 20) << i;
    }
}

TEST(VoronoiEdges, OfACube_HaveLengthZeroOrAreRaysThroughItsFaces) {
    const Dual dual(lattice_cube(1));  // 8 points on one sphere around (0.5, 0.5, 0.5)
    std::size_t rays = 0, inner = 0;
    for (u32 cell = 0; cell < dual.tets.cells.size(); ++cell)
        for (int corner = 0; corner < 4; ++corner) {
            const VoronoiEdge edge = dual_edge(dual.tets, dual.centres, cell, corner);
            const bool is_ray = dual.tets.neighbours[cell][static_cast<std::size_t>(corner)] == TetMesh::outside_hull;
            (is_ray ? rays : inner)++;
            EXPECT_NEAR((edge.foot + edge.from * edge.normal - Vec3(0.5, 0.5, 0.5)).norm(), 0, 1e-15);
            EXPECT_EQ(edge.to, is_ray ? infinity : edge.from);
            for (int j = 0; j < 4; ++j) {
                if (j == corner) continue;
                const u32 vertex = dual.tets.cells[cell][static_cast<std::size_t>(j)];
                EXPECT_NEAR(dual.poles.heights[vertex], std::sqrt(0.75), 1e-15);
                // The axis is the diagonal or leans towards a face that has two triangles at the corner; the centre is
                // far below, and a ray leaves it upwards.
                EXPECT_EQ((dual.hits[cell] >> (4 * corner + j) & 1) != 0, is_ray) << cell << ' ' << corner << ' ' << j;
            }
        }
    EXPECT_EQ(rays, 12u);
    EXPECT_GE(inner, 8u);
}

TEST(VoronoiEdges, OfPointsNearOneSphere_AreNotReversed) {
    // Circumcentres that should coincide differ by rounding.
    const Dual dual(vertices_of(geodesic_sphere(1, 6)));
    for (u32 cell = 0; cell < dual.tets.cells.size(); ++cell)
        for (int corner = 0; corner < 4; ++corner) {
            const VoronoiEdge edge = dual_edge(dual.tets, dual.centres, cell, corner);
            EXPECT_LE(edge.from, edge.to);
        }
}

TEST(Poles, OfASphere_PointAlongTheNormal) {
    // Without jitter, all points are on one sphere, up to rounding.
    for (const double jitter : {0.0, 1e-6, 1e-3}) {
        const Dual dual(fibonacci_sphere(2000, jitter));
        for (std::size_t v = 0; v < dual.tets.positions.size(); ++v) {
            EXPECT_GT(dual.poles.directions[v].dot(dual.tets.positions[v].normalized()), std::cos(3 * degree));
            EXPECT_NEAR(dual.poles.directions[v].norm(), 1, 1e-15);
            EXPECT_NEAR(dual.poles.heights[v], 1, jitter < 1e-3 ? 1e-3 : 0.5);
        }
    }
}

TEST(Poles, OfABall_AreTheFarthestCircumcentres) {
    const Dual dual(random_ball(1000, 3)), parallel(random_ball(1000, 3), 2);
    EXPECT_TRUE(std::ranges::equal(dual.poles.directions, parallel.poles.directions));
    EXPECT_TRUE(std::ranges::equal(dual.poles.heights, parallel.poles.heights));
    const TetMesh& tets = dual.tets;
    std::size_t inner = 0, hull = 0;
    for (u32 vertex = 0; vertex < tets.positions.size(); ++vertex) {
        const Vec3& p = tets.positions[vertex];
        std::vector<Vec3> corners;
        Vec3 hull_normals = Vec3::Zero();
        for (u32 cell = 0; cell < tets.cells.size(); ++cell) {
            if (std::ranges::find(tets.cells[cell], vertex) == tets.cells[cell].end()) continue;
            corners.push_back(dual.centres[cell]);
            for (int i = 0; i < 4; ++i)
                if (tets.neighbours[cell][static_cast<std::size_t>(i)] == TetMesh::outside_hull &&
                    tets.cells[cell][static_cast<std::size_t>(i)] != vertex)
                    hull_normals += leaving_normal(tets, cell, i);
        }
        const auto farther = [&](const Vec3& a, const Vec3& b) { return (a - p).norm() < (b - p).norm(); };
        const bool at_hull = hull_normals.norm() > 0;
        (at_hull ? hull : inner)++;
        const Vec3 positive = *std::ranges::max_element(corners, farther);
        const Vec3 expected = (at_hull ? hull_normals : Vec3(positive - p)).normalized();
        EXPECT_LT((dual.poles.directions[vertex] - expected).norm(), 1e-12) << vertex;
        double height = at_hull ? infinity : (positive - p).norm();
        std::erase_if(corners, [&](const Vec3& corner) { return (corner - p).dot(expected) >= 0; });
        if (!corners.empty()) height = std::min(height, (*std::ranges::max_element(corners, farther) - p).norm());
        EXPECT_DOUBLE_EQ(dual.poles.heights[vertex], height) << vertex;
        if (at_hull)
            for (const Vec3& q : tets.positions) {
                EXPECT_TRUE(q == p || dual.poles.directions[vertex].dot(q - p) < 0) << "must point away from the hull";
            }
    }
    EXPECT_GT(inner, 700u);
    EXPECT_GT(hull, 50u);
}

TEST(Poles, EquallyFar_TheLowerCellCounts) {
    // The middle of a lattice of 27 points: all corners of its Voronoi cell are (±0.5, ±0.5, ±0.5) away.
    const Dual dual(lattice_cube(2));
    const auto middle =
        static_cast<std::size_t>(std::ranges::find(dual.tets.positions, Vec3(1, 1, 1)) - dual.tets.positions.begin());
    ASSERT_LT(middle, dual.tets.positions.size());
    const u32 lowest = *std::ranges::min_element(dual.cells_at[middle]);
    EXPECT_LT((dual.poles.directions[middle] - (dual.centres[lowest] - Vec3(1, 1, 1)).normalized()).norm(), 1e-15);
    EXPECT_DOUBLE_EQ(dual.poles.heights[middle], std::sqrt(0.75));
}

TEST(CoconeHits, AreThoseOfEachFacetInBothCells) {
    for (const PointCloud& cloud : {random_ball(800, 4), noisy_torus(), fibonacci_sphere(500, 1e-3)}) {
        const Dual dual(cloud), parallel(cloud, 2);
        EXPECT_TRUE(std::ranges::equal(dual.hits, parallel.hits));
        const TetMesh& tets = dual.tets;
        const double squared_sine = std::pow(std::sin(cone_angle), 2);
        std::map<std::array<u32, 3>, std::map<u32, int>> by_facet;
        std::size_t differences = 0, facets = 0;
        for (u32 cell = 0; cell < tets.cells.size(); ++cell)
            for (int i = 0; i < 4; ++i) {
                std::array<u32, 3> facet;
                std::map<u32, int> its;
                const VoronoiEdge edge = dual_edge(tets, dual.centres, cell, i);
                for (int j = 0, k = 0; j < 4; ++j) {
                    const bool hit = (dual.hits[cell] >> (4 * i + j) & 1) != 0;
                    if (j == i) {
                        EXPECT_FALSE(hit) << "the corner opposite to the facet";
                        continue;
                    }
                    const u32 vertex = tets.cells[cell][static_cast<std::size_t>(j)];
                    facet[static_cast<std::size_t>(k++)] = vertex;
                    its[vertex] = hit;
                    const Cocone cocone{tets.positions[vertex], dual.poles.directions[vertex], squared_sine};
                    // Seen from the other cell, rounding may differ.
                    if (owns_facet(tets, cell, i)) differences += cocone.meets(edge) != hit;
                }
                std::ranges::sort(facet);
                const auto [found, is_first] = by_facet.emplace(facet, its);
                facets += is_first;
                EXPECT_EQ(found->second, its) << cell << ' ' << i;
            }
        EXPECT_EQ(facets, by_facet.size());
        EXPECT_EQ(differences, 0u);
    }
}

TEST(Candidates, OfASphere_AreItsTriangles) {
    Context context;
    const TetMesh tets = tets_of(fibonacci_sphere(1000, 1e-6));
    const cocones::Diagram diagram(tets, cone_angle, context);
    const CoconeParams params;
    const cocones::FacetSet candidates =
        cocones::candidates(diagram, cocones::sampling(diagram, params, context), params.lid_factor, context);
    std::size_t count = 0;
    std::map<std::array<u32, 2>, int> edges;
    double least_cosine = 1;
    for (u32 cell = 0; cell < tets.cells.size(); ++cell)
        for (int corner = 0; corner < 4; ++corner) {
            if (!candidates.contains(cell, corner) || !owns_facet(tets, cell, corner)) continue;
            ++count;
            const Triangle facet = cocones::corners_of(tets, {cell, corner});
            const Vec3 normal = leaving_normal(tets, cell, corner);
            for (std::size_t k = 0; k < 3; ++k) {
                const u32 a = facet[k], b = facet[(k + 1) % 3];
                ++edges[{std::min(a, b), std::max(a, b)}];
                least_cosine = std::min(least_cosine, std::abs(normal.dot(tets.positions[a].normalized())));
            }
        }
    EXPECT_EQ(count, 2 * 1000u - 4);
    EXPECT_EQ(edges.size(), 3 * 1000u - 6);
    for (const auto& [edge, uses] : edges) EXPECT_EQ(uses, 2) << edge[0] << ' ' << edge[1];
    // A triangle on the unit sphere differs from the normals at its corners by its circumradius, at most 0.8 spacings.
    const double spacing = std::sqrt(4 * std::numbers::pi / 1000);
    EXPECT_GT(least_cosine, std::cos(0.8 * spacing));
    // The poles are nearer to the normals: the largest error is about 1.2 degrees.
    for (std::size_t v = 0; v < tets.positions.size(); ++v)
        EXPECT_GT(diagram.poles.directions[v].dot(tets.positions[v].normalized()), std::cos(1.3 * degree)) << v;
}

}  // namespace
}  // namespace scanmill
