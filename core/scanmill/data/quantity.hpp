// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Numbers with dimensions, as people write them: lengths, angles, ratios.
///
/// A Length is relative (`0.1 %diag`, `3 spacing`), absolute (`0.2 mm`) or in the scan's own unit (`0.5 u`); resolved()
/// converts it to the scan's unit. Algorithms read lengths with value(), which requires a resolved length. The engine
/// resolves the lengths of a filter before it runs (except those declared with takes_spacings). A C++ caller writes
/// `params.tolerance = 0.2` (scan units) or resolves lengths with length_scale(cloud).

#include <functional>
#include <string>
#include <string_view>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/frame.hpp"

namespace scanmill {

/// The lengths of a scan that resolve relative and absolute lengths.
struct LengthScale {
    LengthUnit unit = LengthUnit::unknown;
    /// Functions that return lengths in the scan's unit; called only if a length needs them.
    std::function<double()> diagonal, spacing;
};

/// The notations of quantities, for messages.
inline constexpr std::string_view length_examples = "0.2 mm, 0.1 %diag, 3 spacing or 0.5 u";
inline constexpr std::string_view angle_examples = "40 deg or 0.7 rad";
inline constexpr std::string_view ratio_examples = "5 % or 0.05";

class Length {
public:
    enum class In { scan_unit, percent_of_diagonal, spacing, micrometre, millimetre, centimetre, metre, inch, foot };

    constexpr Length() = default;
    /// A length in the scan's own unit.
    constexpr Length(double amount) : amount_(amount) {}
    constexpr Length(double amount, In in) : amount_(amount), in_(in) {}
    static constexpr Length percent_of_diagonal(double amount) { return {amount, In::percent_of_diagonal}; }
    static constexpr Length spacings(double amount) { return {amount, In::spacing}; }

    constexpr double amount() const { return amount_; }
    constexpr In in() const { return in_; }

    /// The value in the scan's unit. Throws UnresolvedLength if the length is not resolved.
    double value() const;
    /// The same length in the scan's unit. Throws UnresolvedLength for an absolute length on a scan of unknown unit and
    /// for a relative length if its reference is zero.
    Length resolved(const LengthScale& scale) const;
    /// "0.1 %diag", with the shortest digits that read back equal.
    std::string text() const;
    /// Parses a number, an optional space and a unit. Throws Error with the expected forms.
    static Length parse(std::string_view text);
    bool operator==(const Length&) const = default;

private:
    double amount_ = 0;
    In in_ = In::scan_unit;
};

/// The Error for a length that cannot be resolved against a scan, or that is read before it is resolved.
class __attribute__((visibility("default"))) UnresolvedLength : public Error {
public:
    UnresolvedLength(const Length& length, const Error& reason) : Error(reason), length_(length) {}
    ~UnresolvedLength() override;
    const Length& length() const { return length_; }

private:
    Length length_;
};

class Angle {
public:
    constexpr Angle() = default;
    static constexpr Angle degrees(double amount) { return Angle(amount, true); }
    static constexpr Angle radians(double amount) { return Angle(amount, false); }

    double in_radians() const;
    double in_degrees() const;
    std::string text() const;
    static Angle parse(std::string_view text);
    bool operator==(const Angle&) const = default;

private:
    constexpr Angle(double amount, bool degrees) : amount_(amount), degrees_(degrees) {}
    double amount_ = 0;
    bool degrees_ = true;
};

class Ratio {
public:
    constexpr Ratio() = default;
    /// fraction(0.05) and percent(5) are the same ratio, written differently.
    static constexpr Ratio fraction(double amount) { return Ratio(amount, false); }
    static constexpr Ratio percent(double amount) { return Ratio(amount, true); }

    constexpr double value() const { return percent_ ? amount_ / 100 : amount_; }
    std::string text() const;
    /// "5 %" or "0.05".
    static Ratio parse(std::string_view text);
    bool operator==(const Ratio&) const = default;

private:
    constexpr Ratio(double amount, bool percent) : amount_(amount), percent_(percent) {}
    double amount_ = 0;
    bool percent_ = false;
};

}  // namespace scanmill
