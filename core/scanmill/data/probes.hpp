// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// `probes`: where and from which direction a touch probe touches the edges of a part, after Wang 2006, chapter 5.
///
/// A touch has a reference point T near a true edge. The centre of the probe's ball moves from `start` along -u,
/// through T + s u with decreasing s, until the ball meets the part. If T is on the edge, the centre is then at
/// T + r u. The direction u is in the plane perpendicular to the tangent e of the edge. Let n0 be the bisector of the
/// normals n1 (left of e) and n2 (right of e). Then u = cos phi n0 - sin phi (e x n0): a positive phi leans towards n1.

#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "scanmill/data/array.hpp"
#include "scanmill/data/frame.hpp"

namespace scanmill {

/// Reason why a touch is not made; `none` if it is made.
enum class ProbeReason : u8 {
    none,
    concave,  ///< the interior angle is pi or more
    too_narrow,  ///< no direction meets the edge first for all tolerated T, or the ball does not pass the hole
    too_tilted,  ///< every direction that meets the edge first deviates too far from the machine's axis
    obstructed  ///< ball or stylus would meet the part elsewhere, or cannot leave the start along the axis
};
constexpr std::array<std::string_view, 5> names_of(const ProbeReason*) {
    return {"none", "concave", "too-narrow", "too-tilted", "obstructed"};
}

/// The first contact of the ball if it moves against the mesh.
enum class ProbeContact : u8 {
    none,  ///< not simulated: the touch is not made
    edge,  ///< the part, near T
    elsewhere,  ///< the part, too far from T; or the stylus meets the part first
    missed  ///< the ball does not meet the part
};
constexpr std::array<std::string_view, 4> names_of(const ProbeContact*) {
    return {"none", "edge", "elsewhere", "missed"};
}

struct ProbeTouch {
    static constexpr u32 no_order = ~u32(0);
    static constexpr double nan = std::numeric_limits<double>::quiet_NaN();

    u32 touch = 0;  ///< number of the reference point, from 0; two touches of one point share it
    u32 feature = 0;  ///< row of the polyline among the features, from 0
    /// T, relative to frame.origin.
    Vec3 position = Vec3::Zero();
    /// e, n1, n2: unit vectors.
    Vec3 tangent = Vec3::Zero(), left_normal = Vec3::Zero(), right_normal = Vec3::Zero();
    /// alpha: the angle of the material between the two faces, in radians; pi or more where the edge is concave.
    double interior_angle = nan;
    /// Whether n2 is not known, but assumed to be perpendicular to n1.
    bool assumed = false;
    /// The range of directions that meet the edge first, in radians, for every T within the scanner's error of the
    /// edge. NaN if no direction is admissible or none was searched for.
    double phi_min = nan, phi_max = nan;
    /// The range of directions for T on the left face, in radians. Searched for only if `assumed`, else NaN.
    double phi_known_min = nan, phi_known_max = nan;
    /// The direction that is used, in radians; NaN if there is none.
    double phi = nan;
    /// u: unit vector from the part to the probe. Zero if the touch is not made; `start` and `centre` are T then.
    Vec3 approach = Vec3::Zero();
    /// The centre of the ball where the approach begins, and where the retraction ends; relative to frame.origin.
    Vec3 start = Vec3::Zero();
    /// The centre of the ball at contact if T is on the edge, T + r u; relative to frame.origin.
    Vec3 centre = Vec3::Zero();
    ProbeReason reason = ProbeReason::none;
    /// The share of the tried positions of T for which a face is met before the edge; NaN if the touch is not made.
    double false_share = nan;
    ProbeContact contact = ProbeContact::none;
    /// The distance from T to the point of the mesh that the ball meets first; NaN if the ball meets no point.
    double contact_distance = nan;
    /// Position in the order of touches, from 0; no_order if the touch is not made.
    u32 order = no_order;

