// SPDX-License-Identifier: GPL-3.0-or-later
#include "merge/fuse.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <vector>

#include "scanmill/base/parallel.hpp"
#include "scanmill/base/statistics.hpp"
#include "scanmill/data/bounds.hpp"
#include "scanmill/data/point_tree.hpp"
#include "scanmill/geometry/fit/covariance.hpp"
#include "scanmill/geometry/spatial/cell_grid.hpp"
#include "scanmill/geometry/spatial/unit_vectors.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill::merging {

namespace {

/// Neighbours in a view: a grid's square of 5 × 5 points, which determines a normal and shows a border.
constexpr std::size_t patch_neighbours = 24, least_neighbours = 3;
/// Points on a line have no normal.
constexpr double least_flatness = 1e-3;
/// Largest empty wedge around a point inside a view. At a straight border the wedge has 180 degrees. Of points sampled
/// at random, one in 10,000 has a wedge of 150 degrees inside; one in 500 has one of 120 degrees.
constexpr double cosine_150_degrees = -0.86602540378443865;
/// Sines below this are rounding errors between equal directions.
constexpr double same_direction = 1e-9;
/// A view's weight falls towards its border over this distance, in reaches, to this share.
constexpr double fade_width = 4, least_fade = 0.01;
constexpr double least_cosine = 0.05;
constexpr double least_agreement = 0.7;  // product of normals
/// Distances of the kernel's centroid from the point, in reaches: 0.5 in the corner of a square, 1 if all partners are
/// on the rim.
constexpr double inside = 0.5, outside = 0.8;
constexpr std::size_t least_partners = 3;
/// Added to the second moments, in squares of the reach, so that partners on a line give a mean and not a plane.
constexpr double ridge = 1e-3;
constexpr std::size_t rows_per_chunk = 1 << 10, cells_per_chunk = 1 << 5;

/// What a point contributes to the heights of others.
struct Sample {
    Vec3 normal;  ///< unit vector, or zero: takes no part
    double cosine, fade;
    u32 view;
};

struct SampledView {
    Array<Sample> samples;  ///< by row
    double spacing = 0, reach = 0;
};

/// A view's points without the weights of their borders.
struct Patches {
    Array<Vec3> normals;  ///< of either sign; zero if not determined
    Array<double> nearest, farthest;  ///< distances to the first and the last neighbour
    std::vector<u8> is_border;
};

/// A direction in a plane: a number that ascends with the angle, from -2 to 2, and unit coordinates.
struct Direction {
    double order, u, v;
};

/// Whether no wedge of more than 150 degrees around 0 is without offsets, seen along the normal. `work`: memory. Pre:
/// the offsets are not on a line.
bool surround(std::span<const Vec3> offsets, const Vec3& normal, std::vector<Direction>& work) {
    const auto [across_u, across_v] = directions_across(normal);
    work.clear();
    for (const Vec3& offset : offsets) {
        const double u = across_u.dot(offset), v = across_v.dot(offset), length = std::sqrt(u * u + v * v);
        if (length == 0) continue;
        const double turn = v / (std::abs(u) + std::abs(v));
        work.push_back({u >= 0 ? turn : v >= 0 ? 2 - turn : -2 - turn, u / length, v / length});
    }
    if (work.size() < least_neighbours) return false;
    std::ranges::sort(work, {}, &Direction::order);
    for (std::size_t i = 0; i < work.size(); ++i) {
        const Direction &a = work[i], &b = work[(i + 1) % work.size()];
        const double sine = a.u * b.v - a.v * b.u, cosine = a.u * b.u + a.v * b.v;
        if (sine < -same_direction || cosine < cosine_150_degrees) return false;
    }
    return true;
}

Patches patches_of(const PointTree& tree, const Execution& execution) {
    const std::span<const Vec3> positions = tree.positions();
    const std::size_t count = positions.size();
    Patches patches{Array<Vec3>(count), Array<double>(count), Array<double>(count), std::vector<u8>(count)};
    const std::size_t each = std::min(patch_neighbours, count - 1);
    tree.for_each_nearest(each, execution.threads(), [&](const NeighbourBatch& batch) {
        execution.check_cancelled();
        Array<Vec3> offsets;
        std::vector<Direction> around;
        for (std::size_t i = 0; i < batch.indices.size(); ++i) {
            const u32 index = batch.indices[i];
            offsets.assign(1, Vec3::Zero());
            for (const Neighbour& n : batch.of(i)) offsets.push_back(positions[n.index] - positions[index]);
            const Scatter scatter = scatter_of(offsets);
            patches.normals[index] = scatter.flatness < least_flatness ? Vec3(Vec3::Zero()) : scatter.normal;
            patches.nearest[index] = std::sqrt(batch.of(i).front().squared);
            patches.farthest[index] = std::sqrt(batch.of(i).back().squared);
            patches.is_border[index] = !surround(std::span(offsets).subspan(1), scatter.normal, around);
        }
    });
    return patches;
}

/// For every position of the tree, the distance to the nearest border point as a fraction of `width`, at most 1.
Array<double> fades_of(const PointTree& tree, std::span<const u8> is_border, double width, const Execution& execution) {
    Array<Vec3> border;
    for (std::size_t i = 0; i < is_border.size(); ++i)
        if (is_border[i]) border.push_back(tree.positions()[i]);
    Array<double> fades(is_border.size(), 1);
    if (border.empty()) return fades;
    const PointTree border_tree(border, execution.threads());
    for_each_chunk(execution.threads(), fades.size(), rows_per_chunk, [&](std::size_t begin, std::size_t end) {
        execution.check_cancelled();
        NeighbourBuffer buffer;
        for (std::size_t i = begin; i < end; ++i) {
            const double squared = border_tree.nearest_to(tree.positions()[i], 1, buffer)[0].squared;
            fades[i] = std::min(1.0, std::sqrt(squared) / width);
        }
    });
    return fades;
}

SampledView sampled(const ViewToFuse& view, u32 number, const Execution& execution) {
    SampledView result;
    result.samples.assign(view.positions.size(), {Vec3::Zero(), 1, 1, number});
    const PointTree tree(view.positions, execution.threads());
    if (tree.positions().size() <= least_neighbours) return result;
    const Patches patches = patches_of(tree, execution);
    result.spacing = median(Array<double>(patches.nearest));
    result.reach = median(Array<double>(patches.farthest));
    const Array<double> fades = fades_of(tree, patches.is_border, fade_width * result.reach, execution);
    for (std::size_t row = 0; row < view.positions.size(); ++row) {
        const u32 index = tree.index_of_row()[row];
        const Vec3 to_scanner = unit_or_zero(view.to_scanner[view.to_scanner.size() == 1 ? 0 : row]);
        Vec3 normal = view.normals.empty() ? patches.normals[index] : unit_or_zero(view.normals[row]);
        if (view.normals.empty() && normal.dot(to_scanner) < 0) normal = -normal;
        const double cosine = view.weighs_angle ? std::max(least_cosine, normal.dot(to_scanner)) : 1;
        result.samples[row] = {normal, cosine, least_fade + fades[index], number};
    }
    return result;
}

/// Sums over the partners of one view, weighted with the kernel. u and v are the coordinates across the normal.
struct Sums {
    double weight = 0, u = 0, v = 0, uu = 0, uv = 0, vv = 0;
    double height = 0, height_u = 0, height_v = 0;
    double cosine = 0, fade = 0;
    std::size_t partners = 0;

