// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/graph/output_files.hpp"

#include <sys/stat.h>

#include <algorithm>

#include "scanmill/base/error.hpp"

namespace scanmill {

namespace {

namespace fs = std::filesystem;

bool lies_below(const fs::path& path, const fs::path& folder) {
    const auto [end, rest] = std::ranges::mismatch(folder, path);
    return end == folder.end() || end->empty();
}

/// Absolute and without links, as far as it exists.
fs::path real_path(const fs::path& path) {
    std::error_code trouble;
    fs::path real = fs::weakly_canonical(fs::absolute(path), trouble);
    if (trouble) throw Error("results cannot be written to '{}': {}", path.string(), trouble.message());
    return real;
}

}  // namespace

OutputFiles::OutputFiles(const fs::path& folder) : folder_(real_path(folder)) {
    if (!folder_.has_filename() && folder_ != folder_.root_path()) folder_ = folder_.parent_path();  // "out/"
}

fs::path OutputFiles::add(const std::string& name, const OutputContent& content, const std::string& writer) {
    const fs::path file = folder_ / name;
    const auto [found, is_new] = files_.emplace(file, Entry{content, writer});
    if (!is_new) {
        if (found->second.content != content)
            throw Error("{} and {} would both write '{}'", found->second.writer, writer, file.string())
                .hint(
                    "put {variant}, {workflow} or {folder}, the name of the scan's folder, into the output's name, or "
                    "rename a scan");
        return file;
    }
    require_no_clash(file, writer);
    for (fs::path part = file.parent_path(); part != folder_; part = part.parent_path()) folders_.emplace(part, writer);
    if (const fs::path real = real_path(file.parent_path()); !lies_below(real, folder_))
        throw Error("'{}' would be written outside the output folder, to '{}'", file.string(), real.string())
            .hint("a symbolic link below the output folder leads out of it; remove it");
    for (const fs::path& replaced : {file, previous_of(file)})
        if (const Identity existing = identity(replaced); existing != Identity() && inputs_.contains(existing))
            throw Error("'{}' is an input; an output must not replace it", replaced.string())
                .hint("choose another output folder")
                .remedy(Remedy::choose_output_folder);
    return file;
}

/// A path cannot be a file and a folder at once.
void OutputFiles::require_no_clash(const fs::path& file, const std::string& writer) const {
    if (const auto folder = folders_.find(file); folder != folders_.end())
        throw Error("{} would write the file '{}', which is the folder that {} writes into", writer, file.string(),
                    folder->second);
    for (fs::path part = file.parent_path(); part != folder_; part = part.parent_path())
        if (const auto other = files_.find(part); other != files_.end())
            throw Error("{} would write '{}' into a folder that is a file of {}", writer, file.string(),
                        other->second.writer);
    std::error_code unknown;  // for a name that is too long, writing fails later
    if (fs::is_directory(file, unknown))
        throw Error("the output '{}' is an existing folder", file.string())
            .hint("remove it, or choose another output folder")
            .remedy(Remedy::choose_output_folder);
}

/// Zeros for what does not exist.
OutputFiles::Identity OutputFiles::identity(const fs::path& file) {
    struct stat status;
    if (::stat(file.c_str(), &status) != 0) return {0, 0};
    return {status.st_dev, status.st_ino};
}

fs::path description_of(const fs::path& file) { return file.string() + ".json"; }

fs::path previous_of(const fs::path& file) { return file.string() + ".previous"; }

bool move_aside(const fs::path& file) {
    const auto move = [](const fs::path& from, const fs::path& to) {
        std::error_code trouble;
        const fs::file_status status = fs::symlink_status(from, trouble);
        if (!fs::is_regular_file(status) && !fs::is_symlink(status)) return false;
        fs::rename(from, to, trouble);
        if (trouble) throw Error("'{}' cannot be moved to '{}': {}", from.string(), to.string(), trouble.message());
        return true;
    };
    const fs::path previous = previous_of(file);
    const bool was_there = move(file, previous);
    return move(description_of(file), description_of(previous)) || was_there;
}

}  // namespace scanmill
