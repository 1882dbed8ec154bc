// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/batch/scan_files.hpp"

#include <fnmatch.h>

#include <algorithm>

#include "scanmill/engine/no_file.hpp"
#include "scanmill/filter/error.hpp"

namespace scanmill {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_names = 1'000'000;

bool has_wildcards(const std::string& name) { return name.find_first_of("*?[") != std::string::npos; }

bool is_file(const fs::path& path) {
    std::error_code ignored;
    return fs::is_regular_file(path, ignored);
}

bool is_folder(const fs::path& path) {
    std::error_code ignored;
    return fs::is_directory(path, ignored);
}

/// For messages: where somebody would have to look.
std::string shown(const fs::path& folder) {
    std::error_code trouble;
    const fs::path absolute = fs::absolute(folder.empty() ? fs::path(".") : folder, trouble).lexically_normal();
    const std::string text = (trouble ? folder : absolute).string();
    return text.size() > 1 && text.ends_with('/') ? text.substr(0, text.size() - 1) : text;
}

class Search {
public:
    explicit Search(std::vector<std::string> components) : components_(std::move(components)) {}

    std::vector<fs::path> from(const fs::path& folder) {
        look(folder, 0);
        std::ranges::sort(found_, {}, [](const fs::path& path) -> const std::string& { return path.native(); });
        const auto repeated = std::ranges::unique(found_);  // `**/**` leads to a file in several ways
        found_.erase(repeated.begin(), repeated.end());
        return std::move(found_);
    }

private:
    void look(const fs::path& folder, std::size_t depth) {
        const std::string& component = components_[depth];
        const bool last = depth + 1 == components_.size();
        if (component == "**") {
            if (last) throw Error("'**' stands for folders; expected a name behind it, as '**/*.ply'");
            look(folder, depth + 1);
            for (const fs::directory_entry& entry : entries(folder))
                if (!is_hidden(entry) && !entry.is_symlink() && is_folder(entry.path())) look(entry.path(), depth);
        } else if (!has_wildcards(component)) {
            take(folder / component, depth, last);
        } else {
            for (const fs::directory_entry& entry : entries(folder))
                if (::fnmatch(component.c_str(), entry.path().filename().c_str(), FNM_PERIOD | FNM_NOESCAPE) == 0)
                    take(entry.path(), depth, last);
        }
    }

    void take(const fs::path& path, std::size_t depth, bool last) {
        if (last && is_file(path)) found_.push_back(path);
        if (!last && is_folder(path)) look(path, depth + 1);
    }

    static bool is_hidden(const fs::directory_entry& entry) {
        return entry.path().filename().native().starts_with('.');
    }

    std::vector<fs::directory_entry> entries(const fs::path& folder) {
        std::vector<fs::directory_entry> all;
        std::error_code trouble;
        for (fs::directory_iterator entry(folder.empty() ? fs::path(".") : folder, trouble), end;
             !trouble && entry != end; entry.increment(trouble)) {
            if (++names_ > most_names)
                throw Error("more than {} names were looked at; name the folders more closely", most_names);
            all.emplace_back(folder / entry->path().filename());
        }
        if (trouble) throw Error("the folder '{}' cannot be read: {}", shown(folder), trouble.message());
        return all;
    }

    std::vector<std::string> components_;
    std::vector<fs::path> found_;
    std::size_t names_ = 0;
};

}  // namespace

std::vector<fs::path> scan_files(const fs::path& folder, const std::string& pattern) {
    if (pattern.empty()) throw Error("the path is empty; expected a file, or several as 'scans/*.ply'");
    if (pattern.find('\0') != std::string::npos) throw Error("the path has a zero byte");
    const fs::path whole = folder / pattern;
    if (is_file(whole)) return {whole};
    if (is_folder(whole))
        throw Error("'{}' is a folder; expected files, as '{}'", pattern, (fs::path(pattern) / "*.ply").string());
    if (std::error_code ignored; fs::exists(whole, ignored))
        if (const std::optional<Error> other = why_no_file(whole))
            throw Error("{}; {}", other->sentence(), other->hint());
    if (!has_wildcards(pattern))
        throw Error("there is no file '{}' in '{}'", whole.filename().string(), shown(whole.parent_path()));

    // What stands before the first wildcard is where the search begins.
    fs::path begin = fs::path(pattern).is_absolute() ? fs::path() : folder;
    std::vector<std::string> components;
    for (const fs::path& part : fs::path(pattern)) {
        if (components.empty() && !has_wildcards(part.string()))
            begin /= part;
        else if (!part.empty())
            components.push_back(part.string());
    }
    if (pattern.ends_with('/')) throw Error("'{}' ends in a slash; expected files, as '{}*.ply'", pattern, pattern);
    if (!is_folder(begin.empty() ? fs::path(".") : begin))
        throw Error("no file matches '{}'; there is no folder '{}'", pattern, shown(begin));
    std::vector<fs::path> found = Search(std::move(components)).from(begin);
    if (found.empty()) throw Error("no file matches '{}'; looked in '{}'", pattern, shown(begin));
    return found;
}

}  // namespace scanmill
