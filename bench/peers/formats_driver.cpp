// SPDX-License-Identifier: GPL-3.0-or-later
/// Reads and writes files on demand, so that bench/peers/harness.py can time Scanmill in turn with other programs.
///
/// One request per line on standard input, one answer per line on standard output: "read PATH" keeps what the file
/// holds and answers "SECONDS POINTS TRIANGLES"; "write PATH" writes what was read last and answers the same.
#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <iostream>
#include <string>

#include "scanmill/filter/error.hpp"
#include "scanmill/formats/files.hpp"

namespace {

using namespace scanmill;

std::string sizes(const Value& value) {
    if (const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&value))
        return fmt::format("{} {}", (*mesh)->positions.size(), (*mesh)->triangles.size());
    return fmt::format("{} 0", std::get<std::shared_ptr<const PointCloud>>(value)->size());
}

}  // namespace

int main() {
    Value held;
    for (std::string line; std::getline(std::cin, line);) {
        const std::size_t blank = line.find(' ');
        const std::string request = line.substr(0, blank), path = line.substr(blank + 1);
        try {
            held = request == "read" ? Value() : held;
            const auto begin = std::chrono::steady_clock::now();
            if (request == "read")
                held = read_file(path).value;
            else
                write_file(path, held);
            const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
            fmt::print("{:.6f} {}\n", seconds.count(), sizes(held));
        } catch (const Error& error) {
            fmt::print("failed {}\n", error.sentence());
        }
        std::fflush(stdout);
    }
}
