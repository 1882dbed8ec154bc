// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/batch/scans.hpp"

#include <fmt/format.h>
#include <fnmatch.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/batch/objects.hpp"
#include "scanmill/formats/common/format.hpp"
#include "scanmill/formats/poses/poses.hpp"
#include "scanmill/io/mapped_file.hpp"
#include "scanmill/plan/output_names.hpp"
#include "scanmill/workflow/grammar.hpp"

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
    return fs::is_directory(path.empty() ? fs::path(".") : path, ignored);
}

/// The absolute path of the folder, for messages.
std::string shown(const fs::path& folder) {
    std::error_code trouble;
    const fs::path absolute = fs::absolute(folder.empty() ? fs::path(".") : folder, trouble).lexically_normal();
    const std::string text = (trouble ? folder : absolute).string();
    return text.size() > 1 && text.ends_with('/') ? text.substr(0, text.size() - 1) : text;
}

/// Matches the components of a pattern against the names in folders.
class Search {
public:
    Search(std::vector<std::string> components, const OnWarning& warn)
        : components_(std::move(components)),
          warn_(warn) {}

    std::vector<fs::path> from(const fs::path& folder) {
        begin_ = folder;
        look(folder, 0);
        std::ranges::sort(found_, {}, [](const fs::path& path) -> const std::string& { return path.native(); });
        const auto repeated = std::ranges::unique(found_);  // `**/**` matches a file several times
        found_.erase(repeated.begin(), repeated.end());
        return std::move(found_);
    }

private:
    void look(const fs::path& folder, std::size_t depth) {
        const std::string& component = components_[depth];
        const bool last = depth + 1 == components_.size();
        if (component == "**") {
            if (last) throw Error("'**' matches folders; expected a name after it, as '**/*.ply'");
            look(folder, depth + 1);
            for (const fs::path& entry : entries(folder))
                if (!is_hidden(entry) && own_type(entry) == fs::file_type::directory) look(entry, depth);
        } else if (!has_wildcards(component)) {
            take(folder / component, depth, last);
        } else {
            for (const fs::path& entry : entries(folder))
                if (::fnmatch(component.c_str(), entry.filename().c_str(), FNM_PERIOD | FNM_NOESCAPE) == 0)
                    take(entry, depth, last);
        }
    }

    void take(const fs::path& path, std::size_t depth, bool last) {
        std::error_code trouble;
        const fs::file_type type = fs::status(path, trouble).type();
        if (last && type == fs::file_type::regular) found_.push_back(path);
        if (!last && type == fs::file_type::directory) look(path, depth + 1);
        if (type == fs::file_type::none)
            skip(path, trouble);
        else if (last && type == fs::file_type::not_found && own_type(path) == fs::file_type::symlink)
            warn("'{}' is a link that leads nowhere; it is left out", path.string());
    }

    static bool is_hidden(const fs::path& entry) { return entry.filename().native().starts_with('.'); }

    /// The type of the entry itself. Links are not followed.
    fs::file_type own_type(const fs::path& path) {
        std::error_code trouble;
        const fs::file_type type = fs::symlink_status(path, trouble).type();
        if (type == fs::file_type::none) skip(path, trouble);
        return type;
    }

    /// Warns that a path cannot be read. If its folder cannot be entered, warns only once per folder, because all
    /// entries of the folder give the same error.
    void skip(const fs::path& path, const std::error_code& why) {
        if (why != std::errc::permission_denied)
            warn("'{}' cannot be read: {}; it is left out", path.string(), why.message());
        else if (closed_.insert(path.parent_path()).second)
            warn("the files in the folder '{}' cannot be read: {}; they are left out", shown(path.parent_path()),
                 why.message());
    }

    template <class... Arguments>
    void warn(fmt::format_string<Arguments...> format, Arguments&&... arguments) const {
        if (warn_) warn_(fmt::format(format, std::forward<Arguments>(arguments)...));
    }

