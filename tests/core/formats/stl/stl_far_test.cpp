// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes that single precision does not hold: survey coordinates, and triangles that collapse.
#include "core/formats/support.hpp"
#include "scanmill/data/topology.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// What write_bytes() reports.
struct Written {
    Warnings warnings;
    Vec3 shift = Vec3::Zero();
    bool was_opened = false;
    std::string bytes;

    explicit Written(const TriangleMesh& mesh, const char* name = "a.stl") {
        WriteOptions options = warnings.writing();
        options.on_shift = [this](const Vec3& used) { shift = used; };
        options.on_opened = [this](std::string sentence) {
            was_opened = true;
            warnings.sentences.push_back(std::move(sentence));
        };
        bytes = write_bytes(name, std::make_shared<const TriangleMesh>(mesh), options);
    }
    std::shared_ptr<const TriangleMesh> back() const { return mesh_in(bytes, "a.stl"); }
};

TriangleMesh sphere_at(const Vec3& centre, double radius = 5, u32 frequency = 20) {
    TriangleMesh mesh = geodesic_sphere(radius, frequency);
    mesh.frame.origin = centre;
    return mesh;
}

TEST(StlFarFromZero, ASphereAtSurveyCoordinates_StaysClosed) {
    const Vec3 centre(500000, 4500000, 300);
    const Written written(sphere_at(centre));
    EXPECT_EQ(written.shift, Vec3(500000, 4500000, 0)) << "floats hold heights of 300";
    const auto back = written.back();
    EXPECT_TRUE(topology(*back).closed);
    EXPECT_EQ(back->triangles.size(), 20u * 20 * 20);
    const BoundingBox box = bounding_box(back->positions.span());
    EXPECT_LT((box.high + back->frame.origin - Vec3(0, 0, 300)).maxCoeff(), 5.001);
    EXPECT_GT((box.low + back->frame.origin - Vec3(0, 0, 300)).minCoeff(), -5.001);
    EXPECT_THAT(written.warnings.sentences, ElementsAre(HasSubstr("relative to 500000 4500000 0:")));
    EXPECT_THAT(written.bytes.substr(0, 80), HasSubstr("; shift 500000 4500000 0"));
    EXPECT_FALSE(written.was_opened);
}

TEST(StlFarFromZero, TheShift_IsReportedWhenTheFileIsRead) {
    TriangleMesh mesh = sphere_at(Vec3(500000, 4500000, 300));
    mesh.frame.unit = LengthUnit::metre;
    mesh.frame.name = "site; 4";
    Warnings reading;
    const auto back = mesh_in(Written(mesh).bytes, "a.stl", &reading);
    EXPECT_EQ(back->frame.unit, LengthUnit::metre);
    EXPECT_EQ(back->frame.name, "site; 4");
    EXPECT_THAT(reading.sentences, ElementsAre(HasSubstr("relative to '500000 4500000 0'")));
}

TEST(StlFarFromZero, TheShiftIsRound_OnFarAxesOnly) {
    EXPECT_EQ(Written(sphere_at(Vec3(512345.678, 4500000, 0))).shift, Vec3(510000, 4500000, 0));
    EXPECT_EQ(Written(sphere_at(Vec3(-512345.678, 20, 0), 0.005)).shift, Vec3(-512350, 20, 0));
}

TEST(StlThatFloatsHold, IsWrittenAtItsWorldCoordinates) {
    // A fine sphere near zero, and one at a distance where edges of 0.3 keep a hundredth.
    for (const Vec3& centre : {Vec3(0, 0, 0), Vec3(40, -70, 3), Vec3(2000, 3000, 100)}) {
        const TriangleMesh mesh = sphere_at(centre);
        const Written written(mesh);
        EXPECT_EQ(written.shift, Vec3::Zero());
        const auto back = written.back();
        for (std::size_t corner = 0; corner < 3; ++corner)
            EXPECT_EQ(back->frame.origin + back->positions[back->triangles[0][corner]],
                      (mesh.frame.origin + mesh.positions[mesh.triangles[0][corner]]).cast<float>().cast<double>());
        EXPECT_THAT(written.bytes.substr(0, 80), testing::Not(HasSubstr("shift")));
    }
}