    void add(double kernel, double at_u, double at_v, double at_height, const Sample& sample) {
        ++partners;
        weight += kernel;
        u += kernel * at_u;
        v += kernel * at_v;
        uu += kernel * at_u * at_u;
        uv += kernel * at_u * at_v;
        vv += kernel * at_v * at_v;
        height += kernel * at_height;
        height_u += kernel * at_height * at_u;
        height_v += kernel * at_height * at_v;
        cosine += kernel * sample.cosine;
        fade += kernel * sample.fade;
    }
};

/// Height of the fitted plane at u = v = 0, and the view's weight there.
struct Layer {
    double height, weight;
};

/// Coordinates are in reaches. Pre: sums.weight > 0.
Layer layer_of(const Sums& sums, bool is_own) {
    const double w = 1 / sums.weight;
    const double u = sums.u * w, v = sums.v * w, height = sums.height * w;
    const double uu = sums.uu * w - u * u + ridge, vv = sums.vv * w - v * v + ridge, uv = sums.uv * w - u * v;
    const double hu = sums.height_u * w - height * u, hv = sums.height_v * w - height * v;
    const double determinant = uu * vv - uv * uv;
    const double slope_u = (vv * hu - uv * hv) / determinant, slope_v = (uu * hv - uv * hu) / determinant;
    const double off_centre = std::sqrt(u * u + v * v);
    const double support = is_own ? 1 : std::clamp((outside - off_centre) / (outside - inside), 0.0, 1.0);
    return {height - slope_u * u - slope_v * v, sums.cosine * w * sums.fade * w * support};
}

/// The points of all views in a grid, with the search for partners. The points of a cell share their candidates, which
/// are the points of the cell and of the cells around it.
class Layers {
public:
    /// The arguments must outlive the object. Rows are ordered by view.
    Layers(std::span<const Vec3> positions, std::span<const Sample> samples, double reach, double length)
        : positions_(positions),
          samples_(samples),
          reach_(reach),
          length_(length),
          grid_(bounding_box(positions), std::sqrt(reach * reach + length * length)) {
        Array<u32> cell_of_row(positions.size());
        for (std::size_t row = 0; row < positions.size(); ++row) cell_of_row[row] = grid_.enter(positions[row]);
        begin_.assign(*std::ranges::max_element(cell_of_row) + std::size_t(2), 0);
        for (const u32 cell : cell_of_row) ++begin_[cell + 1];
        std::inclusive_scan(begin_.begin(), begin_.end(), begin_.begin());
        rows_.resize(positions.size());
        Array<u32> next(begin_.begin(), begin_.end() - 1);
        for (u32 row = 0; row < positions.size(); ++row) rows_[next[cell_of_row[row]]++] = row;
    }

