// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/io/atomic_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "scanmill/base/error.hpp"

namespace scanmill {

namespace {

namespace fs = std::filesystem;

std::string reason_of(int number) { return std::generic_category().message(number); }

[[noreturn]] void throw_failed() {
    const int number = errno;
    throw Error::of_writing(fmt::format("writing failed: {}; the file was not made", reason_of(number)), number);
}

/// `in`: empty, or " in 'FOLDER'".
[[noreturn]] void throw_unwritable(int number, const std::string& in = {}) {
    throw Error::of_writing(fmt::format("cannot be written{}: {}", in, reason_of(number)), number);
}

fs::path folder_of(const fs::path& target) { return target.has_parent_path() ? target.parent_path() : fs::path("."); }

constexpr std::string_view part_prefix = ".scanmill-", part_suffix = ".part";

/// The name of this machine, as file names may contain it.
std::string host() {
    std::array<char, 65> name{};
    std::string text = ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
    for (char& c : text)
        if (!std::isalnum(static_cast<unsigned char>(c)) && c != '.' && c != '-') c = '_';
    return text;
}

/// Machines that share a folder have processes of equal numbers.
fs::path temporary_name(const fs::path& folder, unsigned attempt) {
    return folder / fmt::format("{}{}-{}-{}{}", part_prefix, host(), ::getpid(), attempt, part_suffix);
}

struct PartName {
    std::string host;
    int process = 0;
};

std::optional<PartName> part_name(std::string name) {
    if (!name.starts_with(part_prefix) || !name.ends_with(part_suffix)) return std::nullopt;
    name = name.substr(part_prefix.size(), name.size() - part_prefix.size() - part_suffix.size());
    const std::size_t attempt = name.rfind('-');
    if (attempt == 0 || attempt == std::string::npos) return std::nullopt;
    const std::size_t process = name.rfind('-', attempt - 1);
    if (process == std::string::npos) return std::nullopt;
    PartName part{name.substr(0, process), std::atoi(name.c_str() + process + 1)};
    return part.process > 0 ? std::optional(std::move(part)) : std::nullopt;
}

bool is_same_file(const fs::path& file, const struct stat& other) {
    struct stat status;
    return ::lstat(file.c_str(), &status) == 0 && status.st_dev == other.st_dev && status.st_ino == other.st_ino;
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
    int existing = -1;
    // ESTALE: another machine has just replaced the file.
    for (int attempt = 0; existing < 0 && attempt < 3 && (attempt == 0 || errno == ESTALE); ++attempt)
        existing = ::open(target.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
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

bool holds_bytes_of(const fs::path& target, const fs::path& file) {
    const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) return false;
    const bool is_equal = holds_bytes_of(target, descriptor);
    ::close(descriptor);
    return is_equal;
}

/// Gives the file `part`, whose status is `status`, the name `target` only.
void move_into_place(const fs::path& part, const fs::path& target, const struct stat& status) {
    // link() does not replace a file: of several writers of equal bytes, the first wins. A network file system may
    // report that the name exists because its first answer was lost. Then rename() would leave both names.
    if (::link(part.c_str(), target.c_str()) == 0 ||
        (errno == EEXIST && (is_same_file(target, status) || holds_bytes_of(target, part)))) {
        ::unlink(part.c_str());
        return;
    }
    if (::rename(part.c_str(), target.c_str()) == 0) return;
    // Nobody else removes the part. If it is gone, rename() moved it, and its first answer was lost.
    const int reason = errno;
    struct stat ignored;
    const bool is_moved = ::lstat(part.c_str(), &ignored) != 0 && ::lstat(target.c_str(), &ignored) == 0;
    if (reason != ENOENT || !is_moved) throw_unwritable(reason);
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
            const int reason = errno;
            temporary_.clear();
            throw_unwritable(reason);
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
    struct stat status;
    if (::fstat(descriptor_, &status) != 0) throw_failed();
    // A file without a name gets a temporary name first, because the target must not appear before close() succeeds.
    const std::string opened = fmt::format("/proc/self/fd/{}", descriptor_);
    const fs::path folder = folder_of(target_);
    for (unsigned attempt = 0; temporary_.empty(); ++attempt) {
        const fs::path name = temporary_name(folder, attempt);
        if (::linkat(AT_FDCWD, opened.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0)
            temporary_ = name;
        else if (errno != EEXIST)
            throw_unwritable(errno, fmt::format(" in '{}'", folder.string()));
    }
    if (::close(std::exchange(descriptor_, -1)) != 0) throw_failed();
    move_into_place(temporary_, target_, status);
    temporary_.clear();
    if (sync == Sync::yes) sync_folder(folder);
}

bool is_abandoned_part(const fs::path& file) {
    using namespace std::chrono_literals;
    const std::optional<PartName> part = part_name(file.filename().string());
    if (!part) return false;
    const bool is_own = part->host == host();
    if (is_own && (::kill(part->process, 0) == 0 || errno != ESRCH)) return false;
    std::error_code gone;
    const auto written = fs::last_write_time(file, gone);
    // A process in another container may still be writing a file of this machine.
    const std::chrono::minutes settled = is_own ? 1min : 24h;
    return !gone && fs::file_time_type::clock::now() - written > settled;
}

void remove_abandoned_parts(const fs::path& folder) {
    std::error_code gone;
    for (fs::directory_iterator entry(folder, gone), end; !gone && entry != end; entry.increment(gone))
        if (std::error_code ignored; is_abandoned_part(entry->path())) fs::remove(entry->path(), ignored);
}

}  // namespace scanmill
