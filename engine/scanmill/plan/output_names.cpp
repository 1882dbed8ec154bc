// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plan/output_names.hpp"

#include <fmt/format.h>

#include "scanmill/base/error.hpp"

namespace scanmill {

namespace fs = std::filesystem;

OutputNames::Added OutputNames::add(const std::string& name, const OutputContent& content, const std::string& writer) {
    const fs::path file = folder_ / name;
    if (const auto found = files_.find(file); found != files_.end()) {
        if (found->second.content != content)
            throw Error("{} and {} would both write '{}'", found->second.writer, writer, file.string())
                .hint(
                    "put {variant}, {workflow} or {folder}, the name of the scan's folder, into the output's name, or "
                    "rename a scan");
        return {file, false};
    }
    if (const auto folder = folders_.find(file); folder != folders_.end())
        throw Error("{} would write the file '{}', which is the folder that {} writes into", writer, file.string(),
                    folder->second);
    for (fs::path part = file.parent_path(); part != folder_; part = part.parent_path())
        if (const auto other = files_.find(part); other != files_.end())
            throw Error("{} would write '{}' into a folder that {} writes as a file", writer, file.string(),
                        other->second.writer);
    files_.emplace(file, Entry{content, writer});
    for (fs::path part = file.parent_path(); part != folder_; part = part.parent_path()) folders_.emplace(part, writer);
    return {file, true};
}

fs::path description_of(const fs::path& file) { return file.string() + ".json"; }

std::string cell_text(const std::string& scan, const std::string& variant, const std::string& workflow) {
    return fmt::format("scan '{}' under variant '{}'{}", scan, variant,
                       workflow.empty() ? "" : " of workflow '" + workflow + "'");
}

}  // namespace scanmill
