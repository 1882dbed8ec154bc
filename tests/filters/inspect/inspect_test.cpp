// SPDX-License-Identifier: GPL-3.0-or-later
/// Whole inspections: closed forms, counts, columns, laws.
#include <gmock/gmock.h>

#include <numeric>

#include "filters/inspect/cases.hpp"
#include "scanmill/data/topology.hpp"
#include "support/doubts.hpp"
#include "support/numbers.hpp"

namespace scanmill::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

void expect_counts_add_up(const Inspection& found) {
    EXPECT_EQ(found.points, found.numbers.counted + found.cut + found.undecided + found.beyond_border + found.too_far);
    EXPECT_NEAR(found.numbers.in_tolerance + found.numbers.above + found.numbers.below, 1, 1e-12);
    EXPECT_NEAR(std::accumulate(found.histogram.begin(), found.histogram.end(), 0.0), 1, 1e-12);
    const auto with_value =
        std::ranges::count_if(found.deviations, [](double deviation) { return !std::isnan(deviation); });
    EXPECT_EQ(static_cast<std::size_t>(with_value), found.numbers.counted + found.cut);
    const DeviationNumbers& n = found.numbers;
    EXPECT_NEAR(n.rms * n.rms, n.mean * n.mean + n.standard_deviation * n.standard_deviation, 1e-12 * n.rms * n.rms);
}

double metric(const Inspection& found, std::string_view name) {
    const Metrics metrics = metrics_of(found);
    const Metric* metric = metrics.find(name);
    EXPECT_NE(metric, nullptr) << name;
    return metric ? metric->value : nan;
}

bool has_metric(const Inspection& found, std::string_view name) { return metrics_of(found).find(name) != nullptr; }

