// SPDX-License-Identifier: GPL-3.0-or-later
#include "inspect/inspect.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <limits>

#include "inspect/comparable.hpp"
#include "inspect/nominal.hpp"
#include "inspect/on_nominal.hpp"
#include "inspect/parts.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/robust_box.hpp"
#include "scanmill/data/spacing.hpp"
#include "scanmill/data/topology.hpp"
#include "scanmill/filter/inputs.hpp"
#include "scanmill/geometry/spatial/spatial_order.hpp"

namespace scanmill {

namespace {

using namespace inspecting;

constexpr std::size_t chunk = 1 << 12;
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
/// max-distance: auto, in amounts of the tolerance and in spacings of the scan.
constexpr double tolerances_to_far = 10, spacings_to_far = 3;
/// Edges of the map, in percent of the nominal's diagonal and in spacings of the scan.
constexpr double map_edge_percent = 0.5, map_edge_spacings = 3;
/// Numbers of parts begin here, because 1 is the whole nominal.
constexpr u32 first_part_number = 2;

/// What is inspected: points, and how the distance between them is found.
struct Scan {
    const Frame& frame;
    std::span<const Vec3> positions;
    Array<u32> rows;  ///< the points to inspect, ascending
    std::function<double()> spacing, diagonal;
    /// An upper bound of `spacing` that is found faster, from points along a space-filling curve.
    std::function<double(std::span<const u32> order)> rough_spacing;
};

/// Rows of the scan with their nearest triangles and findings.
struct Distances {
    Array<double> deviations;
    Array<u32> triangles;  ///< rows of Nominal::surface(); NearestTriangle::none if too far
    Array<u32> slots;
    Array<Finding> findings;
};

Array<u32> all_rows(std::size_t count) {
    Array<u32> rows(count);
    for (u32 row = 0; row < count; ++row) rows[row] = row;
    return rows;
}

Array<u32> used_rows(const TriangleMesh& mesh) {
    Array<u8> is_used(mesh.positions.size(), u8(0));
    for (const Triangle& triangle : mesh.triangles)
        for (const u32 vertex : triangle) is_used[vertex] = 1;
    Array<u32> rows;
    for (u32 row = 0; row < is_used.size(); ++row)
        if (is_used[row]) rows.push_back(row);
    return rows;
}

/// Median distance between points and the nearest of their neighbours along the curve. Not below the median distance
/// to the nearest point. Uses at most 10,000 points.
double spacing_along(std::span<const Vec3> positions, std::span<const u32> order) {
    constexpr std::size_t window = 32, most_samples = 10'000;
    if (order.size() < 2) return 0;
    std::vector<double> distances;
    const std::size_t step = (order.size() + most_samples - 1) / most_samples;
    for (std::size_t at = 0; at < order.size(); at += step) {
        double nearest = std::numeric_limits<double>::infinity();
        const std::size_t last = std::min(order.size() - 1, at + window);
        for (std::size_t other = at < window ? 0 : at - window; other <= last; ++other)
            if (other != at)
                nearest = std::min(nearest, (positions[order[other]] - positions[order[at]]).squaredNorm());
        distances.push_back(nearest);
    }
    const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
    std::nth_element(distances.begin(), middle, distances.end());
    return std::sqrt(*middle);
}

/// The rows along a space-filling curve.
Array<u32> ordered(std::span<const Vec3> positions, std::span<const u32> rows) {
    if (rows.size() == positions.size()) return spatial_order(positions);
    Array<Vec3> used(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) used[i] = positions[rows[i]];
    Array<u32> order = spatial_order(used);
    for (u32& row : order) row = rows[row];
    return order;
}

/// Computes the signed distances of the points at `order` that are not farther than `limit`.
void measure_points(Distances& distances, std::span<const Vec3> positions, std::span<const u32> order,
                    const Nominal& nominal, double limit, Context& context, double from, double to) {
    const TriangleTree& tree = nominal.tree();
    std::atomic<std::size_t> done = 0;
    for_each_chunk(context.threads(), order.size(), chunk, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        u32 hint = NearestTriangle::none;
        for (std::size_t i = begin; i < end; ++i) {
            const u32 row = order[i];
            const Vec3& point = positions[row];
            distances.deviations[row] = not_a_number;
            distances.triangles[row] = NearestTriangle::none;
            distances.findings[row] = Finding::too_far;
            if (!tree.is_within(point, limit * limit, hint)) continue;
            const NearestTriangle nearest = tree.nearest(point, hint);
            hint = nearest.slot;
            const SignedDistance found = nominal.signed_distance(point, nearest.slot);
            distances.triangles[row] = nearest.triangle;
            distances.slots[row] = nearest.slot;
            distances.deviations[row] = found.value;
            distances.findings[row] = found.side == Side::beyond ? Finding::beyond_border
                                      : std::isnan(found.value)  ? Finding::undecided
                                                                 : Finding::counted;
        }
        done += end - begin;
        context.progress(from + (to - from) * static_cast<double>(done) / static_cast<double>(order.size()));
    });
}

/// The rows of `order` that are too far.
Array<u32> far_rows(const Distances& distances, std::span<const u32> order) {
    Array<u32> rows;
    for (const u32 row : order)
        if (distances.findings[row] == Finding::too_far) rows.push_back(row);
    return rows;
}

/// The distance at which points are too far by default. The spacing of the scan is only found if it matters.
double default_distance(const Distances& distances, const Scan& scan, std::span<const u32> order, double by_tolerance) {
    if (by_tolerance > 0 && far_rows(distances, order).empty()) return by_tolerance;
    if (spacings_to_far * scan.rough_spacing(order) <= by_tolerance) return by_tolerance;
    return std::max(by_tolerance, spacings_to_far * scan.spacing());
}

/// The ends of colours and histogram.
ColourScale scale_of(const Tolerance& tolerance, const DeviationNumbers& numbers) {
    if (tolerance.low != 0 || tolerance.high != 0) return scale_of_tolerance(tolerance.low, tolerance.high);
    const double widest = std::max(std::abs(numbers.min), std::abs(numbers.max));
    return widest > 0 ? ColourScale{-widest, widest} : ColourScale{-1, 1};
}

/// The counted rows, in the order of `rows`.
Array<u32> counted_rows(const Distances& distances, std::span<const u32> rows) {
    Array<u32> counted;
    for (const u32 row : rows)
        if (distances.findings[row] == Finding::counted) counted.push_back(row);
    return counted;
}

Array<double> values_at(const Array<double>& values, std::span<const u32> rows) {
    Array<double> result(rows.size());
    for (std::size_t i = 0; i < rows.size(); ++i) result[i] = values[rows[i]];
    return result;
}

/// Cuts the points that are too many standard deviations from the mean.
void cut(Distances& distances, std::span<const u32> counted, double sigma) {
    const Spread spread = spread_of(values_at(distances.deviations, counted));
    for (const u32 row : counted)
        if (std::abs(distances.deviations[row] - spread.mean) > sigma * spread.standard_deviation)
            distances.findings[row] = Finding::cut;
}

void count_findings(Inspection& result, const Distances& distances, const Scan& scan) {
    result.points = scan.rows.size();
    for (const u32 row : scan.rows) switch (distances.findings[row]) {
            case Finding::counted: break;
            case Finding::cut: ++result.cut; break;
            case Finding::undecided: ++result.undecided; break;
            case Finding::beyond_border: ++result.beyond_border; break;
            case Finding::too_far: ++result.too_far; break;
        }
}

void inspect_parts(Inspection& result, const Distances& distances, const Scan& scan, const Parts& parts) {
    result.parts.resize(parts.count);
    result.part_numbers.assign(scan.positions.size(), u32(0));
    for (const u32 row : scan.rows)
        if (const u32 triangle = distances.triangles[row]; triangle != NearestTriangle::none) {
            ++result.parts[parts.of_triangle[triangle]].points;
            result.part_numbers[row] = parts.of_triangle[triangle] + first_part_number;
        }
    Lists<double> deviations(parts.count, [&](const auto& add) {
        for (const u32 row : scan.rows)
            if (distances.findings[row] == Finding::counted)
                add(parts.of_triangle[distances.triangles[row]], distances.deviations[row]);
    });
    for (std::size_t part = 0; part < parts.count; ++part)
        if (const std::span<double> values = deviations[part]; !values.empty())
            result.parts[part].numbers = numbers_of(values, result.tolerance);
}

Column colours_of(std::span<const double> deviations, const ColourScale& scale) {
    Array<u8> colours(3 * deviations.size());
    for (std::size_t i = 0; i < deviations.size(); ++i)
        std::ranges::copy(colour_of(scale, deviations[i]), &colours[3 * i]);
    return Column("colour", 3, Buffer<u8>(std::move(colours)));
}

/// The nominal with the columns that describe its faces still.
void carry_columns(TriangleMesh& map, const TriangleMesh& nominal, std::span<const u32> parents, Context& context) {
    std::vector<std::string> dropped;
    for (const Column& column : nominal.face_columns)
        // Normals of corners belong to the given corners; colours of faces would hide those of the map.
        if (column.name().starts_with("corner-") || column.name() == "colour")
            dropped.push_back("'" + column.name() + "'");
        else
            map.face_columns.add(column.gather(parents));
    for (const ColumnTable* columns : {&nominal.vertex_columns, &nominal.edge_columns})
        for (const Column& column : *columns) dropped.push_back("'" + column.name() + "'");
    if (!dropped.empty())
        context.warn(fmt::format("the {} {} of the nominal {} not on on-nominal, whose vertices and edges are others",
                                 by_count(dropped.size(), "column", "columns"), enumerated(dropped),
                                 by_count(dropped.size(), "is", "are")));
}

TriangleMesh map_on(const TriangleMesh& given, const Vec3& shift, const Nominal& nominal, const Distances& distances,
                    const Scan& scan, std::span<const u32> counted, double rough_spacing, const Parts* parts,
                    const Inspection& result, Context& context) {
    const double edge =
        affordable_edge(given, std::max(map_edge_percent / 100 * result.diagonal, map_edge_spacings * rough_spacing));
    const RefinedMesh map = refined(given, edge, context);
    Array<Vec3> feet(counted.size());
    for_each_chunk(context.threads(), counted.size(), chunk, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        for (std::size_t i = begin; i < end; ++i)
            feet[i] = nominal.tree().nearest_point(scan.positions[counted[i]], distances.slots[counted[i]]);
    });
    Array<u32> triangles(counted.size());
    for (std::size_t i = 0; i < triangles.size(); ++i) triangles[i] = distances.triangles[counted[i]];
    const Array<double> deviations = values_at(distances.deviations, counted);
    const Buffer<Vec3> positions = shift.isZero(0) ? map.mesh.positions : translated(map.mesh.positions, shift);
    Array<double> means = averaged(map, positions.span(), nominal, {feet, triangles, deviations}, edge, context);
    TriangleMesh mesh = map.mesh;
    carry_columns(mesh, given, map.parents, context);
    const Column colours = colours_of(means, result.scale);
    // Floats suffice for means, and all formats hold them.
    Array<float> rounded(means.begin(), means.end());
    mesh.vertex_columns.add(Column("deviation", 1, Buffer<float>(std::move(rounded))).with_length_exponent(1));
    mesh.vertex_columns.add(colours);
    if (parts) {
        Array<u32> of_row(given.triangles.size(), 0);
        for (std::size_t i = 0; i < nominal.rows().size(); ++i)
            of_row[nominal.rows()[i]] = parts->of_triangle[i] + first_part_number;
        Array<u32> numbers(map.parents.size());
        for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = of_row[map.parents[i]];
        add_column(mesh.face_columns, Column("part", 1, Buffer<u32>(std::move(numbers))), context);
    }
    return mesh;
}

