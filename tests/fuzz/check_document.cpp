// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "fuzz/targets.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/kinds/document.hpp"
#include "scanmill/kinds/kind.hpp"

namespace scanmill::test {

namespace {

std::string text_of(Kind kind, const void* object) {
    Json document;
    kind.info().to_json(object, document);
    return document.dump();
}

}  // namespace

bool check_document(std::string_view bytes) {
    bool is_read = false;
    try {
        const Json document = parse_document(bytes);
        for (const Kind kind : all_kinds()) {
            if (!kind.has_json() || !document.is_object() || !document.contains(kind.info().json_member)) continue;
            const std::shared_ptr<void> object = kind.info().from_json(document, [](const std::string&) {});
            is_read = true;
            const std::string text = text_of(kind, object.get());
            const std::shared_ptr<void> again = kind.info().from_json(parse_document(text), [](const std::string&) {});
            require_law(text_of(kind, again.get()) == text, "a document that is not read back as it was");
        }
    } catch (const Error&) {
        require_law(!is_read, "a document that was read, written, and then refused");
    }
    return is_read;
}

}  // namespace scanmill::test
