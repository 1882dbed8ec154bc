// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/text_columns.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "scanmill/formats/reading.hpp"
#include "scanmill/formats/text_names.hpp"

namespace scanmill {

namespace {

using Components = std::vector<const Array<double>*>;

class TextTable {
public:
    TextTable(std::vector<std::string> names, std::vector<Array<double>> values,
              const std::function<void(std::string)>& on_warning)
        : names_(std::move(names)),
          values_(std::move(values)),
          on_warning_(on_warning) {}

    ColumnTable named() {
        std::map<std::size_t, Column> whole;  // by the place of the first of its components
        std::set<std::size_t> taken;
        for (const NamedGroup& group : groups_among(names_)) {
            std::optional<Column> column = united(group);
            if (!column) continue;
            whole.emplace(*std::ranges::min_element(group.columns), std::move(*column));
            taken.insert(group.columns.begin(), group.columns.end());
        }
        for (std::size_t i = 0; i < names_.size(); ++i) {
            if (const auto found = whole.find(i); found != whole.end())
                table_.add(found->second);
            else if (!taken.contains(i))
                add(i);
        }
        return std::move(table_);
    }

    ColumnTable numbered(bool is_pts) {
        for (std::size_t i = 0; i < values_.size(); ++i) names_.push_back("c" + std::to_string(i + 4));
        if (is_pts && (values_.size() == 1 || values_.size() == 4)) {
            names_[0] = "intensity";
            add(0);
            if (values_.size() == 4) add_colour({1, 2, 3});
            return std::move(table_);
        }
        if (values_.size() == 3) {
            if (are_unit_normals(components({0, 1, 2}))) {
                table_.add(joined("normal", components({0, 1, 2})));
                return std::move(table_);
            }
            if (is_pts) {
                add_colour({0, 1, 2});
                return std::move(table_);
            }
            warn(on_warning_, "columns 4 to 6 are no unit normals; they are kept as c4, c5 and c6");
        }
        for (std::size_t i = 0; i < values_.size(); ++i) add(i);
        return std::move(table_);
    }

private:
    Components components(const std::vector<std::size_t>& columns) const {
        Components found;
        for (const std::size_t column : columns) found.push_back(&values_[column]);
        return found;
    }

    /// A column as it is.
    void add(std::size_t column) { table_.add(Column(names_[column], 1, Buffer(std::move(values_[column])))); }

    void add_colour(const std::vector<std::size_t>& columns) {
        if (const auto colour = as_colour(components(columns))) {
            table_.add(*colour);
            return;
        }
        tell_no_colour(columns);
        for (const std::size_t column : columns) add(column);
    }

    void tell_no_colour(const std::vector<std::size_t>& columns) const {
        warn(on_warning_, "the columns {} are no colours of whole numbers from 0 to 255; they are kept as they are",
             list(columns));
    }

    std::string list(const std::vector<std::size_t>& columns) const {
        std::string text;
        for (const std::size_t column : columns) text.append(text.empty() ? "" : ", ").append(names_[column]);
        return text;
    }

    /// The group as one column; nothing when it is none, or when another column has the name already.
    std::optional<Column> united(const NamedGroup& group) const {
        const bool is_normal = group.kind == NamedGroup::Kind::normal;
        const Components parts = components(group.columns);
        if (std::ranges::find(names_, is_normal ? "normal" : "colour") != names_.end()) return std::nullopt;
        if (!is_normal) {
            std::optional<Column> colour = as_colour(parts);
            if (!colour) tell_no_colour(group.columns);
            return colour;
        }
        if (!are_unit_normals(parts)) warn(on_warning_, "not all normals ({}) have unit length", list(group.columns));
        return joined("normal", parts);
    }

    std::vector<std::string> names_;
    std::vector<Array<double>> values_;
    const std::function<void(std::string)>& on_warning_;
    ColumnTable table_;
};

template <class T>
Column side_by_side(std::string name, std::span<const Array<double>* const> components) {
    const std::size_t width = components.size(), rows = components.front()->size();
    Array<T> values(width * rows);
    for (std::size_t i = 0; i < width; ++i)
        for (std::size_t row = 0; row < rows; ++row) values[row * width + i] = static_cast<T>((*components[i])[row]);
    return Column(std::move(name), static_cast<u32>(width), Buffer(std::move(values)));
}

}  // namespace

ColumnTable text_columns(std::vector<std::string> names, std::vector<Array<double>> values, bool is_pts,
                         const std::function<void(std::string)>& on_warning) {
    const bool headerless = names.empty();
    TextTable table(std::move(names), std::move(values), on_warning);
    return headerless ? table.numbered(is_pts) : table.named();
}

bool are_unit_normals(std::span<const Array<double>* const> components) {
    constexpr double tolerance = 0.1;
    for (std::size_t row = 0; row < components[0]->size(); ++row) {
        const double length = std::hypot((*components[0])[row], (*components[1])[row], (*components[2])[row]);
        if (!(std::abs(length - 1) <= tolerance) && length != 0) return false;
    }
    return true;
}

Column joined(std::string name, std::span<const Array<double>* const> components) {
    return side_by_side<double>(std::move(name), components);
}

std::optional<Column> as_colour(std::span<const Array<double>* const> components) {
    double highest = 0;
    for (const Array<double>* component : components)
        for (const double value : *component) {
            if (!(value >= 0 && value <= 255) || value != std::trunc(value)) return std::nullopt;
            highest = std::max(highest, value);
        }
    if (highest == 1) return std::nullopt;  // the faintest, or of a scale that ends at 1
    return side_by_side<u8>("colour", components);
}

}  // namespace scanmill
