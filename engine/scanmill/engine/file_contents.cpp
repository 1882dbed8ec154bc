// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/engine/file_contents.hpp"

#include "scanmill/engine/no_file.hpp"

namespace scanmill {

const FileContent& FileContents::of(const std::filesystem::path& file) {
    const auto [known, is_new] = known_.try_emplace(file.string());
    FileContent& content = known->second;
    if (!is_new) return content;
    try {
        if (const std::optional<Error> other = why_no_file(file)) throw *other;
        content.hash = hash_(file);
    } catch (const Error& error) {
        content = {"unreadable " + file.string(), error.sentence() + (error.hint().empty() ? "" : "; " + error.hint())};
    }
    return content;
}

}  // namespace scanmill
