// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Fuzz targets: all functions that read files of others. A target returns whether the bytes were accepted, and throws
/// LawBroken when the result contradicts itself; a crash, a leak or any other exception is a finding as well.
///
/// The targets are rows of one table (targets.cpp); each has seeds in corpus/<name>/ and optionally words in
/// <name>.dict. With clang, SCANMILL_FUZZ builds a fuzzer from them; without, a test runs them on the seeds.

#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

namespace scanmill::test {

struct FuzzTarget {
    std::string_view name;
    bool (*run)(std::string_view bytes);
};

std::span<const FuzzTarget> fuzz_targets();
/// Throws std::out_of_range when there is none.
const FuzzTarget& fuzz_target(std::string_view name);

struct LawBroken : std::logic_error {
    using std::logic_error::logic_error;
};

inline void require_law(bool holds, const std::string& law) {
    if (!holds) throw LawBroken(law);
}

/// Reads the bytes as a scan called "scan.EXTENSION"; what was read is consistent, and comes back from every format
/// that can carry it.
bool read_scan(std::string_view extension, std::string_view bytes);
/// Reads the bytes as an E57 file, as they are and with the checksums and the size that its content needs.
bool read_e57(std::string_view bytes);
/// Opens the bytes as a stream of the points in "scan.EXTENSION"; returns whether there is one. Its points and warnings
/// must be those of reading the file. read_scan() runs this as well.
bool read_stream(std::string_view extension, std::string_view bytes);
/// Parses and plans a workflow, against filters that exist only as declarations.
bool check_workflow_text(std::string_view bytes);
/// Parses and plans a batch, in a folder with two scans and a workflow, against the same filters; bytes that could lead
/// out of the folder are refused unread.
bool check_batch_text(std::string_view bytes);
/// Reads the bytes as the VALUE of `--set NAME=VALUE`, as every type of parameter, and plans a workflow with it.
bool check_setting(std::string_view bytes);
/// Reads the bytes as a filter's manifest.
bool check_manifest(std::string_view bytes);
/// Reads the bytes as the manifest of a file format's module.
bool check_format_manifest(std::string_view bytes);
/// Reads the bytes as a file of poses, in either syntax.
bool check_poses(std::string_view bytes);
/// Reads the bytes as a JSON document of any kind (features, patches, transform, metrics …); what was read is written
/// and read back as the same text.
bool check_document(std::string_view bytes);

}  // namespace scanmill::test
