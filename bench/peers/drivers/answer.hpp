// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Shared by the C++ drivers: reads requests as JSON lines, writes answers, and reads and writes raw arrays.
///
/// A request is {"do": JOB, …}. Its answer holds properties of the result (and "seconds" for a timed job), or is
/// {"failed": SENTENCE}. Standard output holds only answers; output of the libraries goes to standard error.

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace peers {

using Json = nlohmann::json;
/// May throw; the answer then contains the text of the std::exception.
using Job = std::function<Json(const Json& request)>;

/// Answers requests until standard input ends. Answers "versions" with `versions`, the compiler and its flags.
int answer(std::map<std::string, Job> jobs, Json versions);

/// Seconds that `work` takes.
template <class Work>
double seconds_of(Work&& work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

using Vectors = std::vector<std::array<double, 3>>;
using TriangleIndices = std::vector<std::array<std::uint32_t, 3>>;

/// The content of PATH.points, PATH.triangles, PATH.weights and PATH.normals: see harness/inputs.py.
struct RawInput {
    Vectors points;
    /// Empty for a cloud.
    TriangleIndices triangles;
    /// Squared lengths, one per point; or empty.
    std::vector<double> weights;
    /// Unit vectors, one per point; or empty.
    Vectors normals;

    /// The counts as an answer.
    Json counts() const;
};

/// Throws std::runtime_error if PATH.points is missing, or if a file does not hold a whole number of elements.
RawInput read_raw(const std::string& path);
void write_raw(const std::string& path, const RawInput& input);

/// The request's "threads"; 1 by default.
unsigned threads_of(const Json& request);

/// The answer about normals: "along_x", the share of normals with x as their largest component; with "oriented" in the
/// request also "flux", the mean product of normal and point, which is positive where normals point away from the
/// origin.
Json directions(const Json& request, const Vectors& points, const Vectors& normals);
/// The volume that the triangles enclose if they are closed; negative if they face inwards.
double enclosed_volume(const Vectors& points, const TriangleIndices& triangles);
/// Edges in exactly one triangle.
std::size_t boundary_edges(const TriangleIndices& triangles);

}  // namespace peers