    bool is_made() const { return reason == ProbeReason::none; }
};
constexpr auto fields(const ProbeTouch*) {
    using T = ProbeTouch;
    constexpr auto is_made = [](const T& touch) { return touch.is_made(); };
    return std::tuple{
        field("touch", &T::touch, "The number of the reference point."),
        field("feature", &T::feature, "The line that the touch measures."),
        field("point", &T::position, "The reference point, in world coordinates.").means(Meaning::position),
        field("tangent", &T::tangent).means(Meaning::direction),
        field("left-normal", &T::left_normal).means(Meaning::direction),
        field("right-normal", &T::right_normal).means(Meaning::direction),
        field("interior-angle", &T::interior_angle, "The angle between the faces; null if not defined.")
            .unit("rad")
            .nullable(),
        field("assumed", &T::assumed, "Whether the right normal is an assumption."),
        field("phi-min", &T::phi_min, "The smallest admissible direction; null if there is none.")
            .unit("rad")
            .nullable(),
        field("phi-max", &T::phi_max).unit("rad").nullable(),
        field("phi-known-min", &T::phi_known_min, "As phi-min, for reference points on the left face.")
            .unit("rad")
            .nullable(),
        field("phi-known-max", &T::phi_known_max).unit("rad").nullable(),
        field("phi", &T::phi, "The direction that is used.").unit("rad").nullable(),
        field("approach", &T::approach, "From the part to the probe; null if the touch is not made.")
            .means(Meaning::direction)
            .only_if(is_made),
        field("start", &T::start, "The ball's centre where the approach begins.")
            .means(Meaning::position)
            .only_if(is_made),
        field("centre", &T::centre, "The predicted centre of the ball at the contact.")
            .means(Meaning::position)
            .only_if(is_made),
        field("reason", &T::reason, "Why the touch is not made."),
        field("false-share", &T::false_share, "The share of admissible reference points where a face is met first.")
            .nullable(),
        field("contact", &T::contact, "What the ball meets first."),
        field("contact-distance", &T::contact_distance, "The distance of the contact from the reference point.")
            .means(Meaning::length)
            .nullable(),
        field("order", &T::order, "Position in the order of touches, from 0.").nullable()};
}

enum class ProbeMoveType : u8 { clearance, approach, retract };
constexpr std::array<std::string_view, 3> names_of(const ProbeMoveType*) {
    return {"clearance", "approach", "retract"};
}

/// A move of the ball's centre along a polyline.
struct ProbeMove {
    ProbeMoveType type;
    u32 touch;  ///< row of the touch that the move leads to; for a retraction, that it comes from
    Array<Vec3> points;  ///< positions of the ball's centre, relative to frame.origin
};
constexpr auto fields(const ProbeMove*) {
    return std::tuple{
        field("type", &ProbeMove::type), field("touch", &ProbeMove::touch, "A row of the touches."),
        field("points", &ProbeMove::points, "The ball's centre, in world coordinates.").means(Meaning::position)};
}

/// The spelling of a DMIS program's moves.
enum class DmisGoto : u8 {
    plain,  ///< GOTO/x,y,z
    cart  ///< GOTO/CART,x,y,z
};
constexpr std::array<std::string_view, 2> names_of(const DmisGoto*) { return {"plain", "cart"}; }

/// How the plan is written as a DMIS program (see dmis_format() in formats/common/built_in.hpp).
struct DmisOptions {
    static constexpr u32 auto_decimals = ~u32(0);
    static constexpr u32 most_decimals = 12;

    std::string header;  ///< used in place of the default header, with its placeholders; empty: the default
    DmisGoto moves = DmisGoto::plain;
    u32 decimals = auto_decimals;  ///< of coordinates; at most most_decimals

    bool operator==(const DmisOptions&) const = default;
};
constexpr auto fields(const DmisOptions*) {
    using T = DmisOptions;
    return std::tuple{
        field("header", &T::header, "The text of the header; null for the default header.").nullable(),
        field("goto", &T::moves, "The spelling of moves."),
        field("decimals", &T::decimals, "Decimals of coordinates; null if the ball's radius decides.").nullable()};
}

struct ProbePlan {
    Frame frame;
    /// In the order of the lines; the two touches of one reference point follow one another.
    std::vector<ProbeTouch> touches;
    /// In the order in which the machine makes them: for each touch a clearance move to its start, the approach and the
    /// retraction.
    std::vector<ProbeMove> moves;

    double radius = 0;  ///< r: the radius of the ball
    double scanner_error = 0;  ///< delta: the largest distance of a reference point from the true edge
    double clearance = 0;  ///< the distance that ball and stylus keep from the part on clearance moves
    double stylus_radius = 0;
    double stylus_length = 0;  ///< from the ball's centre along the machine's axis
    /// a: the unit vector from the ball's centre along the stylus.
    Vec3 machine_axis = Vec3::UnitZ();
    DmisOptions dmis;
};
constexpr auto fields(const ProbePlan*) {
    using T = ProbePlan;
    return std::tuple{
        field("frame", &T::frame).flat(),
        field("radius", &T::radius, "The radius of the ball.").means(Meaning::length),
        field("scanner-error", &T::scanner_error, "The largest distance of a point from the true edge.")
            .means(Meaning::length),
        field("clearance", &T::clearance, "The distance kept from the part on clearance moves.").means(Meaning::length),
        field("stylus-radius", &T::stylus_radius).means(Meaning::length),
        field("stylus-length", &T::stylus_length).means(Meaning::length),
        field("machine-axis", &T::machine_axis, "From the ball's centre along the stylus.").means(Meaning::direction),
        field("dmis", &T::dmis, "How the plan is written as a DMIS program.").optional(),
        field("touches", &T::touches),
        field("moves", &T::moves)};
}

}  // namespace scanmill