TEST(Inspect, SphereThatIsTooLarge_DeviatesByTheDifferenceOfTheRadii) {
    const TriangleMesh nominal = geodesic_sphere(5, 24);
    const PointCloud scan = random_sphere(20'000, 3, 5.02);
    const Inspection found = inspected(scan, nominal, params_with(-0.01, 0.01));
    // The nominal's facets are up to this far inside the sphere: half the edge of 1/24 of 63.4 degrees, squared, / 2 r.
    const double chord_error = 5 * (1 - std::cos(63.44 / 24 * degree / std::sqrt(3.0)));
    EXPECT_GE(found.numbers.min, 0.02 - 1e-9);
    EXPECT_LE(found.numbers.max, 0.02 + 1.5 * chord_error);
    EXPECT_NEAR(found.numbers.mean, 0.02, chord_error);
    EXPECT_EQ(found.numbers.above, 1);
    EXPECT_EQ(found.numbers.in_tolerance, 0);
    EXPECT_EQ(found.undecided + found.beyond_border + found.too_far, 0u);
    expect_counts_add_up(found);
}

TEST(Inspect, MeshScan_IsMeasuredAtItsUsedVertices) {
    TriangleMesh scan = geodesic_sphere(1.05, 4);
    Array<Vec3> positions(scan.positions.begin(), scan.positions.end());
    positions.insert(positions.begin(), Vec3(7, 7, 7));
    Array<Triangle> triangles;
    for (const auto& [a, b, c] : scan.triangles) triangles.push_back({a + 1, b + 1, c + 1});
    scan = soup(std::move(positions), std::move(triangles));
    const Inspection found = inspected(scan, geodesic_sphere(1, 4));
    EXPECT_EQ(found.points, 162u);
    EXPECT_NEAR(found.numbers.min, 0.05, 1e-12) << "vertices are above vertices";
    EXPECT_NEAR(found.numbers.max, 0.05, 1e-12);
    EXPECT_TRUE(std::isnan(found.deviations[0]));
    Context context;
    const TriangleMesh shown = deviation_of(scan, found, context);
    EXPECT_EQ(shown.vertex_columns.find("deviation")->rows(), 163u);
    EXPECT_EQ(shown.triangles.size(), scan.triangles.size());
}

TEST(Inspect, PlanePair_HasOneDeviation) {
    const TriangleMesh nominal = rectangle(2, 1);
    PointCloud scan = cloud(random_points(1000, {0, 0, 0.3}, {2, 1, 0.3}, -1e-9, 4));
    for (const double height : {0.3, -0.2}) {
        Array<Vec3> positions(scan.positions.begin(), scan.positions.end());
        for (Vec3& p : positions) p.z() = height;
        const Inspection found = inspected(cloud(positions), nominal, params_with(-0.2, 0.25));
        EXPECT_DOUBLE_EQ(found.numbers.min, height);
        EXPECT_DOUBLE_EQ(found.numbers.max, height);
        EXPECT_DOUBLE_EQ(found.numbers.mean, height);
        EXPECT_NEAR(found.numbers.standard_deviation, 0, 1e-15);
        EXPECT_EQ(found.numbers.in_tolerance, height < 0 ? 1 : 0);
        EXPECT_EQ(has_metric(found, "mean-above"), height > 0);
        EXPECT_EQ(has_metric(found, "mean-below"), height < 0);
    }
}

TEST(Inspect, EveryFinding_IsCountedOnce) {
    InspectParams params = params_with();
    params.max_distance = 0.6;
    params.sigma = 2;
    PointCloud scan = cloud({{0.5, 0.5, 5}, {2.5, 0.5, 0.1}, {9, 9, 9}, {1, 0.5, 0.55}});
    Array<Vec3> positions(scan.positions.begin(), scan.positions.end());
    for (int i = 0; i < 20; ++i) positions.emplace_back(0.1 + 0.09 * i, 0.4, i % 2 == 0 ? 0.01 : -0.01);
    const Inspection found = inspected(cloud(positions), rectangle(2, 1), params);
    EXPECT_EQ(found.points, 24u);
    EXPECT_EQ(found.too_far, 2u);
    EXPECT_EQ(found.beyond_border, 1u);
    EXPECT_EQ(found.cut, 1u);
    EXPECT_EQ(found.numbers.counted, 20u);
    EXPECT_DOUBLE_EQ(found.deviations[3], 0.55) << "a point that is cut keeps its deviation";
    EXPECT_DOUBLE_EQ(found.numbers.max, 0.01);
    expect_counts_add_up(found);
    for (const auto& [name, value] : std::initializer_list<std::pair<const char*, double>>{
             {"points", 24}, {"counted", 20}, {"too-far", 2}, {"beyond-borders", 1}, {"cut", 1}, {"undecided", 0}})
        EXPECT_EQ(metric(found, name), value) << name;
}

TEST(Inspect, SigmaCut_IsThatOfMeanAndStandardDeviationOfAll) {
    Random random(5);
    Array<Vec3> positions;
    for (int i = 0; i < 2000; ++i)
        positions.emplace_back(random.uniform(0, 2), random.uniform(), 0.02 * random.normal());
    InspectParams params = params_with();
    const Inspection all = inspected(cloud(positions), rectangle(2, 1), params);
    params.sigma = 1.5;
    const Inspection some = inspected(cloud(positions), rectangle(2, 1), params);
    std::vector<double> kept;
    for (const Vec3& p : positions)
        if (std::abs(p.z() - all.numbers.mean) <= 1.5 * all.numbers.standard_deviation) kept.push_back(p.z());
    EXPECT_EQ(some.cut, 2000 - kept.size());
    EXPECT_NEAR(some.numbers.mean, std::accumulate(kept.begin(), kept.end(), 0.0) / static_cast<double>(kept.size()),
                1e-15);
    // The share of a normal distribution beyond 1.5 standard deviations is 13.4 %.
    EXPECT_NEAR(static_cast<double>(some.cut) / 2000, 0.134, 0.03);
}

TEST(Inspect, AutomaticDistance_IsTenTolerancesOrThreeSpacings) {
    InspectParams params = params_with(-0.02, 0.05);
    params.max_distance.reset();
    // A grid of spacing 0.1: three spacings are 0.3, ten tolerances 0.5.
    Array<Vec3> positions;
    for (int i = 0; i < 10; ++i)
        for (int j = 0; j < 10; ++j) positions.emplace_back(0.05 + 0.1 * i, 0.05 + 0.1 * j, 0);
    positions.emplace_back(0.5, 0.5, 0.45);
    positions.emplace_back(0.5, 0.5, 0.6);
    Inspection found = inspected(cloud(positions), rectangle(1, 1), params);
    EXPECT_DOUBLE_EQ(found.max_distance, 0.5);
    EXPECT_EQ(found.too_far, 1u);
    params.tolerance = {-0.001, 0.001};
    found = inspected(cloud(positions), rectangle(1, 1), params);
    EXPECT_NEAR(found.max_distance, 0.3, 1e-12);
    EXPECT_EQ(found.too_far, 2u);
    positions[100].z() = 0.25;
    found = inspected(cloud(positions), rectangle(1, 1), params);
    EXPECT_EQ(found.too_far, 1u);
    EXPECT_DOUBLE_EQ(found.numbers.max, 0.25);
}

TEST(Inspect, Range_IsTwiceTheToleranceAndHasTwoSides) {
    const PointCloud scan = cloud({{1, 0.5, 0.03}, {1, 0.4, -0.01}});
    const auto scale = [&](double low, double high) {
        const ColourScale found = inspected(scan, rectangle(2, 1), params_with(low, high)).scale;
        return std::vector{found.low, found.high};
    };
    EXPECT_THAT(scale(-0.05, 0.1), ElementsAre(-0.1, 0.2));
    EXPECT_THAT(scale(0.05, 0.1), ElementsAre(-0.2, 0.2));
    EXPECT_THAT(scale(-0.1, -0.05), ElementsAre(-0.2, 0.2));
    EXPECT_THAT(scale(0, 0.1), ElementsAre(-0.2, 0.2));
    EXPECT_THAT(scale(0, 0), ElementsAre(-0.03, 0.03));
}

TEST(Inspect, OneFaceMoved_IsShownByThatPatchAlone) {
    InspectParams params = params_with(-0.01, 0.01);
    params.by = InspectParams::By::patches;
    const Vec3 size(3, 2, 1);
    const PointCloud scan = points_on_box(size, 20, [](int face, const Vec3&) { return face == 5 ? 0.03 : 0.0; });
    const Inspection found = inspected(scan, box(size), params);
    ASSERT_EQ(found.parts.size(), 6u);
    int moved = 0;
    for (const InspectedPart& part : found.parts) {
        EXPECT_EQ(part.points, 400u);
        ASSERT_TRUE(part.numbers);
        if (part.numbers->mean > 0.01) {
            ++moved;
            EXPECT_NEAR(part.numbers->mean, 0.03, 1e-12);
            EXPECT_EQ(part.numbers->in_tolerance, 0);
        } else {
            EXPECT_NEAR(part.numbers->rms, 0, 1e-12);
            EXPECT_EQ(part.numbers->in_tolerance, 1);
        }
    }
    EXPECT_EQ(moved, 1);
    EXPECT_DOUBLE_EQ(found.numbers.in_tolerance, 5 / 6.0);
    // The last 400 points are those of the upper face; their part's numbers have the number of the column.
    const u32 part = found.part_numbers.back();
    EXPECT_EQ(metric(found, "in-tolerance@" + std::to_string(part)), 0);
    EXPECT_EQ(metric(found, "points@" + std::to_string(part)), 400);
    EXPECT_EQ(metric(found, "parts"), 6);
    EXPECT_FALSE(has_metric(found, "in-tolerance@8"));
}

TEST(Inspect, ComponentWithoutPoints_IsReported) {
    InspectParams params = params_with();
    params.by = InspectParams::By::components;
    const Inspection found =
        inspected(cloud({{0.5, 0.5, 1.1}, {0.5, 0.4, 1}}), both(cube(), shifted(cube(), {5, 0, 0})), params);
    ASSERT_EQ(found.parts.size(), 2u);
    EXPECT_EQ(found.parts[0].points, 2u);
    EXPECT_EQ(found.parts[1].points, 0u);
    EXPECT_EQ(metric(found, "points@3"), 0);
    EXPECT_EQ(metric(found, "counted@3"), 0);
    EXPECT_FALSE(has_metric(found, "mean@3"));
}

TEST(Inspect, ManyParts_AreReportedUpToALimitWithAWarning) {
    InspectParams params = params_with();
    params.by = InspectParams::By::components;
    TriangleMesh nominal = cube();
    for (int i = 1; i < 120; ++i) nominal = both(nominal, shifted(cube(), {2.0 * i, 0, 0}));
    Context context;
    const Inspection found = inspect(cloud({{0.5, 0.5, 1.1}}), nominal, nullptr, params, context);
    EXPECT_EQ(found.parts.size(), 120u);
    EXPECT_TRUE(has_metric(found, "points@101"));
    EXPECT_FALSE(has_metric(found, "points@102"));
    EXPECT_THAT(context.warnings(), ElementsAre(HasSubstr("120 parts")));
}

TEST(Inspect, Labels_AreInColumnAndMetrics) {
    PointCloud scan = cloud({{0.5, 0.5, 0.01}, {1.5, 0.5, -0.3}, {1.51, 0.5, -0.2}, {0.2, 0.2, 0.25}});
    scan.frame.origin = Vec3(10, 20, 30);
    TriangleMesh nominal = shifted(rectangle(2, 1), {10, 20, 30});
    InspectParams params = params_with();
    params.label_distance = 0.5;
    params.labels = 2;
    const Inspection found = inspected(scan, nominal, params);
    EXPECT_THAT(found.label_numbers, ElementsAre(0, 1, 0, 2));
    EXPECT_NEAR(metric(found, "label"), -0.3, 1e-12);
    EXPECT_NEAR(metric(found, "label@2"), 0.25, 1e-12);
    EXPECT_NEAR(metric(found, "label-x"), 11.5, 1e-12);
    EXPECT_NEAR(metric(found, "label-y@2"), 20.2, 1e-12);
    EXPECT_NEAR(metric(found, "label-z@2"), 30.25, 1e-12);
    params.labels = 0;
    EXPECT_TRUE(inspected(scan, nominal, params).labels.empty());
}

TEST(Inspect, Transform_IsReportedButNotApplied) {
    Context context;
    const PointCloud scan = cloud({{1, 0.5, 0.1}});
    RigidTransform transform;
    transform.translation = Vec3(1, 2, 3);
    transform.rms = 0.012;
    const auto inspect_with = [&](const PointCloud& points, const TriangleMesh& nominal) {
        const Transforms transforms(transform);
        return inspect(points, nominal, &transforms, params_with(), context);
    };
    const Inspection with = inspect_with(scan, rectangle(2, 1));
    EXPECT_EQ(metric(with, "aligned"), 1);
    EXPECT_EQ(metric(with, "alignment-rms"), 0.012);
    EXPECT_DOUBLE_EQ(with.numbers.mean, 0.1);
    const Inspection without = inspected(scan, rectangle(2, 1));
    EXPECT_EQ(metric(without, "aligned"), 0);
    EXPECT_FALSE(has_metric(without, "alignment-rms"));
    PointCloud in_millimetres = scan;
    TriangleMesh nominal = rectangle(2, 1);
    in_millimetres.frame.unit = nominal.frame.unit = LengthUnit::millimetre;
    transform.unit = LengthUnit::micrometre;
    EXPECT_DOUBLE_EQ(*inspect_with(in_millimetres, nominal).alignment_rms, 0.012e-3);
}

TEST(Inspect, TransformOfSeveralMotions_ReportsNoRms) {
    Context context;
    RigidTransform first, second;
    first.from = "a";
    second.from = "b";
    first.rms = second.rms = 0.012;
    Transforms transforms(first);
    transforms.motions.push_back(second);
    const Inspection found = inspect(cloud({{1, 0.5, 0.1}}), rectangle(2, 1), &transforms, params_with(), context);
    EXPECT_EQ(metric(found, "aligned"), 1);
    EXPECT_FALSE(has_metric(found, "alignment-rms"));
}

TEST(Inspect, Columns_OfTheScanAreCarried) {
    PointCloud scan = cloud({{1, 0.5, 0.1}, {9, 9, 9}, {1, 0.4, 0}});
    scan.columns.add(Column("colour", 3, Buffer<u8>{1, 2, 3, 4, 5, 6, 7, 8, 9}));
    scan.columns.add(Column("weight", 1, Buffer<double>{1, 2, 3}));
    const Inspection found = inspected(scan, rectangle(2, 1));
    Context context;
    const PointCloud shown = deviation_of(scan, found, context);
    EXPECT_THAT(context.warnings(), IsEmpty());
    EXPECT_EQ(*shown.columns.find("weight"), *scan.columns.find("weight"));
    EXPECT_EQ(*shown.columns.find("scan-colour"), scan.columns.find("colour")->renamed("scan-colour"));
    const Column& deviation = *shown.columns.find("deviation");
    EXPECT_EQ(deviation.length_exponent(), 1);
    EXPECT_DOUBLE_EQ(deviation.number(0), 0.1);
    EXPECT_TRUE(std::isnan(deviation.number(1)));
    const Column& colour = *shown.columns.find("colour");
    const auto colour_at = [&](std::size_t row) {
        return Colour{static_cast<u8>(colour.number(row, 0)), static_cast<u8>(colour.number(row, 1)),
                      static_cast<u8>(colour.number(row, 2))};
    };
    EXPECT_EQ(colour_at(0), colour_of(found.scale, 0.1));
    EXPECT_EQ(colour_at(1), no_data);
    EXPECT_EQ(colour_at(2), colour_of(found.scale, 0));
    EXPECT_EQ(shown.columns.find("part"), nullptr);
    // Inspected again, the columns of the first inspection are replaced.
    const PointCloud again = deviation_of(shown, found, context);
    EXPECT_EQ(*again.columns.find("scan-colour"), colour.renamed("scan-colour"));
    EXPECT_FALSE(context.warnings().empty());
}

TEST(Inspect, DifferentOrigins_ArePartOfThePositions) {
    PointCloud scan = cloud({{1, 0.5, 0.1}});
    TriangleMesh nominal = shifted(rectangle(2, 1), {-100, 0, 0});
    nominal.frame.origin = Vec3(100, 0, 0);
    const Inspection found = inspected(scan, nominal);
    EXPECT_DOUBLE_EQ(found.numbers.mean, 0.1);
    EXPECT_EQ(found.on_nominal.frame, nominal.frame);
    EXPECT_EQ(found.on_nominal.positions[0], nominal.positions[0]);
}

/// Positions and deviations of a part with noise, for laws.
struct Noisy {
    TriangleMesh nominal = l_block();
    Array<Vec3> points = random_points(3000, {0, 0, 0}, {2, 2, 1}, 0.1, 21);
};

TEST(InspectLaws, Threads_ChangeNoByte) {
    const Noisy part;
    InspectParams params = params_with(-0.02, 0.03);
    params.by = InspectParams::By::patches;
    params.max_distance.reset();
    params.sigma = 2;
    const Inspection one = inspected(cloud(part.points), part.nominal, params, 1);
    for (const unsigned threads : {2u, 8u}) {
        const Inspection other = inspected(cloud(part.points), part.nominal, params, threads);
        EXPECT_EQ(metrics_of(one).values, metrics_of(other).values);
        EXPECT_TRUE(
            std::ranges::equal(std::as_bytes(std::span(one.deviations)), std::as_bytes(std::span(other.deviations))));
        EXPECT_EQ(one.on_nominal.vertex_columns, other.on_nominal.vertex_columns);
        EXPECT_EQ(one.on_nominal.face_columns, other.on_nominal.face_columns);
    }
}

TEST(InspectLaws, Motion_ChangesNoDeviation) {
    const Noisy part;
    const Inspection here = inspected(cloud(part.points), part.nominal);
    const Eigen::AngleAxisd turn(1.1, Vec3(1, 2, 3).normalized());
    Array<Vec3> points;
    for (const Vec3& p : part.points) points.push_back(turn * p + Vec3(3, -2, 1));
    const Inspection there = inspected(cloud(points), shifted(turned(part.nominal, 1.1, {1, 2, 3}), {3, -2, 1}));
    for (std::size_t i = 0; i < points.size(); ++i) EXPECT_NEAR(here.deviations[i], there.deviations[i], 1e-12);
    EXPECT_NEAR(here.numbers.rms, there.numbers.rms, 1e-12);
}

TEST(InspectLaws, Scale_ScalesDeviations) {
    const Noisy part;
    const Inspection small = inspected(cloud(part.points), part.nominal);
    Array<Vec3> points;
    for (const Vec3& p : part.points) points.push_back(8 * p);
    const Inspection large = inspected(cloud(points), scaled(part.nominal, 8), params_with(-0.8, 0.8));
    EXPECT_EQ(large.numbers.mean, 8 * small.numbers.mean);
    EXPECT_EQ(large.numbers.p95, 8 * small.numbers.p95);
    EXPECT_EQ(large.numbers.in_tolerance, small.numbers.in_tolerance);
    EXPECT_EQ(large.histogram, small.histogram);
}

TEST(InspectLaws, OrderOfThePoints_ChangesNoDeviation) {
    const Noisy part;
    Array<Vec3> reversed(part.points.rbegin(), part.points.rend());
    const Inspection forward = inspected(cloud(part.points), part.nominal),
                     backward = inspected(cloud(reversed), part.nominal);
    for (std::size_t i = 0; i < reversed.size(); ++i)
        EXPECT_EQ(forward.deviations[i], backward.deviations[reversed.size() - 1 - i]);
    EXPECT_EQ(forward.numbers.p5, backward.numbers.p5);
}

/// A plate of 100 × 60 × 8 mm with noise of 20 µm, a dent of 0.4 mm with a flat floor (radius 4 to 6) and a pad of
/// 0.2 mm (radius 5 to 6) on its upper face.
struct DentedPlate {
    static constexpr double noise = 0.02;
    const Vec3 size{100, 60, 8}, dent{30, 20, 8}, pad{70, 40, 8};
    PointCloud scan;
    Array<u32> floor, top;  ///< rows on the dent's floor and on the pad's top

    DentedPlate() {
        Random random(17);
        const auto depth = [](double radius, double flat, double rim) {
            return std::clamp((rim - radius) / (rim - flat), 0.0, 1.0);
        };
        scan = points_on_box(size, 160, [&](int face, const Vec3& p) {
            double offset = noise * random.normal();
            if (face == 5) offset += 0.2 * depth((p - pad).norm(), 5, 6) - 0.4 * depth((p - dent).norm(), 4, 6);
            return offset;
        });
        for (u32 row = 5 * 160 * 160; row < scan.size(); ++row) {
            Vec3 p = scan.positions[row];
            p.z() = 8;
            if ((p - dent).norm() < 4) floor.push_back(row);
            if ((p - pad).norm() < 5) top.push_back(row);
        }
    }
};

TEST(Inspect, DentAndPad_AreLabelledAndMeasured) {
    const DentedPlate part;
    InspectParams params = params_with(-0.1, 0.1);
    params.max_distance.reset();
    params.labels = 10;
    params.label_distance = 10;
    const Inspection found = inspected(part.scan, box(part.size), params);
    expect_counts_add_up(found);
    const auto mean_at = [&](const Array<u32>& rows) {
        double sum = 0;
        for (const u32 row : rows) sum += found.deviations[row];
        return sum / static_cast<double>(rows.size());
    };
    EXPECT_NEAR(mean_at(part.floor), -0.4, 0.01);
    EXPECT_NEAR(mean_at(part.top), 0.2, 0.01);
    ASSERT_EQ(found.labels.size(), 10u);
    EXPECT_LT(found.labels[0].deviation, -0.35);
    EXPECT_LT((found.labels[0].position - part.dent).norm(), 6);
    const bool has_pad = std::ranges::any_of(found.labels, [&](const Label& label) {
        return label.deviation > 0.15 && (label.position - part.pad).norm() < 6;
    });
    EXPECT_TRUE(has_pad);
    for (std::size_t i = 0; i < found.labels.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) EXPECT_GE((found.labels[i].position - found.labels[j].position).norm(), 10);
}

TEST(InspectMap, DentInOneLargeFacet_IsVisible) {
    const DentedPlate part;
    const Inspection found = inspected(part.scan, box(part.size), params_with(-0.1, 0.1));
    const TriangleMesh& map = found.on_nominal;
    const Column& deviation = *map.vertex_columns.find("deviation");
    EXPECT_EQ(deviation.length_exponent(), 1);
    double dent = 0, pad = 0;
    std::size_t in_dent = 0, on_pad = 0;
    for (std::size_t vertex = 0; vertex < map.positions.size(); ++vertex) {
        if ((map.positions[vertex] - part.dent).norm() < 3) dent += deviation.number(vertex), ++in_dent;
        if ((map.positions[vertex] - part.pad).norm() < 4) pad += deviation.number(vertex), ++on_pad;
        // The lower face is only 8 below; it has no dent.
        if (map.positions[vertex].z() == 0) {
            EXPECT_NEAR(deviation.number(vertex), 0, 0.06);
        }
    }
    ASSERT_GT(in_dent, 10u);
    ASSERT_GT(on_pad, 10u);
    EXPECT_NEAR(dent / static_cast<double>(in_dent), -0.4, 0.02);
    EXPECT_NEAR(pad / static_cast<double>(on_pad), 0.2, 0.02);
}

TEST(InspectMap, Refinement_KeepsTheSurfaceAndIsConforming) {
    const TriangleMesh nominal = box({3, 2, 1});
    const PointCloud scan = points_on_box({3, 2, 1}, 60, [](int, const Vec3&) { return 0.0; });
    const TriangleMesh map = inspected(scan, nominal).on_nominal;
    EXPECT_GT(map.triangles.size(), 10'000u);
    EXPECT_NEAR(area(map), 22, 1e-10);
    EXPECT_NEAR(signed_volume(map), 6, 1e-10);
    EXPECT_TRUE(topology(map).closed);
    const double longest = std::max(0.005 * std::sqrt(14.0), 3 * 1 / 60.0);
    for (const Triangle& t : map.triangles)
        for (int i = 0; i < 3; ++i)
            EXPECT_LE((map.positions[t[i]] - map.positions[t[(i + 1) % 3]]).norm(), longest * 1.2);
}

TEST(InspectMap, ThinWall_DoesNotMixItsSides) {
    const Vec3 size(10, 10, 0.02);
    const PointCloud all = points_on_box(size, 240, [](int face, const Vec3&) {
        return face == 5 ? 0.005 : face == 4 ? -0.003 : 0.0;
    });
    // The two large faces.
    const PointCloud scan = cloud(Array<Vec3>(all.positions.begin() + 4 * 240 * 240, all.positions.end()));
    const Inspection found = inspected(scan, box(size));
    const Column& deviation = *found.on_nominal.vertex_columns.find("deviation");
    for (std::size_t vertex = 0; vertex < found.on_nominal.positions.size(); ++vertex) {
        const Vec3& p = found.on_nominal.positions[vertex];
        if (p.x() < 0.5 || p.x() > 9.5 || p.y() < 0.5 || p.y() > 9.5) continue;
        EXPECT_EQ(deviation.number(vertex), p.z() == 0 ? -0.003f : 0.005f) << "exact to a float";
    }
}

TEST(InspectMap, PlacesWithoutPoints_HaveNoData) {
    const TriangleMesh nominal = both(cube(), shifted(cube(), {3, 0, 0}));
    const Inspection found = inspected(points_on_box({1, 1, 1}, 40, [](int, const Vec3&) { return 0.01; }), nominal);
    const Column& deviation = *found.on_nominal.vertex_columns.find("deviation");
    const Column& colour = *found.on_nominal.vertex_columns.find("colour");
    std::size_t without = 0;
    for (std::size_t vertex = 0; vertex < found.on_nominal.positions.size(); ++vertex) {
        const bool is_other = found.on_nominal.positions[vertex].x() > 2;
        EXPECT_EQ(std::isnan(deviation.number(vertex)), is_other);
        if (!is_other) continue;
        ++without;
        EXPECT_EQ(colour.number(vertex, 1), no_data[1]);
    }
    EXPECT_GT(without, 100u);
}

TEST(InspectMap, ColumnsAndSharpEdges_AreCarriedWhereTheyCanBe) {
    TriangleMesh nominal = rectangle(2, 1);
    nominal.face_columns.add(Column("surface", 1, Buffer<u32>{7, 9}));
    nominal.vertex_columns.add(Column("weight", 1, Buffer<double>{1, 2, 3, 4}));
    nominal.sharp_edges = {make_edge(0, 2)};
    Context context;
    const TriangleMesh map =
        inspect(cloud({{1, 0.5, 0.1}, {1.1, 0.5, 0.1}}), nominal, nullptr, params_with(), context).on_nominal;
    EXPECT_THAT(context.warnings(), ElementsAre(HasSubstr("'weight'")));
    double length = 0;
    for (const auto& [a, b] : map.sharp_edges) length += (map.positions[a] - map.positions[b]).norm();
    EXPECT_GT(map.sharp_edges.size(), 4u);
    EXPECT_NEAR(length, std::sqrt(5.0), 1e-12);
    for (std::size_t t = 0; t < map.triangles.size(); ++t) {
        const Vec3 middle = (map.positions[map.triangles[t][0]] + map.positions[map.triangles[t][1]] +
                             map.positions[map.triangles[t][2]]) /
                            3;
        EXPECT_EQ(map.face_columns.find("surface")->number(t), middle.y() < middle.x() / 2 ? 7 : 9);
    }
}

TEST(Inspect, Cancelled_Ends) {
    ContextOptions options;
    options.is_cancelled = [] { return true; };
    Context context(options);
    EXPECT_THROW(inspect(cloud({{1, 0.5, 0.1}}), rectangle(2, 1), nullptr, params_with(), context), Cancelled);
}

TEST(Inspect, Progress_MovesForwardToTheEnd) {
    std::vector<double> fractions;
    ContextOptions options;
    options.on_progress = [&](double fraction) { fractions.push_back(fraction); };
    Context context(options);
    inspect(cloud({{1, 0.5, 0.1}}), rectangle(2, 1), nullptr, params_with(), context);
    EXPECT_TRUE(std::ranges::is_sorted(fractions));
    EXPECT_EQ(fractions.back(), 1);
}

}  // namespace
}  // namespace scanmill::test
