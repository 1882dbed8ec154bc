// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What the command prints with --json, against the schemas of this tree.

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace scanmill::test {

/// The errors of a document against NAME.schema.json in schemas/output or schemas/documents, one per line; empty if it
/// is valid.
std::string schema_errors(const std::string& name, const nlohmann::json& document);

/// A document with the name of its schema.
struct OutputDocument {
    std::string schema;
    nlohmann::json document;
};

/// The documents, or the events, that a command with these arguments printed; without what is cut off.
std::vector<OutputDocument> output_documents(const std::vector<std::string>& arguments, const std::string& out);

}  // namespace scanmill::test
