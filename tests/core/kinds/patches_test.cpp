// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/patches.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "scanmill/base/random.hpp"
#include "scanmill/kinds/base64.hpp"
#include "scanmill/kinds/document.hpp"
#include "support/same_bits.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
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

template <class Row>
Array<Row> rows_of(const Json& json) {
    Base64<Row> value;
    JsonForm<Base64<Row>>::read(json, value);
    return value.rows;
}
/// Changes the rows of an array in a document.
template <class Row>
void change(Json& json, const std::function<void(Array<Row>&)>& action) {
    Array<Row> rows = rows_of<Row>(json);
    action(rows);
    json = JsonForm<Base64<Row>>::write({rows});
}

void expect_read_back(const PatchComplex& patches) {
    expect_same_bits(patches_of(parse_document(json_of(patches).dump())), patches);
}

TEST(Patches, AsJsonText_AreReadBackBitForBit) {
    expect_read_back(two_tets());
    for (const Combine combine : {Combine::max, Combine::min}) {
        PatchComplex patches = two_functions(combine);
        expect_read_back(patches);
        patches.kinds = {PatchKind::sharp, PatchKind::sharp};
        expect_read_back(patches);
    }
}

TEST(Patches, WeightsAtACommonFace_AreWrittenOnce) {
    const PatchComplex patches = two_tets();
    const Json json = json_of(patches);
    Array<double> wanted(patches.weights[0].begin(), patches.weights[0].end());
    // c_ijkl with l > 0, which belong to point 4
    for (const std::size_t i : {3, 6, 8, 9, 12, 14, 15, 17, 18, 19}) wanted.push_back(patches.weights[1][i]);
    EXPECT_EQ(rows_of<double>(json["weights"]), wanted);
    EXPECT_EQ(json["own-weights"], "");
    EXPECT_EQ(json["partners"], "");
    EXPECT_THAT(rows_of<u32>(json["edge"]), ElementsAre(4294967295u, 7));
}

TEST(Patches, WithOneOtherBitAtACommonFace_HaveAllWeights) {
    for (const std::size_t changed : {0, 7}) {  // -7 / 3, and 0, which becomes -0
        PatchComplex patches = two_tets();
        PatchWeights weights = patches.weights[1];
        weights[changed] = changed == 7 ? -0.0 : std::nextafter(weights[changed], 0);
        patches.weights = {patches.weights[0], weights};
        const Json json = json_of(patches);
        EXPECT_THAT(rows_of<u32>(json["own-weights"]), ElementsAre(1));
        EXPECT_EQ(rows_of<double>(json["weights"]).size(), 40u);
        expect_read_back(patches);
    }
}

TEST(Patches, AtSharpEdges_HaveAllWeights_WhichOthersDoNotShare) {
    PatchComplex patches = two_functions();
    patches.kinds = {PatchKind::sharp, PatchKind::sharp};
    const Json json = json_of(patches);
    EXPECT_THAT(rows_of<u32>(json["own-weights"]), ElementsAre(0, 1));
    EXPECT_EQ(rows_of<double>(json["weights"]).size(), 40u);
    EXPECT_THAT(rows_of<u32>(json["partners"]), ElementsAre(0, 1, 1));
    EXPECT_THAT(rows_of<u32>(json_of(two_functions(Combine::min))["partners"]), ElementsAre(0, 1, 2));
    // A third tetrahedron at the same points has another function, and needs no row of its own for it.
    PatchWeights other = patches.weights[0];
    other[0] = 5;
    patches.tets = {patches.tets[0], patches.tets[1], {0, 1, 2, 3}};
    patches.weights = {patches.weights[0], patches.weights[1], other};
    patches.kinds = {PatchKind::sharp, PatchKind::sharp, PatchKind::edge};
    patches.sides = {1, 1, 0};
    patches.triangles = {0, 1, 2};
    patches.edges = {3, 3, 4};
    patches.combine = {Combine::max, Combine::max, Combine::none};
    patches.partners = {1, 0, PatchComplex::no_partner};
    EXPECT_THAT(rows_of<u32>(json_of(patches)["own-weights"]), ElementsAre(0, 1));
    expect_read_back(patches);
}

