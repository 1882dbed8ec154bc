// SPDX-License-Identifier: GPL-3.0-or-later
/// meshoptimizer's simplifier, in one thread and single precision.

#include <meshoptimizer.h>

#include <span>
#include <stdexcept>

#include "answer.hpp"

namespace {

using peers::Json;

struct Mesh {
    std::vector<float> coordinates;
    std::vector<unsigned> indices;
};

Json load(Mesh& mesh, const Json& request) {
    const peers::RawInput raw = peers::read_raw(request.at("path"));
    mesh = {};
    for (const auto& point : raw.points)
        for (const double value : point) mesh.coordinates.push_back(static_cast<float>(value));
    for (const auto& triangle : raw.triangles)
        mesh.indices.insert(mesh.indices.end(), triangle.begin(), triangle.end());
    return raw.counts();
}

void write(const std::string& path, const Mesh& mesh, std::span<const unsigned> indices) {
    peers::RawInput raw;
    for (std::size_t i = 0; i < mesh.coordinates.size(); i += 3)
        raw.points.push_back({mesh.coordinates[i], mesh.coordinates[i + 1], mesh.coordinates[i + 2]});
    for (std::size_t i = 0; i < indices.size(); i += 3)
        raw.triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
    peers::write_raw(path, raw);
}

/// Simplifies to "triangles" triangles, without an error bound. Writes the mesh "into" raw arrays.
Json simplify(const Mesh& mesh, const Json& request) {
    const auto wanted = request.at("triangles").get<std::size_t>();
    if (mesh.indices.empty()) throw std::runtime_error("there are no triangles to simplify");
    std::vector<unsigned> left(mesh.indices.size());
    constexpr float any_error = 1e9f;
    std::size_t count = 0;
    const double seconds = peers::seconds_of([&] {
        count = meshopt_simplify(left.data(), mesh.indices.data(), mesh.indices.size(), mesh.coordinates.data(),
                                 mesh.coordinates.size() / 3, 3 * sizeof(float), 3 * wanted, any_error);
    });
    if (request.contains("into")) write(request["into"], mesh, std::span(left).first(count));
    return {{"seconds", seconds}, {"triangles", count / 3}};
}

}  // namespace

int main() {
    Mesh mesh;
    constexpr int version = MESHOPTIMIZER_VERSION;
    return peers::answer(
        {{"load", [&](const Json& request) { return load(mesh, request); }},
         {"decimate", [&](const Json& request) { return simplify(mesh, request); }}},
        {{"meshoptimizer", std::to_string(version / 1000) + "." + std::to_string(version % 1000 / 10)}});
}
