// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/worker/scratch_folder.hpp"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/file.h>
#include <unistd.h>

#include <cstdlib>

#include "scanmill/base/error.hpp"

namespace scanmill {

namespace {

namespace fs = std::filesystem;

constexpr const char* prefix = "scanmill-scratch-";

/// The folder's own descriptor with its lock; -1 when somebody else has it, or it is not ours to open.
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
        // A folder that was just made is not locked yet.
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
        const char* told = std::getenv("TMPDIR");
        throw Error("no scratch folder could be made in '{}'", told ? told : "/tmp")
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
            .hint("set TMPDIR to a folder with room");
    return folder;
}

}  // namespace scanmill
