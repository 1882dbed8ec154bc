// SPDX-License-Identifier: GPL-3.0-or-later
#include "measure/measurable.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/kinds/length_scale.hpp"

namespace scanmill::measuring {

namespace {

constexpr double unit_tolerance = 0.05;
/// Extents below this share of the diagonal do not count when units are guessed.
constexpr double thin_extent = 0.1;
constexpr double most_times_larger = 30;
constexpr double remarkable_times_larger = 2;
constexpr double widest_gap = 0.1;

constexpr const char* way_out =
    "declare each file's unit (`unit:` at the input or the scan) and give both files in one coordinate "
    "system (`pose:` at a scan of a batch moves it there); if both are right already, set same-frame: true";

/// Two units of which the first is larger.
struct UnitPair {
    LengthUnit larger, smaller;
    double ratio;
};

/// Likely confusions come first, because the first of several pairs with the same ratio is named.
std::vector<UnitPair> unit_pairs() {
    using enum LengthUnit;
    std::vector<UnitPair> pairs;
    for (const auto& [larger, smaller] : {std::pair(metre, millimetre),
                                          {inch, millimetre},
                                          {centimetre, millimetre},
                                          {metre, centimetre},
                                          {foot, metre},
                                          {foot, inch},
                                          {foot, millimetre},
                                          {foot, centimetre},
                                          {inch, centimetre},
                                          {metre, inch},
                                          {metre, foot},
                                          {centimetre, micrometre},
                                          {metre, micrometre},
                                          {inch, micrometre},
                                          {foot, micrometre}}) {
        const double ratio = in_unit(1, larger, smaller);
        pairs.push_back(ratio > 1 ? UnitPair{larger, smaller, ratio} : UnitPair{smaller, larger, 1 / ratio});
    }
    return pairs;
}

std::array<double, 3> ascending_extents(const BoundingBox& box) {
    const Vec3 size = box.high - box.low;
    std::array<double, 3> extents{size.x(), size.y(), size.z()};
    std::ranges::sort(extents);
    return extents;
}

/// Two units whose ratio equals the ratio of each extent of `large` to the same extent of `small`.
std::optional<UnitPair> confused_units(const BoundingBox& large, const BoundingBox& small) {
    const auto of_large = ascending_extents(large), of_small = ascending_extents(small);
    for (const UnitPair& pair : unit_pairs()) {
        const auto fits = [&](std::size_t i) {
            const bool counts =
                of_large[i] >= thin_extent * large.diagonal() || of_small[i] >= thin_extent * small.diagonal();
            return !counts || std::abs(of_large[i] / (of_small[i] * pair.ratio) - 1) <= unit_tolerance;
        };
        if (fits(0) && fits(1) && fits(2)) return pair;
    }
    return std::nullopt;
}

std::string size_text(const BoundingBox& box, LengthUnit unit) {
    const Vec3 size = box.high - box.low;
    return fmt::format("{:.4g} x {:.4g} x {:.4g} {}", size.x(), size.y(), size.z(), symbol(unit));
}

std::string range_text(const BoundingBox& box) {
    return fmt::format("({:.4g}, {:.4g}, {:.4g}) to ({:.4g}, {:.4g}, {:.4g})", box.low.x(), box.low.y(), box.low.z(),
                       box.high.x(), box.high.y(), box.high.z());
}

double gap_between(const BoundingBox& a, const BoundingBox& b) {
    return (a.low - b.high).cwiseMax(b.low - a.high).cwiseMax(0).norm();
}

}  // namespace

void require_sound(const MeasureParams& params) {
    if (params.samples < fewest_samples)
        throw Error("samples is {}; the standard error of the mean needs at least {}", params.samples, fewest_samples)
            .hint("100000 samples suit most meshes");
    const double gap = params.gap.value();
    if (!(gap > 0 && gap < 1))
        throw Error("gap is {}; it must be above 0 % and below 100 %", params.gap.text())
            .hint("1 % suits most meshes; a smaller gap takes longer");
}

std::vector<double> thresholds_for(const TriangleMesh& mesh, const MeasureParams& params) {
    const LengthScale scale{mesh.frame.unit, [&] { return surface_box(mesh).diagonal(); },
                            [&] { return edge_spacing(mesh); }};
    std::vector<double> thresholds;
    for (const Length& threshold : params.thresholds) {
        thresholds.push_back(threshold.resolved(scale).value());
        if (!(thresholds.back() > 0 && std::isfinite(thresholds.back())))
            throw Error("the threshold {} is {} in the unit of the mesh; thresholds must be above 0 and finite",
                        threshold.text(), number_text(thresholds.back()))
                .hint("give the threshold as a share of the mesh's size, for example 0.5 %diag");
    }
    return thresholds;
}

void require_surface(const TriangleMesh& mesh, std::string_view name) {
    if (mesh.triangles.empty())
        throw Error("the {} has no triangles ({}); there is no surface to measure", name,
                    count_text(mesh.positions.size(), "vertex", "vertices"))
            .hint("make a surface of the points first; only the truth may be points");
    require_consistent(mesh);
    require_finite(mesh.positions.span(), fmt::format("vertices of the {}", name));
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3& origin = mesh.positions[a];
        if ((mesh.positions[b] - origin).cross(mesh.positions[c] - origin).squaredNorm() > 0) return;
    }
    throw Error("{} of the {} has {} area; there is no surface to measure",
                mesh.triangles.size() == 1 ? "the only triangle"
                                           : fmt::format("none of the {} triangles", mesh.triangles.size()),
                name, by_count(mesh.triangles.size(), "no", "an"))
        .hint("`scanmill info` shows what a file contains");
}

