// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/format_modules.hpp"

#include <algorithm>
#include <mutex>
#include <optional>

#include "scanmill/base/error.hpp"
#include "scanmill/plugin/module.hpp"

namespace scanmill {

namespace {

/// A module that is loaded by the first thread that needs it.
struct LazyModule {
    const FormatDeclaration& declaration() {
        const std::scoped_lock lock(mutex);
        if (!loaded) {
            FormatDeclaration found = load_format_module(file, name);
            if (found.spec != spec) throw_manifest_differs(file);
            loaded = std::move(found);
        }
        return *loaded;
    }

    std::filesystem::path file;
    std::string name;
    FormatSpec spec;
    std::mutex mutex{};
    std::optional<FormatDeclaration> loaded{};
};

Format row_of(const std::filesystem::path& manifest_file, const std::string& name) {
    const FormatManifest manifest = parse_format_manifest(manifest_text(manifest_file));
    const FormatSpec& spec = manifest.spec;
    const std::shared_ptr<LazyModule> module(new LazyModule{module_beside(manifest_file, manifest.abi), name, spec});
    Format row;
    row.name = spec.name;
    row.extensions = spec.extensions;
    row.recognises = [begins = spec.begins](std::string_view head, u64) {
        const auto at_start = [&](const std::string& text) { return head.starts_with(text); };
        return std::ranges::any_of(begins, at_start) ? Recognition::certain : Recognition::no;
    };
    row.memory_per_byte = spec.memory_per_byte;
    row.is_refused = !spec.reads;
    if (spec.reads)
        row.read = [module](const FileBytes& file, const ReadOptions& options) {
            return module->declaration().read(file, options);
        };
    else
        row.read = [format = spec.name](const FileBytes&, const ReadOptions&) -> LoadedFile {
            throw Error("{} is written for other programs, and not read", format)
                .hint("read the file that it was made from; PLY keeps everything and is read");
        };
    if (spec.streams) {
        row.may_stream = [module](std::string_view file) { return module->declaration().may_stream(file); };
        row.open_stream = [module](std::unique_ptr<MappedFile> file, const ReadOptions& options, unsigned threads,
                                   const OnWorldPositions& on_positions) {
            return module->declaration().open_stream(std::move(file), options, threads, on_positions);
        };
    }
    if (spec.has_views)
        row.count_views = [module](std::string_view file) { return module->declaration().count_views(file); };
    for (std::size_t i = 0; i < spec.writes.size(); ++i)
        row.writers.emplace_back(spec.writes[i],
                                 [module, i](const Value& value, OutputBuffer& out, const WriteOptions& options) {
                                     module->declaration().writers[i].second(value, out, options);
                                 });
    return row;
}

/// The row of an unusable module. Reading a file of this format throws Error with the reason.
Format unusable_row(const std::string& name, const std::filesystem::path& manifest, const std::string& reason) {
    Format row;
    row.name = name;
    for (char& c : row.name) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    row.extensions = {name};
    row.recognises = [](std::string_view, u64) { return Recognition::no; };
    row.unusable = fmt::format("the module's manifest '{}' {}", manifest.string(), reason);
    row.read = [format = row.name, why = row.unusable](const FileBytes&, const ReadOptions&) -> LoadedFile {
        throw Error("{} cannot be read: {}", format, why);
    };
    return row;
}

}  // namespace

FormatDeclaration load_format_module(const std::filesystem::path& module, const std::string& name) {
    FormatDeclaration declaration;
    load_declaration(module, "scanmill-format", "file format", name, &declaration);
    if (bool(declaration.read) != declaration.spec.reads || bool(declaration.may_stream) != declaration.spec.streams ||
        bool(declaration.open_stream) != declaration.spec.streams ||
        bool(declaration.count_views) != declaration.spec.has_views ||
        !std::ranges::equal(declaration.writers, declaration.spec.writes, {}, &std::pair<Kind, Format::Write>::first))
        throw Error("module '{}' declares other functions than it contains", module.string());
    return declaration;
}

std::vector<Format> format_modules(const std::filesystem::path& folder) {
    std::vector<Format> rows;
    for (const std::filesystem::path& manifest : module_manifests(folder)) {
        const std::string name = module_name(manifest);
        try {
            rows.push_back(row_of(manifest, name));
        } catch (const Error& error) {
            rows.push_back(unusable_row(name, manifest, error.sentence()));
        }
    }
    return rows;
}

std::vector<Format> module_formats() { return format_modules(installed_format_folder()); }

}  // namespace scanmill