    std::size_t cells() const { return begin_.size() - 1; }

    /// Reusable memory of a thread: the candidates of a cell.
    struct Work {
        Array<u32> rows;
        Array<Vec3> positions;
        Array<Sample> samples;
    };

    /// Writes how far the points of a cell move along their normals; 0 without partners in another view.
    void moves_of_cell(std::size_t cell, Work& work, std::span<double> moved) const {
        const std::span<const u32> rows = rows_of(cell);
        work.rows.clear();
        grid_.any_near(positions_[rows[0]], [&](u32 other) {
            const std::span<const u32> more = rows_of(other);
            work.rows.insert(work.rows.end(), more.begin(), more.end());
            return false;
        });
        std::erase_if(work.rows, [&](u32 row) { return samples_[row].normal.isZero(0); });
        std::ranges::sort(work.rows);  // by view
        work.positions.clear();
        work.samples.clear();
        for (const u32 row : work.rows) {
            work.positions.push_back(positions_[row]);
            work.samples.push_back(samples_[row]);
        }
        for (const u32 row : rows) moved[row] = move_of(row, work);
    }

private:
    std::span<const u32> rows_of(std::size_t cell) const {
        return std::span(rows_).subspan(begin_[cell], begin_[cell + 1] - begin_[cell]);
    }

