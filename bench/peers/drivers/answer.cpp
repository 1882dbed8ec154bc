// SPDX-License-Identifier: GPL-3.0-or-later
#include "answer.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <type_traits>

namespace peers {

namespace {

Json answered(const std::map<std::string, Job>& jobs, const std::string& line) {
    try {
        const Json request = Json::parse(line);
        const std::string name = request.at("do");
        const auto job = jobs.find(name);
        if (job == jobs.end()) throw std::runtime_error("this program cannot do '" + name + "'");
        return job->second(request);
    } catch (const std::exception& error) {
        return {{"failed", error.what()}};
    }
}

/// Returns a stream to standard output for the answers, and redirects all other output to standard error.
std::FILE* stream_of_answers() {
    std::FILE* answers = ::fdopen(::dup(STDOUT_FILENO), "w");
    if (!answers || ::dup2(STDERR_FILENO, STDOUT_FILENO) < 0) throw std::runtime_error("standard output is not open");
    return answers;
}

template <class Element>
std::vector<Element> read_array(const std::string& path) {
    static_assert(std::is_trivially_copyable_v<Element>);
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    if (!file) throw std::runtime_error(path + " cannot be read");
    const auto bytes = static_cast<std::size_t>(file.tellg());
    if (bytes % sizeof(Element) != 0) throw std::runtime_error(path + " does not hold a whole number of elements");
    std::vector<Element> elements(bytes / sizeof(Element));
    file.seekg(0);
    file.read(reinterpret_cast<char*>(elements.data()), static_cast<std::streamsize>(bytes));
    if (!file) throw std::runtime_error(path + " cannot be read");
    return elements;
}

template <class Element>
void write_array(const std::string& path, const std::vector<Element>& elements) {
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char*>(elements.data()),
               static_cast<std::streamsize>(elements.size() * sizeof(Element)));
    file.close();
    if (!file) throw std::runtime_error(path + " cannot be written");
}

}  // namespace

int answer(std::map<std::string, Job> jobs, Json versions) {
    versions["compiler"] = "GCC " __VERSION__ " with " PEERS_BUILD;
    jobs["versions"] = [versions](const Json&) { return versions; };
    std::FILE* answers = stream_of_answers();
    for (std::string line; std::getline(std::cin, line);) {
        const std::string text = answered(jobs, line).dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
        std::fputs(text.c_str(), answers);
        std::fflush(answers);
    }
    return 0;
}

Json RawInput::counts() const {
    Json counts{{"points", points.size()}};
    if (!triangles.empty()) counts["triangles"] = triangles.size();
    return counts;
}

RawInput read_raw(const std::string& path) {
    RawInput input;
    input.points = read_array<std::array<double, 3>>(path + ".points");
    if (std::ifstream(path + ".triangles").good())
        input.triangles = read_array<std::array<std::uint32_t, 3>>(path + ".triangles");
    if (std::ifstream(path + ".weights").good()) input.weights = read_array<double>(path + ".weights");
    if (std::ifstream(path + ".normals").good()) input.normals = read_array<std::array<double, 3>>(path + ".normals");
    return input;
}

void write_raw(const std::string& path, const RawInput& input) {
    std::remove((path + ".triangles").c_str());
    if (!input.triangles.empty()) write_array(path + ".triangles", input.triangles);
    std::remove((path + ".weights").c_str());
    if (!input.weights.empty()) write_array(path + ".weights", input.weights);
    std::remove((path + ".normals").c_str());
    if (!input.normals.empty()) write_array(path + ".normals", input.normals);
    write_array(path + ".points", input.points);
}

unsigned threads_of(const Json& request) { return request.value("threads", 1u); }

Json directions(const Json& request, const Vectors& points, const Vectors& normals) {
    const auto count = static_cast<double>(normals.size());
    const auto along_x = std::ranges::count_if(
        normals, [](const auto& n) { return std::abs(n[0]) > std::abs(n[1]) && std::abs(n[0]) > std::abs(n[2]); });
    Json answer{{"along_x", static_cast<double>(along_x) / count}};
    if (!request.value("oriented", false)) return answer;
    double flux = 0;
    for (std::size_t i = 0; i < normals.size(); ++i)
        for (std::size_t axis = 0; axis < 3; ++axis) flux += normals[i][axis] * points[i][axis];
    answer["flux"] = flux / count;
    return answer;
}

double enclosed_volume(const Vectors& points, const TriangleIndices& triangles) {
    double six_volumes = 0;
    for (const auto& [i, j, k] : triangles) {
        const auto& [ax, ay, az] = points[i];
        const auto& [bx, by, bz] = points[j];
        const auto& [cx, cy, cz] = points[k];
        six_volumes += ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx);
    }
    return six_volumes / 6;
}

std::size_t boundary_edges(const TriangleIndices& triangles) {
    std::vector<std::array<std::uint32_t, 2>> edges;
    for (const auto& [a, b, c] : triangles)
        for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
            edges.push_back({std::min(from, to), std::max(from, to)});
    std::ranges::sort(edges);
    std::size_t count = 0;
    for (std::size_t i = 0, next; i < edges.size(); i = next) {
        for (next = i + 1; next < edges.size() && edges[next] == edges[i];) ++next;
        count += next == i + 1;
    }
    return count;
}

}  // namespace peers
