// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The content of a GLB file, parsed without our reader.

#include <cstring>
#include <nlohmann/json.hpp>

#include "core/formats/support.hpp"

namespace scanmill::test {

using Json = nlohmann::json;

template <class T>
T number_at(std::string_view bytes, std::size_t at) {
    T number;
    std::memcpy(&number, bytes.substr(at, sizeof(T)).data(), sizeof(T));
    return number;
}

/// A GLB split by its specification.
struct Container {
    std::string bytes;
    Json json;
    std::string_view numbers;

    template <class T>
    explicit Container(const T& object, Warnings* warnings = nullptr)
        : bytes(write_bytes("a.glb", std::make_shared<const T>(object),
                            warnings ? warnings->writing() : WriteOptions{})) {
        const auto length = number_at<u32>(bytes, 12);
        json = Json::parse(std::string_view(bytes).substr(20, length));
        numbers = std::string_view(bytes).substr(28 + length);
    }
    const Json& primitive() const { return json["meshes"][0]["primitives"][0]; }
    const Json* attribute(const std::string& name) const {
        const Json& all = primitive()["attributes"];
        return all.contains(name) ? &json["accessors"][all[name].get<std::size_t>()] : nullptr;
    }
    template <class T>
    T number(const std::string& name, std::size_t row, std::size_t component) const {
        const Json& view = json["bufferViews"][(*attribute(name))["bufferView"].get<std::size_t>()];
        return number_at<T>(numbers, view.value("byteOffset", std::size_t(0)) +
                                         row * view["byteStride"].get<std::size_t>() + component * sizeof(T));
    }
};

inline PointCloud two_points() {
    PointCloud cloud;
    cloud.frame.unit = LengthUnit::metre;
    cloud.positions = {Vec3(1, 2, 3), Vec3(4, 5, 6)};
    return cloud;
}

}  // namespace scanmill::test
