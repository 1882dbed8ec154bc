// SPDX-License-Identifier: GPL-3.0-or-later
#include "merge/merge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "merge/merged_columns.hpp"
#include "merge/overlap.hpp"
#include "merge/placed_points.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"

namespace scanmill {

namespace {

using Inputs = std::span<const std::shared_ptr<const PointCloud>>;

std::string_view said(LengthUnit unit) { return unit == LengthUnit::unknown ? "an unknown unit" : symbol(unit); }

void require_one_unit(Inputs inputs) {
    const LengthUnit first = inputs.front()->frame.unit;
    for (std::size_t input = 1; input < inputs.size(); ++input)
        if (const LengthUnit unit = inputs[input]->frame.unit; unit != first)
            throw Error("the inputs have different units: {} in input 0, {} in input {}", said(first), said(unit),
                        input)
                .hint(first == LengthUnit::unknown || unit == LengthUnit::unknown
                          ? "declare the unit of all of them (--unit mm, or `unit: mm` at the workflow's input)"
                          : "convert one of them: scanmill convert --to-unit mm IN OUT");
}

void require_sound(Inputs inputs, const MergeParams& params) {
    if (inputs.empty()) throw Error("there are no clouds; merging needs at least one");
    std::size_t points = 0;
    for (std::size_t input = 0; input < inputs.size(); ++input) {
        if (inputs[input]->size() == 0) throw Error("input {} of {} has no points", input, inputs.size());
        points += inputs[input]->size();
        try {
            require_finite(inputs[input]->positions.span());
        } catch (Error& error) {
            error.add_frame(fmt::format("in input {} of {}", input, inputs.size()));
            throw;
        }
    }
    if (points > std::numeric_limits<u32>::max())
        throw Error("the {} inputs have {} points together; at most {} can be numbered", inputs.size(), points,
                    std::numeric_limits<u32>::max())
            .hint("thin the inputs first");
    require_one_unit(inputs);
    const double within = params.within.value();
    if (!(within >= 0) || !std::isfinite(within))
        throw Error("the distance `within` is {} u; it must be 0 or more", within);
    if (!params.poses.empty() && params.poses.size() != inputs.size())
        throw Error("there {} {} for {}; every input needs one", by_count(params.poses.size(), "is", "are"),
                    counted(params.poses.size(), "pose", "poses"), counted(inputs.size(), "input", "inputs"));
}

/// The column's numbers, checked, of all inputs end to end.
std::vector<double> uncertainties(Inputs inputs) {
    std::vector<double> values;
    for (std::size_t input = 0; input < inputs.size(); ++input) {
        const Column* column = inputs[input]->columns.find("uncertainty");
        if (!column || column->components() != 1)
            throw Error(
                "input {} of {} has no column 'uncertainty' with one number per point, which lower-uncertainty "
                "compares",
                input, inputs.size())
                .hint("`prefer: none` keeps the points of the earlier input");
        for (std::size_t row = 0; row < column->rows(); ++row) {
            values.push_back(column->number(row));
            if (!(values.back() >= 0))
                throw Error("an uncertainty is 0 or more; point {} of input {} has {}", row, input, values.back());
        }
    }
    return values;
}

void tell_names(Inputs inputs, Context& context) {
    const std::string& first = inputs.front()->frame.name;
    const auto differs = [&](const auto& cloud) { return cloud->frame.name != first; };
    const auto other = std::ranges::find_if(inputs, differs);
    if (other == inputs.end()) return;
    context.warn(fmt::format(
        "{} of {} inputs have another frame than '{}', the first one's, as input {} in '{}'; "
        "without poses all are taken to be in that one",
        std::ranges::count_if(inputs, differs), inputs.size(), first, other - inputs.begin(), (*other)->frame.name));
}

}  // namespace

MergeResult merge(Inputs inputs, const MergeParams& params, Context& context) {
    require_sound(inputs, params);
    if (params.poses.empty()) tell_names(inputs, context);
    std::vector<double> preference;
    if (params.prefer == MergeParams::Prefer::lower_uncertainty) preference = uncertainties(inputs);

    PointCloud all = merging::placed_points(inputs, params.poses);
    all.columns = merging::merged_columns(inputs, params.poses, context);
    const std::span<const u32> source = all.columns.find("source")->values<u32>();

    MergeResult result;
    result.kept = merging::without_overlap(all.positions.span(), source, preference, params.within.value(), context);
    result.dropped = all.size() - result.kept.size();
    result.points = result.dropped == 0 ? std::move(all) : gather(all, result.kept);

    context.metric("points", static_cast<double>(result.points.size()));
    context.metric("dropped", static_cast<double>(result.dropped));
    context.progress(1);
    return result;
}

}  // namespace scanmill
