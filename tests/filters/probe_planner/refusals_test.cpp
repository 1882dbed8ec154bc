// SPDX-License-Identifier: GPL-3.0-or-later
/// What probe-planner refuses, with numbers and a way out.

#include <gmock/gmock.h>

#include <limits>

#include "filters/probe_planner/cases.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::HasSubstr;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TriangleMesh part() { return box(Vec3::Zero(), Vec3::Constant(10), 2); }

Error refusal(const FeatureGraph& features, const TriangleMesh& mesh, const ProbePlannerParams& params) {
    const Error error = error_of([&] { planned(features, mesh, params, 1); });
    EXPECT_FALSE(error.hint().empty()) << error.sentence();
    return error;
}

template <class Change>
std::string refusal_of_params(Change&& change) {
    ProbePlannerParams params = probe_of(1, 0.1, 2);
    change(params);
    const TriangleMesh mesh = part();
    return refusal(lines_of(mesh), mesh, params).sentence();
}

TEST(ProbePlannerRefusals, Parameters) {
    using P = ProbePlannerParams;
    EXPECT_EQ(refusal_of_params([](P& p) { p.radius = 0; }), "radius must be above 0; it is 0 u");
    EXPECT_EQ(refusal_of_params([](P& p) { p.radius = nan; }), "radius must be above 0; it is nan u");
    EXPECT_EQ(refusal_of_params([](P& p) { p.scanner_error = -1; }), "scanner-error must be at least 0; it is -1 u");
    EXPECT_THAT(refusal_of_params([](P& p) { p.scanner_error = 1; }),
                testing::HasSubstr("scanner-error is 1 u and radius is 1 u: unless the radius is larger"));
    EXPECT_EQ(
        refusal_of_params([](P& p) { p.scanner_error = 1.5; }),
        "scanner-error is 1.5 u and radius is 1 u: unless the radius is larger, a face may be touched before the edge");
    EXPECT_EQ(refusal_of_params([](P& p) { p.spacing = 0; }), "spacing must be above 0; it is 0 u");
    EXPECT_EQ(refusal_of_params([](P& p) { p.spacing = 1e-9; }),
              "a spacing of 1e-09 u gives more than 1000000 touches");
    EXPECT_EQ(refusal_of_params([](P& p) { p.clearance = -0.5; }), "clearance must be at least 0; it is -0.5 u");
    EXPECT_EQ(refusal_of_params([](P& p) { p.retract = 0; }), "retract must be above 0; it is 0 u");
    EXPECT_EQ(refusal_of_params([](P& p) { p.stylus_radius = 1; }),
              "stylus-radius is 1 u and radius is 1 u: the stylus must be thinner than the ball");
    EXPECT_EQ(refusal_of_params([](P& p) { p.stylus_radius = 0; }), "stylus-radius must be above 0; it is 0 u");
    EXPECT_EQ(refusal_of_params([](P& p) { p.stylus_length = 0; }), "stylus-length must be above 0; it is 0 u");
    EXPECT_EQ(refusal_of_params([](P& p) { p.stylus_length = 0.5; }),
              "stylus-length is 0.5 u and radius is 1 u: the stylus ends inside the ball");
    EXPECT_EQ(refusal_of_params([](P& p) { p.approach = Angle::degrees(91); }),
              "approach must be from -90 to 90 deg; it is 91 deg");
    EXPECT_EQ(refusal_of_params([](P& p) { p.max_tilt = Angle::degrees(-1); }),
              "max-tilt must be from 0 to 180 deg; it is -1 deg");
    EXPECT_EQ(refusal_of_params([](P& p) { p.machine_axis = {0, 1}; }), "machine-axis has 2 numbers; it needs 3");
    EXPECT_EQ(refusal_of_params([](P& p) {
                  p.machine_axis = {0, 0, 0};
              }),
              "machine-axis is (0, 0, 0); it must be finite and not zero");
    EXPECT_EQ(refusal_of_params([](P& p) { p.directions = 3; }), "directions must be 1 or 2; it is 3");
    EXPECT_EQ(refusal_of_params([](P& p) {
                  p.directions = 2;
                  p.approach = Angle::degrees(5);
              }),
              "`directions: 2` chooses two approaches, but `approach` gives one");
}

/// One line of three segments along y with a crease's normals, and a square boundary.
FeatureGraph two_lines() {
    FeatureGraph graph;
    graph.positions = {Vec3(0, 0, 0), Vec3(0, 1, 0), Vec3(0, 2, 0), Vec3(0, 3, 0),
                       Vec3(5, 0, 0), Vec3(9, 0, 0), Vec3(9, 4, 0), Vec3(5, 4, 0)};
    graph.polylines = {{FeatureType::outer_boundary, true, 0, 4}, {FeatureType::crease, false, 4, 8}};
    graph.vertices = {4, 5, 6, 7, 0, 1, 2, 3};
    const Vec3 x = Vec3::UnitX(), z = Vec3::UnitZ(), none = Vec3::Zero();
    graph.left_normals = {z, z, z, z, z, z, z, none};
    graph.right_normals = {none, none, none, none, x, x, x, none};
    return graph;
}

