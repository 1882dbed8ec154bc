// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The kind `tets`.

#include "scanmill/data/tets.hpp"
#include "scanmill/kinds/kind.hpp"

namespace scanmill {

template <>
struct KindTraits<TetMesh> : NoJson<TetMesh> {
    static constexpr std::string_view name = "tets";
    static constexpr bool is_geometric = true;
    static void visit(FieldVisitor& visitor, TetMesh& tets);
    static BoundingBox box(const TetMesh& tets);
    static double spacing(const TetMesh& tets);
    static std::vector<PropertySpec> property_specs();
    static Metrics properties(const TetMesh& tets);
    static void require_usable(const TetMesh&) {}
};
inline const KindRegistration<TetMesh> tets_kind;

}  // namespace scanmill
