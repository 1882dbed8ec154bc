// SPDX-License-Identifier: GPL-3.0-or-later
#include "measure/comparable.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "scanmill/base/error.hpp"

namespace scanmill::measuring {

namespace {

constexpr double unit_tolerance = 0.05;
constexpr double thin_side = 0.1;
constexpr double most_times_larger = 30;
constexpr double remarkable_times_larger = 2;
constexpr double widest_gap = 0.1;

constexpr const char* way_out =
    "declare each file's unit (--unit mm, or `unit:` at the input or the scan) and bring both into one frame (`pose:` "
    "at the scan, or the filters align and apply-transform); where both are right, say same-frame: true";

/// Two units of which the first is larger.
struct UnitPair {
    LengthUnit larger, smaller;
    double ratio;
};

/// Likely confusions first: where two pairs have one ratio, the first is named.
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

std::array<double, 3> ascending_sides(const BoundingBox& box) {
    const Vec3 size = box.high - box.low;
    std::array<double, 3> sides{size.x(), size.y(), size.z()};
    std::ranges::sort(sides);
    return sides;
}

/// The units whose ratio all sides of `large` have to those of `small`.
std::optional<UnitPair> confused_units(const BoundingBox& large, const BoundingBox& small) {
    const auto large_sides = ascending_sides(large), small_sides = ascending_sides(small);
    for (const UnitPair& pair : unit_pairs()) {
        const auto fits = [&](std::size_t side) {
            const bool counts =
                large_sides[side] >= thin_side * large.diagonal() || small_sides[side] >= thin_side * small.diagonal();
            return !counts || std::abs(large_sides[side] / (small_sides[side] * pair.ratio) - 1) <= unit_tolerance;
        };
        if (fits(0) && fits(1) && fits(2)) return pair;
    }
    return std::nullopt;
}

std::string size_text(const BoundingBox& box, LengthUnit unit) {
    const Vec3 size = box.high - box.low;
    return fmt::format("{:.4g} x {:.4g} x {:.4g} {}", size.x(), size.y(), size.z(), symbol(unit));
}

std::string place_text(const BoundingBox& box) {
    return fmt::format("({:.4g}, {:.4g}, {:.4g}) to ({:.4g}, {:.4g}, {:.4g})", box.low.x(), box.low.y(), box.low.z(),
                       box.high.x(), box.high.y(), box.high.z());
}

double gap_between(const BoundingBox& a, const BoundingBox& b) {
    return (a.low - b.high).cwiseMax(b.low - a.high).cwiseMax(0).stableNorm();
}

}  // namespace

Buffer<Vec3> in_frame_of(const Frame& mesh, const Frame& truth, const Buffer<Vec3>& positions) {
    if (!mesh.name.empty() && !truth.name.empty() && mesh.name != truth.name)
        throw Error("the mesh is in the frame '{}', the truth in the frame '{}'", mesh.name, truth.name)
            .hint("bring both into one frame: `pose:` at the scan, or the filters align and apply-transform");
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
    for (std::size_t i = 0; i < moved.size(); ++i) {
        moved[i] = converted(positions[i]) + shift;
        if (!moved[i].allFinite())
            throw Error("the truth's point {} cannot be converted from {} to {}: a coordinate is too large", i,
                        symbol(truth.unit), symbol(mesh.unit))
                .hint("is its unit the one that was declared? --unit says another");
    }
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
            throw Error("{}: {:.4g} times as large along every side, as if the {} were in {} and the {} in {}", sizes,
                        large.diagonal() / small.diagonal(), larger_name, symbol(units->smaller), smaller_name,
                        symbol(units->larger))
                .hint(way_out);
    const bool is_part = truth_may_be_part && !truth_is_larger;
    if (!is_part && large.diagonal() > most_times_larger * small.diagonal())
        throw Error("{}: the {} is more than {} times as large, too different to be measured", sizes, larger_name,
                    most_times_larger)
            .hint(way_out);
    if (const double gap = gap_between(mesh, truth); gap > widest_gap * large.diagonal())
        throw Error("the mesh lies from {}, the truth from {}: {:.4g} {} apart, so they are not in one frame",
                    place_text(mesh), place_text(truth), gap, symbol(unit))
            .hint(way_out);
    if (!is_part && large.diagonal() > remarkable_times_larger * small.diagonal())
        return {fmt::format("{}: the diagonals differ by a factor of {:.3g}; they are compared as they are", sizes,
                            large.diagonal() / small.diagonal())};
    return {};
}

}  // namespace scanmill::measuring
