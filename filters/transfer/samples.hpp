// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Finds the points or the triangle of a scan whose values a position takes.

#include <memory>
#include <optional>
#include <span>

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/point_tree.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/geometry/spatial/lists.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill::transferring {

inline constexpr u32 no_row = ~u32(0);

struct Sample {
    u32 row;
    double squared;  ///< squared distance
    double weight;
};

/// What one position takes its values from; also the reusable memory of the search.
struct Samples {
    /// Weights add up to 1; the nearest row comes first.
    Array<Sample> samples;
    /// Rows of the nearest point or corner, and of the nearest triangle; no_row without one.
    u32 nearest = no_row, face = no_row;
    /// Whether anything is within the distance, whichever way it faces.
    bool is_near = false;

    NeighbourBuffer buffer;
    u32 hint = NearestTriangle::none;
};

/// The directions in which the rows face; 0 if unknown. May be empty.
Array<Vec3> normals_of(const PointCloud& cloud);
Array<Vec3> normals_of(const TriangleMesh& mesh);

class PointSamples {
public:
    /// Without `max_distance`: 1.5 times the median distance of a position from its 12th nearest other one. These are 3
    /// spacings of an evenly sampled surface, and still span the gaps between random samples.
    PointSamples(const PointCloud& cloud, std::optional<double> max_distance, unsigned threads);
    double max_distance() const { return max_distance_; }

    /// `normal`: the direction in which the position faces; 0 if unknown. Safe from several threads.
    void find(const Vec3& position, const Vec3& normal, Samples& found) const;
    /// The median distance between the colours of a point and of its nearest neighbour; 0 for fewer than 2 positions.
    double colour_noise(const Column& colour, unsigned threads) const;

private:
    double facing(u32 row, const Vec3& normal) const;

    PointTree tree_;
    Lists<> rows_;  // by position
    Array<Vec3> normals_, approaches_;
    double max_distance_;
};

class MeshSamples {
public:
    /// Without `max_distance`: 3 times the median edge.
    MeshSamples(const TriangleMesh& mesh, std::optional<double> max_distance, unsigned threads);
    double max_distance() const { return max_distance_; }

    void find(const Vec3& position, const Vec3& normal, Samples& found) const;

private:
    TriangleTree tree_;
    Buffer<Triangle> triangles_;
    double max_distance_;
};

/// The distance between two colours: of the codes of red, green and blue. Pre: at least three components.
double squared_colour_distance(const Column& colour, u32 a, u32 b);

}  // namespace scanmill::transferring
