// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plan/output_names.hpp"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"

namespace scanmill {

namespace fs = std::filesystem;

/// Names the placeholders that differ between two cells; without any, what to rename.
std::string OutputNames::way_out(const Entry& one, const Entry& other) {
    const TemplateValues &a = one.values, &b = other.values;
    std::vector<std::string> differing;
    if (a.scan != b.scan) differing.push_back("{scan}");
    if (a.folder != b.folder) differing.push_back("{folder}");
    if (a.variant != b.variant) differing.push_back("{variant}");
    if (a.workflow != b.workflow) differing.push_back("{workflow}");
    if (differing.size() > 1) return "put one of " + enumerated(differing) + " into the output's name";
    if (!differing.empty()) return "put " + differing.front() + " into the output's name";
    if (one.is_of_failure != other.is_of_failure)
        return fmt::format("put the output into another folder than '{}'", failed_folder_name);
    return one.writer == other.writer ? "give the outputs, or the workflows, different names"
                                      : "no placeholder differs between the two; rename one of the scans";
}

OutputNames::Added OutputNames::add(const std::string& name, const OutputContent& content, const std::string& writer,
                                    const TemplateValues& values) {
    const Added added = reserve(name, {content, writer, values, false});
    if (added.is_new) reserve(fs::path(failed_folder_name) / name, {content, writer, values, true});
    return added;
}

OutputNames::Added OutputNames::reserve(const fs::path& name, Entry entry) {
    const fs::path file = folder_ / name;
    if (const auto found = files_.find(file); found != files_.end()) {
        const Entry& other = found->second;
        if (other.content != entry.content || other.is_of_failure != entry.is_of_failure)
            throw Error("{} and {} would both write '{}'", other.text(), entry.text(), file.string())
                .hint(way_out(other, entry));
        return {file, false};
    }
    if (const auto folder = folders_.find(file); folder != folders_.end())
        throw Error("{} would write the file '{}', which is the folder that {} writes into", entry.text(),
                    file.string(), folder->second);
    for (fs::path part = file.parent_path(); part != folder_; part = part.parent_path())
        if (const auto other = files_.find(part); other != files_.end())
            throw Error("{} would write '{}' into a folder that {} writes as a file", entry.text(), file.string(),
                        other->second.text());
    for (fs::path part = file.parent_path(); part != folder_; part = part.parent_path())
        folders_.emplace(part, entry.text());
    files_.emplace(file, std::move(entry));
    return {file, true};
}

fs::path description_of(const fs::path& file) { return file.string() + ".json"; }

std::string cell_text(const std::string& scan, const std::string& variant, const std::string& workflow) {
    return fmt::format("scan '{}' under variant '{}'{}", scan, variant,
                       workflow.empty() ? "" : " of workflow '" + workflow + "'");
}

}  // namespace scanmill
