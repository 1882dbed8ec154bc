// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Objects of many views. An object is a folder; files in it are its views, in the order of their names. Its name is
/// that of the folder. Records know it by the folder's path, as they know a scan by the path of its file.
///
/// The poses of the views are a file beside them, `*.conf` or `*poses.json`. A workflow takes them as its parameter
/// `poses`.

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "scanmill/formats/common/format.hpp"
#include "scanmill/plan/refusal.hpp"
#include "scanmill/workflow/workflow.hpp"

namespace scanmill {

/// The workflow parameter that takes the file of the poses.
inline constexpr const char* poses_parameter = "poses";

struct ObjectFolder {
    std::filesystem::path folder;  ///< its last component is the object's name
    std::vector<std::filesystem::path> views;  ///< sorted by name

    std::string name() const { return folder.filename().string(); }
};

/// The objects with these views: files in one folder belong to one object. In the order of their first files.
std::vector<ObjectFolder> objects_of(std::span<const std::filesystem::path> files);

/// Whether a run wrote its results into the folder. They do not count as views.
bool has_results(const ObjectFolder& object);

/// The files that count as views: those with the extension of a format of points or meshes. Texts (.txt) do only if no
/// other file does.
std::vector<std::filesystem::path> views_among(std::span<const std::filesystem::path> files);

/// The object of a folder, with views_among() its files that are not hidden. Warns about texts that do not count.
/// Throws Error if there are none, if has_results(),
/// or if the folder cannot be read.
ObjectFolder object_in(const std::filesystem::path& folder, const OnWarning& warn = {});

/// The file with the poses of an object's views, or the reason why its cells fail. Both are empty without poses.
struct ObjectPoses {
    std::filesystem::path file;
    Refusal refusal;
    std::string idle{};  ///< a warning about a file of poses beside the views that is not used; empty without one
};

/// The poses for the views of an object, in `file`. Refused if the file cannot be read, if a view has no pose in it, or
/// if it has a pose of another view. Names are not compared if the file has none, or if a view is in a format whose
/// files may hold several views.
ObjectPoses poses_in(const std::filesystem::path& file, const ObjectFolder& object);

/// The poses in the file beside the views. Refused if there are two such files, or if poses_in() refuses it. Views in
/// formats whose files may hold several views have poses of their own; a file beside them is `idle`.
ObjectPoses poses_beside(const ObjectFolder& object);

/// Whether the workflow has the parameter for a file of poses.
bool takes_poses(const Workflow& workflow);

/// Whether the workflow's first input is a list, which the views of an object can feed.
bool takes_views(const Workflow& workflow);

/// A setting of one text, at `position`.
ValueExpression text_setting(std::string text, Position position);

}  // namespace scanmill
