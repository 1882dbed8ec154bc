// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/describe/document_schemas.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "scanmill/kinds/value.hpp"

namespace scanmill {

const std::vector<std::string>& document_names() {
    static const std::vector<std::string> all = [] {
        std::vector<std::string> names;
#define SCANMILL_ADD(Type) \
    if (const Kind kind = kind_of<Type>(); kind.has_json()) names.emplace_back(kind.name());
        SCANMILL_ALL_KINDS(SCANMILL_ADD)
#undef SCANMILL_ADD
        std::ranges::sort(names);
        return names;
    }();
    return all;
}

std::string document_schema(std::string_view name) { return kind_named(name)->info().schema().dump(2) + "\n"; }

}  // namespace scanmill
