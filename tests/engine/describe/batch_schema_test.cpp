// SPDX-License-Identifier: GPL-3.0-or-later
// The JSON Schema of batches accepts what the parser accepts, and rejects at the same place what it rejects.

#include "scanmill/describe/schemas.hpp"

#include "engine/batch/measuring_batches.hpp"
#include "engine/describe/schema_support.hpp"

namespace scanmill {
namespace {

using test::known_only;
using testing::HasSubstr;

class BatchSchema : public test::MeasuringBatches {
protected:
    test::Schema schema_{batch_schema(library_)};
};

TEST_F(BatchSchema, WhatTheParserAccepts_IsAccepted) {
    folder_.write("p.json", "{\"scanmill\": 1, \"poses\": [{\"rotation\": [0, 0, 0, 1], \"translation\": [0, 0, 0]}]}");
    const std::string scan = "scanmill: 1\nbatch: b\nworkflows: [w.yaml]\nscans: ";
    for (const std::string& batch :
         {head, head + "summary: It.\nset:\nlimits:\n", std::string("scanmill: 1\nbatch: b\nworkflows: w.yaml\n"),
          scan + "[{path: scans/*.ply, unit: mm, invalid: drop, frame: '{stem}', pose: p.json, truth: "
                 "'scans/{stem}.ply', set: {n: "
                 "2}}]\n",
          scan + "[{path: scans/*.ply, set: , pose: [[1, 0, 0, 0.5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]}]\n",
          scan + "[scans/a.ply, {path: scans/b.ply, pose: {translation: [1, 2, 3], rotation: [0, 0, 0, 1]}}]\n",
          head + "set: {n: {sweep: [1, 2]}, s: 0.1 %diag, t: [1, 2], u: true, v: $$x}\n",
          scan + "[{path: scans/a.ply, truth: {path: '{folder}/{stem}.ply', unit: cm, frame: x}, in: {to: scans/a.ply, "
                 "more: [scans/a.ply, scans/b.ply]}}]\n",
          head + "measure:\n", head + "measure: {}\n",
          head + "measure: {of: surface, samples: 5}\ngate: {hausdorff: +1 %, surface.genus: exact, kept: -2, "
                 "closed: exact, outputs: exact, seconds: +20 %, memory: +50 %, repeats: 3}\n",
          head + "measure: {of: [a, b.mesh], filter: compare, near: 2 %diag}\n",
          head + "limits: {memory: 8 GiB, time: 10 min, step: {memory: 1.5GB, time: 250 ms}, retries: 0}\n"}) {
        EXPECT_THAT(findings(batch), testing::IsEmpty()) << batch;
        EXPECT_EQ(schema_.complaints(batch), "") << batch;
    }
}

struct Mistake {
    std::string batch;
    std::string schema;  ///< a part of the schema's errors: position and reason
    std::string parser;  ///< a part of the parser's only error
};

/// One mistake each, so that neither of the two can reject it for another reason.
std::vector<Mistake> mistakes(const std::string& head) {
    const std::string scan = "scanmill: 1\nbatch: b\nworkflows: [w.yaml]\nscans: ";
    const std::string files = "scanmill: 1\nbatch: b\nscans: [scans/a.ply]\nworkflows: ";
    return {
        {"batch: b\nscans: [scans/a.ply]\nworkflows: w.yaml\n", ": Missing required property 'scanmill'",
         "has no grammar version"},
        {"scanmill: 1\nscans: [scans/a.ply]\nworkflows: w.yaml\n", ": Missing required property 'batch'",
         "has no name"},
        {"scanmill: 1\nbatch: b\nscans: [scans/a.ply]\n", ": Missing required property 'workflows'",
         "has no workflows"},
        {"scanmill: 2\nbatch: b\nscans: [scans/a.ply]\nworkflows: w.yaml\n", "scanmill: Failed to match expected value",
         "the grammar is '2'"},
        {"scanmill: 1\nbatch: a b\nscans: [scans/a.ply]\nworkflows: w.yaml\n", "batch: Failed to match regex",
         "'a b' is not a name"},
        {head + "sumary: x\n", ": Object contains a property" + known_only + "'sumary'", "has no key 'sumary'"},
        {head + "summary: [x]\n", "summary: Value type not permitted", "a text for 'summary'"},
        {scan + "[]\n", "scans: Array should contain no fewer than 1", "the list of scans is empty"},
        {scan + "scans/a.ply\n", "scans: Value type not permitted", "expected a list of scans"},
        {scan + "['']\n", "scans 0: String should be no fewer than 1", "the path is empty"},
        {scan + "[{unit: mm}]\n", "scans 0: Missing required property 'path'", "the scan has no path"},
        {scan + "[{path: scans/a.ply, unti: mm}]\n", "scans 0: Object contains a property" + known_only + "'unti'",
         "a scan has no key 'unti'"},
        {scan + "[{path: scans/a.ply, invalid: keep}]\n", "scans 0 invalid: Failed to match against any enum",
         "expected drop or refuse"},
        {scan + "[{path: scans/a.ply, unit: yard}]\n", "scans 0 unit: Failed to match against any enum",
         "'yard' is not a unit"},
        {scan + "[{path: scans/a.ply, frame: [x]}]\n", "scans 0 frame: Value type not permitted", "a text for 'frame'"},
        {scan + "[{path: scans/a.ply, truth: ''}]\n", "scans 0 truth: String should be no fewer than 1",
         "the truth is empty"},
        {scan + "[{path: scans/a.ply, pose: }]\n", "scans 0 pose: Value type not permitted",
         "expected a file, as poses/"},
        {scan + "[{path: scans/a.ply, pose: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]}]\n",
         "scans 0 pose: Array should contain no fewer than 4", "a matrix of 3 rows"},
        {scan + "[{path: scans/a.ply, pose: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1], [0, 0, 0, 1]]}]\n",
         "scans 0 pose 2: Array should contain no fewer than 4", "a list of 3 values"},
        {scan + "[{path: scans/a.ply, pose: {translation: [0, 0, x], rotation: [0, 0, 0, 1]}}]\n",
         "scans 0 pose translation 2: Value type not permitted", "'x' is not a finite number"},
        {scan + "[{path: scans/a.ply, pose: {rotation: [0, 0, 0, 1]}}]\n",
         "scans 0 pose: Missing required property 'translation'", "the pose has no translation"},
        {scan + "[{path: scans/a.ply, set: {a b: 1}}]\n",
         "scans 0: Failed to validate against schema associated with property name 'set'", "'a b' is not a name"},
        {files + "[]\n", "workflows: Array should contain no fewer than 1", "the list of workflows is empty"},
        {files + "{}\n", "workflows: Value type not permitted", "expected a list of workflow files"},
        {files + "[[]]\n", "workflows 0: Value type not permitted", "expected a workflow file"},
        {head + "set: {n: $m}\n", "set n: Failed to match regex", "cannot refer to a parameter"},
        {head + "set: {n: {sweep: []}}\n", "set n sweep: Array should contain no fewer than 1",
         "the sweep has no values"},
        {head + "set: {n: {swep: [1]}}\n", "set n: Object contains a property" + known_only + "'swep'",
         "a value has no key 'swep'"},
        {head + "set: {n: }\n", "set n: Value type not permitted", "found nothing"},
        {head + "limits: {memory: 8}\n", "limits memory: Value type not permitted", "'8' has no unit"},
        {head + "limits: {memory: 8 Gb}\n", "limits memory: Failed to match regex", "'8 Gb' is not a size"},
        {head + "limits: {memory: 0 B}\n", "limits memory: Failed to match regex", "is out of range"},
        {head + "limits: {time: 5 m}\n", "limits time: Failed to match regex", "'5 m' is not a time"},
        {head + "limits: {time: -5 s}\n", "limits time: Failed to match regex", "'-5 s' is not a time"},
        {head + "limits: {step: {tme: 5 s}}\n", "limits step: Object contains a property" + known_only + "'tme'",
         "has no key 'tme'"},
        {head + "limits: {step: }\n", "limits step: Value type not permitted", "expected the limits of one step"},
        {head + "limits: {retries: 11}\n", "limits retries: Expected number less than or equal to 10",
         "11 is out of range"},
        {head + "limits: {retries: 1.5}\n", "limits retries: Value type not permitted", "'1.5' is not a whole number"},
        {head + "measure: {of: []}\n", "measure of: Array should contain no fewer than 1",
         "the list of values to measure is empty"},
        {head + "measure: {of: {}}\n", "measure of: Value type not permitted", "the name of a step"},
        {head + "measure: all\n", "measure: Value type not permitted", "expected a map, as {of: [surface]"},
        {head + "gate: {}\n", "gate: Object should have no fewer than 1", "the gate has no rules"},
        {head + "gate: strict\n", "gate: Value type not permitted", "expected a map from metrics"},
        {head + "gate: {distance: [1]}\n", "gate distance: Value type not permitted", "expected a tolerance"},
        {head + "gate: {kept: exact, repeats: 0}\n", "gate repeats: Expected number greater than or equal to 1",
         "0 is out of range"},
        {head + "gate: {kept: exact, repeats: 21}\n", "gate repeats: Expected number less than or equal to 20",
         "21 is out of range"},
        {scan + "[{path: scans/a.ply, truth: {unit: mm}}]\n", "scans 0 truth: Missing required property 'path'",
         "the truth has no path"},
        {scan + "[{path: scans/a.ply, in: {to: []}}]\n", "scans 0 in to: Array should contain no fewer than 1",
         "the list of files"},
        {scan + "[{path: scans/a.ply, in: to.ply}]\n", "scans 0 in: Value type not permitted",
         "as {target: target.ply}"},
    };
}

TEST_F(BatchSchema, WhatIsWrongAtOnePlace_IsRejectedThere_AsByTheParser) {
    for (const Mistake& mistake : mistakes(head)) {
        EXPECT_THAT(findings(mistake.batch), testing::ElementsAre(HasSubstr(mistake.parser))) << mistake.batch;
        EXPECT_THAT("\n" + schema_.complaints(mistake.batch), HasSubstr("\n" + mistake.schema)) << mistake.batch;
    }
}

}  // namespace
}  // namespace scanmill
