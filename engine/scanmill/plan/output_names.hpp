// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Checks the names of output files against each other: no two cells may write the same file, and the file of one cell
/// may not be the folder of another cell's file. Reads no file.

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

#include "scanmill/plan/plan.hpp"

namespace scanmill {

/// The records of all runs in an output folder.
inline constexpr const char* records_file = "scanmill.sqlite";

/// The folder below the output folder that gets the outputs of cells that failed by an expectation.
inline constexpr std::string_view failed_folder_name = "failed";

/// The content of an output file: one output port of one node, for one scan under one workflow.
struct OutputContent {
    std::string node;
    std::string port;
    bool operator==(const OutputContent&) const = default;
};

class OutputNames {
public:
    /// `folder` is put before every name, in messages and results.
    explicit OutputNames(std::filesystem::path folder) : folder_(std::move(folder)) {}

    struct Added {
        std::filesystem::path file;
        bool is_new = false;  ///< false: the same content was added before
    };
    /// Adds an output and its name below `failed_folder_name`. `name` is relative to the folder, in normal form.
    /// `writer` names the cell in messages, and `values` are the cell's placeholders, for hints. Throws Error if an
    /// output with other content has the same name, and if the file of one output is the folder of another. A name
    /// below `failed_folder_name` that another output would take if its cell fails is refused whatever its content: the
    /// next success of that cell would remove the file.
    Added add(const std::string& name, const OutputContent& content, const std::string& writer,
              const TemplateValues& values = {});

private:
    struct Entry {
        OutputContent content;
        std::string writer;
        TemplateValues values;
        bool is_of_failure = false;  ///< written only if the cell fails by an expectation

        std::string text() const { return is_of_failure ? writer + ", if it fails," : writer; }
    };

    Added reserve(const std::filesystem::path& name, Entry entry);
    static std::string way_out(const Entry& one, const Entry& other);

    std::filesystem::path folder_;
    std::map<std::filesystem::path, Entry> files_;
    std::map<std::filesystem::path, std::string> folders_;  // maps each folder of files_ to its first writer
};

/// The JSON file beside an output that describes it: `<output>.json`.
std::filesystem::path description_of(const std::filesystem::path& file);

/// The name of a cell for messages: "scan 'a.ply' under variant 'default' of workflow 'w'". `workflow` is empty if
/// there is only one workflow.
std::string cell_text(const std::string& scan, const std::string& variant, const std::string& workflow);

}  // namespace scanmill
