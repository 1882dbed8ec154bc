// SPDX-License-Identifier: GPL-3.0-or-later
/// The kind `patches`. Its JSON form:
///
///     {"scanmill": 1, "unit": "mm", "frame": "part",
///      "points": "AAAAAAAA8D8…", "tets": "DAAAAAAAAAA…", "kind": "AAAA…", "side": "AQEB…", "patch": "AAAAAA…",
///      "edge": "/////w…", "partners": "", "own-weights": "", "weights": "AAAAAAAAAAA…"}
///
/// Every array is base64 of its rows' little-endian bytes (base64.hpp); fields() describes each.
///
/// The weight c_ijkl of a tetrahedron belongs to a control point: the multiset of three of its vertices that has its
/// first vertex i times, its second j times, and so on. Tetrahedra with equal functions on a common face have equal
/// weights there, and `weights` has these once. The rows in `own-weights` are exceptions: their functions differ from
/// others at a common control point, as at sharp edges. Numbers are read back bit for bit. `unit` and `frame` are null
/// if unknown.
#include "scanmill/data/patches.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <unordered_map>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/kinds/base64.hpp"
#include "scanmill/kinds/document.hpp"

namespace scanmill {

namespace {

std::size_t number_of_patches(const PatchComplex& patches) {
    std::size_t most = 0;
    for (const u32 triangle : patches.triangles) most = std::max<std::size_t>(most, triangle + std::size_t(1));
    return most;
}

/// Throws Error if `row` has a partner but no rule to combine functions, or a rule but no partner. Throws Error unless
/// the partner is another row with the same points, side and rule, and its partner is `row`.
void require_partner(const PatchComplex& patches, std::size_t row) {
    const u32 partner = patches.partners[row];
    if ((partner == PatchComplex::no_partner) != (patches.combine[row] == Combine::none))
        throw Error("tetrahedron {} has {}", row,
                    partner == PatchComplex::no_partner ? "no partner to combine with" : "a partner without 'combine'");
    if (partner == PatchComplex::no_partner) return;
    if (partner >= patches.tets.size())
        throw Error("tetrahedron {} has partner {}; there are {} tetrahedra", row, partner, patches.tets.size());
    if (partner == row || patches.partners[partner] != row)
        throw Error("tetrahedron {} has partner {}, which has another partner", row, partner);
    auto one = patches.tets[row], other = patches.tets[partner];
    std::ranges::sort(one);
    std::ranges::sort(other);
    if (one != other || patches.combine[row] != patches.combine[partner] ||
        patches.sides[row] != patches.sides[partner])
        throw Error("tetrahedron {} and its partner {} differ in their points, 'side' or 'combine'", row, partner);
}

/// Throws Error if a point occurs twice in a tetrahedron.
void require_four_points(const std::array<u32, 4>& tet, std::size_t row) {
    for (std::size_t i = 1; i < tet.size(); ++i)
        if (std::find(tet.begin(), tet.begin() + static_cast<std::ptrdiff_t>(i), tet[i]) !=
            tet.begin() + static_cast<std::ptrdiff_t>(i))
            throw Error("tetrahedron {} names point {} twice; its four points must differ", row, tet[i]);
}

/// Throws Error if a tetrahedron does not have four points of the complex.
void require_points(std::span<const std::array<u32, 4>> tets, std::size_t points) {
    for (std::size_t row = 0; row < tets.size(); ++row) {
        for (const u32 vertex : tets[row])
            if (vertex >= points) throw Error("tetrahedron {} names point {}; there are {}", row, vertex, points);
        require_four_points(tets[row], row);
    }
}

/// Throws Error if arrays have different lengths, an index is out of range, or partners do not match.
void require_consistent(const PatchComplex& patches) {
    const std::size_t tets = patches.tets.size();
    if (patches.weights.size() != tets || patches.kinds.size() != tets || patches.sides.size() != tets ||
        patches.triangles.size() != tets || patches.edges.size() != tets || patches.combine.size() != tets ||
        patches.partners.size() != tets)
        throw Error("the patches' arrays do not have one row for each of the {} tetrahedra", tets);
    require_points(patches.tets.span(), patches.positions.size());
    for (std::size_t row = 0; row < tets; ++row) require_partner(patches, row);
}

/// A row of `partners`.
struct Pair {
    u32 row, partner, combine;
};

struct PatchesDocument {
    Frame frame;
    Base64<Vec3> points;
    Base64<std::array<u32, 4>> tets;
    Base64<PatchKind> kinds;
    Base64<u8> sides;
    Base64<u32> triangles, edges;
    Base64<Pair> pairs;
    Base64<u32> own_weights;
    Base64<double> weights;
};
constexpr auto fields(const PatchesDocument*) {
    using T = PatchesDocument;
    return std::tuple{
        field("frame", &T::frame).flat(),
        field("points", &T::points, "Three float64 per point: world coordinates."),
        field("tets", &T::tets, "Four u32 per tetrahedron: rows of the points."),
        field("kind", &T::kinds, "A byte per tetrahedron: 0 face, 1 edge, 2 sharp, 3 continuation."),
        field("side", &T::sides, "A byte per tetrahedron: 1 outside the mesh, 0 inside."),
        field("patch", &T::triangles, "A u32 per tetrahedron: the row of the mesh's triangle."),
        field("edge", &T::edges,
              "A u32 per tetrahedron: the number of the mesh's edge; 4294967295 if it is over a triangle."),
        field("partners", &T::pairs,
              "Three u32 per pair of tetrahedra with the same points: their two rows, and the function that holds: 1 "
              "the larger one, 2 the smaller one."),
        field("own-weights", &T::own_weights,
              "A u32 per tetrahedron that shares no weights: its row, in rising order."),
        field(
            "weights", &T::weights,
            "The float64 weights c_ijkl of the tetrahedra in their order, each with (i, j, k, l) in descending "
            "lexicographic order: 3000, 2100, …, 0003. A weight belongs to three vertices: the first one i times, the "
            "second one j times, … If an earlier tetrahedron has the same three vertices, the weight is left out, and "
            "equal to the earlier one. Rows of 'own-weights' have all 20, and others do not take values from them.")};
}

// Weights that tetrahedra share.

/// The three vertices of a weight, in rising order.
using ControlPoint = std::array<u32, 3>;

struct HashOfControlPoint {
    std::size_t operator()(const ControlPoint& point) const {
        constexpr u64 factor = 0x9E3779B97F4A7C15;  // 2^64 over the golden ratio
        u64 hash = 0;
        for (const u32 vertex : point) hash = (hash + vertex) * factor;
        return hash ^ hash >> 32;
    }
};
using KnownWeights = std::unordered_map<ControlPoint, double, HashOfControlPoint>;

/// The control points of the 20 weights, in the order of PatchWeights.
std::array<ControlPoint, 20> control_points(const std::array<u32, 4>& tet) {
    std::array<ControlPoint, 20> points;
    std::size_t number = 0;
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = i; j < 4; ++j)
            for (std::size_t k = j; k < 4; ++k) {
                points[number] = {tet[i], tet[j], tet[k]};
                std::ranges::sort(points[number++]);
            }
    return points;
}

template <class T>
Array<T> array_of(const Buffer<T>& buffer) {
    return {buffer.begin(), buffer.end()};
}

bool equal_bits(double one, double other) { return std::bit_cast<u64>(one) == std::bit_cast<u64>(other); }

/// Whether a tetrahedron has another function than its neighbours, known or to come.
bool has_own_weights(PatchKind kind, const std::array<ControlPoint, 20>& points, const PatchWeights& weights,
                     const KnownWeights& known) {
    if (kind == PatchKind::sharp || kind == PatchKind::continuation) return true;
    for (std::size_t i = 0; i < weights.size(); ++i)
        if (const auto found = known.find(points[i]); found != known.end() && !equal_bits(found->second, weights[i]))
            return true;
    return false;
}

/// Writes `own_weights` and `weights`.
void write_weights(const PatchComplex& patches, PatchesDocument& document) {
    KnownWeights known;
    for (std::size_t row = 0; row < patches.tets.size(); ++row) {
        const std::array<ControlPoint, 20> points = control_points(patches.tets[row]);
        const PatchWeights& weights = patches.weights[row];
        const bool is_own = has_own_weights(patches.kinds[row], points, weights, known);
        if (is_own) document.own_weights.rows.push_back(static_cast<u32>(row));
        for (std::size_t i = 0; i < weights.size(); ++i)
            if (is_own || known.try_emplace(points[i], weights[i]).second) document.weights.rows.push_back(weights[i]);
    }
}

/// Reads what write_weights() writes. Throws Error if there are too few weights, or too many.
Array<PatchWeights> read_weights(const PatchesDocument& document) {
    const Array<double>& values = document.weights.rows;
    std::size_t used = 0;
    const auto next = [&] { return used++ < values.size() ? values[used - 1] : 0; };
    const u32* own = document.own_weights.rows.data();
    const u32* const own_end = own + document.own_weights.rows.size();
    KnownWeights known;
    known.reserve(values.size());
    Array<PatchWeights> all(document.tets.rows.size());
    for (std::size_t row = 0; row < all.size(); ++row) {
        const std::array<ControlPoint, 20> points = control_points(document.tets.rows[row]);
        const bool is_own = own != own_end && *own == row;
        if (is_own) ++own;
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (is_own) {
                all[row][i] = next();
                continue;
            }
            const auto [found, is_new] = known.try_emplace(points[i], 0);
            if (is_new) found->second = next();
            all[row][i] = found->second;
        }
    }
    if (used != values.size())
        throw Error("the document: 'weights' has {} values; its {} tetrahedra need {}", values.size(), all.size(),
                    used);
    return all;
}

