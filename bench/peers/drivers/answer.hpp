// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What the C++ drivers share: requests as JSON lines in, answers out, and inputs as raw arrays.
///
/// A request is {"do": JOB, …}; its answer tells facts about the result, of a timed job also "seconds", or is
/// {"failed": SENTENCE}. Only answers are written to standard output: what a library prints there goes to standard
/// error instead.

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
/// Throws what it likes; the text of a std::exception is told.
using Job = std::function<Json(const Json& request)>;

/// Answers until standard input ends. "versions" is answered from `versions`, with the compiler and its flags.
int answer(std::map<std::string, Job> jobs, Json versions);

/// Seconds that `work` takes.
template <class Work>
double seconds_of(Work&& work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// What lies in PATH.points and PATH.triangles: see harness/inputs.py.
struct RawInput {
    std::vector<std::array<double, 3>> points;
    /// Empty for a cloud.
    std::vector<std::array<std::uint32_t, 3>> triangles;
    /// Empty, or one per point: squared lengths.
    std::vector<double> weights;

    /// As an answer.
    Json counts() const;
};

/// Throws std::runtime_error when there is no PATH.points, or when a file holds no whole number of elements.
RawInput read_raw(const std::string& path);
void write_raw(const std::string& path, const RawInput& input);

/// The request's "threads"; 1 when it names none.
unsigned threads_of(const Json& request);

}  // namespace peers