Inspection inspect_scan(const Scan& scan, const TriangleMesh& nominal, const Transforms* transforms,
                        const InspectParams& params, Context& context) {
    require_sound(params);
    require_surface(nominal);
    require_same_frame(scan.frame, "the scan is", nominal.frame, "the nominal");
    const LengthScale lengths_of_scan{scan.frame.unit, scan.diagonal, scan.spacing};
    const auto resolved = [&](const Length& length) { return length.resolved(lengths_of_scan).value(); };
    Inspection result;
    result.unit = scan.frame.unit;
    result.tolerance = {resolved(params.tolerance[0]), resolved(params.tolerance[1])};
    require_tolerance(params, result.tolerance, result.unit);
    result.chord_error = resolved(params.chord_error);
    result.diagonal = surface_box(nominal).diagonal();
    result.aligned = transforms != nullptr;
    if (transforms && transforms->motions.size() == 1 && transforms->motions.front().rms)
        result.alignment_rms = in_unit_of(transforms->motions.front(), result.unit);

    const Vec3 shift = nominal.frame.origin - scan.frame.origin;
    const Nominal surface(nominal, shift.isZero(0) ? nominal.positions : translated(nominal.positions, shift),
                          context.threads());
    doubt_nominal(surface, context);
    context.progress(0.2);

    const std::size_t size = scan.positions.size();
    Distances distances{Array<double>(size, not_a_number), Array<u32>(size, NearestTriangle::none),
                        Array<u32>(size, NearestTriangle::none), Array<Finding>(size, Finding::too_far)};
    const Array<u32> order = ordered(scan.positions, scan.rows);
    const double by_tolerance =
        tolerances_to_far * std::max(std::abs(result.tolerance.low), std::abs(result.tolerance.high));
    result.max_distance = params.max_distance ? resolved(*params.max_distance) : by_tolerance;
    measure_points(distances, scan.positions, order, surface, result.max_distance, context, 0.2, 0.6);
    if (!params.max_distance) {
        result.max_distance = default_distance(distances, scan, order, by_tolerance);
        if (result.max_distance > by_tolerance)
            measure_points(distances, scan.positions, far_rows(distances, order), surface, result.max_distance, context,
                           0.6, 0.65);
    }
    for (const u32 row : scan.rows) {
        Finding& finding = distances.findings[row];
        if (finding != Finding::beyond_border) continue;
        if (params.borders == InspectParams::Borders::exclude)
            distances.deviations[row] = not_a_number;
        else
            finding = std::isnan(distances.deviations[row]) ? Finding::undecided : Finding::counted;
    }
    Array<u32> counted = counted_rows(distances, scan.rows);
    if (params.sigma && !counted.empty()) {
        cut(distances, counted, *params.sigma);
        counted = counted_rows(distances, scan.rows);
    }
    count_findings(result, distances, scan);
    const Extents extents{bounding_box(scan.positions), surface_box(surface.surface()), scan.frame.origin, result.unit};
    if (counted.empty()) refuse_without_points(result, extents, params);
    doubt_findings(result, extents, context);
    context.progress(0.7);

    Array<double> deviations = values_at(distances.deviations, counted);
    result.numbers = numbers_of(deviations, result.tolerance);
    result.scale = scale_of(result.tolerance, result.numbers);
    result.histogram = histogram_of(deviations, result.scale.low, result.scale.high, params.bins);
    warn_of_chord_error(result, context);
    std::optional<Parts> parts;
    if (params.by == InspectParams::By::components) parts = components_of(surface);
    if (params.by == InspectParams::By::patches) parts = patches_of(surface, context.threads());
    if (parts) inspect_parts(result, distances, scan, *parts);
    if (result.parts.size() > most_parts)
        context.warn(fmt::format("the nominal has {} parts; the metrics contain the first {}, the column 'part' all",
                                 result.parts.size(), most_parts));

    result.label_numbers.assign(size, u32(0));
    // Points at one position have no diagonal, and need none.
    const double apart = params.labels > 0 && extents.scan.diagonal() > 0 ? resolved(params.label_distance) : 0;
    for (const u32 row : largest_apart(counted, scan.positions, distances.deviations, params.labels, apart, context)) {
        result.labels.push_back({row, scan.frame.origin + scan.positions[row], distances.deviations[row]});
        result.label_numbers[row] = static_cast<u32>(result.labels.size());
    }
    context.progress(0.8);
    // Along the curve, points that are averaged together are in the same part of the memory.
    result.on_nominal = map_on(nominal, shift, surface, distances, scan, counted_rows(distances, order),
                               scan.rough_spacing(order), parts ? &*parts : nullptr, result, context);
    result.deviations = std::move(distances.deviations);
    context.progress(1);
    return result;
}

