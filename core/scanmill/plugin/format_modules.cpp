// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/format_modules.hpp"

#include <algorithm>
#include <fstream>
#include <mutex>
#include <optional>
#include <sstream>

#include "scanmill/base/error.hpp"
#include "scanmill/plugin/module.hpp"

namespace scanmill {

namespace {

/// A module that is loaded once, by whichever thread needs it first.
class LazyModule {
public:
    LazyModule(std::filesystem::path module, std::string name, FormatSpec spec)
        : module_(std::move(module)),
          name_(std::move(name)),
          spec_(std::move(spec)) {}

    const FormatDeclaration& declaration() {
        const std::scoped_lock alone(mutex_);
        if (!loaded_) {
            FormatDeclaration found = load_format_module(module_, name_);
            if (!(found.spec == spec_))
                throw Error("the module '{}' differs from the manifest beside it", module_.string())
                    .hint("build or install the module again; its manifest is written then");
            loaded_ = std::move(found);
        }
        return *loaded_;
    }
    Format::Write writer(Kind kind) {
        const auto& writers = declaration().writers;
        return std::ranges::find(writers, kind, &std::pair<Kind, Format::Write>::first)->second;
    }

private:
    std::mutex mutex_;
    std::filesystem::path module_;
    std::string name_;
    FormatSpec spec_;
    std::optional<FormatDeclaration> loaded_;
};

std::string text_of(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    if (!stream) throw Error("cannot be read");
    return text.str();
}

LoadedFile refuse_to_read(const std::string& format) {
    throw Error("{} is written for other programs, and not read", format)
        .hint("read the file that it was made from; PLY keeps everything and is read");
}

Format row_of(const std::filesystem::path& manifest_file, const std::string& name) {
    const FormatManifest manifest = parse_format_manifest(text_of(manifest_file));
    if (manifest.abi != abi_text())
        throw Error("was built for another program: it needs '{}', this is '{}'", manifest.abi, abi_text());
    const std::filesystem::path module_file = std::filesystem::path(manifest_file).replace_extension(".so");
    if (!std::filesystem::exists(module_file)) throw Error("has no module beside it");
    const FormatSpec& spec = manifest.spec;
    const auto module = std::make_shared<LazyModule>(module_file, name, spec);
    Format row;
    row.name = spec.name;
    row.extensions = spec.extensions;
    row.recognises = [begins = spec.begins](std::string_view head, u64) {
        const auto at_start = [&](const std::string& text) { return head.starts_with(text); };
        return std::ranges::any_of(begins, at_start) ? Recognition::certain : Recognition::no;
    };
    row.is_refused = !spec.reads;
    if (spec.reads)
        row.read = [module](const FileBytes& file, const ReadOptions& options) {
            return module->declaration().read(file, options);
        };
    else
        row.read = [format = spec.name](const FileBytes&, const ReadOptions&) -> LoadedFile {
            return refuse_to_read(format);
        };
    for (const Kind kind : spec.writes)
        row.writers.emplace_back(kind,
                                 [module, kind](const Value& value, OutputBuffer& out, const WriteOptions& options) {
                                     module->writer(kind)(value, out, options);
                                 });
    return row;
}

/// Stands for a module that cannot be used: whoever needs it hears why.
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
    declare(open_module(module, {format_magic, "file format"}, name), module, &declaration);
    std::vector<Kind> written;
    for (const auto& [kind, write] : declaration.writers) written.push_back(kind);
    if (bool(declaration.read) != declaration.spec.reads || written != declaration.spec.writes)
        throw Error("module '{}' lacks a reader or a writer that it announces, or has one that it does not",
                    module.string());
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
