# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of decimate.py: triangles at equal distance, their angles, and self-intersections."""
import statistics

from tables import page

NOTES = """\
`decimate` gets the *max-error*, in percent of the diagonal of the mesh. *measured* is the largest distance between its
result and the input, in both directions: the upper bound of `scanmill measure --certify`, which is at most 1 % above
the lower one. It can therefore be above the max-error, although `decimate` proves the max-error itself; the exit code
shows whether the lower bound is above it.

The other programs take a number of triangles. A search finds the smallest number with which the same measurement is at
most ours (or 0.0001 % of the diagonal, the rounding of floats). It ends when a number that is at most 1 % smaller is
too small. The distance does not fall monotonically with the number of triangles, so the search also tries smaller
numbers in steps of 10 %, down to 60 %. The other programs therefore get the best of many results, and `decimate` has
one.

All programs get the same mesh, with coordinates rounded to float, and their default settings, except that
fast-simplification's *agg* is 4, with which it needs fewer triangles than with the default 7, and that PyMeshLab also
runs with *planarquadric*, with which it can need fewer on models with planes.

`decimate` keeps vertices of the input. The other programs, except meshoptimizer, move vertices; on smooth convex
surfaces they can then do with half as many triangles, because the surface can lie on both sides of the input's."""


def percent(value):
    return f"{value:.3g} %"


def pairs(record):
    return [one for one in record["distances"] if "upper" in one["ours"]]


def names(records):
    """The other programs, in the order of the results."""
    return list(dict.fromkeys(name for record in records for one in record["distances"] for name in one["others"]))


def ratio(one, name):
    """Our triangles divided by those of the program; None if one of them failed."""
    other = one["others"].get(name, {})
    if "triangles" not in other or "triangles" not in one["ours"]:
        return None
    return one["ours"]["triangles"] / other["triangles"]


def triangles_cell(one, name):
    found = ratio(one, name)
    return "failed" if found is None else f"{one['others'][name]['triangles']:,} ({found:.2f})"


def value_cell(facts, key, format_):
    return format(facts[key], format_) if key in facts else "failed"


def model_cell(record):
    return f"{record['name']} ({record['input']['triangles']:,})"


def triangle_rows(records, others):
    for record in records:
        for one in record["distances"]:
            ours = one["ours"]
            row = [model_cell(record), percent(one["share"])]
            if "upper" not in ours:
                yield [*row, "", "failed", *[""] * len(others)]
                continue
            yield [*row, percent(100 * ours["upper"] / record["diagonal"]), f"{ours['triangles']:,}",
                   *(triangles_cell(one, name) for name in others)]


def median_row(title, records, others):
    """The median of the ratios of every program over these models; empty if there are none."""
    ratios = [[found for record in records for one in pairs(record) if (found := ratio(one, name)) is not None]
              for name in others]
    return [f"**{title}**", "", "", "", *(f"**{statistics.median(some):.2f}**" if some else "" for some in ratios)]


def median_rows(records, others):
    yield median_row("median ratio", records, others)
    for kind in dict.fromkeys(record["kind"] for record in records):
        yield median_row(f"median, {kind}", [record for record in records if record["kind"] == kind], others)


def fact_rows(records, others, key, format_):
    """One fact of the input, of our result, and of the other programs."""
    for record in records:
        for one in pairs(record):
            yield [model_cell(record), percent(one["share"]), value_cell(record["input"], key, format_),
                   value_cell(one["ours"], key, format_),
                   *(value_cell(one["others"].get(name, {}), key, format_) for name in others)]


def median_facts(records, others, key, format_):
    """The medians of the columns of fact_rows(), over all models and over each kind."""
    for kind in ["", *dict.fromkeys(record["kind"] for record in records)]:
        columns = {}
        for record in records:
            for one in pairs(record):
                if kind in ("", record["kind"]):
                    results = {"input": record["input"], "ours": one["ours"], **one["others"]}
                    for name, facts in results.items():
                        columns.setdefault(name, []).extend([facts[key]] if key in facts else [])
        medians = [columns.get(name) for name in ["input", "ours", *others]]
        yield [f"**median{', ' if kind else ''}{kind}**", "",
               *(f"**{statistics.median(some):{format_}}**" if some else "" for some in medians)]


def of_model(record):
    """What is printed after a model."""
    if record["failure"]:
        return [f"{record['name']}: failed: {record['failure']}"]
    others = names([record])
    return page.table(["model", "max-error", "measured", "ours", *others], triangle_rows([record], others))


def summary(records, others):
    """Where a program needs fewer triangles than ours."""
    for name in others:
        fewer = [f"{record['name']} at {percent(one['share'])} ({found:.2f})" for record in records
                 for one in pairs(record) if (found := ratio(one, name)) is not None and found > 1]
        if fewer:
            yield f"- {name} needs fewer triangles: {', '.join(fewer)}"


def remarks(records):
    for record in records:
        if record["failure"]:
            yield f"- {record['name']}: failed: {record['failure']}"
        for one in record["distances"]:
            results = {"ours": one["ours"], **one["others"]}
            for name, result in results.items():
                if "failure" in result:
                    yield f"- {record['name']} at {percent(one['share'])}, {name}: failed: {result['failure']}"
                elif not result["certified"]:
                    yield (f"- {record['name']} at {percent(one['share'])}, {name}: the bounds of the distance are "
                           "more than 1 % apart")


def lines(results):
    records = results["models"]
    done = [record for record in records if not record["failure"]]
    others = names(done)
    text = page.heading("Triangles of decimated meshes at equal distance", results, "decimate.json")
    text += [", ".join(f"{name} {version}" for name, version in sorted(results["versions"].items())) + ".", ""]
    text += [NOTES, "", "## Triangles", "",
             "In brackets: our triangles divided by the program's; below 1 ours are fewer. After the name of a model: "
             "its triangles.", ""]
    text += page.table(["model", "max-error", "measured", "ours", *others],
                       [*triangle_rows(done, others), *median_rows(done, others)])
    text += ["", *summary(done, others), *remarks(records), "", "## Angles", "",
             "The 10 % quantile of the triangles' minimum angles, in degrees. Larger is better.", ""]
    header = ["model", "max-error", "input", "ours", *others]
    text += page.table(header, [*fact_rows(done, others, "min_angle", ".1f"),
                                *median_facts(done, others, "min_angle", ".1f")])
    text += ["", "## Self-intersections", "", "Pairs of triangles that intersect.", ""]
    text += page.table(header, fact_rows(done, others, "self_intersections", ","))
    return text + ["", page.other_load(results["load"])]