/// A column `colour` under the name `scan-colour`, so that the heat map takes its place.
void keep_colours(ColumnTable& columns, Context& context) {
    const Column* own = columns.find("colour");
    if (!own) return;
    const Column kept = own->renamed("scan-colour");
    ColumnTable others;
    for (const Column& column : columns)
        if (column.name() != "colour") others.add(column);
    columns = std::move(others);
    add_column(columns, kept, context);
}

/// The scan's columns with those of the inspection.
void add_columns(ColumnTable& columns, const Inspection& inspected, Context& context) {
    keep_colours(columns, context);
    const Buffer<double> deviations(inspected.deviations);
    add_column(columns, Column("deviation", 1, deviations).with_length_exponent(1), context);
    add_column(columns, Column("label", 1, Buffer<u32>(inspected.label_numbers)), context);
    if (!inspected.part_numbers.empty())
        add_column(columns, Column("part", 1, Buffer<u32>(inspected.part_numbers)), context);
    columns.add(colours_of(deviations.span(), inspected.scale));
}

void add_numbers(Metrics& metrics, const DeviationNumbers& numbers, const std::string& suffix) {
    const auto add = [&](std::string_view name, double value, Unit unit = Unit::length) {
        metrics.set(std::string(name) + suffix, value, unit);
    };
    add("min", numbers.min);
    add("max", numbers.max);
    add("mean", numbers.mean);
    add("rms", numbers.rms);
    add("standard-deviation", numbers.standard_deviation);
    if (numbers.mean_above) add("mean-above", *numbers.mean_above);
    if (numbers.mean_below) add("mean-below", *numbers.mean_below);
    add("in-tolerance", numbers.in_tolerance, Unit::ratio);
    add("above", numbers.above, Unit::ratio);
    add("below", numbers.below, Unit::ratio);
    add("p1", numbers.p1);
    add("p5", numbers.p5);
    add("p50", numbers.p50);
    add("p95", numbers.p95);
    add("p99", numbers.p99);
}

