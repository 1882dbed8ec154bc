// SPDX-License-Identifier: GPL-3.0-or-later
// The commands `schema` and `docs`, which generate files from the filters' declarations.

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "commands/commands.hpp"
#include "commands/common.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/describe/document_schemas.hpp"
#include "scanmill/describe/filter_page.hpp"
#include "scanmill/describe/generated_parts.hpp"
#include "scanmill/describe/output_schemas.hpp"
#include "scanmill/describe/schemas.hpp"
#include "scanmill/io/atomic_file.hpp"

namespace scanmill::runner {

namespace {

struct SchemaOptions {
    std::string kind = "workflow";
    std::filesystem::path folder;
};

struct DocsOptions {
    std::filesystem::path folder;
    std::vector<std::filesystem::path> update;
};

/// Writes the file completely or not at all; makes the file's folder if it is missing. Throws Error if that fails.
void write_text(const std::filesystem::path& path, std::string_view text) {
    std::error_code trouble;
    if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path(), trouble);
    if (trouble) throw Error("the folder '{}' cannot be made: {}", path.parent_path().string(), trouble.message());
    try {
        AtomicFile file(path);
        file.write(text);
        file.commit();
    } catch (const Error& error) {
        throw error.reworded(fmt::format("'{}' {}", path.string(), error.sentence()));
    }
}

bool is_document(const std::string& name) {
    return std::ranges::find(document_names(), name) != document_names().end();
}

int schema(const SchemaOptions& options) {
    const FilterLibrary library = open_library();
    if (options.folder.empty()) {
        fmt::print("{}", options.kind == "workflow"  ? workflow_schema(library)
                         : options.kind == "batch"   ? batch_schema(library)
                         : is_document(options.kind) ? document_schema(options.kind)
                                                     : output_schema(options.kind));
        return done;
    }
    write_text(options.folder / "workflow.schema.json", workflow_schema(library));
    write_text(options.folder / "batch.schema.json", batch_schema(library));
    for (const std::string& name : output_names())
        write_text(options.folder / "output" / (name + ".schema.json"), output_schema(name));
    for (const std::string& name : document_names())
        write_text(options.folder / "documents" / (name + ".schema.json"), document_schema(name));
    return done;
}

/// Throws Error for a file that `scanmill docs` did not write, and for a path that is not a file.
void require_replaceable(const std::filesystem::path& file) {
    std::error_code absent;
    if (!std::filesystem::exists(file, absent)) return;
    std::string text;
    if (std::ifstream stream(file); std::filesystem::is_regular_file(file, absent))
        text.assign(std::istreambuf_iterator<char>(stream), {});
    if (!is_filter_page(text))
        throw Error("'{}' exists and was not written by scanmill docs", file.string())
            .hint("choose another folder, or move it away");
}

/// Writes the generated parts of the pages anew. Nothing is written if one of them has a fault.
void update_pages(const std::vector<std::filesystem::path>& files, const FilterLibrary& library) {
    std::vector<std::pair<std::filesystem::path, std::string>> changed;
    for (const std::filesystem::path& file : files) {
        std::ifstream stream(file);
        if (!stream || !std::filesystem::is_regular_file(file))
            throw Error("'{}' cannot be read", file.string()).hint("--update takes Markdown files that exist");
        const std::string page(std::istreambuf_iterator<char>(stream), {});
        try {
            if (std::string updated = with_generated_parts(page, library); updated != page)
                changed.emplace_back(file, std::move(updated));
        } catch (const Error& error) {
            throw error.reworded(fmt::format("'{}' {}", file.string(), error.sentence()));
        }
    }
    for (const auto& [file, page] : changed) write_text(file, page);
}

int docs(const DocsOptions& options) {
    const FilterLibrary library = open_library();
    if (!options.update.empty()) {
        update_pages(options.update, library);
        return done;
    }
    std::vector<FilterSpec> specs;
    for (const std::string& name : library.names()) specs.push_back(*library.find(name));
    if (options.folder.empty()) {
        for (const FilterSpec& spec : specs) fmt::print("{}\n", filter_page(spec, library));
        return done;
    }
    std::vector<std::pair<std::filesystem::path, std::string>> pages;
    for (const FilterSpec& spec : specs)
        pages.emplace_back(options.folder / (spec.name + ".md"), filter_page(spec, library));
    pages.emplace_back(options.folder / "README.md", filter_index(specs));
    for (const auto& [file, page] : pages) require_replaceable(file);
    for (const auto& [file, page] : pages) write_text(file, page);
    return done;
}

}  // namespace

void add_schema_and_docs(CLI::App& app, Action& chosen) {
    auto [schema_command, schema_options] =
        add_command<SchemaOptions>(app, chosen, "schema",
                                   "Prints the JSON Schema of workflow or batch files (for editors), of a command's "
                                   "--json output, or of the JSON documents that steps write",
                                   schema);
    std::vector<std::string> kinds{"workflow", "batch"};
    kinds.insert(kinds.end(), output_names().begin(), output_names().end());
    kinds.insert(kinds.end(), document_names().begin(), document_names().end());
    CLI::Option* kind =
        schema_command
            .add_option("KIND", schema_options.kind,
                        "The schema to print: workflow (the default), batch, or the name of a command's output or of "
                        "a document")
            ->check(CLI::IsMember(kinds));
    schema_command
        .add_option("-o,--output", schema_options.folder,
                    "Write all schemas into this folder instead: workflow.schema.json, batch.schema.json, "
                    "output/NAME.schema.json and documents/NAME.schema.json")
        ->excludes(kind);

    auto [docs_command, docs_options] =
        add_command<DocsOptions>(app, chosen, "docs", "Prints a page about every installed filter, in Markdown", docs);
    CLI::Option* folder = docs_command.add_option("-o,--output", docs_options.folder,
                                                  "Write one page per filter into this folder instead");
    docs_command
        .add_option("--update", docs_options.update,
                    "Write the generated parts of these Markdown files anew: what is between the lines "
                    "'<!-- generated: filter NAME -->' (or filters LINK, doubts LINK) and '<!-- end -->'")
        ->excludes(folder);
}

}  // namespace scanmill::runner
