// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/work/process_state.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cfenv>
#include <clocale>
#include <filesystem>

#include "scanmill/filter/counted.hpp"
#include "scanmill/work/resource_use.hpp"

namespace scanmill {

namespace {

namespace fs = std::filesystem;

std::size_t count_open_files() {
    std::error_code unknown;
    std::size_t count = 0;
    for (fs::directory_iterator entry("/proc/self/fd", unknown), end; !unknown && entry != end;
         entry.increment(unknown))
        ++count;
    return count;
}

std::string all_of_environment() {
    std::string all;
    for (char** entry = environ; entry && *entry; ++entry) all.append(*entry).push_back('\0');
    return all;
}

unsigned file_mask() {
    const mode_t mask = ::umask(0);
    ::umask(mask);
    return mask;
}

}  // namespace

ProcessState ProcessState::now() {
    ProcessState state;
    std::error_code gone;
    state.folder_ = fs::current_path(gone).string();
    state.locale_ = std::setlocale(LC_ALL, nullptr);
    state.environment_ = all_of_environment();
    state.file_mask_ = file_mask();
    state.rounding_ = std::fegetround();
    state.open_files_ = count_open_files();
    return state;
}

std::string ProcessState::changes_since(const ProcessState& before) const {
    if (open_files_ > before.open_files_)
        return counted(open_files_ - before.open_files_, "more file is open", "more files are open");
    if (open_files_ < before.open_files_) return "files were closed that somebody else had opened";
    if (folder_ != before.folder_) return "the working folder changed";
    if (locale_ != before.locale_) return "the locale changed";
    if (environment_ != before.environment_) return "the environment changed";
    if (file_mask_ != before.file_mask_) return "the file mask changed";
    if (rounding_ != before.rounding_) return "the rounding of numbers changed";
    return {};
}

u64 anonymous_memory() { return resident_memory(::getpid()).anonymous; }

}  // namespace scanmill
