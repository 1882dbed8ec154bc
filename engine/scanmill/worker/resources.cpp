// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/worker/resources.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <string>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"

namespace scanmill {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)

MemoryLimit::MemoryLimit(u64, unsigned) {}
MemoryLimit::~MemoryLimit() = default;

#else

MemoryLimit::MemoryLimit(u64 bytes, unsigned threads) {
    rlimit limit{};
    if (bytes == 0) return;
    constexpr u64 largest_stack = u64(64) << 20;
    if (::getrlimit(RLIMIT_STACK, &limit) == 0) bytes += threads * std::min<u64>(limit.rlim_cur, largest_stack);
    if (::getrlimit(RLIMIT_DATA, &limit) != 0 || bytes >= limit.rlim_cur) return;
    before_ = limit.rlim_cur;
    limit.rlim_cur = bytes;
    is_set_ = ::setrlimit(RLIMIT_DATA, &limit) == 0;
}

MemoryLimit::~MemoryLimit() {
    if (!is_set_) return;
    rlimit limit{};
    ::getrlimit(RLIMIT_DATA, &limit);
    limit.rlim_cur = before_;
    ::setrlimit(RLIMIT_DATA, &limit);
}

#endif

namespace {

/// CPU time of all threads of this process, in seconds.
double cpu_seconds() {
    rusage used{};
    ::getrusage(RUSAGE_SELF, &used);
    const auto seconds = [](const timeval& time) {
        return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    };
    return seconds(used.ru_utime) + seconds(used.ru_stime);
}

/// Makes the kernel measure the peak of resident memory from now on.
void reset_peak() {
    const int file = ::open("/proc/self/clear_refs", O_WRONLY | O_CLOEXEC);
    if (file < 0) return;
    [[maybe_unused]] const ssize_t ignored = ::write(file, "5", 1);
    ::close(file);
}

u64 kibibytes_after(const std::string& text, std::string_view name) {
    const std::size_t begin = text.find(name);
    return begin == std::string::npos ? 0 : std::strtoull(text.c_str() + begin + name.size(), nullptr, 10) * 1024;
}

}  // namespace

ResourceUse::ResourceUse() : start_(std::chrono::steady_clock::now()), cpu_seconds_(scanmill::cpu_seconds()) {
    reset_peak();
}

Effort ResourceUse::until_now() const {
    Effort effort;
    effort.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    effort.cpu_seconds = scanmill::cpu_seconds() - cpu_seconds_;
    effort.peak_memory = resident_memory(::getpid()).peak;
    return effort;
}

ResidentMemory resident_memory(int process) {
    std::array<char, 4096> text;
    const int file = ::open(fmt::format("/proc/{}/status", process).c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) return {};
    const ssize_t length = ::read(file, text.data(), text.size());
    ::close(file);
    if (length <= 0) return {};
    const std::string status(text.data(), static_cast<std::size_t>(length));
    return {kibibytes_after(status, "VmRSS:"), kibibytes_after(status, "VmHWM:"), kibibytes_after(status, "RssAnon:")};
}

namespace {

namespace fs = std::filesystem;

constexpr const char* prefix = "scanmill-scratch-";

/// Opens and locks the folder. Returns its descriptor, or -1 if another process has the lock or it cannot be opened.
int locked(const fs::path& folder) {
    const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW);
    if (descriptor >= 0 && ::flock(descriptor, LOCK_EX | LOCK_NB) == 0) return descriptor;
    if (descriptor >= 0) ::close(descriptor);
    return -1;
}

void remove_abandoned(const fs::path& parent) {
    std::error_code gone;
    for (fs::directory_iterator entry(parent, gone), end; !gone && entry != end; entry.increment(gone)) {
        const fs::path& folder = entry->path();
        if (!folder.filename().string().starts_with(prefix)) continue;
        std::error_code ignored;
        // Another process may have created the folder and not locked it yet.
        constexpr std::chrono::minutes settled(1);
        const auto written = fs::last_write_time(folder, ignored);
        if (ignored || fs::file_time_type::clock::now() - written < settled) continue;
        if (const int lock = locked(folder); lock >= 0) {
            fs::remove_all(folder, ignored);
            ::close(lock);
        }
    }
}

}  // namespace

ScratchFolder::ScratchFolder() {
    std::error_code unusable;
    const fs::path parent = fs::temp_directory_path(unusable);
    if (!unusable) remove_abandoned(parent);
    std::string name = (parent / (std::string(prefix) + "XXXXXX")).string();
    if (unusable || !::mkdtemp(name.data())) {
        const char* folder = std::getenv("TMPDIR");
        throw Error("no scratch folder could be made in '{}'", folder ? folder : "/tmp")
            .hint("set TMPDIR to a folder that can be written to");
    }
    path_ = name;
    lock_ = locked(path_);
}

ScratchFolder::~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
    if (lock_ >= 0) ::close(lock_);
}

fs::path ScratchFolder::folder(const std::string& name) const {
    const fs::path folder = path_ / name;
    std::error_code trouble;
    fs::remove_all(folder, trouble);
    fs::create_directory(folder, trouble);
    if (trouble)
        throw Error("no scratch folder could be made in '{}': {}", path_.string(), trouble.message())
            .hint("set TMPDIR to a folder with more free space");
    return folder;
}

}  // namespace scanmill
