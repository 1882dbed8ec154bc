// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/io/mapped_file.hpp"
#include "scanmill/base/text.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <system_error>

#include "scanmill/base/error.hpp"

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

/// Those of a mapping that a part of it touches.
struct Pages {
    char* begin;
    std::size_t size;
};

Pages pages_of(std::string_view part, const char* mapping) {
    static const std::size_t page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
    const std::size_t begin = static_cast<std::size_t>(part.data() - mapping), end = begin + part.size();
    const std::size_t first = begin / page * page;
    return {const_cast<char*>(mapping) + first, end - first};
}

}  // namespace

MappedFile::MappedFile(const std::filesystem::path& path, bool whole) {
    // Without O_NONBLOCK, opening a named pipe would wait for its writer forever.
    const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
    if (file.number < 0) throw_unopened(errno);
    struct stat status;
    if (::fstat(file.number, &status) != 0) throw_unopened(errno);
    if (S_ISDIR(status.st_mode))
        throw Error("is a folder, not a file").hint("name one scan, or use a pattern as DIR/*.ply");
    if (!S_ISREG(status.st_mode)) throw_irregular();
    if (status.st_size == 0) throw Error("is empty (0 bytes)");
    size_ = static_cast<std::size_t>(status.st_size);
    // One call that maps all pages beats a fault for every few of them.
    data_ = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE | (whole ? MAP_POPULATE : 0), file.number, 0);
    if (data_ == MAP_FAILED)
        throw Error("its {} cannot be mapped: {}", count_text(size_, "byte", "bytes"),
                    std::generic_category().message(errno));
}

void MappedFile::fetch(std::string_view part) const noexcept {
#ifdef MADV_POPULATE_READ
    const Pages pages = pages_of(part, static_cast<const char*>(data_));
    if (pages.size > 0) ::madvise(pages.begin, pages.size, MADV_POPULATE_READ);  // an older kernel refuses: no harm
#endif
}

void MappedFile::release(std::string_view part) const noexcept {
    // Whatever is touched, the system maps the aligned block around it: some pages, or a whole large one.
    constexpr std::size_t huge_page = std::size_t(2) << 20;
    const auto mapping = reinterpret_cast<std::uintptr_t>(data_), begin = reinterpret_cast<std::uintptr_t>(part.data());
    const std::uintptr_t first = std::max(mapping, begin / huge_page * huge_page);
    const std::uintptr_t end = (begin + part.size() + huge_page - 1) / huge_page * huge_page;
    const Pages pages = pages_of(bytes().substr(first - mapping, end - first), static_cast<const char*>(data_));
    if (pages.size > 0) ::madvise(pages.begin, pages.size, MADV_DONTNEED);
}

MappedFile::~MappedFile() { ::munmap(data_, size_); }

}  // namespace scanmill
