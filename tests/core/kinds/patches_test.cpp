// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/patches.hpp"

#include <gmock/gmock.h>

#include <algorithm>

#include "scanmill/kinds/document.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::HasSubstr;

PatchComplex two_tets() {
    PatchComplex patches;
    patches.frame = {LengthUnit::millimetre, Vec3::Zero(), "part"};
    patches.positions = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0.1 + 0.2, 1. / 3, 1), Vec3(0, 0, -1e-300)};
    patches.tets = {std::array<u32, 4>{0, 1, 2, 3}, std::array<u32, 4>{0, 1, 2, 4}};
    PatchWeights weights;
    for (std::size_t i = 0; i < weights.size(); ++i) weights[i] = (static_cast<double>(i) - 7) / 3;
    PatchWeights small = weights;
    small[3] = 5e-324;
    patches.weights = {weights, small};
    patches.kinds = {PatchKind::face, PatchKind::edge};
    patches.sides = {1, 0};
    patches.triangles = {0, 4};
    patches.edges = {PatchComplex::no_edge, 7};
    patches.combine = {Combine::none, Combine::none};
    patches.partners = {PatchComplex::no_partner, PatchComplex::no_partner};
    return patches;
}

/// Two functions in one tetrahedron, whose corners are in another order in the second row.
PatchComplex two_functions(Combine combine = Combine::max) {
    PatchComplex patches = two_tets();
    patches.tets = {std::array<u32, 4>{0, 1, 2, 3}, std::array<u32, 4>{3, 2, 1, 0}};
    patches.kinds = {PatchKind::face, PatchKind::continuation};
    patches.sides = {1, 1};
    patches.combine = {combine, combine};
    patches.partners = {1, 0};
    return patches;
}

Json json_of(const PatchComplex& patches) {
    Json json;
    kind_of<PatchComplex>().info().to_json(&patches, json);
    return json;
}
PatchComplex patches_of(const Json& json) {
    return *std::static_pointer_cast<PatchComplex>(kind_of<PatchComplex>().info().from_json(json, {}));
}

void expect_equal(const PatchComplex& a, const PatchComplex& b) {
    EXPECT_EQ(a.frame, b.frame);
    EXPECT_TRUE(std::ranges::equal(a.positions, b.positions));
    EXPECT_TRUE(std::ranges::equal(a.tets, b.tets));
    EXPECT_TRUE(std::ranges::equal(a.weights, b.weights));
    EXPECT_TRUE(std::ranges::equal(a.kinds, b.kinds));
    EXPECT_TRUE(std::ranges::equal(a.sides, b.sides));
    EXPECT_TRUE(std::ranges::equal(a.triangles, b.triangles));
    EXPECT_TRUE(std::ranges::equal(a.edges, b.edges));
    EXPECT_TRUE(std::ranges::equal(a.combine, b.combine));
    EXPECT_TRUE(std::ranges::equal(a.partners, b.partners));
}

TEST(Patches, AsJsonText_AreReadBackBitForBit) {
    expect_equal(patches_of(parse_document(json_of(two_tets()).dump())), two_tets());
    for (const Combine combine : {Combine::max, Combine::min}) {
        PatchComplex patches = two_functions(combine);
        expect_equal(patches_of(parse_document(json_of(patches).dump())), patches);
        patches.kinds = {PatchKind::sharp, PatchKind::sharp};
        expect_equal(patches_of(parse_document(json_of(patches).dump())), patches);
    }
}

TEST(Patches, InAnotherUnit_HaveScaledWeights) {
    const Value metres = in_unit(std::make_shared<const PatchComplex>(two_tets()), LengthUnit::metre);
    const PatchComplex& patches = *metres.get<PatchComplex>();
    EXPECT_DOUBLE_EQ(patches.positions[1].x(), 1e-3);
    EXPECT_DOUBLE_EQ(patches.weights[0][0], -7e-3 / 3);
    EXPECT_EQ(patches.tets[1], two_tets().tets[1]);
}

TEST(Patches, Turned_KeepTheirWeights) {
    RigidTransform pose;
    pose.rotation << 0, -1, 0, 1, 0, 0, 0, 0, 1;
    const Value turned = placed(std::make_shared<const PatchComplex>(two_tets()), pose);
    EXPECT_EQ(turned.get<PatchComplex>()->positions[1], Vec3(0, 1, 0));
    EXPECT_EQ(turned.get<PatchComplex>()->weights[1], two_tets().weights[1]);
}

TEST(Patches, HaveCounts) {
    const PatchComplex patches = two_tets();
    const Metrics properties = kind_of<PatchComplex>().info().properties(&patches);
    ASSERT_EQ(properties.values.size(), 2u);
    EXPECT_EQ(properties.values[0].name, "tetrahedra");
    EXPECT_EQ(properties.values[0].value, 2);
    EXPECT_EQ(properties.values[1].value, 5);
}

