// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/files.hpp"

#include "scanmill/base/error.hpp"
#include "scanmill/data/conversions.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/registry.hpp"
#include "scanmill/io/atomic_file.hpp"
#include "scanmill/io/mapped_file.hpp"
#include "scanmill/io/output_buffer.hpp"

namespace scanmill {

namespace {

/// Readers and writers speak of "line 12"; which file that is, is added here, once, to errors and warnings alike.
template <class Action>
auto naming(const std::filesystem::path& path, Action&& action) {
    try {
        return action();
    } catch (const Error& error) {
        throw error.reworded(fmt::format("'{}': {}", path.string(), error.sentence()));
    }
}

std::function<void(std::string)> naming(const std::filesystem::path& path,
                                        const std::function<void(std::string)>& on_warning) {
    if (!on_warning) return {};
    return [path, &on_warning](std::string sentence) { on_warning("'" + path.string() + "': " + sentence); };
}

LoadedFile read_named(const FileBytes& file, const ReadOptions& options) {
    if (file.bytes.empty()) throw Error("is empty (0 bytes)");
    return format_of(file).read(file, {naming(file.path, options.on_warning), options.unit});
}

/// Whether nothing is there that should be. A closed, smooth mesh has no features, and that is worth writing.
bool is_empty(const Value& value) {
    return is_geometric(value.kind()) && !value.find<FeatureGraph>() && positions_of(value).empty();
}

Format::Write writer_for(const std::filesystem::path& path, const Value& value) {
    const Kind kind = kind_of(value);
    const std::string extension = path.extension().string();
    for (const Format& format : formats()) {
        const Format::Write write = format.has_extension(extension) ? format.writer(kind) : nullptr;
        if (!write) continue;
        if (is_empty(value)) throw Error("nothing to write: the {} without a single point", name_of(kind));
        return write;
    }
    const std::string choices = writable_extensions(kind);
    if (const std::string reason = why_unusable(extension); !reason.empty())
        throw Error("{} cannot be written with the extension '{}': {}", name_of(kind), extension, reason);
    Error error("{} cannot be written with the extension '{}'", name_of(kind), extension);
    if (choices.empty())
        error.set_hint("no format here carries this kind");
    else
        error.set_hint("extensions for it: " + choices);
    throw error;
}

}  // namespace

LoadedFile read_file(const std::filesystem::path& path, const ReadOptions& options) {
    return naming(path, [&] {
        const MappedFile file(path);
        return read_named({path, file.bytes()}, options);
    });
}

LoadedFile read_bytes(std::string_view bytes, const std::filesystem::path& name, const ReadOptions& options) {
    return naming(name, [&] { return read_named({name, bytes}, options); });
}

std::shared_ptr<const PointCloud> read_points(const std::filesystem::path& path, const ReadOptions& options) {
    const LoadedFile loaded = read_file(path, options);
    if (loaded.value.find<PointCloud>()) return loaded.value.get<PointCloud>();
    const TriangleMesh* mesh = loaded.value.find<TriangleMesh>();
    if (!mesh)
        throw Error("'{}': points are needed; the file contains {}", path.string(), name_of(loaded.value.kind()));
    warn(options.on_warning, "'{}': points were asked for; {} left out", path.string(),
         count_text(mesh->triangles.size(), "triangle was", "triangles were"));
    return std::make_shared<const PointCloud>(points_of(*mesh));
}

std::shared_ptr<const TriangleMesh> read_mesh(const std::filesystem::path& path, const ReadOptions& options) {
    const LoadedFile loaded = read_file(path, options);
    if (loaded.value.find<TriangleMesh>()) return loaded.value.get<TriangleMesh>();
    const PointCloud* points = loaded.value.find<PointCloud>();
    if (!points)
        throw Error("'{}': a mesh is needed; the file contains {}", path.string(), name_of(loaded.value.kind()));
    throw Error("'{}': a mesh is needed; the file holds {} and not a single face", path.string(),
                count_text(points->size(), "point", "points"))
        .hint("make a surface of the points first, by a workflow of filters that lead from points to a mesh");
}

void write_file(const std::filesystem::path& path, const Value& value, const WriteOptions& options) {
    naming(path, [&] {
        const Format::Write write = writer_for(path, value);
        AtomicFile file(path);
        OutputBuffer out([&](std::string_view bytes) {
            file.write(bytes);
            if (options.on_bytes) options.on_bytes(bytes);
        });
        write(value, out, {naming(path, options.on_warning)});
        out.flush();
        file.commit();
    });
}

std::string write_bytes(const std::filesystem::path& name, const Value& value, const WriteOptions& options) {
    return naming(name, [&] {
        std::string bytes;
        OutputBuffer out([&bytes](std::string_view piece) { bytes += piece; });
        writer_for(name, value)(value, out, {naming(name, options.on_warning)});
        out.flush();
        return bytes;
    });
}

}  // namespace scanmill
