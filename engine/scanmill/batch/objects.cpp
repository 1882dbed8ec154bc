// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/batch/objects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/formats/common/format.hpp"
#include "scanmill/formats/poses/poses.hpp"
#include "scanmill/plan/output_names.hpp"

namespace scanmill {

namespace {

namespace fs = std::filesystem;

template <class Fits>
bool has_format(const fs::path& file, const Fits& fits) {
    return std::ranges::any_of(
        formats(), [&](const Format& format) { return format.has_extension(extension_of(file)) && fits(format); });
}

/// Whether files with this extension may hold points or a mesh. Formats that only read have no writers.
bool may_be_view(const fs::path& name) {
    return has_format(file_view(name).file, [](const Format& format) {
        return !format.is_refused && (format.writers.empty() || format.writer(kind_of<PointCloud>()) ||
                                      format.writer(kind_of<TriangleMesh>()));
    });
}

bool is_text(const fs::path& file) { return extension_of(file) == "txt"; }

bool may_hold_several_views(const fs::path& file) {
    return has_format(file, [](const Format& format) { return format.count_views != nullptr; });
}

bool is_poses_file(const fs::path& file) {
    const std::string name = file.filename().string();
    return name.ends_with(".conf") || name.ends_with("poses.json");
}

/// The path with the folder's name at its end: "objects/bunny" for objects/bunny/, an absolute path for `.` and `..`.
fs::path with_name(const fs::path& folder) {
    const auto ends_in_name = [](const fs::path& path) {
        const fs::path last = path.filename();
        return !last.empty() && last != "." && last != "..";
    };
    fs::path path = folder.lexically_normal();
    if (!path.has_filename()) path = path.parent_path();
    if (ends_in_name(path)) return path;
    std::error_code ignored;
    path = fs::absolute(folder, ignored).lexically_normal();
    return path.has_filename() ? path : path.parent_path();
}

/// The regular files in the folder that are not hidden, sorted, and the number of its folders.
struct Listed {
    std::vector<fs::path> files;
    std::size_t folders = 0;
};
Listed listed(const fs::path& folder) {
    Listed found;
    std::error_code trouble;
    for (fs::directory_iterator entry(folder.empty() ? fs::path(".") : folder, trouble), end; !trouble && entry != end;
         entry.increment(trouble)) {
        std::error_code ignored;
        if (entry->path().filename().native().starts_with('.')) continue;
        if (entry->is_regular_file(ignored)) found.files.push_back(folder / entry->path().filename());
        found.folders += entry->is_directory(ignored);
    }
    if (trouble) throw Error("the folder '{}' cannot be read: {}", folder.string(), trouble.message());
    std::ranges::sort(found.files, {}, [](const fs::path& file) -> const std::string& { return file.native(); });
    return found;
}

/// The reason why the poses do not fit the views; empty if they fit. `file`: the file of the poses, for messages.
Refusal misfit(const std::vector<ScanPose>& poses, const fs::path& file, const ObjectFolder& object) {
    std::vector<std::string> names, views;
    for (const ScanPose& pose : poses) names.push_back(pose.scan);
    for (const fs::path& view : object.views) views.push_back(view.filename().string());
    const auto fits = [](const ScanPose& pose, const fs::path& view) {
        return is_of(pose, view.filename().string()) || is_of(pose, stem_of(view));
    };
    for (const fs::path& view : object.views)
        if (std::ranges::none_of(poses, [&](const ScanPose& pose) { return fits(pose, view); }))
            return {fmt::format("'{}' has no pose of the view '{}' of the object '{}'; it has poses of {}{}",
                                file.string(), view.filename().string(), object.name(), enumerated(names),
                                did_you_mean(view.filename().string(), names)),
                    "add the pose of the view, or move the view to another folder"};
    for (const ScanPose& pose : poses)
        if (!pose.refused && std::ranges::none_of(object.views, [&](const fs::path& view) { return fits(pose, view); }))
            return {fmt::format("'{}' has a pose of '{}', which is not among the {} of the object '{}'", file.string(),
                                pose.scan, count_text(views.size(), "view", "views"), object.name()),
                    "add the view, remove its pose, or set the parameter `poses` to this file, which passes over poses "
                    "of other views"};
    return {};
}

}  // namespace

std::vector<ObjectFolder> objects_of(std::span<const fs::path> files) {
    std::vector<ObjectFolder> objects;
    std::map<fs::path, std::size_t> object_of;
    for (const fs::path& file : files) {
        const auto [object, is_new] = object_of.emplace(file.parent_path(), objects.size());
        if (is_new) objects.push_back({file.parent_path(), {}});
        objects[object->second].views.push_back(file);
    }
    for (ObjectFolder& object : objects) std::ranges::sort(object.views);
    return objects;
}

bool has_results(const ObjectFolder& object) {
    std::error_code ignored;
    return fs::exists(object.folder / records_file, ignored);
}

std::vector<fs::path> views_among(std::span<const fs::path> files) {
    std::vector<fs::path> views;
    std::ranges::copy_if(files, std::back_inserter(views), may_be_view);
    if (!std::ranges::all_of(views, is_text)) std::erase_if(views, is_text);
    return views;
}

ObjectFolder object_in(const fs::path& folder, const OnWarning& warn) {
    ObjectFolder object{with_name(folder), {}};
    if (has_results(object))
        throw Error("the folder '{}' holds results ({}), which do not count as views", object.folder.string(),
                    records_file)
            .hint("name a folder with the views alone, and another one for the results: -o DIR");
    const Listed found = listed(object.folder);
    object.views = views_among(found.files);
    if (!object.views.empty() && !is_text(object.views.front()))
        for (const fs::path& file : found.files)
            if (warn && is_text(file))
                warn(fmt::format("'{}' is not taken as a view, because it is a text among files of other formats",
                                 file.string()));
    if (object.views.empty())
        throw Error("the folder '{}' has no views: {}", object.folder.string(),
                    found.files.empty() ? "it has no files"
                                        : fmt::format("none of its {} is a scan by its extension",
                                                      count_text(found.files.size(), "file", "files")))
            .hint(found.folders > 0 ? fmt::format("name its folders, as {}/*/", object.folder.string())
                                    : "name a folder with the views of one object, or name the files");
    return object;
}

ObjectPoses poses_in(const fs::path& file, const ObjectFolder& object) {
    try {
        const std::vector<ScanPose> poses = read_poses(file, {});
        const bool has_names = std::ranges::none_of(poses, [](const ScanPose& pose) { return pose.scan.empty(); });
        if (!has_names || std::ranges::any_of(object.views, may_hold_several_views)) return {file, {}};
        return {file, misfit(poses, file, object)};
    } catch (const Error& error) {
        return {file,
                {fmt::format("the object '{}' has no poses: {}", object.name(), error.sentence()),
                 error.hint().empty() ? "correct the file of poses, or remove it" : error.hint()}};
    }
}

ObjectPoses poses_beside(const ObjectFolder& object) {
    const auto own = std::ranges::find_if(object.views, may_hold_several_views);
    std::vector<fs::path> found;
    for (const fs::path& file : listed(object.folder).files)
        if (is_poses_file(file)) found.push_back(file);
    if (found.empty()) return {};
    if (own != object.views.end())
        return {{},
                {},
                fmt::format("the object '{}' takes the poses in its views, as '{}'; the file of poses '{}' is not used "
                            "unless `poses` names it",
                            object.name(), own->filename().string(), found.front().string())};
    if (found.size() > 1)
        return {{},
                {fmt::format("the object '{}' has {} files of poses, '{}' and '{}'", object.name(), found.size(),
                             found[0].filename().string(), found[1].filename().string()),
                 "give one as `poses`"}};
    return poses_in(found.front(), object);
}

bool takes_poses(const Workflow& workflow) {
    return std::ranges::find(workflow.parameters, poses_parameter, &WorkflowParameter::name) !=
           workflow.parameters.end();
}

bool takes_views(const Workflow& workflow) { return !workflow.inputs.empty() && workflow.inputs.front().list; }

ValueExpression text_setting(std::string text, Position position) {
    ValueExpression value;
    value.position = position;
    WrittenValue& written = value.values.emplace_back();
    written.position = position;
    written.literal.items = {std::move(text)};
    return value;
}

}  // namespace scanmill
