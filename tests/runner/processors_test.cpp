// SPDX-License-Identifier: GPL-3.0-or-later
/// Results have the same bytes on every processor and for any number of threads. On a processor without fused
/// multiply-add the C library takes other variants of sin, exp and the like, whose last bits differ.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "support/folders.hpp"
#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

using nlohmann::json;

struct Step {
    std::string id, filter, parameters = "", in = "";
};

/// Every filter at least once, on small noisy scans.
const std::vector<Step> steps{
    {"plate", "virtual-scan",
     "shape: box, size: [4 u, 3 u, 0.1 u], views: [0, 0, 1], resolution: 0.05 u, noise: 0.002 u"},
    {"machine", "virtual-scan",
     "shape: box, size: [4 u, 3 u, 0.2 u], views: [0, 0, 1], resolution: 0.05 u, noise: 0.001 u"},
    {"scan", "virtual-scan", "shape: l-block, resolution: 0.05 u, noise: 0.002 u, outliers: 1 %"},
    {"other-scan", "virtual-scan", "shape: l-block, views: [5], resolution: 0.07 u, noise: 0.004 u"},
    {"left-view", "virtual-scan", "shape: l-block, views: [1, 0.4, 0.6], resolution: 0.03 u, noise: 0.001 u"},
    {"right-view", "virtual-scan", "shape: l-block, views: [0.6, 1, 0.5], resolution: 0.03 u, noise: 0.001 u"},
    {"merged", "merge", "within: 0.01 u", "points: [scan, other-scan]"},
    {"clean", "outlier-removal", "", "points: merged"},
    {"cropped", "crop", "centre: [0 u, 0 u, 0 u], radius: 3 u", "points: clean"},
    {"finely-thinned", "voxel-thin", "", "points: cropped"},
    {"thinned", "voxel-thin", "bin-size: 0.08 u", "points: cropped"},
    {"smoothed", "smooth", "", "points: thinned"},
    {"with-normals", "normals", "", "points: smoothed"},
    {"clustered", "cluster-mesh", "", "points: thinned"},
    {"grown", "region-grow", "", "points: thinned"},
    {"flipped", "edge-flip", "", "mesh: grown"},
    {"repaired", "repair", "", "mesh: clustered"},
    {"filled", "fill-holes", "", "mesh: repaired"},
    {"from-normals", "poisson", "depth: 6", "points: with-normals"},
    {"coloured", "transfer", "columns: [view, normal, moved]", "from: with-normals, to: from-normals"},
    {"tetrahedra", "delaunay", "", "points: smoothed"},
    {"open", "cocone", "", "tets: tetrahedra"},
    {"closed", "tight-cocone", "", "tets: tetrahedra"},
    {"rescan", "crop", "centre: [0 u, 0 u, 0 u], radius: 1 u", "points: smoothed"},
    {"updated", "mesh-update", "on-doubt: keep", "mesh: closed, points: [rescan]"},
    {"solid", "alpha-solid", "", "tets: tetrahedra"},
    {"sculpted", "sculpt", "", "tets: solid.tets"},
    {"reduced", "decimate", "max-error: 1 %diag", "mesh: sculpted"},
    {"lines", "features", "", "mesh: filled"},
    {"measured", "measure", "certify: true", "mesh: reduced, truth: sculpted"},
    {"inspected", "inspect", "tolerance: [-0.02 u, 0.02 u], by: patches", "scan: thinned, nominal: reduced"},
    {"surface", "a-patch", "", "mesh: reduced, points: thinned"},
    {"fine", "tessellate", "", "patches: surface"},
    {"distances", "patch-distance", "", "patches: surface, points: thinned"},
    {"corners", "plate-corners", "", "points: plate"},
    {"machine-corners", "plate-corners", "", "points: machine"},
    {"motion", "align", "", "source: corners, target: machine-corners, part: grown"},
    {"moved", "apply-transform", "", "transform: motion, value: grown"},
    {"moved-lines", "apply-transform", "", "transform: motion, value: grown.features"},
    {"registered", "register", "as-is: true", "points: [left-view, right-view]"},
    {"refined", "icp", "", "source: scan, target: merged"},
    {"refined-on-mesh", "icp", "trim: 0 %, max-distance: 3 spacing", "source: other-scan, target: clustered"},
    {"touches", "probe-planner", "radius: 0.05 u, scanner-error: 0.02 u, spacing: 0.2 u, directions: 2",
     "features: moved-lines, mesh: moved"},
    {"touched", "virtual-probe", "noise: 0.001 u", "probes: touches, mesh: moved"},
    {"edge-points", "probe-compensate", "radius: 0.05 u, scanner-error: 0.02 u", "points: touched"},
    {"picture", "render", "edges: true, boundaries: true, size: [200, 150]", "scene: moved, over: touches"},
    {"bands", "render", "style: lines, size: [200, 150], camera: [auto, front]", "scene: surface"},
    {"points-picture", "render", "size: [200, 150], colour: deviation", "scene: inspected.deviation, truth: reduced"},
    {"perspective", "render", "size: [200, 150], eye: [9 u, 7 u, 5 u], creases: true", "scene: fine, over: lines"},
};

