// SPDX-License-Identifier: GPL-3.0-or-later
#include <vtkCellData.h>
#include <vtkFieldData.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataWriter.h>

#include <algorithm>
#include <functional>

#include "scanmill/formats/common/writing.hpp"
#include "vtk/vtk_arrays.hpp"
#include "vtp/vtp.hpp"

namespace scanmill::vtk {

namespace {

constexpr u8 touch_type = 0, direction_type = 1, first_move_type = 2;
const std::vector<std::string> type_names{"touch", "direction", "clearance", "approach", "retract"};

/// The cells of a plan: first the touches, then the lines.
struct ProbeCells {
    Array<Vec3> points, directions;
    vtkSmartPointer<vtkCellArray> lines = vtkSmartPointer<vtkCellArray>::New();
    Array<u8> types;
    std::vector<const ProbeTouch*> touches;
    std::vector<std::shared_ptr<const void>> numbers;  ///< arrays that VTK views

    void add(u8 type, const ProbeTouch& touch) {
        types.push_back(type);
        touches.push_back(&touch);
    }
    void add_line(u8 type, const ProbeTouch& touch, std::span<const Vec3> line) {
        lines->InsertNextCell(static_cast<int>(line.size()));
        for (const Vec3& point : line) {
            lines->InsertCellPoint(static_cast<vtkIdType>(points.size()));
            points.push_back(point);
            directions.push_back(Vec3::Zero());
        }
        add(type, touch);
    }
};

ProbeCells cells_of(const ProbePlan& plan) {
    ProbeCells cells;
    cells.lines->Use32BitStorage();
    for (const ProbeTouch& touch : plan.touches) {
        cells.points.push_back(touch.position);
        cells.directions.push_back(touch.approach);
        cells.add(touch_type, touch);
    }
    for (const ProbeTouch& touch : plan.touches)
        if (touch.is_made()) cells.add_line(direction_type, touch, std::array{touch.position, touch.start});
    for (const ProbeMove& move : plan.moves)
        cells.add_line(static_cast<u8>(first_move_type + static_cast<u8>(move.type)), plan.touches[move.touch],
                       move.points);
    return cells;
}

/// Adds the numbers of a field, one for each cell. An index that may be undefined is written as a double, and as NaN if
/// it is undefined. The names of an enumeration's values are added to the field data.
template <class Field>
void add_numbers(ProbeCells& cells, const Field& field, vtkPolyData& data) {
    using Member = typename Field::Member;
    constexpr bool is_small = std::same_as<Member, bool> || Named<Member>;
    std::string name = field.name;
    std::ranges::replace(name, '-', '_');
    const auto add = [&]<class Number>(Number, auto&& number_of) {
        Array<Number> numbers;
        for (const ProbeTouch* touch : cells.touches) numbers.push_back(number_of(touch->*field.member));
        const Buffer<Number> kept(std::move(numbers));
        cells.numbers.push_back(kept.owner());
        data.GetCellData()->AddArray(array_of(kept.span(), 1, name));
    };
    if constexpr (is_small) {
        add(u8(), [](Member member) { return static_cast<u8>(member); });
    } else if constexpr (std::same_as<Member, u32>) {
        constexpr u32 none = std::numeric_limits<u32>::max();
        if (field.is_nullable)
            add(double(), [](u32 index) { return index == none ? ProbeTouch::nan : static_cast<double>(index); });
        else
            add(u32(), std::identity());
    } else if constexpr (std::same_as<Member, double>) {
        add(double(), std::identity());
    }
    if constexpr (Named<Member>) {
        const auto names = names_of(static_cast<const Member*>(nullptr));
        add_text(name + "_names", std::vector<std::string>(names.begin(), names.end()), *data.GetFieldData());
    }
}

}  // namespace

void write_vtp_probes(const Value& value, OutputBuffer& out, const WriteOptions& options) {
    const ProbePlan& plan = *value.get<ProbePlan>();
    warn_lost_precision(plan.frame, positions_of(value).span(), false, "VTP", options);
    ProbeCells cells = cells_of(plan);
    const auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(points_of(plan.frame, cells.points));
    data->SetVerts(single_points(0, plan.touches.size()));
    data->SetLines(cells.lines);
    data->GetPointData()->AddArray(
        array_of(std::span(reinterpret_cast<const double*>(cells.directions.data()), 3 * cells.directions.size()), 3,
                 "direction"));
    data->GetCellData()->AddArray(array_of(std::span<const u8>(cells.types), 1, "type"));
    add_frame(plan.frame, Text::as_string, *data->GetFieldData());
    add_text("type_names", type_names, *data->GetFieldData());
    for_each_field<ProbeTouch>([&](const auto& field) { add_numbers(cells, field, *data); });
    write(*vtkSmartPointer<vtkXMLPolyDataWriter>::New(), *data, out);
}

}  // namespace scanmill::vtk