TEST(PatchesRefuse, WhatIsNotUsable) {
    const auto refusal = [](const PatchComplex& patches) {
        return error_of([&] { kind_of<PatchComplex>().info().require_usable(&patches); }).sentence();
    };
    EXPECT_THAT(refusal({}), HasSubstr("no tetrahedra"));
    PatchComplex patches = two_tets();
    patches.sides = {1};
    EXPECT_THAT(refusal(patches), HasSubstr("one row for each of the 2"));
    patches = two_tets();
    patches.tets = {std::array<u32, 4>{0, 1, 2, 3}, std::array<u32, 4>{0, 1, 2, 5}};
    EXPECT_THAT(refusal(patches), HasSubstr("tetrahedron 1 names point 5; there are 5"));
    patches.tets = {std::array<u32, 4>{0, 1, 2, 1}, std::array<u32, 4>{0, 1, 2, 4}};
    EXPECT_THAT(refusal(patches), HasSubstr("tetrahedron 0 names point 1 twice"));
    patches = two_functions();
    EXPECT_NO_THROW(kind_of<PatchComplex>().info().require_usable(&patches));
    patches.partners = {1, 1};
    EXPECT_THAT(refusal(patches), HasSubstr("tetrahedron 0 has partner 1, which has another partner"));
    patches.partners = {1};
    EXPECT_THAT(refusal(patches), HasSubstr("one row for each of the 2"));
    patches = two_functions();
    patches.combine = {Combine::max};
    EXPECT_THAT(refusal(patches), HasSubstr("one row for each of the 2"));
}

TEST(PatchesRefuse, BrokenJson) {
    const auto refusal = [](auto&& change) {
        Json json = json_of(two_tets());
        change(json);
        return error_of([&] { patches_of(json); }).sentence();
    };
    EXPECT_THAT(refusal([](Json& j) { j["tets"][0]["vertices"][2] = 9; }),
                HasSubstr("tetrahedron 0 names point 9; there are 5"));
    EXPECT_THAT(refusal([](Json& j) {
                    j["tets"][0]["vertices"] = {1, 2};
                }),
                HasSubstr("'tets[0].vertices' is not a list of 4"));
    EXPECT_THAT(refusal([](Json& j) { j["tets"][1]["vertices"][3] = 0u; }),
                HasSubstr("tetrahedron 1 names point 0 twice"));
    EXPECT_THAT(refusal([](Json& j) { j["tets"][1]["weights"] = {1}; }),
                HasSubstr("'tets[1].weights' is not a list of 20"));
    EXPECT_THAT(refusal([](Json& j) { j["tets"][1]["kind"] = "corner"; }), HasSubstr("'tets[1].kind' is 'corner'"));
    EXPECT_THAT(refusal([](Json& j) { j["tets"][1]["combine"] = "sum"; }), HasSubstr("expected none, max and min"));
    EXPECT_THAT(refusal([](Json& j) { j["tets"][1]["combine"] = "max"; }), HasSubstr("1 has no partner to combine"));
    EXPECT_THAT(refusal([](Json& j) { j["tets"][1]["partner"] = 0u; }), HasSubstr("1 has a partner without 'combine'"));
    EXPECT_THAT(refusal([](Json& j) {
                    j["tets"][1].update({{"partner", 2u}, {"combine", "max"}});
                }),
                HasSubstr("has partner 2; there are 2"));
    EXPECT_THAT(refusal([](Json& j) { j["tets"][1]["side"] = 2; }), HasSubstr("'tets[1].side' is 2"));
    EXPECT_THAT(refusal([](Json& j) { j["tets"][1]["patch"] = -1; }),
                HasSubstr("'tets[1].patch' is not a whole number"));
    EXPECT_THAT(refusal([](Json& j) { j["tets"][0] = 1; }), HasSubstr("'tets[0]' is not an object"));
    const auto refusal_of_two = [](auto&& change) {
        Json json = json_of(two_functions());
        change(json["tets"]);
        return error_of([&] { patches_of(json); }).sentence();
    };
    EXPECT_THAT(refusal_of_two([](Json& tets) { tets[0]["partner"] = 0u; }), HasSubstr("has partner 0, which has"));
    EXPECT_THAT(refusal_of_two([](Json& tets) { tets[1]["combine"] = "min"; }),
                HasSubstr("0 and its partner 1 differ"));
    EXPECT_THAT(refusal_of_two([](Json& tets) { tets[1]["side"] = 0u; }), HasSubstr("0 and its partner 1 differ"));
    EXPECT_THAT(refusal_of_two([](Json& tets) { tets[1]["vertices"][0] = 4u; }),
                HasSubstr("0 and its partner 1 differ"));
}

}  // namespace
}  // namespace scanmill::test
