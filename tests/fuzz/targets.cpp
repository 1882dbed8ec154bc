// SPDX-License-Identifier: GPL-3.0-or-later
#include "fuzz/targets.hpp"

#include <algorithm>
#include <array>

namespace scanmill::test {

std::span<const FuzzTarget> fuzz_targets() {
    static constexpr auto table = std::to_array<FuzzTarget>({
        {"ply", [](std::string_view bytes) { return read_scan("ply", bytes); }},
        {"stl", [](std::string_view bytes) { return read_scan("stl", bytes); }},
        {"off", [](std::string_view bytes) { return read_scan("off", bytes); }},
        {"xyz", [](std::string_view bytes) { return read_scan("xyz", bytes); }},
        {"csv", [](std::string_view bytes) { return read_scan("csv", bytes); }},
        {"pts", [](std::string_view bytes) { return read_scan("pts", bytes); }},
        {"obj", [](std::string_view bytes) { return read_scan("obj", bytes); }},
        {"ptx", [](std::string_view bytes) { return read_scan("ptx", bytes); }},
        {"las", [](std::string_view bytes) { return read_scan("las", bytes); }},
#ifdef SCANMILL_LAZ
        {"laz", [](std::string_view bytes) { return read_scan("laz", bytes); }},
#endif
        {"dmi", [](std::string_view bytes) { return read_scan("dmi", bytes); }},
        {"pcd", [](std::string_view bytes) { return read_scan("pcd", bytes); }},
        {"png", [](std::string_view bytes) { return read_scan("png", bytes); }},
        {"e57", read_e57},
        {"workflow", check_workflow_text},
        {"batch", check_batch_text},
        {"setting", check_setting},
        {"manifest", check_manifest},
        {"format-manifest", check_format_manifest},
        {"poses", check_poses},
        {"document", check_document},
    });
    return table;
}

const FuzzTarget& fuzz_target(std::string_view name) {
    const auto found = std::ranges::find(fuzz_targets(), name, &FuzzTarget::name);
    if (found == fuzz_targets().end()) throw std::out_of_range("there is no fuzz target '" + std::string(name) + "'");
    return *found;
}

}  // namespace scanmill::test