/// The ports of a filter's outputs with the endings of lossless files for them.
std::map<std::string, std::string> outputs_of(const json& filter) {
    std::map<std::string, std::string> outputs;
    for (const json& port : filter.at("outputs")) {
        const std::string kind = port.at("kind");
        outputs[port.at("name")] = kind == "points" || kind == "mesh" ? "ply"
                                   : kind == "tets"                   ? "vtu"
                                   : kind == "picture"                ? "png"
                                                                      : "json";
    }
    return outputs;
}

/// The steps above with every output in a file.
std::string workflow_of(const json& filters) {
    std::string text = "scanmill: 1\nname: every-filter\nsteps:\n", outputs = "outputs:\n";
    for (const auto& [id, filter, parameters, in] : steps) {
        text += fmt::format("  - id: {}\n    {}: {{{}}}\n    in: {{{}}}\n", id, filter, parameters, in);
        if (filter == "apply-transform") {
            outputs += fmt::format("  {}.{}: {}\n", id, id == "moved" ? "ply" : "json", id);
            continue;
        }
        for (const auto& [port, ending] : outputs_of(filters.at(filter)))
            outputs += fmt::format("  {}-{}.{}: {}.{}\n", id, port, ending, id, port);
    }
    return text + outputs;
}

/// Metrics by step and hashes by file.
std::map<std::string, std::string> results(const std::string& workflow, const char* threads,
                                           const std::vector<std::string>& environment) {
    const TemporaryFolder folder;
    folder.write("all.yaml", workflow);
    const ProgramResult ran = scanmill_program({"run", "all.yaml", "--json", "-q", "-j", "0", "--threads", threads},
                                               {.folder = folder.path(), .environment = environment});
    std::map<std::string, std::string> found;
    const json report = json::parse(ran.out);
    for (const json& step : report.at("steps")) {
        EXPECT_FALSE(step.contains("error")) << step.at("step") << ": " << step["error"];
        json metrics = step.value("metrics", json());
        for (auto metric = metrics.begin(); metric != metrics.end();)  // all but times are the same in every run
            metric = metric.key().ends_with("-seconds") ? metrics.erase(metric) : std::next(metric);
        found[step.at("step")] = metrics.dump();
    }
    for (const json& output : report.at("cells").at(0).at("outputs"))
        found[std::filesystem::path(output.at("file")).filename()] = output.value("sha256", "not written");
    return found;
}

json listed_filters() {
    json filters;
    const json list = json::parse(scanmill_program({"list", "--json"}).out);
    for (const json& filter : list.at("filters")) filters[filter.at("name").get<std::string>()] = filter;
    return filters;
}

TEST(Processors, WithAndWithoutFusedMultiplyAdd_WithOneThreadAndTwo_EveryFilterGivesTheSameBytes) {
    const json filters = listed_filters();
    std::set<std::string> tested;
    for (const Step& step : steps) tested.insert(step.filter);
    for (const auto& [name, filter] : filters.items()) EXPECT_TRUE(tested.contains(name)) << "no step runs " << name;
    const std::string workflow = workflow_of(filters);
    const auto usual = results(workflow, "1", {});
    EXPECT_GT(usual.size(), 2 * steps.size());
    EXPECT_EQ(usual,
              results(workflow, "2", {"GLIBC_TUNABLES=glibc.cpu.hwcaps=-FMA,-AVX2_Usable,-FMA_Usable,-AVX2,-FMA4"}));
}

/// Also in code that no step above runs, and in templates of other libraries.
TEST(Processors, NoModuleCallsAFunctionWhoseVariantsDiffer) {
    std::vector<std::filesystem::path> files{build_folder() + "/lib/libscanmill-core.so"};
    for (const char* folder : {"plugins", "formats"})
        for (const auto& entry : std::filesystem::directory_iterator(build_folder() + "/lib/scanmill/" + folder))
            if (entry.path().extension() == ".so") files.push_back(entry.path());
    const std::set<std::string> names{"sin", "cos",  "tan", "sincos", "asin",  "acos", "atan", "atan2",
                                      "exp", "exp2", "log", "log2",   "log10", "pow",  "cbrt", "hypot"};
    const TemporaryFolder folder;
    for (const auto& file : files) {
        const std::string list = (folder / "symbols").string();
        const std::string command = "nm -D --undefined-only --format=posix '" + file.string() + "' > '" + list + "'";
        ASSERT_EQ(std::system(command.c_str()), 0);
        std::ifstream symbols(list);
        for (std::string line; std::getline(symbols, line);) {
            std::string name = line.substr(0, line.find_first_of("@ "));
            EXPECT_FALSE(names.contains(name)) << file << " calls " << name;
            if (name.ends_with('f')) name.pop_back();
            EXPECT_FALSE(names.contains(name)) << file << " calls the single precision of " << name;
        }
    }
}

}  // namespace
}  // namespace scanmill::test