TEST(ProbePlannerRefusals, PartsWithoutLines) {
    const ProbePlannerParams params = probe_of(1, 0.1, 2);
    const TriangleMesh sphere = geodesic_sphere(10, 8);
    EXPECT_EQ(refusal(lines_of(sphere), sphere, params).sentence(),
              "there is no line to probe: the features have 0 outer boundaries, 0 holes and 0 creases");
    ProbePlannerParams holes = params;
    holes.features = ProbePlannerParams::Features::holes;
    const Error error = refusal(lines_of(part()), part(), holes);
    EXPECT_EQ(error.sentence(),
              "there is no line to probe: the features have 0 outer boundaries, 0 holes and 12 creases");
    EXPECT_EQ(error.hint(), "`features: all` probes every line");
    EXPECT_EQ(refusal(two_lines(), part(), holes).sentence(),
              "there is no line to probe: the features have 1 outer boundary, 0 holes and 1 crease");
}

TEST(ProbePlannerRefusals, Meshes) {
    const ProbePlannerParams params = probe_of(1, 0.1, 2);
    const FeatureGraph features = lines_of(part());
    EXPECT_THAT(refusal(features, TriangleMesh(), params).sentence(), HasSubstr("the mesh has no triangles"));
    const TriangleMesh broken = mapped(part(), [](const Vec3& p) { return p == Vec3::Zero() ? Vec3(0, nan, 0) : p; });
    EXPECT_THAT(refusal(features, broken, params).sentence(), HasSubstr("the first is number 0 (y is nan)"));
    TriangleMesh loose = part();
    Array<Vec3> more(loose.positions.begin(), loose.positions.end());
    more.push_back(Vec3(nan, 0, 0));
    loose.positions = std::move(more);
    EXPECT_THAT(refusal(features, loose, params).sentence(), HasSubstr("1 of "))
        << "also a vertex of no triangle, as virtual-probe";
    TriangleMesh torn = part();
    torn.triangles = {{0, 1, 2}, {0, 1, 9999}};
    EXPECT_THAT(refusal(features, torn, params).sentence(), HasSubstr("triangle 1 names vertex 9999; there are"));
    TriangleMesh other = part();
    other.frame.unit = LengthUnit::millimetre;
    EXPECT_EQ(refusal(features, other, params).sentence(), "the features are in u, the mesh in mm; both need one unit");
    other = part();
    other.frame.name = "scanner";
    FeatureGraph named = features;
    named.frame.name = "machine";
    EXPECT_EQ(refusal(named, other, params).sentence(),
              "the features are in the frame 'machine', the mesh in 'scanner'; both need one frame");
    other.frame.name = "machine";
    EXPECT_EQ(planned(named, other, params).plan.frame.name, "machine");
    EXPECT_EQ(planned(features, other, params).plan.frame.name, "machine") << "a name is kept";
}

TEST(ProbePlannerRefusals, AMeshInsideOut) {
    const auto reversed = [](TriangleMesh mesh) {
        Array<Triangle> triangles;
        for (const auto& [a, b, c] : mesh.triangles) triangles.push_back({a, c, b});
        mesh.triangles = std::move(triangles);
        return mesh;
    };
    const ProbePlannerParams params = probe_of(1, 0.1, 2);
    const TriangleMesh wrong = reversed(part());
    const Error error = refusal(lines_of(wrong), wrong, params);
    EXPECT_EQ(error.sentence(),
              "the mesh is inside out: its volume is -1000 u3, so that its convex edges count as concave");
    EXPECT_EQ(error.hint(), "`repair` turns a closed mesh outwards; find the features on its result");
    const TriangleMesh hollow = joined(part(), reversed(box(Vec3::Constant(3), Vec3::Constant(7), 2)));
    EXPECT_EQ(planned(hollow, params).concave, 24u) << "the edges of the cavity; the block itself is not inside out";
    TriangleMesh open = wrong;
    open.triangles = Buffer<Triangle>(Array<Triangle>(wrong.triangles.begin() + 1, wrong.triangles.end()));
    EXPECT_NO_THROW(planned(open, params)) << "an open mesh has no inside";
}

TEST(ProbePlannerRefusals, LinesThatAreNotOnTheMesh) {
    const ProbePlannerParams params = probe_of(1, 0.1, 2);
    const TriangleMesh far = box(Vec3(110, 0, 0), Vec3(120, 10, 10), 2);
    EXPECT_EQ(refusal(lines_of(far), part(), params).sentence(),
              "the lines are not on the mesh: the nearest reference point is 100 u away from it");
    const TriangleMesh both = joined(part(), far);
    EXPECT_EQ(planned(lines_of(both), part(), params).plan.touches.size(), 120u) << "some are";
}

