// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "scanmill/batch/batch.hpp"
#include "scanmill/batch/parse_limits.hpp"
#include "scanmill/batch/parse_scans.hpp"
#include "scanmill/batch/parse_settings.hpp"
#include "scanmill/engine/grammar.hpp"
#include "scanmill/engine/no_file.hpp"

namespace scanmill {

namespace {

namespace fs = std::filesystem;

constexpr const char* batch_forms = "a batch: a map that begins with `scanmill: 1` and `batch: NAME`";

class BatchParser {
public:
    BatchParser(const FilterLibrary& library, Diagnostics& diagnostics)
        : library_(library),
          diagnostics_(diagnostics),
          folder_(fs::path(diagnostics.file()).parent_path()) {}

    Batch batch(const YamlNode& root) {
        Batch batch;
        batch.file = diagnostics_.file();
        if (root.is_null()) {
            if (!diagnostics_.has_errors()) diagnostics_.error({}, fmt::format("is empty; expected {}", batch_forms));
            return batch;
        }
        if (!require_map(root, batch_forms, diagnostics_)) return batch;
        MapReader keys(root, "a batch", diagnostics_);
        require_grammar_version(keys, diagnostics_);
        name(keys, root, batch);
        batch.summary = keys.text("summary");
        if (const YamlEntry* entry = keys.find("scans"))
            batch.scans = parse_scans(entry->value, folder_, diagnostics_);
        else
            diagnostics_.error(root.position, "has no scans; expected `scans:` with a list of paths");
        if (const YamlEntry* entry = keys.find("workflows"))
            workflows(entry->value, batch);
        else
            diagnostics_.error(root.position, "has no workflows; expected `workflows:` with a list of files");
        if (const YamlEntry* entry = given(keys.find("set")))
            batch.settings = parse_settings(entry->value, diagnostics_);
        if (const YamlEntry* entry = given(keys.find("limits")))
            batch.limits = parse_limits(entry->value, diagnostics_);
        if (const YamlEntry* entry = given(keys.find("measure")))
            batch.measure = parse_measure(entry->value, diagnostics_);
        if (const YamlEntry* entry = given(keys.find("gate")))
            batch.gate = parse_gate(entry->value, library_, diagnostics_);
        keys.complain_of_others();
        return batch;
    }

private:
    /// A section without content says nothing.
    static const YamlEntry* given(const YamlEntry* entry) { return entry && !entry->value.is_null() ? entry : nullptr; }

    void name(MapReader& keys, const YamlNode& root, Batch& batch) {
        const YamlEntry* entry = keys.find("batch");
        if (!entry) {
            diagnostics_.error(root.position, "has no name; expected `batch: NAME`");
            return;
        }
        const auto text = require_text(entry->value, "the batch's name", diagnostics_);
        if (text && require_name(*text, entry->value.position, "a batch", diagnostics_)) batch.name = *text;
    }

    void workflows(const YamlNode& node, Batch& batch) {
        if (node.is_scalar()) {
            workflow(node, batch);
            return;
        }
        if (!require_list(node, "a list of workflow files, as [compare.yaml]", diagnostics_)) return;
        if (node.items.empty()) diagnostics_.error(node.position, "the list of workflows is empty");
        for (const YamlNode& item : node.items) workflow(item, batch);
    }

    void workflow(const YamlNode& node, Batch& batch) {
        const auto text = require_text(node, "a workflow file, as compare.yaml", diagnostics_);
        if (!text) return;
        const fs::path file = folder_ / *text;
        std::error_code ignored;
        if (fs::is_directory(file, ignored) || text->empty()) {
            diagnostics_.error(node.position, fmt::format("'{}' is a folder; expected a workflow file", file.string()));
            return;
        }
        if (const std::optional<Error> other = why_no_file(file)) {
            diagnostics_.error(node.position, fmt::format("{}; expected a workflow, by a path that counts from the "
                                                          "batch's own folder",
                                                          other->sentence()));
            return;
        }
        const auto [earlier, is_new] = line_of_.emplace(fs::absolute(file).lexically_normal(), node.position.line);
        if (is_new)
            batch.workflows.push_back({file, node.position});
        else
            diagnostics_.error(node.position, fmt::format("the workflow '{}' stands here a second time; it is already "
                                                          "at line {}",
                                                          *text, earlier->second));
    }

    const FilterLibrary& library_;
    Diagnostics& diagnostics_;
    fs::path folder_;
    std::map<fs::path, int> line_of_;
};

}  // namespace

Batch parse_batch(const std::string& text, const FilterLibrary& library, Diagnostics& diagnostics) {
    const YamlNode root = parse_yaml(text, diagnostics);
    return BatchParser(library, diagnostics).batch(root);
}

bool is_batch(const std::string& text) {
    if (text.find("batch") == std::string::npos) return false;  // most texts are workflows, and some are long
    Diagnostics unheard("");
    return parse_yaml(text, unheard).find("batch") != nullptr;
}

}  // namespace scanmill
