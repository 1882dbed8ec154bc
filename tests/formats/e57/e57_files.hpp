// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// E57 files made by libE57Format's writer, and files that are changed below its checksums.

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

namespace scanmill::test {

struct E57Field {
    enum class Type { real64, real32, integer, scaled, text };
    std::string name;
    Type type = Type::real64;
    std::vector<double> values{};  ///< one per point, before scaling
    double low = 0, high = 0;    ///< declared bounds of integers, before scaling
    double scale = 1, offset = 0;
};

/// A field of doubles.
inline E57Field reals(std::string name, std::vector<double> values) {
    return {std::move(name), E57Field::Type::real64, std::move(values)};
}
inline E57Field integers(std::string name, double low, double high, std::vector<double> values) {
    return {std::move(name), E57Field::Type::integer, std::move(values), low, high};
}

struct E57Pose {
    std::array<double, 4> rotation{1, 0, 0, 0};  ///< w, x, y, z
    std::array<double, 3> translation{};
};

struct E57Scan {
    std::vector<E57Field> fields;
    std::optional<E57Pose> pose{};
    std::string name{};
    /// Numbers in structures of the scan: {"intensityLimits", "intensityMaximum", 255}.
    std::vector<std::tuple<std::string, std::string, double>> limits{};
};

/// The three coordinates as doubles.
std::vector<E57Field> cartesian(const std::vector<std::array<double, 3>>& points);

/// The bytes of a file with these scans, and a number of images without content.
std::string e57_file(const std::vector<E57Scan>& scans, int images = 0);

/// The file with another content under correct checksums. `change` receives the content of all pages without their
/// checksums; it must keep its size.
std::string e57_changed(const std::string& file, const std::function<void(std::string& content)>& change);

/// The file with `from` replaced by `to`, which must have the same size. `from` must occur.
std::string e57_replaced(const std::string& file, std::string_view from, std::string_view to);

}  // namespace scanmill::test