/// "" for the first item, else "@2" and so on.
std::string suffix_of(std::size_t number) { return number == 1 ? "" : fmt::format("@{}", number); }

}  // namespace

Inspection inspect(const PointCloud& scan, const TriangleMesh& nominal, const Transforms* transforms,
                   const InspectParams& params, Context& context) {
    require_points(scan, "there is nothing to inspect");
    const std::span<const Vec3> positions = scan.positions.span();
    return inspect_scan({scan.frame, positions, all_rows(scan.size()), [=] { return point_spacing(positions); },
                         [=] { return robust_box(positions).diagonal(); },
                         [=](std::span<const u32> order) { return spacing_along(positions, order); }},
                        nominal, transforms, params, context);
}

Inspection inspect(const TriangleMesh& scan, const TriangleMesh& nominal, const Transforms* transforms,
                   const InspectParams& params, Context& context) {
    require_triangles(scan, "a scan that is a mesh needs at least one");
    const auto spacing = [&scan] { return edge_spacing(scan); };
    return inspect_scan(
        {scan.frame, scan.positions.span(), used_rows(scan), spacing, [&scan] { return surface_box(scan).diagonal(); },
         [=](std::span<const u32>) { return spacing(); }},
        nominal, transforms, params, context);
}

PointCloud deviation_of(const PointCloud& scan, const Inspection& inspected, Context& context) {
    PointCloud result = scan;
    add_columns(result.columns, inspected, context);
    return result;
}

