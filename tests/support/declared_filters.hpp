// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A library of filters that exist only as declarations: checking a workflow loads no code, so its tests need none.

#include "scanmill/plugin/library.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {

/// thin: points → points (size: length above 0 = 1 %diag; count: integer of at least 1 = 1; rule: nearest, random).
/// tetrahedralise: points → tets.        solid: tets → mesh*, tets (alpha: length or auto; coverage: ratio up to 100
/// %). simplify: mesh → mesh (max-error: length, required).    register: source, target: points → transform. combine:
/// points… (a list) → points.   pair: points → left*, right: points.    make: mesh? → points.
class DeclaredFilters {
public:
    DeclaredFilters();
    /// One more, for libraries that are asked for afterwards.
    void add(const FilterSpec& spec);

    FilterLibrary library() const { return FilterLibrary({folder_.path()}); }
    const TemporaryFolder& folder() const { return folder_; }

private:
    TemporaryFolder folder_;
};

/// A filter that draws: scene (mesh, points or features), scale: metrics? → picture.
FilterSpec drawing_filter(std::string name);

}  // namespace scanmill::test