template <class T>
Buffer<T> with(const Buffer<T>& buffer, std::size_t row, const T& value) {
    Array<T> changed(buffer.begin(), buffer.end());
    changed[row] = value;
    return changed;
}

TEST(ProbePlannerRefusals, Lines) {
    const TriangleMesh mesh = part();
    const ProbePlannerParams params = probe_of(0.2, 0.02, 1);
    EXPECT_EQ(planned(two_lines(), mesh, params).plan.touches.size(), 19u) << "the lines themselves are sound";
    const auto sentence = [&](auto&& change) {
        FeatureGraph graph = two_lines();
        change(graph);
        return refusal(graph, mesh, params).sentence();
    };
    EXPECT_EQ(sentence([](FeatureGraph& g) { g.polylines[0].closed = false; }),
              "line 0 is an open outer boundary with 4 vertices; boundaries of a mesh are closed");
    EXPECT_EQ(sentence([](FeatureGraph& g) { g.positions = with(g.positions, 2, Vec3(0, 1, 0)); }),
              "segment 1 of line 1 has the length 0: both ends are at (0, 1, 0)");
    EXPECT_EQ(sentence([](FeatureGraph& g) { g.positions = with(g.positions, 2, Vec3(0, nan, 0)); }),
              "vertex 2 of line 1 is not finite");
    EXPECT_EQ(sentence([](FeatureGraph& g) { g.left_normals = with(g.left_normals, 5, Vec3(0, nan, 0)); }),
              "the left normal of segment 1 of line 1 is not finite");
    EXPECT_EQ(sentence([](FeatureGraph& g) { g.right_normals = with(g.right_normals, 6, Vec3(nan, 0, 0)); }),
              "the right normal of segment 2 of line 1 is not finite");
    EXPECT_EQ(sentence([](FeatureGraph& g) { g.left_normals = with(g.left_normals, 5, Vec3(0, 0, 2)); }),
              "the left normal of segment 1 of line 1 has the length 2; a unit normal has 1");
    EXPECT_EQ(sentence([](FeatureGraph& g) { g.left_normals = with(g.left_normals, 1, Vec3(0, 0, 0)); }),
              "segment 1 of line 0 has no normal on its left");
    EXPECT_EQ(sentence([](FeatureGraph& g) { g.right_normals = with(g.right_normals, 5, Vec3(0, 0, 1)); }),
              "the normals on both sides of segment 1 of line 1 are equal (0 deg between them): there is no edge");
    EXPECT_THAT(sentence([](FeatureGraph& g) {
                    const Vec3 along = Vec3::UnitY();
                    for (std::size_t row = 4; row < 7; ++row) g.left_normals = with(g.left_normals, row, along);
                }),
                HasSubstr("the left normal of segment 0 of line 1 is along the line"));
    EXPECT_EQ(sentence([](FeatureGraph& g) { g.vertices = with(g.vertices, 6, 99u); }),
              "line 1 names the point 99; there are 8");
    EXPECT_EQ(sentence([](FeatureGraph& g) { g.polylines[1].end = 5; }),
              "line 1 names the vertices 4 to 5 of 8; a line needs at least 2");
    EXPECT_EQ(sentence([](FeatureGraph& g) { g.polylines[1].end = 9; }),
              "line 1 names the vertices 4 to 9 of 8; a line needs at least 2");
    // Lines that are not chosen are checked, too: whether lines meet depends on all of them.
    ProbePlannerParams creases = params;
    creases.features = ProbePlannerParams::Features::creases;
    EXPECT_EQ(planned(two_lines(), mesh, creases).plan.touches.size(), 3u);
    FeatureGraph beyond = two_lines(), far = two_lines();
    beyond.polylines[0].end = 1'000'000;
    far.vertices = with(far.vertices, 2, 1'000'000u);
    EXPECT_EQ(refusal(beyond, mesh, creases).sentence(),
              "line 0 names the vertices 0 to 1000000 of 8; a line needs at least 3");
    EXPECT_EQ(refusal(far, mesh, creases).sentence(), "line 0 names the point 1000000; there are 8");
    EXPECT_EQ(sentence([](FeatureGraph& g) { g.left_normals = {Vec3(0, 0, 1)}; }),
              "the features have 1 left and 8 right normals for 8 vertices of lines");
}

TEST(ProbePlanner, Cancelled_Ends) {
    ContextOptions options;
    options.is_cancelled = [] { return true; };
    Context context(options);
    const TriangleMesh mesh = part();
    EXPECT_THROW(probe_planner(lines_of(mesh), mesh, probe_of(1, 0.1, 2), context), Cancelled);
}

}  // namespace
}  // namespace scanmill::test
