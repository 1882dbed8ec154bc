// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/io/memory.hpp"

#include <algorithm>
#include <fstream>
#include <limits>
#include <optional>
#include <string>

namespace scanmill {

namespace {

constexpr std::uint64_t unlimited = std::numeric_limits<std::uint64_t>::max();

std::uint64_t machine_memory() {
    std::ifstream properties("/proc/meminfo");
    for (std::string name, unit; properties >> name;) {
        std::uint64_t amount = 0;
        properties >> amount;
        std::getline(properties, unit);
        if (name == "MemAvailable:") return amount * 1024;
    }
    return unlimited;
}

/// The number in a file; nullopt for "max" or a missing file.
std::optional<std::uint64_t> number_in(const std::string& file) {
    std::ifstream stream(file);
    std::uint64_t number = 0;
    return stream >> number ? std::optional(number) : std::nullopt;
}

std::uint64_t control_group_memory() {
    std::ifstream groups("/proc/self/cgroup");
    std::uint64_t least = unlimited;
    for (std::string line; std::getline(groups, line);) {
        if (!line.starts_with("0::/")) continue;
        for (std::string group = line.substr(3);; group.resize(group.rfind('/'))) {
            const std::string folder = "/sys/fs/cgroup" + group;
            const std::optional<std::uint64_t> limit = number_in(folder + "/memory.max");
            const std::optional<std::uint64_t> used = number_in(folder + "/memory.current");
            if (limit && used) least = std::min(least, *limit > *used ? *limit - *used : 0);
            if (group.empty() || group == "/") break;
        }
    }
    return least;
}

}  // namespace

std::uint64_t available_memory() { return std::min(machine_memory(), control_group_memory()); }

}  // namespace scanmill
