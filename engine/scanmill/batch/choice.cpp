// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/batch/choice.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"

namespace scanmill {

namespace {

namespace fs = std::filesystem;

/// Throws Error for the first name for which `exists` is false.
template <class Exists>
void require_all(const std::vector<std::string>& names, std::string_view noun, std::vector<std::string> known,
                 const Exists& exists) {
    for (const std::string& name : names) {
        if (exists(name)) continue;
        std::ranges::sort(known);
        const auto repeated = std::ranges::unique(known);
        known.erase(repeated.begin(), repeated.end());
        throw Error("the batch has no {} '{}'{}", noun, name, did_you_mean(name, known))
            .hint(known.empty() ? fmt::format("it has no {}s", noun) : "it has " + enumerated(known));
    }
}

bool has(const std::vector<std::string>& names, const std::string& name) {
    return std::ranges::find(names, name) != names.end();
}

}  // namespace

void choose(CheckedBatch& checked, const BatchChoice& choice) {
    const fs::path folder = fs::path(checked.batch.file).parent_path();
    const auto is_named = [&](const BatchScan& scan, const std::string& name) {
        fs::path path = (folder / name).lexically_normal();
        if (!path.has_filename()) path = path.parent_path();  // an object's folder with a slash at its end
        return scan.file == name || scan.file.lexically_normal() == path;
    };
    std::vector<std::string> scans, workflows, variants;
    for (const BatchScan& scan : checked.batch.scans) scans.push_back(scan.file.string());
    for (const BatchPart& part : checked.parts) {
        workflows.push_back(workflow_name(*part.plan));
        for (const PlannedVariant& variant : part.plan->variants) variants.push_back(variant.name);
    }
    require_all(choice.scans, "scan", scans, [&](const std::string& name) {
        return std::ranges::any_of(checked.batch.scans, [&](const BatchScan& scan) { return is_named(scan, name); });
    });
    require_all(choice.workflows, "workflow", workflows, [&](const std::string& name) { return has(workflows, name); });
    require_all(choice.variants, "variant", variants, [&](const std::string& name) { return has(variants, name); });

    std::vector<BatchPart> parts;
    for (BatchPart& part : checked.parts) {
        if (!choice.workflows.empty() && !has(choice.workflows, workflow_name(*part.plan))) continue;
        for (const PlannedVariant& variant : part.plan->variants)
            if (has(choice.variants, variant.name)) part.only.push_back(variant.name);
        if (!choice.variants.empty() && part.only.empty()) continue;
        if (!choice.scans.empty()) {
            std::erase_if(part.scans, [&](std::size_t scan) {
                return std::ranges::none_of(
                    choice.scans, [&](const std::string& name) { return is_named(checked.batch.scans[scan], name); });
            });
            if (part.scans.empty()) continue;
        }
        parts.push_back(std::move(part));
    }
    if (parts.empty()) throw Error("no cell of the batch matches all chosen names");
    checked.parts = std::move(parts);
}

}  // namespace scanmill
