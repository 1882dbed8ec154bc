// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Files that commands write beside results: whole or not at all.

#include <filesystem>
#include <string_view>

#include "scanmill/base/error.hpp"
#include "scanmill/io/atomic_file.hpp"

namespace scanmill::runner {

/// Makes the folder when it is missing. Throws Error when the file cannot be written.
inline void write_text(const std::filesystem::path& path, std::string_view text) {
    std::error_code trouble;
    if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path(), trouble);
    if (trouble) throw Error("the folder '{}' cannot be made: {}", path.parent_path().string(), trouble.message());
    try {
        AtomicFile file(path);
        file.write(text);
        file.commit();
    } catch (const Error& error) {
        throw error.reworded(fmt::format("'{}' {}", path.string(), error.sentence()));
    }
}

}  // namespace scanmill::runner
