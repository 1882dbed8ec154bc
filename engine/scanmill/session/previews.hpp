// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Small pictures and light meshes of files, for reports. They are made once per content of a file and kept in the
/// folder `previews` of an output folder, so that runs without a cache reuse them.
///
/// A preview consists of up to four files in that folder. KEY depends on the contents of the wished file, of its truth
/// and of the file that sets the camera, on the declared units, and on the versions of the filters that make previews.
///
/// | file              | content                                                                                   |
/// |-------------------|-------------------------------------------------------------------------------------------|
/// | KEY.png           | picture of the file                                                                       |
/// | KEY.ply           | the simplified mesh, if the file is a mesh, with its deviation by vertex, if it has one   |
/// | KEY-deviation.png | picture coloured by the deviation: of KEY.ply, or of the file if that has the deviation   |
/// | KEY.json          | hash of the previewed file, names of the parts, scale of the colours, why one is missing  |
///
/// The filters are found by what they declare: the first by name that draws, that simplifies, and that measures.

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "scanmill/data/frame.hpp"
#include "scanmill/kinds/value.hpp"
#include "scanmill/plugin/library.hpp"

namespace scanmill {

/// The deviations that a file has itself, in its unit, as a filter that inspects a part writes them.
struct FileDeviation {
    std::string column;
    std::array<double, 2> range{}, tolerance{};  ///< both ends of the colours, and the limits that they show
};

struct PreviewWish {
    std::filesystem::path file;  ///< may be the name of a view; see file_view()
    std::string sha256;          ///< hash of the file's bytes when it was recorded; empty: of its bytes now
    std::string truth_file;      ///< for the deviation of a mesh; empty: none
    /// Sets the camera: the truth, or else the scan, so that pictures of all variants of a scan match. A mesh or
    /// points. Empty: the wished file.
    std::string camera_file;
    /// Units of the three files; unknown: from the file.
    LengthUnit unit = LengthUnit::unknown, truth_unit = LengthUnit::unknown, camera_unit = LengthUnit::unknown;
    /// Kind of the file. Empty: a mesh or points, of which only the picture is made, as for scans and truths.
    std::optional<Kind> kind = kind_of<TriangleMesh>();
    std::optional<FileDeviation> deviation{};  ///< takes the place of the deviation from the truth
    bool is_for_paper = false;  ///< only the picture of the deviation, with 1200 x 900 pixels
};

struct Preview {
    std::string key;
    std::filesystem::path picture, deviation, mesh;  ///< empty: missing
    std::string reason;  ///< why a file is missing or is not up to date; empty: no reason
    /// The colours of `deviation` end at -scale and scale, in the unit of the mesh; 0 without that picture.
    double scale = 0;
};

struct PreviewSettings {
    unsigned jobs = 1;  ///< largest number of worker processes; 0: all work is done in this process
    unsigned threads = 0;  ///< threads inside a filter; 0: the cores are divided among the jobs
    std::vector<std::string> worker_command;  ///< as in SessionSettings; empty: all work is done in this process
    std::function<bool()> is_cancelled;
    double seconds = 60;  ///< time limit of each preview; not enforced without worker processes
};

/// The folder of previews in an output folder.
std::filesystem::path previews_folder(const std::filesystem::path& folder);

/// Returns the preview of every wish, in order, and makes those that the output folder `folder` lacks.
///
/// - A picture has 320 x 240 pixels unless it is for paper, a simplified mesh at most 3,000 triangles.
/// - The pictures of deviations from one truth have one scale. It is that of the first wish in order whose picture
///   exists; pictures with another scale are drawn again. If none exists, the scale is 1.5 times the median, over these
///   wishes, of the 95 % quantile of the distances by vertex, rounded up to two digits.
/// - A preview of which a part cannot be made stays as it is, with the reason. It is tried again if its key changes.
/// - A reason is not kept, and the preview is tried again in the next call, if a file is missing, changed after it was
///   recorded, or cannot be written, or if the call was cancelled.
///
/// The work is an ordinary run with worker processes, without records and without a cache. Bytes do not depend on jobs
/// and threads. Previews are complete group by group (wishes with one truth), so that an interrupted call loses little.
/// `warn` receives one sentence if no preview can be made. Does not throw Error.
/// Cost: hashes every truth and camera file once, and the files of missing previews.
std::vector<Preview> make_previews(const std::filesystem::path& folder, const std::vector<PreviewWish>& wishes,
                                   FilterLibrary& library, const PreviewSettings& settings,
                                   const std::function<void(std::string)>& warn);

/// The files of unused previews in the output folder `folder`, in the order in which to remove them. A preview is used
/// if it shows an output with one of these hashes, or a file that was read and has one of these names without its
/// folder.
std::vector<std::filesystem::path> unused_previews(const std::filesystem::path& folder,
                                                   const std::set<std::string>& outputs,
                                                   const std::set<std::string>& read);

/// A mesh in 16-bit numbers.
struct QuantisedMesh {
    Vec3 low, high;  ///< box of the vertices in world coordinates
    std::vector<std::uint16_t> positions;  ///< 3 per vertex: 0 is `low`, 65535 is `high`; 0 where both are equal
    std::vector<u32> triangles;  ///< 3 vertices per triangle
    static constexpr std::uint16_t no_deviation = 65535;
    /// 1 per vertex: 0 is -range, 65534 is range, no_deviation is NaN; empty: not in the file.
    std::vector<std::uint16_t> deviation;
    double range = 0;  ///< largest absolute deviation, in the unit of the mesh
    LengthUnit unit = LengthUnit::unknown;
};

/// Reads the mesh of a preview. The deviation is the first vertex column of lengths. Throws Error as
/// read_mesh() does.
QuantisedMesh quantised(const std::filesystem::path& mesh);

}  // namespace scanmill
