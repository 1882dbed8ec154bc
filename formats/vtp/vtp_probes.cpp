// SPDX-License-Identifier: GPL-3.0-or-later
#include <vtkCellData.h>
#include <vtkFieldData.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataWriter.h>

#include "scanmill/formats/common/writing.hpp"
#include "scanmill/kinds/probes.hpp"
#include "vtk/vtk_arrays.hpp"
#include "vtp/vtp.hpp"

namespace scanmill::vtk {

namespace {

constexpr u8 touch_type = 0, direction_type = 1, first_move_type = 2;
const std::vector<std::string> type_names{"touch", "direction", "clearance", "approach", "retract"};

/// The cells of a plan, and their data: first the touches, then lines.
struct ProbeCells {
    Array<Vec3> points, directions;
    vtkSmartPointer<vtkCellArray> lines = vtkSmartPointer<vtkCellArray>::New();
    Array<u8> type, reason, contact, assumed;
    Array<u32> touch, feature;
    Array<double> interior_angle, phi, false_share, contact_distance;
    Array<double> order;  ///< NaN, as phi, where the touch is not made

    void add_data(u8 cell_type, const ProbeTouch& of) {
        type.push_back(cell_type);
        reason.push_back(static_cast<u8>(of.reason));
        touch.push_back(of.touch);
        feature.push_back(of.feature);
        interior_angle.push_back(of.interior_angle);
        assumed.push_back(of.assumed);
        phi.push_back(of.phi);
        false_share.push_back(of.false_share);
        contact.push_back(static_cast<u8>(of.contact));
        contact_distance.push_back(of.contact_distance);
        order.push_back(of.order == ProbeTouch::no_order ? ProbeTouch::nan : static_cast<double>(of.order));
    }
    void add_line(u8 cell_type, const ProbeTouch& of, std::span<const Vec3> line) {
        lines->InsertNextCell(static_cast<int>(line.size()));
        for (const Vec3& point : line) {
            lines->InsertCellPoint(static_cast<vtkIdType>(points.size()));
            points.push_back(point);
            directions.push_back(Vec3::Zero());
        }
        add_data(cell_type, of);
    }
};

ProbeCells cells_of(const ProbePlan& plan) {
    ProbeCells cells;
    cells.lines->Use32BitStorage();
    for (const ProbeTouch& touch : plan.touches) {
        cells.points.push_back(touch.position);
        cells.directions.push_back(touch.approach);
        cells.add_data(touch_type, touch);
    }
    for (const ProbeTouch& touch : plan.touches)
        if (touch.reason == ProbeReason::none)
            cells.add_line(direction_type, touch, std::array{touch.position, touch.start});
    for (const ProbeMove& move : plan.moves)
        cells.add_line(static_cast<u8>(first_move_type + static_cast<u8>(move.type)), plan.touches[move.touch],
                       plan.path.span().subspan(move.begin, move.end - move.begin));
    return cells;
}

}  // namespace

void write_vtp_probes(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    const ProbePlan& plan = *value.get<ProbePlan>();
    warn_lost_precision(plan.frame, positions_of(value).span(), false, "VTP", options);
    const ProbeCells cells = cells_of(plan);
    const auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(points_of(plan.frame, cells.points));
    data->SetVerts(single_points(0, plan.touches.size()));
    data->SetLines(cells.lines);
    data->GetPointData()->AddArray(
        array_of(std::span(reinterpret_cast<const double*>(cells.directions.data()), 3 * cells.directions.size()), 3,
                 "direction"));
    const auto add = [&]<class T>(const Array<T>& rows, std::string_view name) {
        data->GetCellData()->AddArray(array_of(std::span<const T>(rows), 1, name));
    };
    add(cells.type, "type");
    add(cells.touch, "touch");
    add(cells.feature, "feature");
    add(cells.reason, "reason");
    add(cells.interior_angle, "interior_angle");
    add(cells.assumed, "assumed");
    add(cells.phi, "phi");
    add(cells.false_share, "false_share");
    add(cells.contact, "contact");
    add(cells.contact_distance, "contact_distance");
    add(cells.order, "order");
    add_frame(plan.frame, Text::as_string, *data->GetFieldData());
    add_text("type_names", type_names, *data->GetFieldData());
    std::vector<std::string> reasons, contacts;
    for (u8 reason = 0; reason <= static_cast<u8>(ProbeReason::obstructed); ++reason)
        reasons.emplace_back(name_of(static_cast<ProbeReason>(reason)));
    for (u8 contact = 0; contact <= static_cast<u8>(ProbeContact::missed); ++contact)
        contacts.emplace_back(name_of(static_cast<ProbeContact>(contact)));
    add_text("reason_names", reasons, *data->GetFieldData());
    add_text("contact_names", contacts, *data->GetFieldData());
    write(*vtkSmartPointer<vtkXMLPolyDataWriter>::New(), *data, out);
}

}  // namespace scanmill::vtk