// Other arrays.

Array<Pair> pairs_of(const PatchComplex& patches) {
    Array<Pair> pairs;
    for (u32 row = 0; row < patches.tets.size(); ++row)
        if (const u32 partner = patches.partners[row]; partner != PatchComplex::no_partner && row < partner)
            pairs.push_back({row, partner, static_cast<u32>(patches.combine[row])});
    return pairs;
}

/// Sets `combine` and `partners` of the rows in pairs. Throws Error unless pairs are of two rows that are in no other
/// pair, with a known rule.
void read_pairs(const Array<Pair>& pairs, Array<Combine>& combine, Array<u32>& partners) {
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        const auto [row, partner, rule] = pairs[i];
        for (const u32 named : {row, partner}) {
            if (named >= partners.size())
                throw Error("the document: 'partners[{}]' names tetrahedron {}; there are {}", i, named,
                            partners.size());
            if (row == partner || partners[named] != PatchComplex::no_partner)
                throw Error("the document: 'partners[{}]' names tetrahedron {} a second time", i, named);
        }
        if (rule != static_cast<u32>(Combine::max) && rule != static_cast<u32>(Combine::min))
            throw Error(
                "the document: 'partners[{}]' has the rule {}; expected 1 (the larger function) or 2 (the "
                "smaller one)",
                i, rule);
        combine[row] = combine[partner] = static_cast<Combine>(rule);
        partners[row] = partner;
        partners[partner] = row;
    }
}

