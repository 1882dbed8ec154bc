// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/files.hpp"

#include <algorithm>

#include "scanmill/base/error.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/detail/content.hpp"
#include "scanmill/io/atomic_file.hpp"
#include "scanmill/io/output_buffer.hpp"

namespace scanmill {

namespace {

/// Whether `bytes` are a text or a PLY file that begins with a byte order mark of UTF-8.
bool is_marked_text(std::string_view bytes) {
    const std::string_view head = bytes.substr(0, head_size), text = without_byte_order_mark(head);
    return text.size() < head.size() && (text.starts_with("ply") || text.find('\0') == std::string_view::npos);
}

std::string before_mark(const std::filesystem::path& path) { return path.string().substr(0, path.string().rfind('#')); }

/// Whether there is no such file, but one with the name before the last '#'.
bool is_view_of_a_file(const std::filesystem::path& path) {
    std::error_code ignored;
    return path.string().find('#') != std::string::npos && !std::filesystem::exists(path, ignored) &&
           std::filesystem::is_regular_file(before_mark(path), ignored);
}

/// `options.on_warning`, with the file's name before each sentence if the options ask for it.
OnWarning warnings_of(const std::filesystem::path& path, const ReadOptions& options) {
    return options.names_file ? warnings_with_file_name(path, options.on_warning) : options.on_warning;
}

/// Runs the action. An Error without a hint gets this one.
template <class Action>
auto with_hint(const char* hint, Action&& action) {
    try {
        return action();
    } catch (Error& error) {
        if (error.hint().empty() && error.remedy() == Remedy::none) error.set_hint(hint);
        throw;
    }
}

LoadedFile read_named(const FileBytes& file, const ReadOptions& options) {
    if (file.bytes.empty()) throw Error("is empty (0 bytes)").hint("fetch or export it again");
    const OnWarning on_warning = warnings_of(file.path, options);
    const std::optional<Array<char>> content = unwrapped(file.bytes, on_warning);
    FileBytes plain{file.path, content ? std::string_view(content->data(), content->size()) : file.bytes};
    if (is_marked_text(plain.bytes)) plain.bytes = without_byte_order_mark(plain.bytes);
    const Format& format = format_of(plain);
    if (options.view > 1 && !format.count_views)
        throw Error("has no view {}: {} files hold one", options.view, format.name).hint("name it without #");
    LoadedFile loaded = with_hint("fetch or export it again, or convert it to PLY by the program that made it", [&] {
        return format.read(plain, {on_warning, options.unit, true, options.view});
    });
    if (content) loaded.encoding += wrapping_of(file.bytes) == Wrapping::gzip ? ", gzip" : ", UTF-16";
    return loaded;
}

/// The writer for the file's extension and the value's kind. Throws Error if there is none, or for a value without
/// points. Features may be empty, because a closed, smooth mesh has none.
Format::Write writer_for(const std::filesystem::path& path, const Value& value) {
    const Kind kind = kind_of(value);
    const std::string extension = path.extension().string();
    for (const Format& format : formats()) {
        const Format::Write write = format.has_extension(extension) ? format.writer(kind) : nullptr;
        if (!write) continue;
        if (is_geometric(kind) && !value.find<FeatureGraph>() && positions_of(value).empty())
            throw Error("nothing to write: the {} has no points", name_of(kind));
        return write;
    }
    const std::string choices = writable_extensions(kind);
    if (const std::string reason = why_unusable(extension); !reason.empty())
        throw Error("{} cannot be written with the extension '{}': {}", name_of(kind), extension, reason);
    throw Error("{} cannot be written with the extension '{}'", name_of(kind), extension)
        .hint(choices.empty() ? "no file format can hold this kind" : "extensions for it: " + choices);
}

}  // namespace

LoadedFile read_file(const std::filesystem::path& path, const ReadOptions& options) {
    return with_file_name(path, [&] {
        const FileView source = file_view(path);
        if (is_view_of_a_file(source.file))
            throw Error("there is no such view").hint("views are counted from 1: " + before_mark(path) + "#1");
        const MappedFile file(source.file);
        ReadOptions of_view = options;
        if (source.view > 0) of_view.view = source.view;
        return read_named({path, file.bytes()}, of_view);
    });
}

u32 count_views(const std::filesystem::path& path) {
    try {
        const MappedFile file(path, false);
        const std::optional<Array<char>> content = unwrapped(file.bytes());
        const FileBytes plain{path, content ? std::string_view(content->data(), content->size()) : file.bytes()};
        const Format& format = format_of(plain);
        return format.count_views ? std::max(1u, format.count_views(plain.bytes)) : 1;
    } catch (const Error&) {
        return 1;  // read_file() throws the Error again, with the file's name
    }
}

u64 memory_to_read(const std::filesystem::path& path) {
    try {
        const MappedFile file(file_view(path).file, false);
        const double per_byte = wrapping_of(file.bytes()) == Wrapping::none
                                    ? format_of({path, file.bytes()}).memory_per_byte
                                    : Format().memory_per_byte;
        return static_cast<u64>(per_byte * static_cast<double>(file.bytes().size()));
    } catch (const Error&) {
        return 0;  // read_file() throws the Error again, with the file's name
    }
}

void require_memory_to_read(const std::filesystem::path& path, u64 available) {
    const u64 need = memory_to_read(path);
    if (need <= available) return;
    throw Error("'{}': it has {}; reading it needs up to {} of memory, and {} are available", path.string(),
                byte_size_text(std::filesystem::file_size(file_view(path).file)), byte_size_text(need),
                byte_size_text(available))
        .hint(
            "thin or split it first, use a machine with more memory, or store points as binary PLY with vertices "
            "only, LAS or LAZ, which are read piece by piece where the workflow allows it");
}

LoadedFile read_bytes(std::string_view bytes, const std::filesystem::path& name, const ReadOptions& options) {
    return with_file_name(name, [&] { return read_named({name, bytes}, options); });
}

namespace {

std::shared_ptr<const PointCloud> points_in(const LoadedFile& loaded, const std::filesystem::path& path,
                                            const ReadOptions& options) {
    if (loaded.value.find<PointCloud>()) return loaded.value.get<PointCloud>();
    const TriangleMesh* mesh = loaded.value.find<TriangleMesh>();
    if (!mesh)
        throw Error("'{}': points are needed; the file contains {}", path.string(), name_of(loaded.value.kind()));
    warn(warnings_of(path, options), "read as points; {} left out",
         count_text(mesh->triangles.size(), "triangle was", "triangles were"));
    return std::make_shared<const PointCloud>(points_of(*mesh));
}

}  // namespace

std::shared_ptr<const PointCloud> read_points(const std::filesystem::path& path, const ReadOptions& options) {
    return points_in(read_file(path, options), path, options);
}

Cleaned<PointCloud> accepted_points(const LoadedFile& loaded, const std::filesystem::path& path,
                                    const ReadOptions& options, InvalidRows rule) {
    const std::shared_ptr<const PointCloud> cloud = points_in(loaded, path, options);
    Cleaned<PointCloud> result = with_file_name(path, [&] { return accepted(*cloud, rule, loaded.nan_is_no_return); });
    if (result.points > 0)
        warn(warnings_of(path, options), "{} of {} {} dropped: {}", result.points,
             count_text(cloud->size(), "point", "points"), by_count(result.points, "was", "were"),
             loaded.nan_is_no_return ? "no return, or a coordinate that is too far"
                                     : "a coordinate is NaN, infinite or too far");
    return result;
}

std::shared_ptr<const TriangleMesh> read_mesh(const std::filesystem::path& path, const ReadOptions& options) {
    const LoadedFile loaded = read_file(path, options);
    if (loaded.value.find<TriangleMesh>()) return loaded.value.get<TriangleMesh>();
    const PointCloud* points = loaded.value.find<PointCloud>();
    if (!points)
        throw Error("'{}': a mesh is needed; the file contains {}", path.string(), name_of(loaded.value.kind()));
    throw Error("'{}': a mesh is needed; the file has {} and no faces", path.string(),
                count_text(points->size(), "point", "points"))
        .hint("make a surface of the points first, with a workflow whose filters turn points into a mesh");
}

std::unique_ptr<PointStream> open_point_stream(const std::filesystem::path& path, const ReadOptions& options,
                                               unsigned threads, const OnWorldPositions& on_positions) {
    try {
        const FileView source = file_view(path);
        if (source.view > 1) return nullptr;  // no streamed format holds several
        auto file = std::make_unique<MappedFile>(source.file, false);
        if (wrapping_of(file->bytes()) != Wrapping::none) return nullptr;
        const Format& format = format_of({path, file->bytes()});
        if (format.open_stream)
            return format.open_stream(std::move(file), {warnings_of(path, options), options.unit}, threads,
                                      on_positions);
    } catch (const Error&) {
        // read_points() throws the Error again, with the file's name.
    }
    return nullptr;
}

bool may_be_point_stream(const std::filesystem::path& path) {
    try {
        const FileView source = file_view(path);
        if (source.view > 1) return false;
        const MappedFile file(source.file, false);
        if (wrapping_of(file.bytes()) != Wrapping::none) return false;
        const Format& format = format_of({path, file.bytes()});
        return format.may_stream && format.may_stream(file.bytes());
    } catch (const Error&) {
        return false;
    }
}

void write_file(const std::filesystem::path& path, const Value& value, const WriteOptions& options) {
    with_file_name(path, [&] {
        const Format::Write write = writer_for(path, value);
        AtomicFile file(path);
        OutputBuffer out([&](std::string_view bytes) {
            file.write(bytes);
            if (options.on_bytes) options.on_bytes(bytes);
        });
        WriteOptions named = options;
        named.on_warning = warnings_with_file_name(path, options.on_warning);
        write(value, out, named);
        out.flush();
        file.commit();
    });
}

std::string write_bytes(const std::filesystem::path& name, const Value& value, const WriteOptions& options) {
    return with_file_name(name, [&] {
        std::string bytes;
        OutputBuffer out([&bytes](std::string_view piece) { bytes += piece; });
        WriteOptions named = options;
        named.on_warning = warnings_with_file_name(name, options.on_warning);
        writer_for(name, value)(value, out, named);
        out.flush();
        return bytes;
    });
}

}  // namespace scanmill
