// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/kinds/kind.hpp"

#include <algorithm>
#include <mutex>

#include "scanmill/kinds/all_kinds.hpp"

namespace scanmill {

namespace {

struct KindTable {
    std::mutex mutex;
    std::vector<Kind> kinds;
};

/// Filled while libraries are loaded: by this one, then by a module that brings a kind of its own.
KindTable& kind_table() {
    static KindTable table;
    return table;
}

}  // namespace

Kind::Kind() : Kind(kind_info<PointCloud>) {}

void register_kind(Kind kind) {
    KindTable& table = kind_table();
    const std::scoped_lock lock(table.mutex);
    if (std::ranges::find(table.kinds, kind) == table.kinds.end()) table.kinds.push_back(kind);
}

std::vector<Kind> all_kinds() {
    KindTable& table = kind_table();
    const std::scoped_lock lock(table.mutex);
    return table.kinds;
}

std::optional<Kind> kind_named(std::string_view name) {
    const std::vector<Kind> kinds = all_kinds();
    const auto found = std::ranges::find(kinds, name, &Kind::name);
    if (found == kinds.end()) return std::nullopt;
    return *found;
}

std::string kind_names() {
    std::string names;
    for (const Kind kind : all_kinds()) names.append(names.empty() ? "" : ", ").append(kind.name());
    return names;
}

}  // namespace scanmill
