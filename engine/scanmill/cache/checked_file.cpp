// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/cache/checked_file.hpp"

#include <fmt/format.h>
#include <xxhash.h>

#include <fstream>
#include <sstream>

#include "scanmill/filter/error.hpp"
#include "scanmill/formats/atomic_file.hpp"

namespace scanmill {

namespace {

std::string head_of(const std::filesystem::path& file, std::string_view kind, std::string_view content) {
    const XXH128_hash_t hash = XXH3_128bits(content.data(), content.size());
    return fmt::format("scanmill {} {} {:016x}{:016x}\n", kind, file.filename().string(), hash.high64, hash.low64);
}

}  // namespace

void write_checked(const std::filesystem::path& file, std::string_view kind, std::string_view content) {
    AtomicFile target(file);
    target.write(head_of(file, kind, content));
    target.write(content);
    target.commit(AtomicFile::Sync::no);
}

std::optional<std::string> read_checked(const std::filesystem::path& file, std::string_view kind) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) return std::nullopt;
    std::ostringstream text;
    text << stream.rdbuf();
    const std::string bytes = std::move(text).str();
    const std::size_t end = bytes.find('\n');
    const std::string content = end == std::string::npos ? std::string() : bytes.substr(end + 1);
    if (!stream || bytes.substr(0, end + 1) != head_of(file, kind, content))
        throw Error("'{}' is damaged: its bytes are not those that were written under this name", file.string());
    return content;
}

}  // namespace scanmill
