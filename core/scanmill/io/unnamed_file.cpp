// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/io/unnamed_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <system_error>

namespace scanmill {

namespace {

[[noreturn]] void throw_failed(const char* action, int reason) {
    const char* const folder = std::getenv("TMPDIR");
    throw Error::of_writing(fmt::format("a temporary file cannot be {} in '{}': {}", action, folder ? folder : "/tmp",
                                        std::generic_category().message(reason)),
                            reason)
        .hint("set TMPDIR to a folder with more free space");
}

}  // namespace

UnnamedFile::UnnamedFile() {
    std::error_code unusable;
    const std::filesystem::path folder = std::filesystem::temp_directory_path(unusable);
    if (!unusable) descriptor_ = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (!unusable && descriptor_ < 0) {
        // Some file systems have no unnamed files.
        std::string name = (folder / "scanmill-XXXXXX").string();
        descriptor_ = ::mkostemp(name.data(), O_CLOEXEC);
        if (descriptor_ >= 0) ::unlink(name.c_str());
    }
    if (descriptor_ < 0) throw_failed("made", unusable ? unusable.value() : errno);
}

UnnamedFile::~UnnamedFile() { ::close(descriptor_); }

void UnnamedFile::append(std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) throw_failed("written", errno);
        bytes.remove_prefix(static_cast<std::size_t>(written));
    }
}

std::unique_ptr<MappedFile> UnnamedFile::map() const {
    return std::unique_ptr<MappedFile>(new MappedFile(descriptor_, false));
}

}  // namespace scanmill
