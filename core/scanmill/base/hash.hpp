// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// 128-bit XXH3 content hashes, as 32 hexadecimal digits.

#include <filesystem>
#include <string>
#include <string_view>

namespace scanmill {

/// The hash of a sequence of fields. The hashed bytes of a field are name length, name, value length and value.
/// Different sequences therefore have different bytes.
class KeyBuilder {
public:
    KeyBuilder& field(std::string_view name, std::string_view value);
    std::string key() const;

private:
    std::string bytes_;
};

/// The hash of a file's bytes. Throws Error if the file cannot be read. Cost: one pass over the file.
std::string content_hash(const std::filesystem::path& file);

}  // namespace scanmill
