// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/work/unchanged_file.hpp"

#include <ctime>

#include "scanmill/filter/error.hpp"
#include "scanmill/filter/module.hpp"

namespace scanmill {

namespace {

bool are_equal(const timespec& a, const timespec& b) { return a.tv_sec == b.tv_sec && a.tv_nsec == b.tv_nsec; }

bool are_equal(const struct stat& a, const struct stat& b) {
    return a.st_dev == b.st_dev && a.st_ino == b.st_ino && a.st_size == b.st_size && are_equal(a.st_mtim, b.st_mtim) &&
           are_equal(a.st_ctim, b.st_ctim);
}

}  // namespace

void require_unchanged(const std::filesystem::path& file, const std::string& content) {
    if (content_hash(file) != content)
        throw Error("'{}' changed while the run was going on", file.string()).hint("run it again");
}

UnchangedWhileRead::UnchangedWhileRead(std::filesystem::path file, std::string content, bool beside)
    : file_(std::move(file)),
      content_(std::move(content)),
      before_() {
    constexpr std::time_t settled = 2;  // no file system's stamps are coarser
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
