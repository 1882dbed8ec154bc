// SPDX-License-Identifier: GPL-3.0-or-later
// Patches in JSON files: read back bit for bit, so they have the same triangles; their size.

#include <set>

#include "filters/a_patch/sharp_cases.hpp"
#include "filters/tessellate/cases.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/kinds/document.hpp"
#include "support/same_bits.hpp"

namespace scanmill {
namespace {

using namespace test;

std::string json_text(const PatchComplex& patches) {
    return write_bytes("a.json", std::make_shared<const PatchComplex>(patches));
}

void expect_read_back(const PatchComplex& patches) {
    const Value value = read_bytes(json_text(patches), "a.json").value;
    ASSERT_TRUE(value.find<PatchComplex>());
    const PatchComplex& read = *value.find<PatchComplex>();
    expect_same_bits(patches, read);
    const TriangleMesh one = tessellated(patches, 4), other = tessellated(read, 4);
    EXPECT_TRUE(same_bits(one.positions, other.positions));
    EXPECT_TRUE(same_bits(one.triangles, other.triangles));
    EXPECT_TRUE(std::ranges::equal(one.sharp_edges, other.sharp_edges));
    EXPECT_TRUE(one.vertex_columns == other.vertex_columns && one.face_columns == other.face_columns);
}

std::size_t length(const Json& document, const char* member) { return document[member].get<std::string>().size(); }

TEST(TessellateJson, SmoothPatches_AreReadBackBitForBit) {
    for (const Split split : {Split::always, Split::where_needed}) {
        expect_read_back(patched(exact_sphere(3), Curvature::mean, split).result.patches);
        expect_read_back(patched(exact_torus(12, 6), Curvature::distance, split).result.patches);
        expect_read_back(
            patched(without_triangles(geodesic_sphere(1, 4), {0}), Curvature::distance, split).result.patches);
    }
}

TEST(TessellateJson, SharpPatches_AreReadBackBitForBit) {
    for (const TriangleMesh& mesh : {sharp_cube(), sharp_cube(1), cylinder(16), cone(8), plate_with_hole(12),
                                     plate_with_boss(12), plate_with_pocket(12)})
        for (const Split split : {Split::always, Split::where_needed}) {
            const PatchComplex patches = patched(mesh, Curvature::distance, split).result.patches;
            EXPECT_THAT(patches.kinds.span(), testing::Contains(PatchKind::sharp));
            expect_read_back(patches);
        }
}

TEST(TessellateJson, SmoothPatches_HaveEveryCoefficientOnce) {
    for (const Split split : {Split::always, Split::where_needed}) {
        const PatchComplex patches = patched(exact_torus(12, 6), Curvature::distance, split).result.patches;
        std::set<std::array<u32, 3>> control_points;
        for (const auto& tet : patches.tets)
            for (const u32 a : tet)
                for (const u32 b : tet)
                    for (const u32 c : tet) {
                        std::array<u32, 3> point{a, b, c};
                        std::ranges::sort(point);
                        control_points.insert(point);
                    }
        const Json document = parse_document(json_text(patches));
        EXPECT_EQ(document["own-weights"], "");
        EXPECT_EQ(length(document, "weights"), (8 * control_points.size() + 2) / 3 * 4);
    }
}

TEST(TessellateJson, ASphereOf5120Triangles_TakesLessThan8200000Bytes) {
    const PatchComplex patches = patched(exact_sphere(16)).result.patches;
    ASSERT_EQ(patches.tets.size(), 12u * 5120);
    EXPECT_LT(json_text(patches).size(), 8'200'000u);
    expect_read_back(patches);
}

}  // namespace
}  // namespace scanmill
