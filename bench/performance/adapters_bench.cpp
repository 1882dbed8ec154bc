// SPDX-License-Identifier: GPL-3.0-or-later
/// The filters that do what a library does, beside that library's own function: normals, smooth, fill-holes and repair
/// beside CGAL, poisson beside PCL. Both work in turn on the same input, with one thread; the time is the
/// processor's for the calls alone, from data in their own form in memory, so other load on the machine counts little.
/// Prints median, least and most seconds, and the median of the ratios of the rounds. A filter does more than the
/// function: it refuses bad input, computes columns, metrics and doubts. fill-holes takes triangles, CGAL its own mesh:
/// it is compared with and without the conversion.
///
/// usage: adapters_bench [part of a name = all] [points = 35000] [rounds = 5]

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/repair_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/jet_estimate_normals.h>
#include <CGAL/jet_smooth_point_set.h>
#include <CGAL/mst_orient_normals.h>
#include <CGAL/pca_estimate_normals.h>
#include <CGAL/property_map.h>
#include <fmt/format.h>
#include <pcl/point_types.h>
#include <pcl/surface/poisson.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "fill_holes/fill_holes.hpp"
#include "normals/normals.hpp"
#include "poisson/poisson.hpp"
#include "repair/repair.hpp"
#include "smooth/smooth.hpp"
#include "support/point_sets.hpp"
#include "support/shapes.hpp"

