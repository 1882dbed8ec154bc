// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The SHA-256 of bytes that come piece by piece; the hash that users can check with sha256sum.

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "scanmill/graph/graph.hpp"
#include "scanmill/worker/report.hpp"

struct sha256_ctx;

namespace scanmill {

class Sha256 {
public:
    Sha256();
    ~Sha256();

    void add(std::string_view bytes);
    /// 64 hexadecimal digits. Once, after everything was added.
    std::string text();

private:
    std::unique_ptr<sha256_ctx> context_;
};

// The small JSON file beside every output, `<output>.json`: what the file is, how it was made, and what is known to be
// true of it. Equal outputs have equal descriptions, whenever and wherever they were made.

/// Describes as JSON how an output was made: workflow and variants, scan, seed, the program's version, expectations of
/// the step that made it, and for each step from the scan to it: filter, version, build, key, parameters, metrics and
/// doubts. `cells`: all that share the file.
std::string made_how(const RunGraph& graph, const std::vector<std::size_t>& cells, const RunOutput& output,
                     const std::vector<NodeReport>& reports);

/// Names of the columns that the filters between the files that were read and the node's outputs declare to add.
std::vector<std::string> added_columns(const RunGraph& graph, std::size_t node);

/// Writes the description of a file that was written: `how` (of made_how()), with the file's name, bytes and `sha256`
/// (of what was written, see Sha256), the value's unit, frame and properties, and `shift` unless it is zero (see
/// WriteOptions::on_shift). Throws Error as AtomicFile.
void write_description(const std::filesystem::path& file, const std::string& sha256, const std::string& how,
                       const Value& value, const Metrics& properties, const Vec3& shift);

}  // namespace scanmill
