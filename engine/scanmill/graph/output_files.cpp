// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/graph/output_files.hpp"

#include <sys/stat.h>

#include <algorithm>

#include "scanmill/base/error.hpp"
#include "scanmill/formats/common/format.hpp"

namespace scanmill {

namespace {

namespace fs = std::filesystem;

bool lies_below(const fs::path& path, const fs::path& folder) {
    const auto [end, rest] = std::ranges::mismatch(folder, path);
    return end == folder.end() || end->empty();
}

/// The absolute path, with symbolic links resolved in the part of it that exists.
fs::path real_path(const fs::path& path) {
    std::error_code trouble;
    fs::path real = fs::weakly_canonical(fs::absolute(path), trouble);
    if (trouble) throw Error("results cannot be written to '{}': {}", path.string(), trouble.message());
    return real;
}

fs::path real_folder(const fs::path& path) {
    fs::path folder = real_path(path);
    return folder.has_filename() || folder == folder.root_path()
               ? folder
               : folder.parent_path();  // without the final slash of "out/"
}

}  // namespace

OutputFiles::OutputFiles(const fs::path& folder) : folder_(real_folder(folder)), names_(folder_) {}

void OutputFiles::protect(const fs::path& name) {
    const fs::path file = file_view(name).file;
    if (const Identity existing = identity(file); existing != Identity()) {
        inputs_.insert(existing);
        return;
    }
    std::error_code trouble;
    if (fs::path real = fs::weakly_canonical(fs::absolute(file, trouble), trouble); !trouble)
        absent_inputs_.insert(std::move(real));
}

fs::path OutputFiles::add(const std::string& name, const OutputContent& content, const std::string& writer,
                          const TemplateValues& values) {
    const auto [file, is_new] = names_.add(name, content, writer, values);
    if (!is_new) return file;
    std::error_code unknown;  // for a name that is too long, writing fails later
    if (fs::is_directory(file, unknown))
        throw Error("the output '{}' is an existing folder", file.string())
            .hint("remove it, or choose another output folder")
            .remedy(Remedy::choose_output_folder);
    const fs::path failed = failed_of(folder_, file);
    for (const fs::path& written : {file, previous_of(file), failed}) require_free(written);
    return file;
}

/// Throws Error if the file is an input, or if a symbolic link leads it out of the output folder.
void OutputFiles::require_free(const fs::path& file) {
    fs::path& folder = real_folders_[file.parent_path()];
    if (folder.empty()) folder = real_path(file.parent_path());
    if (!lies_below(folder, folder_))
        throw Error("'{}' would be written outside the output folder, to '{}'", file.string(), folder.string())
            .hint("remove the symbolic link that leads out of the output folder");
    const Identity existing = identity(file);
    if (existing != Identity() ? inputs_.contains(existing) : absent_inputs_.contains(folder / file.filename()))
        throw Error("'{}' is an input; an output must not replace it", file.string())
            .hint("choose another output folder")
            .remedy(Remedy::choose_output_folder);
}

/// {0, 0} for a file that does not exist.
OutputFiles::Identity OutputFiles::identity(const fs::path& file) {
    struct stat status;
    if (::stat(file.c_str(), &status) != 0) return {0, 0};
    return {status.st_dev, status.st_ino};
}

fs::path previous_of(const fs::path& file) { return file.string() + ".previous"; }

fs::path failed_folder(const fs::path& folder) { return folder / failed_folder_name; }

fs::path failed_of(const fs::path& folder, const fs::path& file) {
    return failed_folder(folder) / file.lexically_relative(folder);
}

void remove_failed(const fs::path& folder, const fs::path& file) {
    const fs::path failed = failed_of(folder, file);
    std::error_code ignored;
    bool was_there = false;
    for (const fs::path& each : {failed, description_of(failed)})
        if (const fs::file_status status = fs::symlink_status(each, ignored);
            fs::is_regular_file(status) || fs::is_symlink(status))
            was_there = fs::remove(each, ignored) || was_there;
    if (!was_there) return;
    for (fs::path part = failed.parent_path(); part != folder; part = part.parent_path()) {
        if (!fs::is_directory(fs::symlink_status(part, ignored))) continue;
        fs::remove(part, ignored);  // fails if the folder is not empty
    }
}

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
