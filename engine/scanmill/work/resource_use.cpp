// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/work/resource_use.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <string>

namespace scanmill {

namespace {

/// Of this process until now, all threads together.
double cpu_seconds() {
    rusage used{};
    ::getrusage(RUSAGE_SELF, &used);
    const auto seconds = [](const timeval& time) {
        return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    };
    return seconds(used.ru_utime) + seconds(used.ru_stime);
}

/// The kernel then counts the peak of resident memory from what is resident now.
void reset_peak() {
    const int file = ::open("/proc/self/clear_refs", O_WRONLY | O_CLOEXEC);
    if (file < 0) return;
    [[maybe_unused]] const ssize_t ignored = ::write(file, "5", 1);
    ::close(file);
}

u64 kibibytes_after(const std::string& text, std::string_view name) {
    const std::size_t place = text.find(name);
    return place == std::string::npos ? 0 : std::strtoull(text.c_str() + place + name.size(), nullptr, 10) * 1024;
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

}  // namespace scanmill
