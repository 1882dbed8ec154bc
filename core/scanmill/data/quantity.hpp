// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Numbers with dimensions, as people write them: lengths, angles, ratios.
///
/// A Length may be relative (`0.1 %diag`, `3 spacing`) or in a unit of the world (`0.2 mm`); it becomes a plain number
/// in the scan's own unit through resolved(). Algorithms read lengths with value(), which demands a resolved one: the
/// engine resolves every length once before a filter runs, a C++ caller writes `params.tolerance = 0.2` (scan units) or
/// resolves against length_scale(cloud).

#include <functional>
#include <string>
#include <string_view>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/frame.hpp"

namespace scanmill {

/// What relative and absolute lengths are measured against: one scan.
struct LengthScale {
    LengthUnit unit = LengthUnit::unknown;
    /// Called only when a length needs them; both in the scan's unit.
    std::function<double()> diagonal, spacing;
};

class Length {
public:
    enum class In { scan_unit, percent_of_diagonal, spacing, micrometre, millimetre, centimetre, metre, inch, foot };

    constexpr Length() = default;
    /// In the scan's own unit.
    constexpr Length(double amount) : amount_(amount) {}
    constexpr Length(double amount, In in) : amount_(amount), in_(in) {}
    static constexpr Length percent_of_diagonal(double amount) { return {amount, In::percent_of_diagonal}; }
    static constexpr Length spacings(double amount) { return {amount, In::spacing}; }

    constexpr double amount() const { return amount_; }
    constexpr In in() const { return in_; }

    /// In the scan's unit. Throws UnresolvedLength when the length still is relative or in a unit of the world.
    double value() const;
    /// The same length in the scan's unit. Throws UnresolvedLength: an absolute length on a scan of unknown unit, a
    /// relative one when the scale is zero.
    Length resolved(const LengthScale& scale) const;
    /// "0.1 %diag", shortest digits that read back equal.
    std::string text() const;
    /// Throws Error with what was expected: a number, a space or none, and a unit.
    static Length parse(std::string_view text);
    bool operator==(const Length&) const = default;

private:
    double amount_ = 0;
    In in_ = In::scan_unit;
};

/// A length that cannot be resolved against a scan, or that was read before it was resolved.
class __attribute__((visibility("default"))) UnresolvedLength : public Error {
public:
    UnresolvedLength(const Length& length, const Error& reason) : Error(reason), length_(length) {}
    ~UnresolvedLength() override;
    const Length& length() const { return length_; }

private:
    Length length_;
};

/// "0.2 mm, 0.1 %diag, 3 spacing or 0.5 u": how a length is written, for messages.
std::string_view length_examples();

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
    /// 0.05 and percent(5) are the same ratio, written differently.
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
