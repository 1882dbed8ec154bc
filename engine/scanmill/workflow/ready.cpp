// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/workflow/ready.hpp"

#include <fmt/format.h>

#include <set>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/plugin/module.hpp"

namespace scanmill {

namespace {

namespace fs = std::filesystem;

std::vector<fs::path> ready_folders() { return shared_places("workflows"); }

/// The path of the ready workflow or batch; empty if there is none of this name.
std::string ready_file(const std::string& name) {
    if (name.empty() || name.find_first_of("/.") != std::string::npos) return {};
    std::error_code ignored;
    for (const fs::path& folder : ready_folders()) {
        const fs::path file = folder / (name + ".yaml");
        if (fs::exists(file, ignored)) return file.string();
    }
    return {};
}

}  // namespace

std::vector<fs::path> shared_places(const std::string& name) {
    // Library folders have one level, or two as in lib/x86_64-linux-gnu.
    const fs::path library = core_library_file().parent_path();
    std::vector<fs::path> places;
    for (const fs::path& prefix : {library.parent_path(), library.parent_path().parent_path()})
        places.push_back(prefix / "share/scanmill" / name);
    return places;
}

std::vector<std::string> ready_names() {
    std::set<std::string> names;
    for (const fs::path& folder : ready_folders()) {
        std::error_code error;
        for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
            if (entry->path().extension() == ".yaml") names.insert(entry->path().stem().string());
    }
    return {names.begin(), names.end()};
}

std::string workflow_file(const std::string& file_or_name, const OnWarning& warn, const fs::path& folder) {
    std::error_code ignored;
    const std::string file = (folder / file_or_name).string();
    const std::string where =
        folder.empty() ? "in the current folder" : fmt::format("in the folder '{}'", folder.string());
    const bool exists = fs::exists(file, ignored);
    const std::string ready = ready_file(file_or_name);
    if (exists && !fs::is_directory(file, ignored)) {
        if (!ready.empty())
            warn(
                fmt::format("'{0}' is the file {2}, not the ready workflow '{1}'; write './{0}' for the file, or the "
                            "path '{1}' for the ready workflow",
                            file_or_name, ready, where));
        return file;
    }
    if (!ready.empty()) {
        const fs::path own = file + ".yaml";
        if (fs::is_regular_file(own, ignored) && !fs::equivalent(own, ready, ignored))
            warn(
                fmt::format("'{0}' is the ready workflow '{1}', not the file '{0}.yaml' {2}; write '{0}.yaml' for the "
                            "file",
                            file_or_name, ready, where));
        return ready;
    }
    if (exists || file_or_name.find('/') != std::string::npos) return file;
    const std::string name = file_or_name.ends_with(".yaml") ? fs::path(file_or_name).stem().string() : file_or_name;
    const std::vector<std::string> names = ready_names();
    throw Error("'{}' cannot be opened; expected a workflow file or the name of a ready workflow{}", file,
                did_you_mean(name, names))
        .hint(names.empty() ? "give the path of a workflow file" : "ready workflows and batches: " + enumerated(names));
}

}  // namespace scanmill
