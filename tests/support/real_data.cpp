// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/real_data.hpp"

#include <cctype>

#include "support/folders.hpp"

namespace scanmill::test {

namespace {
std::optional<std::filesystem::path> in_collection(const std::filesystem::path& collection, std::string_view file) {
    if (std::filesystem::exists(collection)) return collection / file;
    return std::nullopt;
}
}  // namespace

std::optional<std::filesystem::path> fetched_data(std::string_view name) {
    const std::size_t slash = name.find('/');
    return in_collection(std::filesystem::path(source_folder()) / "build/data" / name.substr(0, slash),
                         name.substr(slash + 1));
}

std::optional<std::filesystem::path> shared_data(std::string_view name) {
    return in_collection(std::filesystem::path(source_folder()).parent_path() / "shared/data", name);
}

std::string missing_data(std::string_view name) {
    const bool shared = !name.empty() && std::isdigit(static_cast<unsigned char>(name[0]));
    return (shared ? "needs ../shared/data: " : "needs build/data (make data): ") + std::string(name);
}

}  // namespace scanmill::test