    std::vector<fs::path> entries(const fs::path& folder) {
        std::vector<fs::path> all;
        std::error_code trouble;
        for (fs::directory_iterator entry(folder.empty() ? fs::path(".") : folder, trouble), end;
             !trouble && entry != end; entry.increment(trouble)) {
            if (++names_ > most_names)
                throw Error("more than {} names were visited; use a path with fewer wildcards", most_names);
            all.push_back(folder / entry->path().filename());
        }
        if (trouble && folder == begin_)
            throw Error("the folder '{}' cannot be read: {}", shown(folder), trouble.message());
        if (trouble && closed_.insert(folder).second)
            warn("the folder '{}' cannot be read: {}; its files are left out", shown(folder), trouble.message());
        return all;
    }

    std::vector<std::string> components_;
    const OnWarning& warn_;
    fs::path begin_;
    std::set<fs::path> closed_;  // folders with a warning
    std::vector<fs::path> found_;
    std::size_t names_ = 0;
};

}  // namespace

std::vector<fs::path> scan_files(const fs::path& folder, const std::string& pattern, const OnWarning& warn) {
    if (pattern.empty()) throw Error("the path is empty; expected a file, or several as 'scans/*.ply'");
    if (pattern.find('\0') != std::string::npos) throw Error("the path has a zero byte");
    const fs::path whole = folder / pattern;
    if (is_file(whole) || file_view(whole).view > 0) return {whole};
    if (is_folder(whole))
        throw Error("'{}' is a folder; expected files, as '{}'", pattern, (fs::path(pattern) / "*.ply").string());
    if (std::error_code ignored; fs::exists(whole, ignored))
        if (const std::optional<Error> other = why_no_file(whole))
            throw Error("{}; {}", other->sentence(), other->hint());
    if (!has_wildcards(pattern))
        throw Error("there is no file '{}' in '{}'", whole.filename().string(), shown(whole.parent_path()));

    // The search begins in the folder before the first wildcard.
    fs::path begin = fs::path(pattern).is_absolute() ? fs::path() : folder;
    std::vector<std::string> components;
    for (const fs::path& part : fs::path(pattern)) {
        if (components.empty() && !has_wildcards(part.string()))
            begin /= part;
        else if (!part.empty())
            components.push_back(part.string());
    }
    if (pattern.ends_with('/')) throw Error("'{}' ends in a slash; expected files, as '{}*.ply'", pattern, pattern);
    if (!is_folder(begin)) throw Error("no file matches '{}'; there is no folder '{}'", pattern, shown(begin));
    std::vector<fs::path> found = Search(std::move(components), warn).from(begin);
    if (found.empty()) throw Error("no file matches '{}'; looked in '{}'", pattern, shown(begin));
    return found;
}

namespace {

/// The path in normal form: `a/../b` becomes `b`, unless that is another file because `a` is a link.
fs::path without_detours(const fs::path& file) {
    fs::path shorter = file.lexically_normal();
    std::error_code other;
    return fs::equivalent(file, shorter, other) && !other ? shorter : file;
}

const std::string pose_label = "the pose";
constexpr const char* missing_file_hint = "add the file, or correct its path in the batch";

/// Reads the numbers of `node` into `values`; false after an error.
bool read_numbers(const YamlNode& node, std::span<double> values, std::string_view expected, Diagnostics& diagnostics) {
    if (!require_list(node, expected, diagnostics)) return false;
    if (node.items.size() != values.size()) {
        diagnostics.error(node.position, "found a list of {}; expected {}",
                          count_text(node.items.size(), "value", "values"), expected);
        return false;
    }
    bool sound = true;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const YamlNode& item = node.items[i];
        if (item.is_scalar() && parse_number(item.text, values[i]) && std::isfinite(values[i])) continue;
        diagnostics.error(item.position, "{} is not a finite number; expected {}", item.described(), expected);
        sound = false;
    }
    return sound;
}

/// The result of `make`. If `make` throws an Error, reports it at `position` and returns nothing.
template <class Make>
auto or_report(Position position, Diagnostics& diagnostics, Make&& make) -> std::optional<decltype(make())> {
    try {
        return make();
    } catch (const Error& error) {
        diagnostics.error(position, error.sentence() + (error.hint().empty() ? "" : "; " + error.hint()));
        return std::nullopt;
    }
}