/// Throws Error if a column has another number of values than there are tetrahedra.
void require_per_tet(std::string_view name, std::size_t values, std::size_t tets) {
    if (values != tets)
        throw Error("the document: '{}' has {}; expected {}, one per tetrahedron", name,
                    count_text(values, "value", "values"), tets);
}

/// Throws Error for a value above `most`.
template <class Value>
void require_at_most(std::string_view name, const Array<Value>& values, Value most, std::string_view expected) {
    const auto wrong = std::ranges::find_if(values, [&](Value value) { return value > most; });
    if (wrong != values.end())
        throw Error("the document: '{}[{}]' is {}; expected {}", name, wrong - values.begin(), static_cast<u32>(*wrong),
                    expected);
}

/// Throws Error for numbers that are not finite.
void require_finite(std::string_view name, std::span<const double> numbers, std::size_t each) {
    const auto wrong = std::ranges::find_if_not(numbers, [](double number) { return std::isfinite(number); });
    if (wrong != numbers.end())
        throw Error("the document: '{}[{}]' contains {}; expected finite numbers", name,
                    static_cast<std::size_t>(wrong - numbers.begin()) / each, *wrong);
}

/// Throws Error unless the rows rise and are rows of tetrahedra.
void require_own_rows(const Array<u32>& rows, std::size_t tets) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (rows[i] >= tets)
            throw Error("the document: 'own-weights[{}]' names tetrahedron {}; there are {}", i, rows[i], tets);
        if (i > 0 && rows[i] <= rows[i - 1])
            throw Error("the document: 'own-weights[{}]' is {} after {}; rows must rise", i, rows[i], rows[i - 1]);
    }
}

