// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/batch/parse_scans.hpp"

#include <fmt/format.h>
#include <fnmatch.h>
#include <algorithm>

#include "scanmill/base/error.hpp"
#include "scanmill/batch/parse_pose.hpp"
#include "scanmill/io/mapped_file.hpp"
#include "scanmill/workflow/grammar.hpp"
#include "scanmill/workflow/parse_value.hpp"

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

namespace {

namespace fs = std::filesystem;

/// The shortest way of writing the same path: `a/../b` is `b`, unless a link makes a difference.
fs::path without_detours(const fs::path& file) {
    fs::path shorter = file.lexically_normal();
    std::error_code other;
    return fs::equivalent(file, shorter, other) && !other ? shorter : file;
}

/// A path over {stem}, and how many of the files that it led to are missing.
class FileTemplate {
public:
    FileTemplate(std::string text, std::string what, Position position, const fs::path& folder,
                 Diagnostics& diagnostics)
        : text_(std::move(text)),
          what_(std::move(what)),
          position_(position),
          folder_(folder),
          diagnostics_(diagnostics) {
        const std::size_t before = diagnostics_.errors();
        check_stem_template(text_, "the " + what_, position_, diagnostics_);
        if (text_.empty()) diagnostics_.error(position_, fmt::format("the {} is empty; expected a path", what_));
        sound_ = diagnostics_.errors() == before;
    }

    /// Calls `use` with the scan's file. When it is missing, or `use` throws Error, that is reported, but not for the
    /// scans beyond the first ten.
    template <class Use>
    void apply(const fs::path& scan, Use&& use) {
        if (!sound_) return;
        const fs::path file = folder_ / with_stem(text_, scan);
        try {
            if (const std::optional<Error> other = why_no_file(file))
                throw Error("{}; expected the {} of '{}'", other->sentence(), what_, scan.string());
            use(file);
        } catch (const Error& error) {
            if (++wrong_ <= most_) diagnostics_.error(position_, error.sentence());
        }
    }
    void finish() {
        if (wrong_ > most_)
            diagnostics_.error(position_, fmt::format("and {} more: the {} of that many scans is missing or wrong, too",
                                                      wrong_ - most_, what_));
    }
    Position position() const { return position_; }

private:
    static constexpr std::size_t most_ = 10;
    std::string text_, what_;
    Position position_;
    fs::path folder_;
    Diagnostics& diagnostics_;
    bool sound_ = false;
    std::size_t wrong_ = 0;
};

class ScansParser {
public:
    ScansParser(const fs::path& folder, Diagnostics& diagnostics) : folder_(folder), diagnostics_(diagnostics) {}

    std::vector<BatchScan> scans(const YamlNode& node) {
        if (!require_list(node, "a list of scans, as [scans/*.ply]", diagnostics_)) return {};
        if (node.items.empty()) diagnostics_.error(node.position, "the list of scans is empty");
        for (const YamlNode& item : node.items) entry(item);
        return std::move(scans_);
    }

private:
    void entry(const YamlNode& node) {
        static const char* const expected = "a path, as scans/*.ply, or {path: scans/*.ply, unit: mm}";
        if (!node.is_map()) {
            if (const auto path = require_text(node, expected, diagnostics_)) find_files(*path, node.position);
            return;
        }
        MapReader keys(node, "a scan", diagnostics_);
        const YamlEntry* path = keys.find("path");
        const std::size_t first = scans_.size();
        if (!path)
            diagnostics_.error(node.position, fmt::format("the scan has no path; expected {}", expected));
        else if (const auto text = require_text(path->value, "a path, as scans/*.ply", diagnostics_))
            find_files(*text, path->value.position);
        const std::span<BatchScan> scans = std::span(scans_).subspan(first);
        if (const YamlEntry* unit = keys.find("unit")) {
            const LengthUnit known = require_unit(unit->value, diagnostics_);
            for (BatchScan& scan : scans) scan.unit = known;
        }
        frame(keys, scans);
        if (const YamlEntry* pose = keys.find("pose")) this->pose(pose->value, scans);
        if (const YamlEntry* truth = keys.find("truth")) this->truth(truth->value, scans);
        if (const YamlEntry* set = keys.find("set"); set && !set->value.is_null()) {
            const Settings settings = parse_settings(set->value, diagnostics_);
            for (BatchScan& scan : scans) scan.settings = settings;
        }
        keys.complain_of_others();
    }