std::optional<RigidTransform> from_matrix(const YamlNode& node, Diagnostics& diagnostics) {
    if (node.items.size() != 4) {
        diagnostics.error(node.position, "found a matrix of {}; expected 4 rows of 4 numbers",
                          count_text(node.items.size(), "row", "rows"));
        return std::nullopt;
    }
    std::array<double, 16> matrix;
    bool sound = true;
    for (std::size_t row = 0; row < 4; ++row)
        sound &=
            read_numbers(node.items[row], std::span(matrix).subspan(4 * row, 4), "a row of 4 numbers", diagnostics);
    if (!sound) return std::nullopt;
    return or_report(node.position, diagnostics, [&] { return motion_of(matrix, pose_label); });
}

std::optional<RigidTransform> from_parts(const YamlNode& node, Diagnostics& diagnostics) {
    const std::string forms = "expected {translation: [x, y, z], rotation: [qx, qy, qz, qw]}";
    std::optional<Eigen::Matrix3d> rotation;
    std::array<double, 3> along{};
    bool moves = false;
    const auto read_translation = [&](const YamlEntry& entry) {
        moves = read_numbers(entry.value, along, "3 numbers: x, y, z", diagnostics);
    };
    const auto read_rotation = [&](const YamlEntry& entry) {
        std::array<double, 4> quaternion{};
        if (!read_numbers(entry.value, quaternion, "4 numbers: qx, qy, qz, qw", diagnostics)) return;
        const Position position = entry.value.position;
        const auto warn = [&](std::string sentence) { diagnostics.warning(position, std::move(sentence)); };
        rotation = or_report(position, diagnostics, [&] { return rotation_of(quaternion, pose_label, warn); });
    };
    read_mapping(node, "a pose",
                 {{"translation", read_translation, "the pose has no translation; " + forms},
                  {"rotation", read_rotation, "the pose has no rotation; " + forms}},
                 diagnostics);
    if (!moves || !rotation) return std::nullopt;
    RigidTransform pose;
    pose.rotation = *rotation;
    pose.translation = Vec3(along.data());
    return pose;
}

/// Parses four rows of four numbers, or `{translation: [x, y, z], rotation: [qx, qy, qz, qw]}`. The result has no unit.
/// Returns nothing after an error.
std::optional<RigidTransform> parse_pose(const YamlNode& node, Diagnostics& diagnostics) {
    return node.is_sequence() ? from_matrix(node, diagnostics) : from_parts(node, diagnostics);
}

/// The pose that names the scan. If the file contains only one pose, and that pose names no scan, it is the pose of the
/// scan. The file may refuse the scan. Throws Error if no pose or several poses belong to the scan.
const ScanPose& pose_of(const fs::path& scan, const std::vector<ScanPose>& poses, const std::string& file) {
    std::vector<std::string> names;
    std::vector<const ScanPose*> fitting;
    for (const ScanPose& pose : poses) {
        if (!pose.scan.empty()) names.push_back(pose.scan);
        if (is_of(pose, scan.filename().string()) || is_of(pose, stem_of(scan))) fitting.push_back(&pose);
    }
    const std::string name = scan.filename().string();
    if (fitting.size() == 1) return *fitting.front();
    if (fitting.size() > 1) throw Error("'{}': contains {} poses of '{}'; expected one", file, fitting.size(), name);
    if (poses.size() == 1 && names.empty()) return poses.front();
    if (names.empty()) throw Error("'{}': contains {} poses, none of which names a scan", file, poses.size());
    throw Error("'{}': has no pose of '{}'; it has poses of {}{}", file, name, enumerated(names),
                did_you_mean(name, names));
}