namespace {

using namespace scanmill;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using OrientedPoints = std::vector<std::pair<Kernel::Point_3, Kernel::Vector_3>>;
namespace processing = CGAL::Polygon_mesh_processing;

std::string wanted;
int rounds = 5;

/// A contender returns the work, which is timed, after it has prepared what the work consumes.
using Contender = std::function<std::function<void()>()>;

double seconds_of(const Contender& contender) {
    const std::function<void()> work = contender();
    const std::clock_t begin = std::clock();
    work();
    return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

struct Spread {
    double median, least, most;
};
Spread spread_of(std::vector<double> values) {
    std::ranges::sort(values);
    return {values[values.size() / 2], values.front(), values.back()};
}

void compare(const std::string& name, std::size_t size, const std::string& library, const Contender& ours,
             const Contender& bare) {
    if (name.find(wanted) == std::string::npos) return;
    std::vector<double> us, them, ratios;
    for (int round = -1; round < rounds; ++round) {  // the first one warms up
        const double a = seconds_of(ours), b = seconds_of(bare);
        if (round < 0) continue;
        us.push_back(a), them.push_back(b), ratios.push_back(a / b);
    }
    const Spread a = spread_of(us), b = spread_of(them), ratio = spread_of(ratios);
    fmt::print(
        "{:<22} {:>8}  {:.3f} s ({:.3f} to {:.3f})  {:<34} {:.3f} s ({:.3f} to {:.3f})  ratio {:.2f} ({:.2f} to "
        "{:.2f})\n",
        name, size, a.median, a.least, a.most, library, b.median, b.least, b.most, ratio.median, ratio.least,
        ratio.most);
    std::fflush(stdout);
}

OrientedPoints cgal_points(const PointCloud& cloud) {
    OrientedPoints points;
    for (const Vec3& p : cloud.positions) points.emplace_back(Kernel::Point_3(p.x(), p.y(), p.z()), Kernel::Vector_3());
    return points;
}

void normals_and_smooth(const PointCloud& cloud) {
    constexpr unsigned neighbours = 18, smoothed = 24;
    const OrientedPoints points = cgal_points(cloud);
    const auto maps = CGAL::parameters::point_map(CGAL::First_of_pair_property_map<OrientedPoints::value_type>())
                          .normal_map(CGAL::Second_of_pair_property_map<OrientedPoints::value_type>());
    const auto ours = [&](NormalsParams::Method method, NormalsParams::Orient orient) {
        return [&cloud, method, orient] {
            return [&cloud, method, orient] {
                NormalsParams params;
                params.method = method;
                params.orient = orient;
                params.neighbours = neighbours;
                Context context;
                normals(cloud, params, context);
            };
        };
    };
    const auto theirs = [&](auto&& estimate) {
        return [&points, estimate] { return [copy = points, estimate]() mutable { estimate(copy); }; };
    };
    using Method = NormalsParams::Method;
    using Orient = NormalsParams::Orient;
    compare("normals-pca", cloud.size(), "CGAL pca_estimate_normals", ours(Method::pca, Orient::none),
            theirs([&](OrientedPoints& copy) {
                CGAL::pca_estimate_normals<CGAL::Sequential_tag>(copy, neighbours, maps);
            }));
    compare("normals-jet", cloud.size(), "CGAL jet_estimate_normals", ours(Method::jet, Orient::none),
            theirs([&](OrientedPoints& copy) {
                CGAL::jet_estimate_normals<CGAL::Sequential_tag>(copy, neighbours, maps);
            }));
    compare("normals-oriented", cloud.size(), "CGAL pca_ and mst_orient_normals", ours(Method::pca, Orient::tree),
            theirs([&](OrientedPoints& copy) {
                CGAL::pca_estimate_normals<CGAL::Sequential_tag>(copy, neighbours, maps);
                CGAL::mst_orient_normals(copy, neighbours, maps);
            }));
    compare(
        "smooth-jet", cloud.size(), "CGAL jet_smooth_point_set",
        [&] {
            return [&] {
                SmoothParams params;
                params.neighbours = smoothed;
                Context context;
                smooth(cloud, params, context);
            };
        },
        theirs([&](OrientedPoints& copy) { CGAL::jet_smooth_point_set<CGAL::Sequential_tag>(copy, smoothed, maps); }));
}

/// A sphere without the triangles near some of its points.
TriangleMesh with_holes(const TriangleMesh& sphere, std::size_t holes) {
    const PointCloud centres = test::fibonacci_sphere(holes);
    const double radius = 0.3 / std::sqrt(static_cast<double>(holes));
    Array<Triangle> kept;
    for (const Triangle& t : sphere.triangles) {
        const Vec3 middle = (sphere.positions[t[0]] + sphere.positions[t[1]] + sphere.positions[t[2]]) / 3;
        if (std::ranges::none_of(centres.positions, [&](const Vec3& c) { return (c - middle).norm() < radius; }))
            kept.push_back(t);
    }
    TriangleMesh mesh = sphere;
    mesh.triangles = std::move(kept);
    return without_unused_vertices(mesh);
}

void holes_and_repair(std::size_t size) {
    using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
    const auto frequency = static_cast<u32>(std::sqrt(static_cast<double>(size) / 10));
    const TriangleMesh sphere = test::geodesic_sphere(1, frequency), mesh = with_holes(sphere, 40);
    std::vector<Kernel::Point_3> vertices;
    for (const Vec3& p : mesh.positions) vertices.emplace_back(p.x(), p.y(), p.z());
    std::vector<std::array<std::size_t, 3>> faces;
    for (const Triangle& t : mesh.triangles) faces.push_back({t[0], t[1], t[2]});
    Mesh surface;
    processing::polygon_soup_to_polygon_mesh(vertices, faces, surface);
    const auto fill = [](Mesh& of) {
        std::vector<Mesh::Halfedge_index> cycles;
        processing::extract_boundary_cycles(of, std::back_inserter(cycles));
        for (const Mesh::Halfedge_index cycle : cycles) {
            std::vector<Mesh::Face_index> new_faces;
            std::vector<Mesh::Vertex_index> new_vertices;
            processing::triangulate_refine_and_fair_hole(of, cycle, std::back_inserter(new_faces),
                                                         std::back_inserter(new_vertices));
        }
    };
    const Contender ours = [&] {
        return [&] {
            Context context;
            fill_holes(mesh, {}, context);
        };
    };
    compare("fill-holes", mesh.positions.size(), "CGAL hole filling, and conversion", ours, [&] {
        return [&] {
            Mesh converted;
            processing::polygon_soup_to_polygon_mesh(vertices, faces, converted);
            fill(converted);
        };
    });
    compare("fill-holes-alone", mesh.positions.size(), "CGAL hole filling of a Surface_mesh", ours,
            [&] { return [copy = surface, fill]() mutable { fill(copy); }; });
    // A soup: every triangle has its own three corners, and every third one is turned.
    TriangleMesh soup;
    Array<Vec3> corners;
    Array<Triangle> triangles;
    for (const Triangle& t : sphere.triangles) {
        const u32 first = static_cast<u32>(corners.size());
        for (const u32 corner : t) corners.push_back(sphere.positions[corner]);
        triangles.push_back(first % 9 == 0 ? Triangle{first, first + 2, first + 1}
                                           : Triangle{first, first + 1, first + 2});
    }
    std::vector<Kernel::Point_3> points;
    for (const Vec3& p : corners) points.emplace_back(p.x(), p.y(), p.z());
    std::vector<std::vector<std::size_t>> polygons;
    for (const Triangle& t : triangles) polygons.push_back({t[0], t[1], t[2]});
    soup.positions = std::move(corners);
    soup.triangles = std::move(triangles);
    compare(
        "repair", soup.triangles.size(), "CGAL repair_ and orient_polygon_soup",
        [&] {
            return [&] {
                Context context;
                repair(soup, {}, context);
            };
        },
        [&] {
            return [points, polygons]() mutable {
                processing::repair_polygon_soup(points, polygons);
                processing::orient_polygon_soup(points, polygons);
            };
        });
}

void poisson_surface(PointCloud cloud) {
    Array<float> values;
    const auto input = std::make_shared<pcl::PointCloud<pcl::PointNormal>>();
    for (const Vec3& p : cloud.positions) {
        const Vec3 normal = p.normalized();
        for (const double number : normal) values.push_back(static_cast<float>(number));
        const Eigen::Vector3f at = p.cast<float>(), n = normal.cast<float>();
        input->push_back(pcl::PointNormal(at.x(), at.y(), at.z(), n.x(), n.y(), n.z()));
    }
    cloud.columns.add(Column("normal", 3, Buffer<float>(std::move(values))));
    compare(
        "poisson", cloud.size(), "PCL Poisson, depth 9",
        [&] {
            return [&] {
                PoissonParams params;
                params.scale = 1.1;  // PCL's default
                Context context;
                poisson(cloud, params, context);
            };
        },
        [&] {
            return [&input] {
                pcl::Poisson<pcl::PointNormal> poisson;
                poisson.setDepth(9);
                poisson.setThreads(1);
                poisson.setInputCloud(input);
                pcl::PointCloud<pcl::PointNormal> points;
                std::vector<pcl::Vertices> polygons;
                poisson.reconstruct(points, polygons);
            };
        });
}

}  // namespace

int main(int argc, char** argv) {
    if (argc > 1) wanted = argv[1];
    const std::size_t size = argc > 2 ? std::stoul(argv[2]) : 35'000;
    if (argc > 3) rounds = std::stoi(argv[3]);
    const PointCloud cloud = test::fibonacci_sphere(size, 0.5 / std::sqrt(static_cast<double>(size)));
    normals_and_smooth(cloud);
    holes_and_repair(size);
    poisson_surface(cloud);
}
