// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The kind `mesh`.

#include "scanmill/data/mesh.hpp"
#include "scanmill/kinds/kind.hpp"

namespace scanmill {

template <>
struct KindTraits<TriangleMesh> : NoJson<TriangleMesh> {
    static constexpr std::string_view name = "mesh";
    static constexpr bool is_geometric = true;
    static void visit(FieldVisitor& visitor, TriangleMesh& mesh);
    static BoundingBox box(const TriangleMesh& mesh);
    static double spacing(const TriangleMesh& mesh);
    static std::vector<PropertySpec> property_specs();
    static Metrics properties(const TriangleMesh& mesh);
    static void require_usable(const TriangleMesh& mesh);
};
inline const KindRegistration<TriangleMesh> mesh_kind;

}  // namespace scanmill
