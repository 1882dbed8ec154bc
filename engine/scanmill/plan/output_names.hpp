// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The names of output files, checked against each other: no two cells write one file, and none writes into a folder
/// that is a file of another. Reads no file.

#include <filesystem>
#include <map>
#include <string>

namespace scanmill {

/// The content of an output file: one output port of one node, for one scan under one workflow.
struct OutputContent {
    std::string node;
    std::string port;
    bool operator==(const OutputContent&) const = default;
};

class OutputNames {
public:
    /// Messages and results contain the names below this folder.
    explicit OutputNames(std::filesystem::path folder) : folder_(std::move(folder)) {}

    struct Added {
        std::filesystem::path file;
        bool is_new = false;  ///< false: the same content was added before
    };
    /// `name`: relative to the folder, in normal form. `writer` names the cell in messages. Throws Error when another
    /// content has the same name, and when one output's file is another's folder.
    Added add(const std::string& name, const OutputContent& content, const std::string& writer);

private:
    struct Entry {
        OutputContent content;
        std::string writer;
    };

    std::filesystem::path folder_;
    std::map<std::filesystem::path, Entry> files_;
    std::map<std::filesystem::path, std::string> folders_;  // folders of files_ and the first writer of each
};

/// The JSON file beside an output that describes it: `<output>.json`.
std::filesystem::path description_of(const std::filesystem::path& file);

/// "scan 'a.ply' under variant 'default' of workflow 'w'": for messages. `workflow`: empty if there is only one.
std::string cell_text(const std::string& scan, const std::string& variant, const std::string& workflow);

}  // namespace scanmill
