// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstring>

#include "scanmill/base/error.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/ply/detail/ply_table.hpp"

namespace scanmill {

namespace {

class RowReader {
public:
    RowReader(TextCursor& text, const PlyElement& element) : text_(text), element_(element) {}

    void read_rows(std::span<const PlySlot> slots) {
        for (row_ = 0; row_ < element_.count; ++row_) {
            if (!text_.next_row())
                throw Error("line {}: the text ends after {} of {} rows of element {}", text_.line(), row_,
                            element_.count, quote(element_.name))
                    .hint("the file is truncated or its header is wrong: fetch or export it again");
            for (const PlySlot& slot : slots)
                if (slot.property->is_list())
                    read_list(slot);
                else
                    read_scalar(slot);
            if (text_.more() && result_.count++ == 0) result_.first_line = text_.line();
        }
    }

    OverlongRows result() const { return result_; }

private:
    template <class T>
    T read(const PlyProperty& property) {
        if (!text_.more())
            throw Error("line {}: row {} of element {} ends before its property {}", text_.line(), row_,
                        quote(element_.name), quote(property.name));
        T number{};
        if (!text_.number(number))
            throw Error("line {}: {} is no number of type {} for the property {} of element {}", text_.line(),
                        quote(text_.last_token()), name_of(scalar_type_of<T>()), quote(property.name),
                        quote(element_.name));
        return number;
    }

    void read_scalar(const PlySlot& slot) {
        if (slot.widened) {
            // The text may carry more digits than the declared type holds: they are kept.
            const double number = read<double>(*slot.property);
            std::memcpy(slot.place + row_ * slot.stride, &number, sizeof number);
            return;
        }
        visit_scalar(slot.property->type, [&](auto zero) {
            const auto number = read<decltype(zero)>(*slot.property);
            if (slot.place) std::memcpy(slot.place + row_ * slot.stride, &number, sizeof number);
        });
    }

    void read_list(const PlySlot& slot) {
        const u64 length = read<u64>(*slot.property);
        if (slot.lists && slot.lists->offsets.empty()) begin_lists(slot);
        visit_scalar(slot.property->type, [&](auto zero) {
            for (u64 i = 0; i < length; ++i) {
                const auto number = read<decltype(zero)>(*slot.property);
                if (!slot.lists) continue;
                Array<std::byte>& values = slot.lists->values;
                values.resize(values.size() + sizeof number);
                std::memcpy(values.data() + values.size() - sizeof number, &number, sizeof number);
            }
        });
        if (slot.lists) slot.lists->offsets.push_back(slot.lists->offsets.back() + length);
    }

    void begin_lists(const PlySlot& slot) {
        constexpr std::size_t usual_length = 3;
        slot.lists->offsets.reserve(element_.count + 1);
        slot.lists->offsets.push_back(0);
        slot.lists->values.reserve(element_.count * usual_length * size_of(slot.property->type));
    }

    TextCursor& text_;
    const PlyElement& element_;
    u64 row_ = 0;
    OverlongRows result_;
};

}  // namespace

OverlongRows decode_ply_ascii(TextCursor& text, const PlyElement& element, std::span<const PlySlot> slots) {
    for (const PlySlot& slot : slots)
        if (slot.lists && element.count == 0) slot.lists->offsets.assign(1, 0);
    if (slots.empty()) return {};
    RowReader reader(text, element);
    reader.read_rows(slots);
    return reader.result();
}

}  // namespace scanmill
