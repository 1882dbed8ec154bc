// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/session/output_lock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <system_error>

#include "scanmill/workflow/sizes.hpp"

namespace scanmill {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

fs::path lock_file(const fs::path& folder) { return folder / "scanmill.lock"; }

struct flock whole_file() {
    struct flock range {};
    range.l_type = F_WRLCK;
    range.l_whence = SEEK_SET;
    return range;
}

double seconds_since_1970() {
    return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

std::string host() {
    std::array<char, 256> name{};
    return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

std::string holder_text(const std::vector<std::string>& command_line) {
    std::string command;
    for (const std::string& word : command_line) command += (command.empty() ? "" : " ") + word;
    const Json json{{"process", ::getpid()}, {"host", host()}, {"since", seconds_since_1970()}, {"command", command}};
    return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string content_of(int descriptor) {
    std::string text(4096, '\0');
    const ssize_t length = ::pread(descriptor, text.data(), text.size(), 0);
    text.resize(length > 0 ? static_cast<std::size_t>(length) : 0);
    return text;
}

/// "process 4711 (scanmill batch b.yaml) has been writing to it for 3 min"
std::string describe_holder(const std::string& text) {
    const Json json = Json::parse(text, nullptr, false);
    try {
        const std::string other = json.at("host");
        const double seconds = std::max(0.0, seconds_since_1970() - json.at("since").get<double>());
        const double unit = seconds >= 3600 ? 360 : seconds >= 60 ? 60 : 1;
        return fmt::format("process {}{} ({}) has been writing to it for {}", json.at("process").get<int>(),
                           other == host() ? "" : fmt::format(" on {}", other), json.at("command").get<std::string>(),
                           duration_text(unit * std::floor(seconds / unit)));
    } catch (const Json::exception&) {
        return "another process is writing to it";
    }
}

bool is_same_file(int descriptor, const fs::path& file) {
    struct stat opened, named;
    return ::fstat(descriptor, &opened) == 0 && ::stat(file.c_str(), &named) == 0 && opened.st_dev == named.st_dev &&
           opened.st_ino == named.st_ino;
}

}  // namespace

OutputLock::OutputLock(const fs::path& folder, const std::vector<std::string>& command_line,
                       const std::function<void(std::string)>& warn)
    : file_(lock_file(folder)) {
    const auto give_up = [&] {
        warn(fmt::format("'{}' cannot be locked: {}; do not start another run into this folder", file_.string(),
                         std::generic_category().message(errno)));
        if (descriptor_ >= 0) ::close(descriptor_);
        descriptor_ = -1;
    };
    for (;;) {
        descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
        if (descriptor_ < 0) {
            give_up();
            return;
        }
        struct flock range = whole_file();
        if (::fcntl(descriptor_, F_OFD_SETLK, &range) != 0) {
            if (errno != EAGAIN && errno != EACCES) {
                give_up();
                return;
            }
            const std::string holder = content_of(descriptor_);
            ::close(descriptor_);
            throw FolderInUse(Error("the output folder '{}' is in use: {}", folder.string(), describe_holder(holder))
                                  .hint("wait until it has ended, or choose another output folder")
                                  .remedy(Remedy::choose_output_folder));
        }
        if (is_same_file(descriptor_, file_)) break;
        ::close(descriptor_);  // the holder of the lock removed the file after it was opened here
    }
    const std::string text = holder_text(command_line);
    [[maybe_unused]] const bool ignored =
        ::ftruncate(descriptor_, 0) == 0 &&
        ::pwrite(descriptor_, text.data(), text.size(), 0) > 0;  // the text is only for messages
}

OutputLock::~OutputLock() {
    if (descriptor_ < 0) return;
    ::unlink(file_.c_str());  // remove the file while this process still holds the lock
    ::close(descriptor_);
}

bool OutputLock::is_held(const fs::path& folder) {
    const int descriptor = ::open(lock_file(folder).c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) return false;
    struct flock range = whole_file();
    const bool is_held = ::fcntl(descriptor, F_OFD_GETLK, &range) == 0 && range.l_type != F_UNLCK;
    ::close(descriptor);
    return is_held;
}

}  // namespace scanmill