/// Whether a run wrote the file beside its outputs: the records, the lock, or the description of an output that is
/// there.
bool is_own_file(const fs::path& file) {
    const std::string name = file.filename().string();
    if (name.starts_with(records_file) || name == "scanmill.lock") return true;
    std::error_code ignored;
    return file.extension() == ".json" && fs::path(file.stem()).has_extension() &&
           fs::is_regular_file(fs::path(file).replace_extension(), ignored);
}

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
        const auto scans = [this, first = scans_.size()] { return std::span(scans_).subspan(first); };
        bool by_folder = false;
        const auto by = [&](const YamlEntry& found) {
            by_folder = found.value.is_scalar() && found.value.text == "folder";
            if (!by_folder)
                diagnostics_.error(found.value.position,
                                   "found {}; expected `by: folder`, or no `by` for one scan per file",
                                   found.value.described());
        };
        const auto path = [&](const YamlEntry& found) {
            if (const auto text = require_text(found.value, "a path, as scans/*.ply", diagnostics_))
                find_files(*text, found.value.position, by_folder);
        };
        const auto unit = [&](const YamlEntry& found) {
            LengthUnit declared = LengthUnit::unknown;
            unit_into(declared, diagnostics_)(found);
            for (BatchScan& scan : scans()) scan.unit = declared;
        };
        const auto frame = [&](const YamlEntry& found) {
            std::string text;
            text_into(text, diagnostics_)(found);
            check_stem_template(text, "the frame", found.value.position, diagnostics_);
            for (BatchScan& scan : scans()) scan.frame = text;
        };
        const auto invalid = [&](const YamlEntry& found) {
            InvalidRows rule = InvalidRows::by_format;
            invalid_into(rule, diagnostics_)(found);
            for (BatchScan& scan : scans()) {
                scan.invalid = rule;
                scan.invalid_position = found.position;
            }
        };
        const auto set = [&](const YamlEntry& found) {
            add_settings(parse_settings(found.value, diagnostics_), scans());
        };
        read_mapping(node, "a scan",
                     {{"by", by},
                      {"path", path, fmt::format("the scan has no path; expected {}", expected)},
                      {"unit", unit},
                      {"frame", frame},
                      {"invalid", invalid},
                      {"pose", [&](const YamlEntry& found) { pose(found, scans()); }},
                      {"poses", [&](const YamlEntry& found) { poses(found, scans()); }},
                      {"truth", [&](const YamlEntry& found) { truth(found, scans()); }},
                      {"in", [&](const YamlEntry& found) { inputs(found, scans()); }},
                      {"set", set}},
                     diagnostics_);
        for (const BatchScan& scan : scans())
            if (const auto twice = scan.settings.find(poses_parameter);
                twice != scan.settings.end() && scan.poses_position.line > 0)
                return diagnostics_.error(twice->second.position, "`set` gives poses, and so does `poses` in line {}",
                                          scan.poses_position.line);
    }

    void find_files(const std::string& path, Position position, bool by_folder = false) {
        try {
            const auto warn = [&](std::string sentence) { diagnostics_.warning(position, std::move(sentence)); };
            std::vector<fs::path> files;
            const bool is_pattern = path.find_first_of("*?[") != std::string::npos;
            for (const fs::path& file : scan_files(folder_, path, warn))
                if (!(is_pattern && is_own_file(file)) && is_new(file, position))
                    files.push_back(without_detours(file));
            if (files.empty() && is_pattern && !diagnostics_.has_errors())
                diagnostics_.error(position, "'{}' matches only files that Scanmill wrote beside results", path);
            if (by_folder) return add_objects(objects_of(files), position);
            for (fs::path& file : files) add_scan(std::move(file), position);
        } catch (const Error& error) {
            diagnostics_.error(position, error.sentence());
        }
    }

    /// Whether no entry has listed the file or the folder before. If one has, reports it.
    bool is_new(const fs::path& path, Position position, std::string_view way_out = "") {
        const auto [earlier, is_new] = line_of_.emplace(fs::absolute(path).lexically_normal(), position.line);
        if (!is_new)
            diagnostics_.error(position, "'{}' is listed twice; line {} lists it too{}", path.string(), earlier->second,
                               way_out);
        return is_new;
    }

    BatchScan& add_scan(fs::path file, Position position) {
        BatchScan& scan = scans_.emplace_back();
        scan.file = std::move(file);
        scan.position = position;
        return scan;
    }

    /// Adds the objects whose folders hold views. Other files that the path matches, as files of poses, are left out.
    void add_objects(const std::vector<ObjectFolder>& objects, Position position) {
        std::vector<fs::path> others;
        bool has_views = false;
        const auto normal = [](const fs::path& folder) {
            return (folder.empty() ? fs::path(".") : folder).lexically_normal();
        };
        for (const ObjectFolder& object : objects) {
            if (normal(object.folder) == normal(folder_)) {
                diagnostics_.error(position,
                                   "'{}' is in the folder of the batch file; with `by: folder`, every object has a "
                                   "folder of its own, as in objects/*/*.ply",
                                   object.views.front().string());
                continue;
            }
            if (has_results(object)) {
                diagnostics_.warning(position,
                                     fmt::format("the folder '{}' holds results ({}), so it is not taken as an object",
                                                 object.folder.string(), records_file));
                continue;
            }
            const ObjectFolder views{object.folder, views_among(object.views)};
            std::ranges::set_difference(object.views, views.views, std::back_inserter(others));
            if (views.views.empty()) continue;
            has_views = true;
            if (!is_new(object.folder, position, "; give all views of an object in one entry")) continue;
            BatchScan& scan = add_scan(object.folder, position);
            scan.views = views.views;
            const ObjectPoses beside = poses_beside(views);
            scan.poses_file = beside.file;
            scan.poses_refusal = beside.refusal;
            scan.idle_poses = beside.idle;
        }
        if (others.empty()) return;
        const std::string more =
            others.size() > 1 ? " and " + count_text(others.size() - 1, "more match", "more matches") : "";
        if (has_views)
            diagnostics_.warning(
                position, fmt::format("'{}'{} {} not taken as {}; expected a path that matches only scans, as in "
                                      "objects/*/*.ply",
                                      others.front().string(), more, others.size() > 1 ? "are" : "is",
                                      others.size() > 1 ? "views" : "a view"));
        else
            diagnostics_.error(position, "'{}'{} {} by {} extension; expected views, as in objects/*/*.ply",
                               others.front().string(), more, others.size() > 1 ? "are not scans" : "is not a scan",
                               others.size() > 1 ? "their" : "its");
    }

    /// Collects sentences about many scans. Only the first ten are reported.
    class Complaints {
    public:
        void add(std::string sentence) {
            if (++count_ <= most) sentences_.push_back(std::move(sentence));
        }
        /// `what`: "the truth".
        template <class Report>
        void report(std::string_view what, const Report& report) {
            for (std::string& sentence : sentences_) report(std::move(sentence));
            if (count_ > most)
                report(fmt::format("for {}, {} is missing or wrong, too",
                                   count_text(count_ - most, "more scan", "more scans"), what));
        }

    private:
        static constexpr std::size_t most = 10;
        std::vector<std::string> sentences_;
        std::size_t count_ = 0;
    };

    /// Reads a path that may contain {stem} and {folder}. Returns nothing after an error.
    std::optional<std::string> path_template(const YamlNode& node, const std::string& what, std::string_view forms) {
        const auto text = require_text(node, forms, diagnostics_);
        if (!text) return std::nullopt;
        const std::size_t before = diagnostics_.errors();
        check_path_template(*text, what, node.position, diagnostics_);
        if (text->empty()) diagnostics_.error(node.position, "{} is empty; expected a path", what);
        return diagnostics_.errors() > before ? std::nullopt : text;
    }

    /// The value of `stem` or `folder`. For an object, the folder is a path, which counts from the batch file.
    std::string value_of(const BatchScan& scan, const std::string& placeholder) const {
        if (placeholder != "folder") return scan.name();
        return scan.is_object() ? path_from(folder_, scan.file).string() : folder_name(scan.file);
    }

    fs::path file_for(const BatchScan& scan, const std::string& path_template) const {
        return folder_ /
               with_placeholders(path_template, [&](const std::string& each) { return value_of(scan, each); });
    }

    /// The files that match a path with wildcards. Wildcards in the names of the scan and its folder match themselves.
    std::vector<fs::path> files_for(const BatchScan& scan, const std::string& path_template,
                                    const OnWarning& warn) const {
        const std::string pattern = with_placeholders(path_template, [&](const std::string& placeholder) {
            std::string literal;
            for (const char each : value_of(scan, placeholder))
                literal += has_wildcards({each}) ? fmt::format("[{}]", each) : std::string(1, each);
            return literal;
        });
        return scan_files(folder_, pattern, warn);
    }

    /// A sentence that explains why `file`, which `scan` needs, is missing; nothing if the file exists. `what`: "the
    /// truth".
    static std::optional<std::string> missing(const fs::path& file, std::string_view what, const BatchScan& scan) {
        if (const std::optional<Error> other = why_no_file(file_view(file).file))
            return fmt::format("{}; expected {} of '{}'", other->sentence(), what, scan.file.string());
        return std::nullopt;
    }

    /// Calls `take` with every scan and its file, the only match of a path with wildcards. A missing file is only a
    /// warning, because it only fails the cells that read it.
    template <class Take>
    void take_files(const YamlNode& node, const std::string& what, std::string_view forms, std::span<BatchScan> scans,
                    const Take& take) {
        const auto text = path_template(node, what, forms);
        if (!text) return;
        Complaints complaints;
        const auto warn = [&](std::string each) { diagnostics_.warning(node.position, std::move(each)); };
        for (BatchScan& scan : scans) {
            fs::path file = file_for(scan, *text);
            if (has_wildcards(*text)) try {
                    file = only_file_for(scan, *text, warn);
                } catch (const Error& error) {
                    complaints.add(fmt::format("{}; expected {} of '{}'", error.sentence(), what, scan.file.string()));
                    take(scan, file);
                    continue;
                }
            if (std::optional<std::string> complaint = missing(file, what, scan)) complaints.add(std::move(*complaint));
            take(scan, file);
        }
        complaints.report(what, warn);
    }

    void truth(const YamlEntry& entry, std::span<BatchScan> scans) {
        static const char* const expected = "a file, as truth/{stem}.stl, or {path: truth/{stem}.stl, unit: mm}";
        const auto path = [&](const YamlNode& node) {
            take_files(node, "the truth", expected, scans,
                       [](BatchScan& scan, const fs::path& file) { scan.truth.files = {file}; });
        };
        for (BatchScan& scan : scans) scan.truth.position = entry.position;
        if (!entry.value.is_map()) return path(entry.value);
        const auto unit = [&](const YamlEntry& found) {
            LengthUnit declared = LengthUnit::unknown;
            unit_into(declared, diagnostics_)(found);
            for (BatchScan& scan : scans) scan.truth.unit = declared;
        };
        const auto frame = [&](const YamlEntry& found) {
            std::string text;
            text_into(text, diagnostics_)(found);
            check_stem_template(text, "the frame", found.value.position, diagnostics_);
            for (BatchScan& scan : scans)
                scan.truth.frame =
                    with_placeholders(text, [&](const std::string& each) { return value_of(scan, each); });
        };
        read_mapping(entry.value, "a truth",
                     {{"path", [&](const YamlEntry& found) { path(found.value); },
                       fmt::format("the truth has no path; expected {}", expected)},
                      {"unit", unit},
                      {"frame", frame}},
                     diagnostics_);
    }

    /// Adds the files of an input to every scan. A path without a match stays in the list, as a missing file.
    void take_matching_files(const YamlNode& node, const std::string& what, const std::string& input,
                             std::span<BatchScan> scans) {
        static const char* const forms = "a file, as targets/{stem}.ply, or a list";
        const auto take = [&](BatchScan& scan, const fs::path& file) { scan.inputs[input].files.push_back(file); };
        if (!node.is_scalar() || !has_wildcards(node.text)) return take_files(node, what, forms, scans, take);
        const auto text = path_template(node, what, forms);
        if (!text) return;
        std::set<std::string> warnings;  // of folders that the patterns of several scans visit, once
        Complaints complaints;
        for (BatchScan& scan : scans) try {
                for (const fs::path& file :
                     files_for(scan, *text, [&](std::string sentence) { warnings.insert(std::move(sentence)); }))
                    take(scan, file);
            } catch (const Error& error) {
                complaints.add(fmt::format("{}; expected {} of '{}'", error.sentence(), what, scan.file.string()));
                take(scan, file_for(scan, *text));
            }
        const auto warn = [&](std::string each) { diagnostics_.warning(node.position, std::move(each)); };
        for (const std::string& warning : warnings) warn(warning);
        complaints.report(what, warn);
    }

    void inputs(const YamlEntry& entry, std::span<BatchScan> scans) {
        if (!require_map(entry.value, "a map from inputs to files, as {target: target.ply}", diagnostics_)) return;
        for (const YamlEntry& input : entry.value.entries) {
            if (!require_name(input.key, input.position, "an input", diagnostics_)) continue;
            for (BatchScan& scan : scans) scan.inputs[input.key].position = input.position;
            const YamlNode& value = input.value;
            if (value.is_sequence() && value.items.empty())
                diagnostics_.error(value.position, "the list of files for the input '{}' is empty", input.key);
            for (const YamlNode& node : value.is_sequence() ? std::span(value.items) : std::span(&value, 1))
                take_matching_files(node, fmt::format("the input '{}'", input.key), input.key, scans);
        }
    }

    /// The only file that matches. Throws Error if none or several do.
    fs::path only_file_for(const BatchScan& scan, const std::string& path_template, const OnWarning& warn) const {
        const std::vector<fs::path> files = files_for(scan, path_template, warn);
        if (files.size() > 1)
            throw Error("'{}' has {} matches for '{}', such as '{}' and '{}'; expected one file", path_template,
                        files.size(), scan.file.string(), files[0].string(), files[1].string());
        return files.front();
    }

    void poses(const YamlEntry& entry, std::span<BatchScan> scans) {
        if (scans.empty()) return;  // reported at the path
        if (!scans.front().is_object()) {
            diagnostics_.error(entry.position,
                               "`poses` is for the views of objects, which need `by: folder`; the pose of a scan is "
                               "`pose: FILE`");
            return;
        }
        const auto path = path_template(entry.value, "the poses", "a file, as \"{folder}/*.conf\"");
        if (!path) return;
        const auto warn = [&](std::string text) { diagnostics_.warning(entry.value.position, std::move(text)); };
        for (BatchScan& scan : scans) {
            scan.poses_position = entry.value.position;
            ObjectPoses poses;
            try {
                poses = poses_in(only_file_for(scan, *path, warn), {scan.file, scan.views});
            } catch (const Error& error) {
                poses.refusal = {fmt::format("the object '{}' has no poses: {}", scan.name(), error.sentence()),
                                 missing_file_hint};
            }
            scan.poses_file = poses.file;
            scan.poses_refusal = poses.refusal;
        }
    }

    static bool is_template(const std::string& text) {
        return text.find("{stem}") != std::string::npos || text.find("{folder}") != std::string::npos;
    }

    /// Whether the texts that contain {stem} or {folder} have no other placeholders. If not, reports these.
    bool check_templates(const Settings& settings) {
        const std::size_t before = diagnostics_.errors();
        for (const auto& [name, value] : settings)
            for (const WrittenValue& written : value.values)
                for (const std::string& item : written.literal.items)
                    if (is_template(item))
                        check_path_template(item, fmt::format("the setting '{}'", name), written.position,
                                            diagnostics_);
        return diagnostics_.errors() == before;
    }

    /// Adds the settings to every scan. Texts that contain {stem} or {folder} are replaced; such a text with wildcards
    /// is the only file that matches.
    void add_settings(const Settings& settings, std::span<BatchScan> scans) {
        for (BatchScan& scan : scans) scan.settings = settings;
        if (!check_templates(settings)) return;
        for (const auto& [name, value] : settings) {
            std::set<std::string> warnings;  // about folders that the patterns of several scans visit, once
            const auto visit = [&](std::string sentence) { warnings.insert(std::move(sentence)); };
            Complaints complaints;
            for (BatchScan& scan : scans)
                for (WrittenValue& written : scan.settings.at(name).values)
                    for (std::string& item : written.literal.items) {
                        if (!is_template(item)) continue;
                        try {
                            item = has_wildcards(item) ? path_from(folder_, only_file_for(scan, item, visit)).string()
                                                       : with_placeholders(item, [&](const std::string& each) {
                                                             return value_of(scan, each);
                                                         });
                        } catch (const Error& error) {
                            Refusal refusal{fmt::format("'{}' has no file for `{}`: {}", scan.file.string(), name,
                                                        error.sentence()),
                                            missing_file_hint};
                            complaints.add(refusal.text());
                            scan.missing_settings.insert_or_assign(name, std::move(refusal));
                        }
                    }
            const auto warn = [&](std::string text) { diagnostics_.warning(value.position, std::move(text)); };
            for (const std::string& warning : warnings) warn(warning);
            complaints.report(fmt::format("the file for `{}`", name), warn);
        }
    }

    void pose(const YamlEntry& entry, std::span<BatchScan> scans) {
        if (!scans.empty() && scans.front().is_object()) {
            diagnostics_.error(entry.position,
                               "`pose` is for single scans; the poses of an object's views are `poses: FILE`");
            return;
        }
        if (entry.value.is_sequence() || entry.value.is_map()) {
            const std::optional<RigidTransform> pose = parse_pose(entry.value, diagnostics_);
            for (BatchScan& scan : scans) {
                scan.pose = pose;
                if (pose) scan.pose->unit = scan.unit;
            }
            return;
        }
        const auto path =
            path_template(entry.value, "the pose",
                          "a file, as poses/{stem}.json, a matrix of 4 rows or {translation: …, rotation: …}");
        if (!path) return;
        const Position position = entry.value.position;
        const auto warn = [&](std::string text) { diagnostics_.warning(position, std::move(text)); };
        Complaints complaints;
        for (BatchScan& scan : scans) try {
                scan.pose_file = file_for(scan, *path);
                if (const auto complaint = missing(scan.pose_file, "the pose", scan)) throw Error(*complaint);
                auto poses = poses_.find(scan.pose_file);
                if (poses == poses_.end())
                    poses = poses_.emplace(scan.pose_file, read_poses(scan.pose_file, warn)).first;
                const ScanPose& pose = pose_of(scan.file, poses->second, scan.pose_file.string());
                if (!pose.refused)
                    scan.pose = pose.transform;
                else
                    refuse(scan, *pose.refused, position);
            } catch (const Error& error) {
                complaints.add(error.sentence());
            }
        complaints.report("the pose", [&](std::string text) { diagnostics_.error(position, std::move(text)); });
    }

    /// The other scans still run, so this is a warning.
    void refuse(BatchScan& scan, const std::string& reason, const Position& position) {
        scan.refusal = {fmt::format("'{}': the scan '{}' has no pose, because it was refused: {}",
                                    scan.pose_file.string(), scan.file.filename().string(), reason),
                        "register the views again, or remove the scan"};
        diagnostics_.warning(position, scan.refusal.text());
    }

    fs::path folder_;
    Diagnostics& diagnostics_;
    std::map<fs::path, std::vector<ScanPose>> poses_;  // by file, so that each file is read only once
    std::vector<BatchScan> scans_;
    std::map<fs::path, int> line_of_;
};

}  // namespace

fs::path path_from(const fs::path& folder, const fs::path& path) {
    if (folder.empty() || folder.is_absolute() != path.is_absolute()) return path;
    const fs::path relative = path.lexically_normal().lexically_relative(folder.lexically_normal());
    return relative.empty() ? path : relative;
}

std::vector<BatchScan> parse_scans(const YamlNode& node, const fs::path& folder, Diagnostics& diagnostics) {
    return ScansParser(folder, diagnostics).scans(node);
}

Settings parse_settings(const YamlNode& node, Diagnostics& diagnostics) {
    Settings settings;
    if (node.is_null() || !require_map(node, "a map of parameters, as {max-error: 0.1 %diag}", diagnostics))
        return settings;
    for (const YamlEntry& entry : node.entries) {
        if (!require_name(entry.key, entry.position, "a parameter", diagnostics)) continue;
        ValueExpression value = value_expression(entry.value, diagnostics);
        refuse_uses(value, "a setting", diagnostics);
        if (value.values.empty()) continue;  // the value could not be read
        value.position = entry.position;
        settings.emplace(entry.key, std::move(value));
    }
    return settings;
}

}  // namespace scanmill
