// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/io/mapped_file.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <system_error>

#include "scanmill/base/text.hpp"

namespace scanmill {

namespace {

struct Descriptor {
    int number;
    ~Descriptor() {
        if (number >= 0) ::close(number);
    }
};

[[noreturn]] void throw_irregular() {
    throw Error("is not a regular file (a pipe, socket or device); scans are read by mapping")
        .hint("copy the data into a file first");
}

[[noreturn]] void throw_unopened(int reason) {
    if (reason == ENOENT || reason == ENOTDIR) throw Error("there is no such file");
    if (reason == EACCES || reason == EPERM)
        throw Error("no permission to read this file").hint("ask its owner for read access (chmod +r)");
    if (reason == ENXIO) throw_irregular();  // a socket
    throw Error("cannot be opened: {}", std::generic_category().message(reason));
}

/// Advises the kernel about the pages that `part` of a mapping touches.
void advise(std::string_view part, const void* mapping, int advice) {
    static const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
    const auto begin = static_cast<std::size_t>(part.data() - static_cast<const char*>(mapping));
    const std::size_t first = begin / page * page, size = begin + part.size() - first;
    if (size > 0) ::madvise(static_cast<char*>(const_cast<void*>(mapping)) + first, size, advice);
}

}  // namespace

MappedFile::MappedFile(const std::filesystem::path& path, bool whole)
    // Without O_NONBLOCK, opening a named pipe would wait for its writer forever.
    : MappedFile(Descriptor{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)}.number, whole) {}

MappedFile::MappedFile(int descriptor, bool whole) {
    if (descriptor < 0) throw_unopened(errno);
    struct stat status;
    if (::fstat(descriptor, &status) != 0) throw_unopened(errno);
    if (S_ISDIR(status.st_mode))
        throw Error("is a folder, not a file").hint("name one file, or several by a pattern such as DIR/*.ply");
    if (!S_ISREG(status.st_mode)) throw_irregular();
    if (status.st_size == 0) throw Error("is empty (0 bytes)");
    size_ = static_cast<std::size_t>(status.st_size);
    // One call that maps all pages is faster than a page fault for every few of them.
    data_ = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE | (whole ? MAP_POPULATE : 0), descriptor, 0);
    if (data_ == MAP_FAILED)
        throw Error("its {} cannot be mapped: {}", count_text(size_, "byte", "bytes"),
                    std::generic_category().message(errno));
}

void MappedFile::fetch(std::string_view part) const noexcept {
#ifdef MADV_POPULATE_READ
    advise(part, data_, MADV_POPULATE_READ);  // older kernels refuse it, which does no harm
#endif
}

void MappedFile::release(std::string_view part) const noexcept {
    // Reading a byte maps the aligned block around it: some pages, or a whole huge page.
    constexpr std::size_t huge_page = std::size_t(2) << 20;
    const auto mapping = reinterpret_cast<std::uintptr_t>(data_), begin = reinterpret_cast<std::uintptr_t>(part.data());
    const std::uintptr_t first = std::max(mapping, begin / huge_page * huge_page);
    const std::uintptr_t end = (begin + part.size() + huge_page - 1) / huge_page * huge_page;
    advise(bytes().substr(first - mapping, end - first), data_, MADV_DONTNEED);
}

MappedFile::~MappedFile() { ::munmap(data_, size_); }

std::optional<Error> why_no_file(const std::filesystem::path& path) {
    using std::filesystem::file_type;
    std::error_code reason;
    const file_type type = std::filesystem::status(path, reason).type();
    switch (type) {
        case file_type::regular: return std::nullopt;
        case file_type::not_found: return Error("'{}': there is no such file", path.string());
        case file_type::none: return Error("'{}' cannot be examined: {}", path.string(), reason.message());
        case file_type::directory:
            return Error("'{}' is a folder, not a file", path.string())
                .hint("name one file, or several by a pattern such as DIR/*.ply");
        default:
            return Error("'{}' is a {}, not a file: its content cannot be read a second time", path.string(),
                         type == file_type::fifo     ? "pipe"
                         : type == file_type::socket ? "socket"
                                                     : "device")
                .hint("copy its content into a file first, and name that file");
    }
}

}  // namespace scanmill
