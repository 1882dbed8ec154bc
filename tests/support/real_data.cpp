// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/real_data.hpp"

namespace scanmill::test {

namespace {
std::optional<std::filesystem::path> existing(std::filesystem::path path) {
    if (std::filesystem::exists(path)) return path;
    return std::nullopt;
}
const std::filesystem::path source_folder = SCANMILL_SOURCE_DIR;
}  // namespace

std::optional<std::filesystem::path> fetched_data(std::string_view name) {
    return existing(source_folder / "build/data" / name);
}

std::optional<std::filesystem::path> shared_data(std::string_view name) {
    return existing(source_folder.parent_path() / "shared/data" / name);
}

}  // namespace scanmill::test