    void find_files(const std::string& path, Position position) {
        try {
            for (fs::path& file : scan_files(folder_, path)) {
                const auto [earlier, is_new] = line_of_.emplace(fs::absolute(file).lexically_normal(), position.line);
                if (is_new) {
                    scans_.emplace_back();
                    scans_.back().file = without_detours(file);
                    scans_.back().position = position;
                } else {
                    diagnostics_.error(position, fmt::format("'{}' is a scan already by line {}; name every file once",
                                                             file.string(), earlier->second));
                }
            }
        } catch (const Error& error) {
            diagnostics_.error(position, error.sentence());
        }
    }

    void frame(MapReader& keys, std::span<BatchScan> scans) {
        const YamlEntry* entry = keys.find("frame");
        if (!entry) return;
        const std::string frame = require_text(entry->value, "a text for 'frame'", diagnostics_).value_or("");
        check_frame_template(frame, entry->value.position, diagnostics_);
        for (BatchScan& scan : scans) scan.frame = frame_of_file(frame, scan.file);
    }

    void pose(const YamlNode& node, std::span<BatchScan> scans) {
        if (node.is_sequence() || node.is_map()) {
            if (const auto pose = parse_pose(node, diagnostics_))
                for (BatchScan& scan : scans) {
                    scan.pose = pose;
                    scan.pose->unit = scan.unit;
                }
            return;
        }
        const auto text = require_text(
            node, "a file, as poses/{stem}.json, a matrix of 4 rows or {translation: …, rotation: …}", diagnostics_);
        if (!text) return;
        FileTemplate files(*text, "pose", node.position, folder_, diagnostics_);
        for (BatchScan& scan : scans)
            files.apply(scan.file, [&](const fs::path& file) {
                scan.pose = pose_files_.pose_of(scan.file, file, files.position(), diagnostics_);
                scan.pose_file = file;
            });
        files.finish();
    }

    void truth(const YamlNode& node, std::span<BatchScan> scans) {
        const auto text = require_text(node, "a file, as truth/{stem}.stl", diagnostics_);
        if (!text) return;
        FileTemplate files(*text, "truth", node.position, folder_, diagnostics_);
        for (BatchScan& scan : scans) files.apply(scan.file, [&](const fs::path& file) { scan.truth = file; });
        files.finish();
    }

    fs::path folder_;
    Diagnostics& diagnostics_;
    PoseFiles pose_files_;
    std::vector<BatchScan> scans_;
    std::map<fs::path, int> line_of_;
};

}  // namespace

std::vector<BatchScan> parse_scans(const YamlNode& node, const fs::path& folder, Diagnostics& diagnostics) {
    return ScansParser(folder, diagnostics).scans(node);
}

Settings parse_settings(const YamlNode& node, Diagnostics& diagnostics) {
    Settings settings;
    if (!require_map(node, "a map of parameters, as {max-error: 0.1 %diag}", diagnostics)) return settings;
    for (const YamlEntry& entry : node.entries) {
        if (!require_name(entry.key, entry.position, "a parameter", diagnostics)) continue;
        ValueExpression value = value_expression(entry.value, diagnostics);
        std::erase_if(value.values, [&](const WrittenValue& written) {
            if (!written.uses.empty())
                diagnostics.error(written.uses.front().position,
                                  "a setting cannot refer to a parameter; write the value");
            return !written.uses.empty();
        });
        if (value.values.empty()) continue;  // and that is reported
        value.position = entry.position;
        settings.emplace(entry.key, std::move(value));
    }
    return settings;
}

}  // namespace scanmill
