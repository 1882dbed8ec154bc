// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The syntax of DMIS 5.2, the language of coordinate measuring machines: statements, continuation lines, units,
/// numbers.
///
///     F(P000001)=FEAT/POINT,CART,1.0000,2.0000,3.0000,$
///     0.0000,0.0000,1.0000
///     $$ a comment
///
/// Only the part that programs for touches and their results need (see built_in.hpp). The syntax is known from public
/// programs.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scanmill/data/frame.hpp"
#include "scanmill/formats/common/text_cursor.hpp"

namespace scanmill::dmis {

constexpr std::size_t longest_line = 80;
constexpr std::size_t longest_label = 10;
/// Greatest difference from 1 of a written direction's length.
constexpr double unit_tolerance = 1e-4;

/// MM, CM, M, INCH, FEET; empty for other units.
std::string_view unit_name(LengthUnit unit);
std::optional<LengthUnit> unit_named(std::string_view name);
/// "MM, CM, M, INCH or FEET", for messages.
std::string unit_names();

/// `[type(label)=]major[/field,field,…]`, in upper case except in quotes; without blanks around the parts.
struct Statement {
    std::size_t line = 0;  ///< number of the first line, from 1
    std::string_view type, label;  ///< "FA" and "P000001"; empty if absent
    std::string_view major;  ///< "FEAT"
    std::vector<std::string_view> fields;  ///< "POINT", "CART", …

    bool is(std::string_view wanted_type, std::string_view wanted_major) const {
        return type == wanted_type && major == wanted_major;
    }
    std::string_view field(std::size_t i) const { return i < fields.size() ? fields[i] : std::string_view(); }
};

/// Reads a text statement by statement. A line that ends with `$` goes on in the next one. `$$` outside quotes begins a
/// comment. Lines end with LF, CRLF or CR. Blank lines are skipped. Bytes that are not ASCII are passed over.
class Statements {
public:
    explicit Statements(std::string_view text) : rest_(text) {}

    /// Moves to the next statement; false at the end of the text.
    bool next();
    /// Valid until next() is called.
    const Statement& current() const { return statement_; }
    /// The number of the last line that was read.
    std::size_t line() const { return line_; }
    /// Whether the text ends with `$`, or with a statement other than ENDFIL that has no line end.
    bool is_cut() const { return is_cut_; }
    u64 foreign_bytes() const { return foreign_bytes_; }
    u64 long_lines() const { return long_lines_; }
    const KeptComments& comments() const { return comments_; }

private:
    void add_line(std::string_view line);
    void parse();

    std::string_view rest_;
    std::string joined_;
    Statement statement_;
    std::size_t line_ = 0;
    bool is_quoted_ = false, is_continued_ = false, is_cut_ = false;
    u64 foreign_bytes_ = 0, long_lines_ = 0;
    KeptComments comments_;
};

/// The statement in lines of at most 80 characters, each with a line end. Lines are broken behind commas if possible.
std::string lines_of(std::string_view statement);

/// The number with so many decimals, rounded to nearest; never "-0.00". Independent of the locale.
std::string fixed_text(double number, u32 decimals);

}  // namespace scanmill::dmis
