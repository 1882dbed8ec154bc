// SPDX-License-Identifier: GPL-3.0-or-later
// The filter test-step, called through its module as by the engine. Other tests rely on it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scanmill/plugin/library.hpp"
#include "support/folders.hpp"
#include "support/shapes.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;

class TestStep : public testing::Test {
protected:
    Outputs run(const std::string& mode, std::vector<std::pair<std::string, ParameterValue>> values = {}) {
        values.emplace_back("mode", ParameterScalar(mode));
        values.emplace_back("length", ParameterScalar(Length(0.5)));
        return library_.load("test-step").run(inputs_, {std::move(values)}, context_);
    }
    const PointCloud& points(const Outputs& outputs) { return *outputs.find("points")->get<PointCloud>(); }
    const TriangleMesh& mesh(const Outputs& outputs) { return *outputs.find("mesh")->get<TriangleMesh>(); }

    FilterLibrary library_{{test::test_plugin_folder()}};
    Inputs inputs_;
    Context context_;
};

PointCloud scan() {
    PointCloud cloud = cloud_of({{1, 2, 3}, {4, 5, 6}});
    cloud.frame = {LengthUnit::millimetre, Vec3(1000, 0, 0), "part"};
    cloud.columns.add(Column("weight", 1, Buffer<float>{1, 2}));
    return cloud;
}

TEST_F(TestStep, Pass_ScalesPositionsAndKeepsTheRest) {
    inputs_.add("points", std::make_shared<const PointCloud>(scan()));
    const Outputs outputs = run("pass", {{"factor", ParameterScalar(2.0)}});
    EXPECT_THAT(points(outputs).positions.span(), ElementsAre(Vec3(2, 4, 6), Vec3(8, 10, 12)));
    EXPECT_EQ(points(outputs).columns, scan().columns);
    EXPECT_EQ(points(outputs).frame, scan().frame);
    EXPECT_EQ(context_.metrics().find("points")->value, 2);
    EXPECT_EQ(*context_.metrics().find("length"), (Metric{"length", 0.5, Unit::length}));
}

TEST_F(TestStep, Mesh_IsATetrahedronWithLegsOfTheLength) {
    inputs_.add("points", std::make_shared<const PointCloud>(scan()));
    const TriangleMesh tetrahedron = mesh(run("pass"));
    EXPECT_NO_THROW(require_consistent(tetrahedron));
    EXPECT_DOUBLE_EQ(signed_volume(tetrahedron), 0.125 / 6);
    EXPECT_DOUBLE_EQ(area(tetrahedron), 0.25 * (1.5 + std::sqrt(0.75)));
    EXPECT_EQ(tetrahedron.frame, scan().frame);
}

TEST_F(TestStep, Unwired_WorksOnTheUnitTetrahedron) {
    EXPECT_THAT(points(run("pass")).positions.span(),
                ElementsAre(Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)));
    EXPECT_EQ(context_.metrics().find("more")->value, 0);
}

TEST_F(TestStep, More_IsOnlyCounted) {
    inputs_.add("points", std::make_shared<const PointCloud>(scan()));
    inputs_.add("more", std::make_shared<const PointCloud>(random_cube(5, 1)));
    inputs_.add("more", std::make_shared<const PointCloud>(random_cube(6, 2)));
    EXPECT_EQ(points(run("pass")).size(), 2u);
    EXPECT_EQ(context_.metrics().find("more")->value, 11);
}

TEST_F(TestStep, EachWayToMisbehave_IsAsItsNameSays) {
    const Error error = error_of([&] { run("fail"); });
    EXPECT_EQ(error.sentence(), "was asked to fail; the cloud has 4 points");
    EXPECT_NE(error.hint(), "");
    EXPECT_THROW(run("throw"), std::runtime_error);
    EXPECT_THROW(run("out-of-memory"), std::bad_alloc);
    EXPECT_EQ(context_.warnings().size(), 0u);
    EXPECT_EQ(points(run("warn")).size(), 4u);
    EXPECT_EQ(context_.warnings().size(), 1u);
    EXPECT_TRUE(mesh(run("empty")).triangles.empty());
}

TEST_F(TestStep, Wait_EndsWhenItIsCancelled) {
    int asked = 0;
    ContextOptions options;
    options.is_cancelled = [&] { return ++asked > 3; };
    Context context(std::move(options));
    EXPECT_THROW(library_.load("test-step").run(inputs_, {{{"mode", ParameterScalar(std::string("wait"))}}}, context),
                 Cancelled);
    EXPECT_EQ(asked, 4);
}

TEST_F(TestStep, Log_GetsALineFromEveryRunEvenOneThatFails) {
    const TemporaryFolder folder;
    const ParameterValue log = ParameterScalar((folder / "log").string());
    run("pass", {{"log", log}});
    EXPECT_THROW(run("fail", {{"log", log}}), Error);
    inputs_.add("points", std::make_shared<const PointCloud>(scan()));
    run("empty", {{"log", log}});
    EXPECT_EQ(content_of(folder / "log"), "pass 4\nfail 4\nempty 2\n");
}

}  // namespace
}  // namespace scanmill::test