/// Throws Error unless the columns have a possible value for every tetrahedron, and `weights` can be read.
void require_readable(const PatchesDocument& document) {
    const std::size_t tets = document.tets.rows.size();
    require_per_tet("kind", document.kinds.rows.size(), tets);
    require_per_tet("side", document.sides.rows.size(), tets);
    require_per_tet("patch", document.triangles.rows.size(), tets);
    require_per_tet("edge", document.edges.rows.size(), tets);
    require_at_most("kind", document.kinds.rows, PatchKind::continuation,
                    "0 (face), 1 (edge), 2 (sharp) or 3 (continuation)");
    require_at_most<u8>("side", document.sides.rows, 1, "0 or 1");
    const Array<Vec3>& points = document.points.rows;
    require_finite("points", {reinterpret_cast<const double*>(points.data()), 3 * points.size()}, 3);
    require_finite("weights", document.weights.rows, 1);
    require_own_rows(document.own_weights.rows, tets);
    require_points(document.tets.rows, points.size());
}

}  // namespace

template <>
struct KindTraits<PatchComplex> : FromPositions<PatchComplex>, HasDocument<PatchComplex, PatchesDocument> {
    static constexpr std::string_view name = "patches";
    static std::vector<PropertySpec> property_specs() {
        return {{"tetrahedra", Unit::count, "Tetrahedra."}, {"patches", Unit::count, "Triangles of the mesh."}};
    }
    static std::vector<std::optional<double>> property_values(const PatchComplex& patches) {
        return {patches.tets.size(), number_of_patches(patches)};
    }
    static void require_usable(const PatchComplex& patches) {
        require_consistent(patches);
        if (patches.tets.empty()) throw Error("the result has no tetrahedra");
    }
    static constexpr std::string_view json_member = "tets";
    static PatchesDocument document(const PatchComplex& patches) {
        require_consistent(patches);
        PatchesDocument document{patches.frame,
                                 {array_of(patches.positions)},
                                 {array_of(patches.tets)},
                                 {array_of(patches.kinds)},
                                 {array_of(patches.sides)},
                                 {array_of(patches.triangles)},
                                 {array_of(patches.edges)},
                                 {pairs_of(patches)},
                                 {},
                                 {}};
        write_weights(patches, document);
        return document;
    }
    static PatchComplex object(PatchesDocument document) {
        require_readable(document);
        const std::size_t tets = document.tets.rows.size();
        Array<Combine> combine(tets, Combine::none);
        Array<u32> partners(tets, PatchComplex::no_partner);
        read_pairs(document.pairs.rows, combine, partners);
        Array<PatchWeights> weights = read_weights(document);
        PatchComplex patches{document.frame,
                             std::move(document.points.rows),
                             std::move(document.tets.rows),
                             std::move(weights),
                             std::move(document.kinds.rows),
                             std::move(document.sides.rows),
                             std::move(document.triangles.rows),
                             std::move(document.edges.rows),
                             std::move(combine),
                             std::move(partners)};
        require_consistent(patches);
        return patches;
    }
    static PatchComplex from_json(const Json& json, const OnWarning& on_warning) {
        if (json.is_object() && json.contains("tets") && json["tets"].is_array())
            throw Error("was written by an earlier version, with 'tets' as a list of {}; expected a base64 text",
                        json["tets"].size())
                .hint("run the step that made it again, with this version");
        try {
            return HasDocument::from_json(json, on_warning);
        } catch (Error& error) {
            if (error.hint().empty())
                error.set_hint("the file is damaged: copy it again, or run the step that made it again");
            throw;
        }
    }
};

template Kind kind_of<PatchComplex>();

}  // namespace scanmill
