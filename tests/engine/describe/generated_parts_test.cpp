// SPDX-License-Identifier: GPL-3.0-or-later
// Parts of Markdown pages that are written from the filters' declarations.

#include "scanmill/describe/generated_parts.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scanmill/describe/filter_page.hpp"
#include "support/folders.hpp"
#include "support/thrown.hpp"

namespace scanmill {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class GeneratedParts : public testing::Test {
protected:
    std::string updated(const std::string& page) const { return with_generated_parts(page, library_); }
    std::string refusal(const std::string& page) const {
        return test::error_of([&] { updated(page); }).what();
    }
    FilterLibrary library_{{test::test_plugin_folder()}};
};

TEST_F(GeneratedParts, OnlyWhatIsBetweenTheMarks_Changes) {
    const std::string page = "# Page\n\n<!-- generated: filter test-step -->\nOBSOLETE\n<!-- end -->\n\nThe end";
    const std::string once = updated(page);
    EXPECT_EQ(once, "# Page\n\n<!-- generated: filter test-step -->\n" + filter_reference(*library_.find("test-step")) +
                        "<!-- end -->\n\nThe end");
    EXPECT_EQ(updated(once), once);
    EXPECT_THAT(once, AllOf(HasSubstr("| `length` |"), HasSubstr("- it is asked to doubt.\n"), HasSubstr("- Version "),
                            Not(HasSubstr("OBSOLETE"))));
}

TEST_F(GeneratedParts, Tables_LinkThePagesOfTheFilters) {
    const std::string all = updated(
        "<!-- generated: filters ../{folder}/README.md -->\n<!-- end -->\n"
        "<!-- generated: doubts {filter}.md -->\n<!-- end -->\n");
    EXPECT_THAT(all, HasSubstr("| [test-step](../test_step/README.md) | points"));
    EXPECT_THAT(all, HasSubstr("| [test-step](test-step.md) | it is asked to doubt |"));
    EXPECT_THAT(all, Not(HasSubstr("(test-draw.md)"))) << "it declares no doubts";
}

TEST_F(GeneratedParts, Faults_NameTheLine) {
    EXPECT_THAT(refusal("a\n<!-- generated: filter test-stepp -->\n<!-- end -->\n"),
                AllOf(HasSubstr("line 2: there is no filter 'test-stepp'"), HasSubstr("test-step'")));
    EXPECT_THAT(refusal("<!-- generated: numbers -->\n<!-- end -->\n"),
                HasSubstr("line 1: 'numbers' cannot be generated"));
    EXPECT_THAT(refusal("<!-- generated: filters -->\n<!-- end -->\n"), HasSubstr("'filters LINK'"));
    EXPECT_THAT(refusal("\n<!-- generated: filter test-step -->\nold\n"),
                HasSubstr("line 2: the generated part has no end"));
    EXPECT_THAT(refusal("<!-- generated: filter test-step -->\n<!-- generated: filter test-draw -->\n<!-- end -->\n"),
                HasSubstr("line 1: the generated part has no end"));
    EXPECT_THAT(refusal("# Page\n"), HasSubstr("has no line '<!-- generated: WHAT -->'"));
}

}  // namespace
}  // namespace scanmill
