// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Writes the JSON file that describes an output, and computes the output's SHA-256 hash.

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "scanmill/graph/graph.hpp"
#include "scanmill/worker/report.hpp"

struct sha256_ctx;

namespace scanmill {

/// Computes the SHA-256 hash of bytes that arrive in parts. Users can check it with sha256sum.
class Sha256 {
public:
    Sha256();
    ~Sha256();

    void add(std::string_view bytes);
    /// The hash as 64 hexadecimal digits. Pre: called once, after the last add().
    std::string text();

private:
    std::unique_ptr<sha256_ctx> context_;
};

/// The SHA-256 hash of the file's bytes; empty if it cannot be read.
std::string sha256_of(const std::filesystem::path& file);

// The description of an output is the small JSON file `<output>.json` beside it. It contains the properties of the file
// and how it was made. Equal outputs have equal descriptions, whenever and wherever they were made.

/// Describes as JSON how an output was made. The text contains the workflow, its variants, the scan, the seed, the
/// program's version, the doubts, and the expectations of the step that made the output. With `is_evidence`, it
/// contains the expectations that the cells do not meet. For each step from the scan to the output, it contains filter,
/// version, build, key, parameters and metrics. `cells` are all cells that share the file.
std::string made_how(const RunGraph& graph, const std::vector<std::size_t>& cells, const RunOutput& output,
                     const std::vector<NodeReport>& reports, bool is_evidence = false);

/// The names of all columns that the node's filter, or a filter upstream, declares to add.
std::vector<std::string> added_columns(const RunGraph& graph, std::size_t node);

/// Writes the description of a file that was written. It consists of `how`, the result of made_how(), and of the name,
/// size and `sha256` of the file. It also contains unit, frame and properties of the value, and `shift` unless it is
/// zero (see WriteOptions::on_shift). Throws Error as AtomicFile does.
void write_description(const std::filesystem::path& file, const std::string& sha256, const std::string& how,
                       const Value& value, const Metrics& properties, const Vec3& shift);

/// Moves a written output with its description to `to`, and adds `unmet`, the result of unmet_by(), to the description.
/// Files already there are replaced. Makes the folder. Throws Error if a file cannot be moved; then the output keeps
/// its path and its description.
void move_with_description(const std::filesystem::path& file, const std::filesystem::path& to,
                           const std::vector<std::string>& unmet);

}  // namespace scanmill