/// Tetrahedra of a few points, in any order of their corners, with weights that few pairs of them share.
PatchComplex random_patches(std::uint64_t seed) {
    constexpr u32 points = 9;
    Random random(seed);
    PatchComplex patches;
    Array<Vec3> positions(points, Vec3(1. / 3, -0.0, 5e-324));
    positions[0] = Vec3(-1, -1, -1);
    patches.positions = positions;
    Array<std::array<u32, 4>> tets(random.index(60));
    Array<PatchWeights> weights(tets.size());
    Array<PatchKind> kinds(tets.size());
    for (std::size_t row = 0; row < tets.size(); ++row) {
        std::array<u32, points> order{0, 1, 2, 3, 4, 5, 6, 7, 8};
        for (u32 i = 0; i < 4; ++i) std::swap(order[i], order[i + random.index(points - i)]);
        std::copy_n(order.begin(), 4, tets[row].begin());
        kinds[row] = static_cast<PatchKind>(random.index(20) < 17 ? random.index(2) : 2 + random.index(2));
        std::size_t number = 0;
        for (std::size_t i = 0; i < 4; ++i)
            for (std::size_t j = i; j < 4; ++j)
                for (std::size_t k = j; k < 4; ++k) {
                    const auto [a, b, c] = std::array{tets[row][i], tets[row][j], tets[row][k]};
                    double& weight = weights[row][number++];
                    weight = a * b * c == 0 ? 0 : std::sin(1. + a + b + c) / (1 + a * b * c);
                    if (random.index(200) == 0) weight = -weight;
                }
    }
    patches.tets = tets;
    patches.weights = weights;
    patches.kinds = kinds;
    patches.sides = Array<u8>(tets.size(), 1);
    patches.triangles = Array<u32>(tets.size(), 3);
    patches.edges = Array<u32>(tets.size(), PatchComplex::no_edge);
    patches.combine = Array<Combine>(tets.size(), Combine::none);
    patches.partners = Array<u32>(tets.size(), PatchComplex::no_partner);
    return patches;
}

TEST(Patches, OfAnyTetrahedra_AreReadBackBitForBit) {
    std::size_t shared = 0, own = 0;
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
        const PatchComplex patches = random_patches(seed);
        expect_read_back(patches);
        const Json json = json_of(patches);
        shared += 20 * patches.tets.size() - rows_of<double>(json["weights"]).size();
        own += rows_of<u32>(json["own-weights"]).size();
    }
    EXPECT_GT(shared, 1000u);
    EXPECT_GT(own, 100u);
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
    patches = two_functions();
    patches.combine = {Combine::max, Combine::none};
    EXPECT_THAT(refusal(patches), HasSubstr("0 and its partner 1 differ"));
    patches.combine = {Combine::none, Combine::none};
    EXPECT_THAT(refusal(patches), HasSubstr("0 has a partner without 'combine'"));
    patches = two_tets();
    patches.combine = {Combine::none, Combine::max};
    EXPECT_THAT(refusal(patches), HasSubstr("1 has no partner to combine"));
    patches = two_functions();
    patches.partners = {2, 0};
    EXPECT_THAT(refusal(patches), HasSubstr("has partner 2; there are 2"));
}

/// The refusal of a document that is changed; it must have a hint.
template <class Change>
std::string refusal(const PatchComplex& patches, const Change& action) {
    Json json = json_of(patches);
    action(json);
    const Error error = error_of([&] { patches_of(json); });
    EXPECT_THAT(error.hint(), HasSubstr("the step that made it again")) << error.what();
    return error.sentence();
}

TEST(PatchesRefuse, DocumentsOfEarlierVersions) {
    EXPECT_THAT(refusal(two_tets(),
                        [](Json& j) {
                            j["tets"] = {1, 2, 3};
                        }),
                HasSubstr("written by an earlier version, with 'tets' as a list of 3"));
}

TEST(PatchesRefuse, TextsThatAreNotBase64) {
    EXPECT_THAT(refusal(two_tets(), [](Json& j) { j["kind"] = "AA!="; }),
                HasSubstr("'kind' is not base64: character 2 is '!'"));
    EXPECT_THAT(refusal(two_tets(), [](Json& j) { j["weights"].get_ref<std::string&>().pop_back(); }),
                HasSubstr("'weights' is not base64: its 319 characters"));
    EXPECT_THAT(refusal(two_tets(), [](Json& j) { j["points"] = 7; }), HasSubstr("'points' is not a base64 text"));
}

TEST(PatchesRefuse, ArraysOfAnotherLength) {
    EXPECT_THAT(refusal(two_tets(), [](Json& j) { j["tets"] = "AAAA"; }),
                HasSubstr("'tets' holds 3 bytes, which are not whole rows of 16"));
    EXPECT_THAT(refusal(two_tets(), [](Json& j) { j["points"] = "AAAA"; }), HasSubstr("not whole rows of 24"));
    EXPECT_THAT(refusal(two_functions(), [](Json& j) { j["partners"] = "AAAA"; }), HasSubstr("not whole rows of 12"));
    for (const std::string name : {"kind", "side"})
        EXPECT_THAT(refusal(two_tets(), [&](Json& j) { j[name] = "AAAA"; }),
                    HasSubstr("'" + name + "' has 3 values; expected 2"));
    for (const std::string name : {"patch", "edge"})
        EXPECT_THAT(refusal(two_tets(), [&](Json& j) { j[name] = "AAAAAA=="; }),
                    HasSubstr("'" + name + "' has 1 value; expected 2"));
    for (const std::string name : {"points", "kind", "side", "patch", "edge", "partners", "own-weights", "weights"})
        EXPECT_THAT(refusal(two_tets(), [&](Json& j) { j.erase(name); }), HasSubstr(name));
}