Buffer<Vec3> in_frame_of(const Frame& mesh, const Frame& truth, const Buffer<Vec3>& positions) {
    if (!mesh.name.empty() && !truth.name.empty() && mesh.name != truth.name)
        throw Error("the mesh is in the frame '{}', the truth in the frame '{}'", mesh.name, truth.name)
            .hint(
                "give both files in one coordinate system (`pose:` at a scan of a batch moves it there) and under one "
                "frame "
                "name, or without names");
    const bool converts =
        mesh.unit != truth.unit && mesh.unit != LengthUnit::unknown && truth.unit != LengthUnit::unknown;
    if (!converts) {
        if (truth.origin == mesh.origin) return positions;
        return translated(positions, truth.origin - mesh.origin);
    }
    const auto converted = [&](const Vec3& p) -> Vec3 {
        return p.unaryExpr([&](double length) { return in_unit(length, truth.unit, mesh.unit); });
    };
    const Vec3 shift = converted(truth.origin) - mesh.origin;
    Array<Vec3> moved(positions.size());
    for (std::size_t i = 0; i < moved.size(); ++i) moved[i] = converted(positions[i]) + shift;
    return moved;
}

std::vector<std::string> require_comparable(const BoundingBox& mesh, const BoundingBox& truth, bool truth_may_be_part,
                                            LengthUnit unit) {
    const bool truth_is_larger = truth.diagonal() > mesh.diagonal();
    const BoundingBox& large = truth_is_larger ? truth : mesh;
    const BoundingBox& small = truth_is_larger ? mesh : truth;
    const std::string sizes =
        fmt::format("the mesh is {}, the truth {}", size_text(mesh, unit), size_text(truth, unit));
    const char* larger_name = truth_is_larger ? "truth" : "mesh";
    const char* smaller_name = truth_is_larger ? "mesh" : "truth";

    if (small.diagonal() > 0)
        if (const auto units = confused_units(large, small))
            throw Error(
                "{}: one is {:.4g} times as large as the other in every direction, as if the {} were in {} and the {} "
                "in {}",
                sizes, large.diagonal() / small.diagonal(), larger_name, symbol(units->smaller), smaller_name,
                symbol(units->larger))
                .hint(way_out);
    const bool is_part = truth_may_be_part && !truth_is_larger;
    if (!is_part && large.diagonal() > most_times_larger * small.diagonal())
        throw Error("{}: the {} is more than {} times as large, too different to compare", sizes, larger_name,
                    most_times_larger)
            .hint(way_out);
    if (const double gap = gap_between(mesh, truth); gap > widest_gap * large.diagonal())
        throw Error(
            "the mesh extends from {}, the truth from {}: they are {:.4g} {} apart, so they are not in one frame",
            range_text(mesh), range_text(truth), gap, symbol(unit))
            .hint(way_out);
    if (!is_part && large.diagonal() > remarkable_times_larger * small.diagonal())
        return {fmt::format("{}: the diagonals differ by a factor of {:.3g}; the objects are compared as they are",
                            sizes, large.diagonal() / small.diagonal())};
    return {};
}

}  // namespace scanmill::measuring