TEST(StlThatCollapses, LeavesOutTrianglesWithoutArea_AndStaysClosed) {
    // An edge of a closed mesh that is shorter than floats resolve: two triangles lose their area.
    TriangleMesh mesh = sphere_at(Vec3::Zero(), 1000, 4);
    Array<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
    const Triangle first = mesh.triangles[0];
    positions[first[1]] = positions[first[0]] + Vec3(1e-9, 0, 0);
    mesh.positions = std::move(positions);
    ASSERT_TRUE(topology(mesh).closed);
    const Written written(mesh);
    EXPECT_THAT(written.warnings.sentences,
                ElementsAre(ContainsRegex("1 vertex .*single precision.* 2 triangles .*left out")));
    EXPECT_TRUE(topology(*written.back()).closed);
    EXPECT_FALSE(written.was_opened);
}

TEST(StlThatCollapses, AndIsNotClosedThen_IsReported) {
    // Two separate spheres that touch in one point as soon as they are rounded.
    TriangleMesh mesh = sphere_at(Vec3::Zero(), 1000, 2);
    const auto count = static_cast<u32>(mesh.positions.size());
    Array<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
    Array<Triangle> triangles(mesh.triangles.begin(), mesh.triangles.end());
    const auto rightmost = std::ranges::max_element(positions, {}, [](const Vec3& p) { return p.x(); });
    const Vec3 tip = *rightmost;
    const Vec3 gap = 2 * Vec3(tip.x(), 0, 0) + Vec3(1e-9, 0, 0);
    for (u32 i = 0; i < count; ++i) {
        const Vec3 mirrored(-positions[i].x(), positions[i].y(), positions[i].z());
        positions.push_back(mirrored + gap);
    }
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto& [a, b, c] = mesh.triangles[i];
        triangles.push_back({a + count, c + count, b + count});
    }
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(triangles);
    ASSERT_TRUE(topology(mesh).closed);
    const Written written(mesh);
    EXPECT_FALSE(topology(*written.back()).closed);
    EXPECT_TRUE(written.was_opened);
    EXPECT_THAT(written.warnings.sentences, testing::Contains(ContainsRegex("closed.*STL file is not")));
}

TEST(StlThatCollapses, Whole_IsRefused) {
    TriangleMesh mesh;
    mesh.positions = {Vec3(1000, 0, 0), Vec3(1000 + 1e-9, 0, 0), Vec3(1000, 1e-60, 0), Vec3(-1000, 0, 0)};
    mesh.triangles = {Triangle{0, 1, 2}, Triangle{0, 1, 3}};
    EXPECT_THROW(Written{mesh}, Error);
    mesh.triangles = {Triangle{0, 1, 3}};
    try {
        Written{mesh};
        FAIL();
    } catch (const Error& error) {
        EXPECT_THAT(error.sentence(), ContainsRegex("single precision .*only triangle .*equal"));
        EXPECT_THAT(error.hint(), HasSubstr("write PLY"));
    }
}

TEST(StlThatCollapsed, IsRefusedWhenItIsRead) {
    const std::string facet =
        "facet normal 0 0 0\nouter loop\nvertex 1 1 1\nvertex 1 1 1\nvertex 2 1 1\nendloop\nendfacet\n";
    EXPECT_THAT(refusal_of("solid\n" + facet + facet + "endsolid\n", "a.stl"),
                ContainsRegex("no surface: all 2 facets .*equal"));
    EXPECT_THAT(refusal_of("solid\n" + facet + "endsolid\n", "a.stl"),
                ContainsRegex("no surface: .*only facet .*equal"));
    const std::string invalid =
        "facet normal 0 0 0\nouter loop\nvertex nan nan nan\nvertex nan nan nan\nvertex 2 1 1\nendloop\nendfacet\n";
    EXPECT_THAT(refusal_of("solid\n" + invalid + invalid + "endsolid\n", "a.stl"),
                ContainsRegex("all 2 facets .*equal .*NaN or infinite"));
    EXPECT_THAT(refusal_of("solid\n" + facet + invalid + facet + "endsolid\n", "a.stl"),
                ContainsRegex("all 3 facets .*equal .*1 of them .*NaN or infinite"));
}

TEST(StlLosses, ColumnsThatFiltersAdded_AreLeftOutWithoutAWarning_TheUsersAreNot) {
    TriangleMesh mesh = cube(1);
    mesh.vertex_columns.add(Column("bin-size", 1, Buffer<u8>(Array<u8>(8, u8(1)))));
    mesh.vertex_columns.add(Column("intensity", 1, Buffer<u8>(Array<u8>(8, u8(1)))));
    Warnings warnings;
    WriteOptions options = warnings.writing();
    options.added_columns = {"bin-size"};
    write_bytes("a.stl", std::make_shared<const TriangleMesh>(mesh), options);
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("STL left out 1 column of the vertices (intensity)")));
}

}  // namespace
}  // namespace scanmill::test
