// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/open_point_stream.hpp"

#include <algorithm>
#include <array>

#include "scanmill/base/error.hpp"
#include "scanmill/formats/ply/ply.hpp"
#include "scanmill/formats/registry.hpp"
#include "scanmill/formats/text/text.hpp"

namespace scanmill {

namespace {

struct PointStreamKind {
    std::string_view format;  ///< Format::name
    decltype(&may_be_ply_stream) may_be;
    decltype(&open_ply_stream) open;
};

constexpr std::array<PointStreamKind, 3> kinds{{{"PLY", may_be_ply_stream, open_ply_stream},
                                                {"XYZ", may_be_text_stream, open_text_stream},
                                                {"CSV", may_be_text_stream, open_text_stream}}};

/// nullptr when files of the format are not read piece by piece. Throws Error when it is not known.
const PointStreamKind* kind_of(const std::filesystem::path& path, std::string_view bytes) {
    const auto found = std::ranges::find(kinds, format_of({path, bytes}).name, &PointStreamKind::format);
    return found == kinds.end() ? nullptr : found;
}

}  // namespace

std::unique_ptr<PointStream> open_point_stream(const std::filesystem::path& path, const ReadOptions& options,
                                               unsigned threads, const OnWorldPositions& on_positions) {
    ReadOptions named = options;
    if (options.on_warning)
        named.on_warning = [&](std::string text) { options.on_warning("'" + path.string() + "': " + text); };
    try {
        auto file = std::make_unique<MappedFile>(path, false);
        if (const PointStreamKind* kind = kind_of(path, file->bytes()))
            return kind->open(std::move(file), named, threads, on_positions);
    } catch (const Error&) {
        // Whoever reads the file whole says it, with the file's name.
    }
    return nullptr;
}

bool may_be_point_stream(const std::filesystem::path& path) {
    try {
        const MappedFile file(path, false);
        const PointStreamKind* kind = kind_of(path, file.bytes());
        return kind && kind->may_be(file.bytes());
    } catch (const Error&) {
        return false;
    }
}

}  // namespace scanmill
