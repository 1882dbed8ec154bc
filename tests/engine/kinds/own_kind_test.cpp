// SPDX-License-Identifier: GPL-3.0-or-later
// A kind that only this test has: one header with its traits, and the line that includes it.
#include <gmock/gmock.h>

#include "engine/kinds/markers.hpp"
#include "scanmill/cache/value_file.hpp"
#include "scanmill/describe/file_info.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/kinds/length_scale.hpp"
#include "scanmill/plan/plan.hpp"
#include "scanmill/worker/step_runner.hpp"
#include "support/declared_filters.hpp"

namespace scanmill::test {
namespace {

using ::testing::EndsWith, ::testing::IsEmpty;

Markers two_markers() {
    return {{LengthUnit::metre, Vec3(500, 0, 0), "site"}, {Vec3(0, 0, 0), Vec3(3, 4, 0)}, {"first", "second"}};
}

Value value() { return std::make_shared<const Markers>(two_markers()); }

class OwnKind : public ::testing::Test {
protected:
    TemporaryFolder folder_;
    std::filesystem::path file_ = folder_ / "m.json";
};

TEST_F(OwnKind, Names_IncludeIt) {
    EXPECT_EQ(kind_named("markers"), kind_of<Markers>());
    EXPECT_THAT(kind_names(), EndsWith(", markers"));
}

TEST_F(OwnKind, Cache_KeepsEveryPart) {
    EncodedValue(value()).write(folder_ / "value");
    const auto read = read_value(folder_ / "value").get<Markers>();
    EXPECT_EQ(read->frame, two_markers().frame);
    EXPECT_EQ(read->names, two_markers().names);
    EXPECT_EQ(read->positions[1], Vec3(3, 4, 0));
}

TEST_F(OwnKind, Json_IsWrittenReadAndDescribed) {
    write_file(file_, value());
    const auto read = read_file(file_).value.get<Markers>();
    EXPECT_EQ(read->names, two_markers().names);
    EXPECT_EQ(Vec3(read->frame.origin + read->positions[1]), Vec3(503, 4, 0));
    const nlohmann::ordered_json info = file_info(file_.string());
    EXPECT_EQ(info.at("kind"), "markers");
    EXPECT_EQ(info.at("markers"), 2);
    EXPECT_EQ(info.at("diagonal"), 5);
    EXPECT_EQ(info.at("unit"), "m");
}

TEST_F(OwnKind, Workflow_TakesItAsInputAndWiresIt) {
    FilterSpec spec;
    spec.name = "count-markers";
    spec.summary = "Counts markers.";
    spec.source = "None";
    spec.ties = "No ties occur.";
    spec.inputs = {{"markers", kind_of<Markers>(), "Markers to count."}};
    spec.outputs = {{"metrics", kind_of<Metrics>(), "How many there are."}};
    DeclaredFilters filters;
    filters.add(spec);
    Diagnostics diagnostics("w");
    const FilterLibrary library = filters.library();
    const Plan plan =
        make_plan(parse_workflow("scanmill: 1\ninputs: {scan: points, marks: markers}\nsteps:\n  - count-markers:\n",
                                 diagnostics),
                  library, {}, diagnostics);
    EXPECT_THAT(diagnostics.sorted(), IsEmpty());
    ASSERT_EQ(plan.steps.size(), 1u);
}

TEST_F(OwnKind, OutputThatFollowsItsInput_HasTheKindOfWhatIsWired) {
    FilterSpec spec;
    spec.name = "move";
    spec.summary = "Moves a value.";
    spec.source = "None";
    spec.ties = "No ties occur.";
    spec.not_finite = "Carried along.";
    spec.inputs = {{"value", kind_of<PointCloud>(), "What is moved.", false, false, {kind_of<Markers>()}}};
    spec.outputs = {{"value", kind_of<PointCloud>(), "The moved value."}};
    spec.outputs.front().like = "value";
    DeclaredFilters filters;
    filters.add(spec);
    Diagnostics diagnostics("w");
    const FilterLibrary library = filters.library();
    ASSERT_THAT(library.unusable(), IsEmpty()) << library.unusable().front().reason;
    EXPECT_EQ(*library.find("move"), spec) << "through its manifest";
    const Plan plan = make_plan(parse_workflow("scanmill: 1\ninputs: {scan: points, marks: markers}\nsteps:\n"
                                               "  - move:\n    in: {value: marks}\n  - move:\n    in: {value: scan}\n"
                                               "    id: cloud\noutputs: {a.json: move, b.ply: cloud}\n",
                                               diagnostics),
                                library, {}, diagnostics);
    EXPECT_THAT(diagnostics.sorted(), IsEmpty());
    ASSERT_EQ(plan.steps.size(), 2u);
    EXPECT_EQ(plan.steps[0].spec.outputs.front().kind, kind_of<Markers>());
    EXPECT_EQ(plan.steps[1].spec.outputs.front().kind, kind_of<PointCloud>());
}

TEST_F(OwnKind, Leaf_IsReadAndPlaced) {
    write_file(file_, value());
    LeafSource leaf;
    leaf.file = file_;
    leaf.kind = kind_of<Markers>();
    leaf.pose.emplace().translation = Vec3(0, 0, 7);
    const Value read = read_leaf(leaf, [](std::string) {});
    EXPECT_EQ(frame_of(read)->origin + positions_of(read)[1], Vec3(503, 4, 7));
    EXPECT_EQ(length_scale(read).diagonal(), 5);
    const Value converted = in_unit(read, LengthUnit::millimetre);
    EXPECT_EQ(frame_of(converted)->origin + positions_of(converted)[1], Vec3(503000, 4000, 7000));
}

}  // namespace
}  // namespace scanmill::test
