// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/io/atomic_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <system_error>
#include <utility>
#include <vector>

#include "scanmill/base/error.hpp"

namespace scanmill {

namespace {

namespace fs = std::filesystem;

std::string reason_of(int number) { return std::generic_category().message(number); }

[[noreturn]] void throw_failed() { throw Error("writing failed: {}; the file was not made", reason_of(errno)); }

fs::path folder_of(const fs::path& target) { return target.has_parent_path() ? target.parent_path() : fs::path("."); }

fs::path temporary_name(const fs::path& folder, unsigned attempt) {
    return folder / fmt::format(".scanmill-{}-{}.part", ::getpid(), attempt);
}

/// Makes the rename survive a power cut. Errors are ignored: some network file systems cannot sync a folder.
void sync_folder(const fs::path& folder) {
    const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (descriptor < 0) return;
    ::fsync(descriptor);
    ::close(descriptor);
}

/// Whether `target` is a regular file with the bytes of the open file.
bool holds_bytes_of(const fs::path& target, int descriptor) {
    const int existing = ::open(target.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    if (existing < 0) return false;
    struct stat old_status, new_status;
    bool is_equal = ::fstat(existing, &old_status) == 0 && ::fstat(descriptor, &new_status) == 0 &&
                    S_ISREG(old_status.st_mode) && old_status.st_size == new_status.st_size;
    std::vector<char> old_bytes(std::size_t(1) << 16), new_bytes(old_bytes.size());
    const auto read = [](int from, std::vector<char>& to, off_t at, std::size_t length) {
        return ::pread(from, to.data(), length, at) == static_cast<ssize_t>(length);
    };
    for (off_t at = 0; is_equal && at < new_status.st_size; at += static_cast<off_t>(old_bytes.size())) {
        const std::size_t length = std::min(old_bytes.size(), static_cast<std::size_t>(new_status.st_size - at));
        is_equal =
            read(existing, old_bytes, at, length) && read(descriptor, new_bytes, at, length) &&
            std::equal(old_bytes.begin(), old_bytes.begin() + static_cast<std::ptrdiff_t>(length), new_bytes.begin());
    }
    ::close(existing);
    return is_equal;
}

}  // namespace

AtomicFile::AtomicFile(fs::path target) : target_(std::move(target)) {
    const fs::path folder = folder_of(target_);
    std::error_code ignored;
    if (!fs::is_directory(folder, ignored))
        throw Error("cannot be written: there is no folder '{}'", folder.string()).hint("make the folder first");
    const fs::file_status status = fs::symlink_status(target_, ignored);
    if (fs::exists(status) && !fs::is_regular_file(status) && !fs::is_symlink(status))
        throw Error("cannot be written: a {} has this name", fs::is_directory(status) ? "folder" : "pipe or device");

    // Without /proc the file could not be named later.
    if (::access("/proc/self/fd", X_OK) == 0)
        descriptor_ = ::open(folder.c_str(), O_RDWR | O_TMPFILE | O_CLOEXEC, 0666);
    if (descriptor_ < 0) open_named(folder);
}

void AtomicFile::open_named(const fs::path& folder) {
    // O_EXCL instead of mkstemp(): the file gets the permissions that the user's umask gives any new file.
    for (unsigned attempt = 0;; ++attempt) {
        temporary_ = temporary_name(folder, attempt);
        descriptor_ = ::open(temporary_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (descriptor_ >= 0) return;
        if (errno != EEXIST) {
            temporary_.clear();
            throw Error("cannot be written: {}", reason_of(errno));
        }
    }
}

AtomicFile::~AtomicFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!temporary_.empty()) ::unlink(temporary_.c_str());
}

void AtomicFile::write(std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) throw_failed();
        bytes.remove_prefix(static_cast<std::size_t>(written));
    }
}

void AtomicFile::commit(Sync sync) {
    if (holds_bytes_of(target_, descriptor_)) {
        ::close(std::exchange(descriptor_, -1));
        if (!temporary_.empty()) ::unlink(std::exchange(temporary_, {}).c_str());
        return;
    }
    if (sync == Sync::yes && ::fsync(descriptor_) != 0) throw_failed();
    // linkat() cannot replace a file, rename() can. A file without a name therefore gets a temporary name first.
    const std::string opened = fmt::format("/proc/self/fd/{}", descriptor_);
    const fs::path folder = folder_of(target_);
    for (unsigned attempt = 0; temporary_.empty(); ++attempt) {
        const fs::path name = temporary_name(folder, attempt);
        if (::linkat(AT_FDCWD, opened.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0)
            temporary_ = name;
        else if (errno != EEXIST)
            throw Error("cannot be written in '{}': {}", folder.string(), reason_of(errno));
    }
    if (::close(std::exchange(descriptor_, -1)) != 0) throw_failed();
    if (::rename(temporary_.c_str(), target_.c_str()) != 0) throw Error("cannot be written: {}", reason_of(errno));
    temporary_.clear();
    if (sync == Sync::yes) sync_folder(folder);
}

void remove_abandoned_parts(const fs::path& folder) {
    constexpr std::string_view prefix = ".scanmill-", suffix = ".part";
    std::error_code gone;
    for (fs::directory_iterator entry(folder, gone), end; !gone && entry != end; entry.increment(gone)) {
        const std::string name = entry->path().filename().string();
        if (!name.starts_with(prefix) || !name.ends_with(suffix)) continue;
        const int process = std::atoi(name.c_str() + prefix.size());
        if (process <= 0 || ::kill(process, 0) == 0 || errno != ESRCH) continue;
        // A process on another machine may still be writing the file.
        constexpr std::chrono::minutes settled(1);
        std::error_code ignored;
        const auto written = fs::last_write_time(entry->path(), ignored);
        if (!ignored && fs::file_time_type::clock::now() - written > settled) fs::remove(entry->path(), ignored);
    }
}

}  // namespace scanmill
