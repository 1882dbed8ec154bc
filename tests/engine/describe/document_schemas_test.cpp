// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/describe/document_schemas.hpp"

#include <gmock/gmock.h>

#include "scanmill/kinds/document.hpp"
#include "scanmill/kinds/kind.hpp"
#include "support/folders.hpp"
#include "support/output_schemas.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill {
#define SCANMILL_DECLARE(T) struct T;
SCANMILL_ALL_KINDS(SCANMILL_DECLARE)
#undef SCANMILL_DECLARE
}  // namespace scanmill

namespace scanmill::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

std::string example_text(const std::string& name) {
    return content_of(test::source_folder() + "/tests/fuzz/corpus/document/" + name + ".json");
}

class DocumentSchemas : public testing::TestWithParam<std::string> {};

TEST_P(DocumentSchemas, DocumentsThatAreReadAndWritten_AreValid) {
    const std::string text = example_text(GetParam());
    EXPECT_EQ(schema_errors(GetParam(), json::parse(text)), "");
    const KindInfo& kind = kind_named(GetParam())->info();
    Json written;
    kind.to_json(kind.from_json(parse_document(text), [](const std::string&) {}).get(), written);
    EXPECT_EQ(schema_errors(GetParam(), json::parse(written.dump())), "") << written.dump(1);
}

TEST_P(DocumentSchemas, MembersThatAreMissingUnknownOrOfAnotherType_AreErrors) {
    const json document = json::parse(example_text(GetParam()));
    json unknown = document;
    unknown["no-such-member"] = 1;
    EXPECT_THAT(schema_errors(GetParam(), unknown), HasSubstr("no-such-member"));
    json missing = document, changed = document;
    const std::string member(kind_named(GetParam())->info().json_member);
    missing.erase(member);
    EXPECT_THAT(schema_errors(GetParam(), missing), HasSubstr(member));
    changed[member] = 7;
    EXPECT_NE(schema_errors(GetParam(), changed), "");
}

INSTANTIATE_TEST_SUITE_P(All, DocumentSchemas, testing::ValuesIn(document_names()),
                         [](const auto& kind) { return kind.param; });

TEST(DocumentSchemaNames, AreTheShippedKindsWithAJsonForm) {
    std::vector<std::string> kinds;
#define SCANMILL_ADD(T) \
    if (kind_of<T>().has_json()) kinds.emplace_back(kind_of<T>().name());
    SCANMILL_ALL_KINDS(SCANMILL_ADD)
#undef SCANMILL_ADD
    EXPECT_THAT(document_names(), testing::UnorderedElementsAreArray(kinds));
}

TEST(DocumentSchemaNames, AreTheFilesOfTheTree) {
    for (const std::string& name : document_names())
        EXPECT_EQ(content_of(test::source_folder() + "/schemas/documents/" + name + ".schema.json"),
                  document_schema(name))
            << "run: make generate";
}

}  // namespace
}  // namespace scanmill::test