TEST(PatchesRefuse, TooFewOrTooManyWeights) {
    for (const std::size_t number : {0, 29, 31})
        EXPECT_THAT(refusal(two_tets(),
                            [&](Json& j) {
                                change<double>(j["weights"], [&](Array<double>& values) { values.resize(number, 1); });
                            }),
                    HasSubstr("'weights' has " + std::to_string(number) + " values; its 2 tetrahedra need 30"));
    EXPECT_THAT(refusal(two_tets(), [](Json& j) { j["own-weights"] = "AQAAAA=="; }),
                HasSubstr("'weights' has 30 values; its 2 tetrahedra need 40"));
}

TEST(PatchesRefuse, NumbersThatAreNotFinite) {
    for (const double wrong : {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity()}) {
        const std::string text = std::isnan(wrong) ? "nan" : "-inf";
        EXPECT_THAT(
            refusal(two_tets(),
                    [&](Json& j) { change<double>(j["weights"], [&](Array<double>& values) { values[21] = wrong; }); }),
            HasSubstr("'weights[21]' contains " + text));
        EXPECT_THAT(
            refusal(two_tets(),
                    [&](Json& j) { change<double>(j["points"], [&](Array<double>& values) { values[10] = wrong; }); }),
            HasSubstr("'points[3]' contains " + text));
    }
}

TEST(PatchesRefuse, IndicesOutOfRange) {
    const auto with_corner = [](std::size_t i, u32 vertex) {
        return refusal(two_tets(),
                       [&](Json& j) { change<u32>(j["tets"], [&](Array<u32>& corners) { corners[i] = vertex; }); });
    };
    EXPECT_THAT(with_corner(2, 9), HasSubstr("tetrahedron 0 names point 9; there are 5"));
    EXPECT_THAT(with_corner(7, 0), HasSubstr("tetrahedron 1 names point 0 twice"));
    const auto with_own = [](Array<u32> rows) {
        return refusal(two_tets(),
                       [&](Json& j) { j["own-weights"] = JsonForm<Base64<u32>>::write({std::move(rows)}); });
    };
    EXPECT_THAT(with_own({1, 2}), HasSubstr("'own-weights[1]' names tetrahedron 2; there are 2"));
    EXPECT_THAT(with_own({1, 0}), HasSubstr("'own-weights[1]' is 0 after 1"));
    EXPECT_THAT(with_own({1, 1}), HasSubstr("'own-weights[1]' is 1 after 1"));
}

TEST(PatchesRefuse, UnknownKindsAndSides) {
    EXPECT_THAT(refusal(two_tets(), [](Json& j) { j["kind"] = "AAQ="; }),
                HasSubstr("'kind[1]' is 4; expected 0 (face)"));
    EXPECT_THAT(refusal(two_tets(), [](Json& j) { j["side"] = "AgE="; }), HasSubstr("'side[0]' is 2; expected 0 or 1"));
}

TEST(PatchesRefuse, PairsThatDoNotMatch) {
    const auto with_pairs = [](Array<u32> pairs, const PatchComplex& patches = two_functions()) {
        return refusal(patches, [&](Json& j) { j["partners"] = JsonForm<Base64<u32>>::write({std::move(pairs)}); });
    };
    EXPECT_THAT(with_pairs({0, 2, 1}), HasSubstr("'partners[0]' names tetrahedron 2; there are 2"));
    EXPECT_THAT(with_pairs({0, 0, 1}), HasSubstr("'partners[0]' names tetrahedron 0 a second time"));
    EXPECT_THAT(with_pairs({0, 1, 1, 1, 0, 1}), HasSubstr("'partners[1]' names tetrahedron 1 a second time"));
    EXPECT_THAT(with_pairs({0, 1, 0}), HasSubstr("'partners[0]' has the rule 0; expected 1"));
    EXPECT_THAT(with_pairs({0, 1, 3}), HasSubstr("'partners[0]' has the rule 3"));
    EXPECT_THAT(with_pairs({0, 1, 1}, two_tets()), HasSubstr("0 and its partner 1 differ"));
    EXPECT_THAT(refusal(two_functions(), [](Json& j) { j["side"] = "AQA="; }), HasSubstr("0 and its partner 1 differ"));
}

}  // namespace
}  // namespace scanmill::test