    double move_of(u32 row, const Work& work) const {
        const Vec3 p = positions_[row];
        const Sample& own = samples_[row];
        if (own.normal.isZero(0)) return 0;
        const auto [across_u, across_v] = directions_across(own.normal);
        const double squared_reach = reach_ * reach_, inverse = 1 / reach_;
        double weights = 0, heights = 0, own_height = 0;
        bool has_others = false;
        for (std::size_t i = 0; i < work.samples.size();) {
            const u32 view = work.samples[i].view;
            Sums sums;
            for (; i < work.samples.size() && work.samples[i].view == view; ++i) {
                const Vec3 offset = work.positions[i] - p;
                const double height = own.normal.dot(offset);
                if (std::abs(height) > length_ || offset.squaredNorm() - height * height >= squared_reach) continue;
                const Sample& sample = work.samples[i];
                if (!(own.normal.dot(sample.normal) > least_agreement)) continue;
                const double u = across_u.dot(offset) * inverse, v = across_v.dot(offset) * inverse;
                const double squared = u * u + v * v, flat = std::max(0.0, 1 - squared * squared);
                const double rise = (across_u.dot(sample.normal) * u + across_v.dot(sample.normal) * v) * reach_;
                sums.add(flat * flat, u, v, height + rise / (2 * own.normal.dot(sample.normal)), sample);
            }
            const bool is_own = view == own.view;
            if (!(sums.weight > 0) || (!is_own && sums.partners < least_partners)) continue;
            const Layer layer = layer_of(sums, is_own);
            weights += layer.weight;
            heights += layer.weight * layer.height;
            if (is_own) own_height = layer.height;
            has_others |= !is_own && layer.weight > 0;
        }
        return has_others ? heights / weights - own_height : 0;
    }

    std::span<const Vec3> positions_;
    std::span<const Sample> samples_;
    double reach_, length_;
    CellGrid grid_;
    Array<u32> begin_, rows_;  ///< the rows of cell i are rows_[begin_[i]] up to rows_[begin_[i + 1]], ascending
};

/// The median of the values above 0; 0 without one.
double median_above_zero(std::span<const SampledView> views, double SampledView::*value) {
    std::vector<double> values;
    for (const SampledView& view : views)
        if (view.*value > 0) values.push_back(view.*value);
    return values.empty() ? 0 : median(values);
}

}  // namespace

Fused fuse(std::span<const ViewToFuse> views, const Length& length, Execution& execution) {
    Fused result;
    for (const ViewToFuse& view : views)
        result.positions.insert(result.positions.end(), view.positions.begin(), view.positions.end());
    const std::size_t count = result.positions.size();
    result.moved.assign(count, 0);
    if (views.size() < 2) return result;

    std::vector<SampledView> sampled_views;
    Array<Sample> samples;
    samples.reserve(count);
    for (const ViewToFuse& view : views) {
        sampled_views.push_back(sampled(view, static_cast<u32>(sampled_views.size()), execution));
        Array<Sample>& own = sampled_views.back().samples;
        samples.insert(samples.end(), own.begin(), own.end());
        own = {};
        execution.progress(0.3 * static_cast<double>(samples.size()) / static_cast<double>(count));
    }
    const double reach = median_above_zero(sampled_views, &SampledView::reach);
    const double spacing = median_above_zero(sampled_views, &SampledView::spacing);
    if (reach == 0) return result;
    const double limit = length.in() == Length::In::spacing ? length.amount() * spacing : length.value();

    const Layers layers(result.positions, samples, reach, limit);
    std::atomic<std::size_t> done = 0;
    for_each_chunk(execution.threads(), layers.cells(), cells_per_chunk, [&](std::size_t begin, std::size_t end) {
        Layers::Work work;
        for (std::size_t cell = begin; cell < end; ++cell) {
            execution.check_cancelled();
            layers.moves_of_cell(cell, work, result.moved);
        }
        execution.progress(0.3 + 0.7 * static_cast<double>(done += end - begin) / static_cast<double>(layers.cells()));
    });
    for (std::size_t row = 0; row < count; ++row) {
        if (result.moved[row] == 0) continue;
        result.positions[row] += result.moved[row] * samples[row].normal;
        ++result.count;
    }
    return result;
}

}  // namespace scanmill::merging
