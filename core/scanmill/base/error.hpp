// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Errors that users cause or meet. An error has one sentence that a user can act on, a hint, and frames that state
/// where it happened.
///
/// The function that throws writes the sentence (what was found, what is needed, with numbers). Each layer that passes
/// the error on adds one frame, innermost first: "in step 'delaunay' (object.yaml:14:5)", "on scan 'plate.ply'".
/// Broken invariants of the program are asserts, never Errors.

#include <fmt/core.h>

#include <exception>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace scanmill {

/// A setting or filter of the calling program that could solve the problem. Core and engine contain no names of options
/// or filters. The calling program adds the name for a remedy to the hint.
enum class Remedy {
    none,
    name_scans,
    name_input_files,
    declare_unit,
    convert_unit,
    drop_invalid_points,  ///< remove the invalid points of a file
    drop_invalid_rows,  ///< drop the invalid rows of a scan while it is read
    choose_output_folder,
    choose_cache_folder,
    run_without_workers,
    declare_truth_unit,
    move_to_frame,
    mesh_points,  ///< use only the points of a mesh that is not a surface
    use_other_disk,  ///< free space on the disk, or write to another one
    add_memory  ///< run on a machine, or in a job, with more memory
};

class __attribute__((visibility("default"))) Error : public std::exception {
public:
    explicit Error(std::string sentence);
    template <class... Arguments>
        requires(sizeof...(Arguments) > 0)
    explicit Error(fmt::format_string<Arguments...> sentence, Arguments&&... arguments)
        : Error(fmt::format(sentence, std::forward<Arguments>(arguments)...)) {}
    ~Error() override;

    Error& add_frame(std::string frame);
    Error& set_hint(std::string hint);
    /// For `throw Error(...).hint(...)`.
    Error&& hint(std::string text) &&;
    Error&& remedy(Remedy remedy) &&;
    /// An error of the system when a file is written, by its `errno`. Its remedy is another disk if the disk or the
    /// quota is full, or the disk is broken, which often makes it read-only.
    static Error of_writing(std::string sentence, int number);
    /// Ends the sentence with "; expected <forms>". finding() is the sentence before this addition.
    Error&& expected(std::string_view forms) &&;
    /// The same error with another sentence.
    Error reworded(std::string sentence) const;

    const std::string& sentence() const { return sentence_; }
    /// The sentence without "; expected …".
    const std::string& finding() const { return finding_.empty() ? sentence_ : finding_; }
    const std::vector<std::string>& frames() const { return frames_; }
    const std::string& hint() const { return hint_; }
    Remedy remedy() const { return remedy_; }
    /// Sentence, frames (each on its line, indented by two) and hint, without a trailing newline.
    const char* what() const noexcept override { return text_.c_str(); }

private:
    void compose();
    std::string sentence_;
    std::string finding_;  // empty if equal to the sentence
    std::vector<std::string> frames_;
    std::string hint_;
    Remedy remedy_ = Remedy::none;
    std::string text_;
};

}  // namespace scanmill
