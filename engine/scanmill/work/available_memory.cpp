// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/work/available_memory.hpp"

#include <algorithm>
#include <fstream>
#include <limits>
#include <optional>
#include <string>

namespace scanmill {

namespace {

constexpr u64 unlimited = std::numeric_limits<u64>::max();

u64 of_machine() {
    std::ifstream facts("/proc/meminfo");
    for (std::string name, unit; facts >> name;) {
        u64 amount = 0;
        facts >> amount;
        std::getline(facts, unit);
        if (name == "MemAvailable:") return amount * 1024;
    }
    return unlimited;
}

/// Nothing for "max", and where there is no such file.
std::optional<u64> number_in(const std::string& file) {
    std::ifstream stream(file);
    u64 number = 0;
    return stream >> number ? std::optional(number) : std::nullopt;
}

u64 of_control_group() {
    std::ifstream groups("/proc/self/cgroup");
    u64 least = unlimited;
    for (std::string line; std::getline(groups, line);) {
        if (!line.starts_with("0::/")) continue;
        for (std::string group = line.substr(3);; group.resize(group.rfind('/'))) {
            const std::string folder = "/sys/fs/cgroup" + group;
            const std::optional<u64> limit = number_in(folder + "/memory.max");
            const std::optional<u64> used = number_in(folder + "/memory.current");
            if (limit && used) least = std::min(least, *limit > *used ? *limit - *used : 0);
            if (group.empty() || group == "/") break;
        }
    }
    return least;
}

}  // namespace

u64 available_memory() { return std::min(of_machine(), of_control_group()); }

}  // namespace scanmill
