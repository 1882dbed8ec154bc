// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// JSON files: values of every kind with a JSON form (see kinds/kind.hpp), recognised by their kind's own member.

#include "scanmill/formats/common/format.hpp"

namespace scanmill {

Recognition recognise_json(std::string_view head, u64 file_size);
/// Throws Error for a document that no kind recognises.
LoadedFile read_json(const FileBytes& file, const ReadOptions& options);
/// Pre: the value's kind has a JSON form.
void write_json(const Value& value, OutputBuffer& out, const WriteOptions& options);

}  // namespace scanmill
