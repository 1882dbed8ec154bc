// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/worker/unchanged_file.hpp"

#include <ctime>
#include <tuple>

#include "scanmill/base/error.hpp"
#include "scanmill/base/hash.hpp"

namespace scanmill {

namespace {

bool are_equal(const struct stat& a, const struct stat& b) {
    const auto fields = [](const struct stat& file) {
        return std::tuple(file.st_dev, file.st_ino, file.st_size, file.st_mtim.tv_sec, file.st_mtim.tv_nsec,
                          file.st_ctim.tv_sec, file.st_ctim.tv_nsec);
    };
    return fields(a) == fields(b);
}

}  // namespace

void require_unchanged(const std::filesystem::path& file, const std::string& content) {
    if (content_hash(file) != content) throw Error("'{}' changed during the run", file.string()).hint("run it again");
}

UnchangedWhileRead::UnchangedWhileRead(std::filesystem::path file, std::string content, bool beside)
    : file_(std::move(file)),
      content_(std::move(content)),
      before_() {
    constexpr std::time_t settled = 2;  // seconds; the coarsest resolution of times in file systems
    is_settled_ = ::stat(file_.c_str(), &before_) == 0 && before_.st_ctim.tv_sec < std::time(nullptr) - settled;
    if (is_settled_ && beside)
        beside_ = std::async(std::launch::async | std::launch::deferred, scanmill::require_unchanged, file_, content_);
}

void UnchangedWhileRead::require() {
    if (beside_.valid()) {
        beside_.get();
        is_hashed_ = true;
    }
    struct stat after;
    if (is_hashed_ && is_settled_ && ::stat(file_.c_str(), &after) == 0 && are_equal(before_, after)) return;
    scanmill::require_unchanged(file_, content_);
    is_hashed_ = true;
}

}  // namespace scanmill
