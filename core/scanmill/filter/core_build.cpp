// SPDX-License-Identifier: GPL-3.0-or-later
#include <link.h>

#include <cstring>
#include <string>

#include <fmt/format.h>

#include "scanmill/filter/module.hpp"

namespace scanmill {

namespace {

/// The library that holds an address, and the build id that its linker left in it.
struct Search {
    ElfW(Addr) address;
    std::string build_id;
};

std::size_t padded(std::size_t size) { return (size + 3) / 4 * 4; }

void read_notes(const char* notes, std::size_t size, Search& search) {
    constexpr std::string_view owner{"GNU\0", 4};
    const char* const end = notes + size;
    while (end - notes >= static_cast<std::ptrdiff_t>(sizeof(ElfW(Nhdr)))) {
        ElfW(Nhdr) note;
        std::memcpy(&note, notes, sizeof note);
        const char* const name = notes + sizeof note;
        const char* const content = name + padded(note.n_namesz);
        if (note.n_type == NT_GNU_BUILD_ID && std::string_view(name, note.n_namesz) == owner)
            for (std::size_t i = 0; i < note.n_descsz; ++i)
                search.build_id += fmt::format("{:02x}", static_cast<unsigned char>(content[i]));
        notes = content + padded(note.n_descsz);
    }
}

int look_into(dl_phdr_info* library, std::size_t, void* data) {
    Search& search = *static_cast<Search*>(data);
    const auto each = [&](auto&& action) {
        for (const auto* segment = library->dlpi_phdr; segment != library->dlpi_phdr + library->dlpi_phnum; ++segment)
            action(*segment, library->dlpi_addr + segment->p_vaddr);
    };
    bool is_ours = false;
    each([&](const auto& segment, ElfW(Addr) begin) {
        is_ours |= segment.p_type == PT_LOAD && search.address >= begin && search.address < begin + segment.p_memsz;
    });
    if (!is_ours) return 0;
    each([&](const auto& segment, ElfW(Addr) begin) {
        if (segment.p_type == PT_NOTE) read_notes(reinterpret_cast<const char*>(begin), segment.p_memsz, search);
    });
    return 1;
}

}  // namespace

std::string core_build() {
    Search search{reinterpret_cast<ElfW(Addr)>(&look_into), {}};
    ::dl_iterate_phdr(look_into, &search);
    return search.build_id.empty() ? content_hash(core_library_file()) : search.build_id;
}

}  // namespace scanmill
