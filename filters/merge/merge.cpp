// SPDX-License-Identifier: GPL-3.0-or-later
#include "merge/merge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "merge/merge_steps.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/kinds/value.hpp"

namespace scanmill {

namespace {

using Inputs = std::span<const std::shared_ptr<const PointCloud>>;
/// The number of each input in messages, ascending.
using Numbers = std::span<const u32>;

/// The count that goes with the numbers, which may lack those of inputs that were left out.
u32 count_of(Numbers numbers) { return numbers.back() + 1; }

std::string_view unit_text(LengthUnit unit) { return unit == LengthUnit::unknown ? "an unknown unit" : symbol(unit); }

void require_one_unit(Inputs inputs, Numbers numbers) {
    const LengthUnit first = inputs.front()->frame.unit;
    for (std::size_t input = 1; input < inputs.size(); ++input)
        if (const LengthUnit unit = inputs[input]->frame.unit; unit != first)
            throw Error("the inputs have different units: {} in input {}, {} in input {}", unit_text(first), numbers[0],
                        unit_text(unit), numbers[input])
                .hint(first == LengthUnit::unknown || unit == LengthUnit::unknown
                          ? "declare the unit of all inputs, for example as `unit: mm` at the workflow's input"
                          : "convert one of them")
                .remedy(first == LengthUnit::unknown || unit == LengthUnit::unknown ? Remedy::declare_unit
                                                                                    : Remedy::convert_unit);
}

void require_sound(Inputs inputs, Numbers numbers, const MergeParams& params) {
    std::size_t points = 0;
    for (std::size_t input = 0; input < inputs.size(); ++input) {
        if (inputs[input]->size() == 0) throw Error("input {} of {} has no points", numbers[input], count_of(numbers));
        points += inputs[input]->size();
        try {
            require_finite(inputs[input]->positions.span());
        } catch (Error& error) {
            error.add_frame(fmt::format("in input {} of {}", numbers[input], count_of(numbers)));
            throw;
        }
    }
    if (points > std::numeric_limits<u32>::max())
        throw Error("the {} inputs have {} points together; at most {} can be numbered", inputs.size(), points,
                    std::numeric_limits<u32>::max())
            .hint("thin the inputs first");
    require_one_unit(inputs, numbers);
    const double within = params.within.value();
    if (!(within >= 0) || !std::isfinite(within))
        throw Error("the distance `within` is {} u; it must be 0 or more", within);
    if (const std::optional<Length>& given = params.fuse) {
        const double value = given->in() == Length::In::spacing ? given->amount() : given->value();
        if (!(value >= 0) || !std::isfinite(value))
            throw Error("the distance `fuse` is {}; it must be 0 or more", given->text())
                .hint("`2 spacing` suits views that lie a fraction of a spacing apart; `none` moves no point");
    }
    if (const std::optional<Length>& given = params.default_uncertainty)
        if (const double value = given->value(); !(value >= 0) || !std::isfinite(value))
            throw Error("default-uncertainty is {} u; it must be 0 or more", value)
                .hint("give the scanner's accuracy, or none");
    if (!params.poses.empty() && params.poses.size() != inputs.size())
        throw Error("there {} {} for {}; every input needs one pose", by_count(params.poses.size(), "is", "are"),
                    count_text(params.poses.size(), "pose", "poses"), count_text(inputs.size(), "input", "inputs"));
}

/// The numbers in the columns `uncertainty` of all inputs, checked and laid end to end.
std::vector<double> uncertainties(Inputs inputs, Numbers numbers) {
    std::vector<double> values;
    for (std::size_t input = 0; input < inputs.size(); ++input) {
        const Column* column = inputs[input]->columns.find("uncertainty");
        if (!column || column->components() != 1)
            throw Error(
                "input {} of {} has no column 'uncertainty' with one number per point, which lower-uncertainty "
                "compares",
                numbers[input], count_of(numbers))
                .hint(
                    "`default-uncertainty` replaces a missing column; `prefer: none` keeps the points of the earlier "
                    "input");
        for (std::size_t row = 0; row < column->rows(); ++row) {
            values.push_back(column->number(row));
            if (!(values.back() >= 0))
                throw Error("an uncertainty must be 0 or more; point {} of input {} has {}", row, numbers[input],
                            values.back())
                    .hint(std::isnan(values.back())
                              ? "`default-uncertainty` replaces NaN; `prefer: none` does not read the column"
                              : "`prefer: none` does not read the column");
        }
    }
    return values;
}

void warn_of_names(Inputs inputs, Numbers numbers, Context& context) {
    const std::string& first = inputs.front()->frame.name;
    const auto differs = [&](const auto& cloud) { return cloud->frame.name != first; };
    const auto other = std::ranges::find_if(inputs, differs);
    if (other == inputs.end()) return;
    context.warn(fmt::format(
        "{} of {} inputs have another frame than '{}', the frame of the first input; one of them is input {} in '{}'. "
        "Without poses, all inputs are assumed to be in the same frame",
        std::ranges::count_if(inputs, differs), inputs.size(), first,
        numbers[static_cast<std::size_t>(other - inputs.begin())], (*other)->frame.name));
}

/// Maps p to rotation p + shift.
struct Motion {
    Eigen::Matrix3d rotation;
    Vec3 shift;
};

/// Throws Error if the points exceed the supported range of scans, as poses or origins far apart can make them do.
void require_supported_size(std::span<const Vec3> positions) {
    constexpr double largest_size = 1e9;
    const BoundingBox box = bounding_box(positions);
    if (const double size = (box.high - box.low).maxCoeff(); !(size <= largest_size))
        throw Error("the longest side of the box around the points is {:.3g} u; at most {:.0e} u is supported", size,
                    largest_size)
            .hint("check the poses, their unit, and that the inputs are in one coordinate system");
}

/// All positions end to end, with the frame of the result and no columns. A pose maps world coordinates: for a position
/// p in a frame with origin o it gives R (o + p) + t. This is computed as R p + (R o + t - origin of the result), so
/// large numbers cancel before a position is added. Without poses, positions are only moved to the origin of the first
/// cloud.
/// Pre: `poses` is empty or as long as `clouds`; the clouds are finite and of one unit. Throws Error if a pose has a
/// known unit and the clouds have an unknown one, and if the moved points exceed the supported range.
PointCloud placed_points(Inputs clouds, std::span<const RigidTransform> poses) {
    PointCloud result;
    result.frame = clouds.front()->frame;
    std::vector<Motion> motions;  // to world coordinates, from relative ones
    std::size_t points = 0;
    BoundingBox world;
    for (std::size_t i = 0; i < clouds.size(); ++i) {
        points += clouds[i]->size();
        const Vec3& origin = clouds[i]->frame.origin;
        if (poses.empty()) {
            motions.push_back({Eigen::Matrix3d::Identity(), origin});
            continue;
        }
        const Eigen::Matrix3d& rotation = poses[i].rotation;
        motions.push_back({rotation, rotation * origin + translation_in(result.frame.unit, poses[i])});
        for (const Vec3& p : clouds[i]->positions) {
            const Vec3 moved = rotation * p + motions.back().shift;
            world.low = world.low.cwiseMin(moved);
            world.high = world.high.cwiseMax(moved);
        }
    }
    if (!poses.empty()) {
        result.frame.name = poses.front().to;
        result.frame.origin = distant_origin(world);
    }

    Array<Vec3> positions;
    positions.reserve(points);
    for (std::size_t i = 0; i < clouds.size(); ++i) {
        const Vec3 shift = motions[i].shift - result.frame.origin;
        if (poses.empty() && shift.isZero(0))  // adding zero would turn -0 into 0
            positions.insert(positions.end(), clouds[i]->positions.begin(), clouds[i]->positions.end());
        else
            for (const Vec3& p : clouds[i]->positions) positions.push_back(motions[i].rotation * p + shift);
    }
    try {
        require_finite(positions);
        require_supported_size(positions);
    } catch (Error& error) {
        error.add_frame("after the clouds were moved to one frame");
        throw;
    }
    result.positions = std::move(positions);
    return result;
}

/// The inputs, with the default uncertainty for points without one. A missing column is float32 if any input has a
/// float32 column, so that equal numbers are ties.
std::vector<std::shared_ptr<const PointCloud>> with_default(Inputs inputs, double value) {
    ScalarType type = ScalarType::float64;
    for (const auto& input : inputs)
        if (const Column* column = input->columns.find("uncertainty"); column && column->type() == ScalarType::float32)
            type = ScalarType::float32;
    std::vector<std::shared_ptr<const PointCloud>> result;
    for (const auto& input : inputs)
        result.push_back(std::make_shared<const PointCloud>(merging::with_default_uncertainty(*input, type, value)));
    return result;
}

/// `given`, or 0, 1, 2 …
std::vector<u32> numbers_of(Inputs inputs, const std::vector<u32>& given) {
    if (inputs.empty()) throw Error("there are no clouds; merging needs at least one");
    if (!given.empty()) {
        if (given.size() != inputs.size() ||
            std::ranges::adjacent_find(given, std::ranges::greater_equal()) != given.end())
            throw Error("the numbers of the inputs must be one per input and ascend");
        return given;
    }
    std::vector<u32> numbers(inputs.size());
    std::iota(numbers.begin(), numbers.end(), 0);
    return numbers;
}

}  // namespace

MergeResult merge(Inputs given, const MergeParams& params, Context& context) {
    const std::vector<u32> numbers = numbers_of(given, params.numbers);
    require_sound(given, numbers, params);
    std::vector<std::shared_ptr<const PointCloud>> completed(given.begin(), given.end());
    if (params.default_uncertainty) completed = with_default(given, params.default_uncertainty->value());
    const Inputs inputs = completed;
    if (params.poses.empty()) warn_of_names(inputs, numbers, context);
    std::vector<double> preference;
    if (params.prefer == MergeParams::Prefer::lower_uncertainty) preference = uncertainties(inputs, numbers);

    PointCloud all = placed_points(inputs, params.poses);
    all.columns = merging::merged_columns(inputs, params.poses, numbers, context);
    if (std::string doubt =
            merging::frames_doubt(all.positions.span(), all.columns.find("source")->values<u32>(), context);
        !doubt.empty())
        context.doubt(doubt + (params.poses.empty() ? "; give the poses of the views, or find them with `register`"
                                                    : "; check the poses and their unit"));

    MergeResult result;
    if (params.fuse) result.fused = merging::fuse_points(all, inputs, params.poses, numbers, *params.fuse, context);
    const std::span<const u32> source = all.columns.find("source")->values<u32>();
    result.kept = merging::without_overlap(all.positions.span(), source, preference, params.within.value(), context);
    result.dropped = all.size() - result.kept.size();
    result.points = result.dropped == 0 ? std::move(all) : gather(all, result.kept);

    context.metric("points", static_cast<double>(result.points.size()));
    context.metric("dropped", static_cast<double>(result.dropped));
    if (params.fuse) context.metric("fused", static_cast<double>(result.fused));
    context.progress(1);
    return result;
}

}  // namespace scanmill
