// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/ply/detail/ply_elements.hpp"

#include <algorithm>

namespace scanmill {

namespace {

constexpr u32 most_components = 1000;
constexpr std::size_t most_declarations = 100;

std::vector<std::string> numbered(std::string_view name, u32 components) {
    std::vector<std::string> names;
    for (u32 i = 0; i < components; ++i) names.push_back(std::string(name) + "_" + std::to_string(i));
    return names;
}

/// Whether the element has all properties in `names`, as scalars of one type.
bool has_all(const PlyElement& element, std::span<const std::string> names) {
    const PlyProperty* first = element.find(names.front());
    return std::ranges::all_of(names, [&](const std::string& name) {
        const PlyProperty* property = element.find(name);
        return property && !property->is_list() && property->type == first->type;
    });
}

/// "components 3 direction" → the properties direction_0, direction_1, direction_2.
std::optional<std::pair<std::string, u32>> declared_components(std::string_view comment) {
    TextCursor text(comment);
    u32 components = 0;
    if (!text.next_row() || text.token() != "components" || !text.more() || !text.number(components)) return {};
    if (components < 2 || components > most_components || !text.more()) return {};
    const std::string name(text.token());
    if (text.more()) return {};
    return std::pair(name, components);
}

struct Group {
    std::string name;
    std::vector<std::string> properties;
};

/// The groups of properties that become one column each.
std::vector<Group> groups_in(const PlyElement& element, const std::vector<std::string>& comments) {
    std::vector<Group> groups;
    const auto add = [&](std::string name, std::vector<std::string> properties) {
        if (has_all(element, properties) && !element.find(name))
            groups.push_back({std::move(name), std::move(properties)});
    };
    if (const PlyProperty* nx = element.find("nx"); nx && is_floating(nx->type)) add("normal", {"nx", "ny", "nz"});
    if (const PlyProperty* red = element.find("red"); red && red->type == ScalarType::uint8) {
        add("colour", {"red", "green", "blue", "alpha"});
        if (groups.empty() || groups.back().name != "colour") add("colour", {"red", "green", "blue"});
    }
    // A header may have millions of such comments, so only the first ones count: searching the properties of each would
    // take hours.
    std::size_t declarations = 0;
    for (const std::string& comment : comments) {
        const auto declared = declared_components(comment);
        if (!declared || ++declarations > most_declarations) continue;
        if (std::ranges::find(groups, declared->first, &Group::name) == groups.end())
            add(declared->first, numbered(declared->first, declared->second));
    }
    return groups;
}

}  // namespace

std::vector<std::string> ply_component_names(const Column& column) {
    if (column.components() <= 1) return {column.name()};
    if (column.name() == "normal" && column.components() == 3 && is_floating(column.type())) return {"nx", "ny", "nz"};
    if (column.name() == "colour" && column.type() == ScalarType::uint8) {
        if (column.components() == 3) return {"red", "green", "blue"};
        if (column.components() == 4) return {"red", "green", "blue", "alpha"};
    }
    return numbered(column.name(), column.components());
}

PlyTable::PlyTable(const PlyElement& element, const std::vector<std::string>& comments,
                   std::span<const std::string_view> elsewhere)
    : exponents_(declared_exponents(comments)) {
    const std::vector<Group> groups = groups_in(element, comments);
    // Slots point into pending_, so its elements must not move.
    pending_.reserve(element.properties.size());
    slots_.reserve(element.properties.size());
    for (const PlyProperty& property : element.properties) {
        PlySlot& slot = slots_.emplace_back(PlySlot{.property = &property});
        if (std::ranges::find(elsewhere, property.name) != elsewhere.end()) continue;
        std::string name = property.name;
        u32 components = property.is_list() ? 0 : 1;
        u32 component = 0;
        for (const Group& group : groups) {
            const auto found = std::ranges::find(group.properties, property.name);
            if (found == group.properties.end()) continue;
            name = group.name;
            components = static_cast<u32>(group.properties.size());
            component = static_cast<u32>(found - group.properties.begin());
            break;
        }
        auto column = std::ranges::find(pending_, name, &Pending::name);
        if (column == pending_.end()) {
            pending_.push_back({name, property.type, components, {}, {}});
            column = pending_.end() - 1;
            column->data.resize(element.count * components * size_of(property.type));
        }
        if (property.is_list()) {
            slot.lists = &column->lists;
        } else if (element.count > 0) {  // without rows there is no memory to point into
            const std::size_t width = size_of(property.type);
            slot.destination = column->data.data() + component * width;
            slot.stride = components * width;
        }
    }
}

Column PlyTable::finished(Pending pending) const {
    const auto exponent = exponents_.find(pending.name);
    const bool is_list = pending.components == 0;
    return {std::move(pending.name),
            pending.type,
            pending.components,
            is_list ? std::move(pending.lists.values) : std::move(pending.data),
            is_list ? Buffer<u64>(std::move(pending.lists.offsets)) : Buffer<u64>(),
            exponent == exponents_.end() ? 0 : exponent->second};
}

std::optional<Column> PlyTable::take(std::string_view name) {
    const auto found = std::ranges::find(pending_, name, &Pending::name);
    if (found == pending_.end()) return std::nullopt;
    Column column = finished(std::move(*found));
    pending_.erase(found);
    return column;
}

ColumnTable PlyTable::columns() {
    ColumnTable table;
    for (Pending& pending : pending_) table.add(finished(std::move(pending)));
    pending_.clear();
    return table;
}

}  // namespace scanmill
