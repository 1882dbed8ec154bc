// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// How much memory something has resident at most, mapped pages of files included.

#include <fstream>
#include <functional>
#include <optional>
#include <string>

namespace scanmill::test {

/// A line of this process's status, in bytes.
inline std::optional<double> resident_bytes(const std::string& line_begins) {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
        if (line.starts_with(line_begins)) return std::stod(line.substr(line.find_first_of("0123456789"))) * 1024;
    return std::nullopt;
}

/// What `work` adds at most to what is resident before it; nothing where the system does not let the peak be reset.
inline std::optional<double> peak_of(const std::function<void()>& work) {
    std::ofstream peak("/proc/self/clear_refs");
    if (!(peak << 5).flush()) return std::nullopt;
    const std::optional<double> before = resident_bytes("VmRSS");
    work();
    const std::optional<double> most = resident_bytes("VmHWM");
    if (!before || !most) return std::nullopt;
    return *most - *before;
}

}  // namespace scanmill::test
