// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Plan keys: what identifies a step's result before anything runs.
///
/// A key is the 128-bit XXH3 hash of a sequence of fields, each written as name length, name, value length, value, so
/// that no two different sequences give the same bytes. It knows filter, version, builds, parameters, unit, seed and
/// the keys of everything upstream; it knows nothing of thread counts, paths, step names or the order of a file's keys.

#include <string>
#include <string_view>

namespace scanmill {

class KeyBuilder {
public:
    KeyBuilder& field(std::string_view name, std::string_view value);
    /// 32 hexadecimal digits.
    std::string key() const;

private:
    std::string bytes_;
};

}  // namespace scanmill
