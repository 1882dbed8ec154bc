// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Clouds sampled from surfaces of known shape, for tests and benches. Seeded: the same points on every machine whose
/// sine and cosine agree; grids use exact arithmetic only.

#include <span>

#include "scanmill/data/points.hpp"

namespace scanmill::test {

/// Points of a Fibonacci spiral on the unit sphere, every coordinate moved by up to `jitter` either way.
PointCloud fibonacci_sphere(std::size_t count, double jitter = 0, std::uint64_t seed = 1);

/// Dart throwing on the torus round z with radii 1 and `minor`: points uniform by area that keep `distance` from each
/// other, until `misses` darts in a row have not found room. `limit` ends it earlier.
PointCloud poisson_torus(double distance, double minor = 0.4, std::size_t misses = 2000, std::uint64_t seed = 1,
                         std::size_t limit = ~std::size_t(0));

/// The lattice points {0 … n}³ times `spacing`; `surface_only` keeps those on the cube's surface.
PointCloud lattice_cube(u32 n, double spacing = 1, bool surface_only = false);

/// Lattice points on the surface of the block size × size × height without its quarter [half, size]² × height, all
/// multiples of `spacing` = size / (2 half_steps), moved by up to `jitter`.
PointCloud l_block_surface(u32 half_steps, double size, u32 height_steps, double jitter = 0, std::uint64_t seed = 1);

/// The same points in a seeded random order.
PointCloud shuffled(const PointCloud& cloud, std::uint64_t seed);
/// The points of both, first those of `a`. Columns are dropped.
PointCloud joined(const PointCloud& a, const PointCloud& b);
/// Every position times `factor`, then moved by `shift`. Columns are kept.
PointCloud moved(const PointCloud& cloud, double factor, const Vec3& shift = Vec3::Zero());
/// Turned about an oblique axis.
PointCloud rotated(const PointCloud& cloud, double angle);

}  // namespace scanmill::test