TriangleMesh deviation_of(const TriangleMesh& scan, const Inspection& inspected, Context& context) {
    TriangleMesh result = scan;
    add_columns(result.vertex_columns, inspected, context);
    keep_colours(result.face_columns, context);
    return result;
}

Metrics metrics_of(const Inspection& inspected) {
    Metrics metrics;
    metrics.unit = inspected.unit;
    const auto count = [&](const std::string& name, std::size_t value) {
        metrics.set(name, static_cast<double>(value), Unit::count);
    };
    const auto length = [&](const std::string& name, double value) { metrics.set(name, value, Unit::length); };
    count("points", inspected.points);
    count("counted", inspected.numbers.counted);
    count("undecided", inspected.undecided);
    count("beyond-borders", inspected.beyond_border);
    count("too-far", inspected.too_far);
    count("cut", inspected.cut);
    add_numbers(metrics, inspected.numbers, "");
    count("parts", inspected.parts.size());
    for (std::size_t i = 0; i < std::min(inspected.parts.size(), most_parts); ++i) {
        const InspectedPart& part = inspected.parts[i];
        const std::string suffix = suffix_of(i + first_part_number);
        count("points" + suffix, part.points);
        count("counted" + suffix, part.numbers ? part.numbers->counted : 0);
        if (part.numbers) add_numbers(metrics, *part.numbers, suffix);
    }
    length("tolerance-low", inspected.tolerance.low);
    length("tolerance-high", inspected.tolerance.high);
    length("chord-error", inspected.chord_error);
    length("max-distance", inspected.max_distance);
    length("range-low", inspected.scale.low);
    length("range-high", inspected.scale.high);
    for (std::size_t i = 0; i < inspected.histogram.size(); ++i)
        metrics.set("histogram" + suffix_of(i + 1), inspected.histogram[i], Unit::ratio);
    for (std::size_t i = 0; i < inspected.labels.size(); ++i) {
        const Label& label = inspected.labels[i];
        const std::string suffix = suffix_of(i + 1);
        length("label" + suffix, label.deviation);
        length("label-x" + suffix, label.position.x());
        length("label-y" + suffix, label.position.y());
        length("label-z" + suffix, label.position.z());
    }
    metrics.set("aligned", inspected.aligned, Unit::boolean);
    if (inspected.alignment_rms) length("alignment-rms", *inspected.alignment_rms);
    length("diagonal", inspected.diagonal);
    return metrics;
}

}  // namespace scanmill
