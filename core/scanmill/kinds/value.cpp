// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/kinds/value.hpp"

#include <algorithm>
#include <array>

namespace scanmill {

namespace {

constexpr std::array<std::string_view, std::variant_size_v<Value>> names{"points",   "mesh",      "tets",
                                                                         "features", "transform", "metrics"};

template <class T>
constexpr bool has_positions = requires(const T& value) { value.positions; };

}  // namespace

std::string_view name_of(Kind kind) { return names[static_cast<std::size_t>(kind)]; }

std::optional<Kind> kind_named(std::string_view name) {
    const auto found = std::ranges::find(names, name);
    if (found == names.end()) return std::nullopt;
    return static_cast<Kind>(found - names.begin());
}

std::string_view kind_names() { return "points, mesh, tets, features, transform, metrics"; }

bool is_geometric(Kind kind) { return kind != Kind::transform && kind != Kind::metrics; }

const Frame* frame_of(const Value& value) {
    return std::visit(
        []<class T>(const std::shared_ptr<const T>& object) -> const Frame* {
            if constexpr (has_positions<T>)
                return &object->frame;
            else
                return nullptr;
        },
        value);
}

Value reframed(const Value& value, const Frame& frame) {
    return std::visit(
        [&]<class T>(const std::shared_ptr<const T>& object) -> Value {
            if constexpr (has_positions<T>) {
                if (object->frame == frame) return object;
                T moved = *object;
                if (moved.frame.origin != frame.origin)
                    moved.positions = translated(moved.positions, moved.frame.origin - frame.origin);
                moved.frame = frame;
                return std::make_shared<const T>(std::move(moved));
            } else {
                return object;
            }
        },
        value);
}

}  // namespace scanmill
