// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// How a member of a params struct becomes a declared parameter: its type, its default, and the way back from the value
/// that a workflow gives (see declare.hpp).

#include <concepts>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "scanmill/base/error.hpp"
#include "scanmill/filter/parameter.hpp"

namespace scanmill {

namespace detail {

template <class T>
struct Member;  // not a type that a parameter can have

template <>
struct Member<bool> {
    static constexpr ParameterType type = ParameterType::boolean;
    using Stored = bool;
};
template <std::integral T>
struct Member<T> {
    static constexpr ParameterType type = ParameterType::integer;
    using Stored = std::int64_t;
};
template <>
struct Member<double> {
    static constexpr ParameterType type = ParameterType::number;
    using Stored = double;
};
template <>
struct Member<std::string> {
    static constexpr ParameterType type = ParameterType::text;
    using Stored = std::string;
};
template <>
struct Member<std::filesystem::path> {
    static constexpr ParameterType type = ParameterType::path;
    using Stored = std::string;
};
template <>
struct Member<Length> {
    static constexpr ParameterType type = ParameterType::length;
    using Stored = Length;
};
template <>
struct Member<Angle> {
    static constexpr ParameterType type = ParameterType::angle;
    using Stored = Angle;
};
template <>
struct Member<Ratio> {
    static constexpr ParameterType type = ParameterType::ratio;
    using Stored = Ratio;
};

/// Between a member of the params struct and the ParameterValue that stands for it.
template <class T>
struct Convert {
    static void describe(ParameterSpec& spec, const T& value) {
        spec.type = Member<T>::type;
        spec.default_value = ParameterScalar(typename Member<T>::Stored(value));
        bound(spec);
    }
    /// What the member cannot hold is out of range.
    static void bound(ParameterSpec& spec) {
        if constexpr (Member<T>::type == ParameterType::integer) {
            if constexpr (std::is_unsigned_v<T>) spec.low = Bound{0, true};
            if constexpr (sizeof(T) < sizeof(std::int64_t)) {
                spec.low = Bound{static_cast<double>(std::numeric_limits<T>::min()), true};
                spec.high = Bound{static_cast<double>(std::numeric_limits<T>::max()), true};
            }
        }
    }
    static T from(const ParameterScalar& value) {
        const auto& stored = std::get<typename Member<T>::Stored>(value);
        if constexpr (Member<T>::type == ParameterType::integer)  // a caller may come without checked values
            if (!std::in_range<T>(stored))
                throw Error("{} is out of range; expected a whole number from {} to {}", stored,
                            std::numeric_limits<T>::min(), std::numeric_limits<T>::max());
        return static_cast<T>(stored);
    }
    static T from(const ParameterValue& value) { return from(std::get<ParameterScalar>(value)); }
};
template <>
inline void Convert<std::filesystem::path>::describe(ParameterSpec& spec, const std::filesystem::path& value) {
    spec.type = ParameterType::path;
    spec.default_value = ParameterScalar(value.string());
}
template <class T>
struct Convert<std::vector<T>> {
    static void describe(ParameterSpec& spec, const std::vector<T>& values) {
        spec.type = Member<T>::type;
        spec.list = true;
        Convert<T>::bound(spec);
        std::vector<ParameterScalar> items;
        for (const T& value : values) items.emplace_back(typename Member<T>::Stored(value));
        spec.default_value = std::move(items);
    }
    static std::vector<T> from(const ParameterValue& value) {
        std::vector<T> values;
        for (const ParameterScalar& item : std::get<std::vector<ParameterScalar>>(value))
            values.push_back(Convert<T>::from(item));
        return values;
    }
};
template <class T>
struct Convert<std::optional<T>> {
    static void describe(ParameterSpec& spec, const std::optional<T>& value) {
        Convert<T>::describe(spec, value.value_or(T{}));
        if (!value) spec.default_value = std::monostate{};
    }
    static std::optional<T> from(const ParameterValue& value) {
        if (std::holds_alternative<std::monostate>(value)) return std::nullopt;
        if (const auto* one = std::get_if<ParameterScalar>(&value); one && std::holds_alternative<Word>(*one))
            return std::nullopt;
        return Convert<T>::from(value);
    }
};

}  // namespace detail

}  // namespace scanmill
