# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of the robustness bench: success rates, why the others failed, and where the border runs."""
import statistics

import verdict
from tables import page

NOTES = """\
`delaunay`, `alpha-solid` and `sculpt` as they are, without any parameter and without any clean-up before them. A success is
a closed manifold of one piece, with as many handles as the truth, whose Hausdorff distance from the truth (as `measure`
samples it, both ways) is at most {gap:g} spacings and as much again as the farthest point was moved: a mesh through the points cannot be nearer.
With much noise that bound is wide, so the mean distance and the points that the mesh leaves out are to be read beside it.
Everything else is a failure, and what the program would not or could not do is counted apart from what it did wrong.

Points keep their distance, the *spacing*, from each other and leave no gap on the surface; every coordinate is then moved
by a normally distributed error whose deviation is given as a share of the spacing. {seeds} seeds for each cell."""


def cells_of(trials, shape, axis):
    """(level, trials) of one line, from the easiest to the hardest."""
    mine = [trial for trial in trials if trial["shape"] == shape and trial["axis"] == axis]
    levels = sorted({trial["level"] for trial in mine}, reverse=axis == "density")
    return [(level, [trial for trial in mine if trial["level"] == level]) for level in levels]


def verdicts_of(trials, shape, axis):
    return [(level, [trial["verdict"] for trial in some]) for level, some in cells_of(trials, shape, axis)]


def cell(trials):
    """Successes of trials, and why the others failed: "3/5: 2 genus"."""
    verdicts = [trial["verdict"] for trial in trials]
    succeeded, count = verdict.rate(verdicts)
    reasons = [f"{verdicts.count(name)} {name}" for name in verdict.FAILURES if name in verdicts]
    text = f"{succeeded}/{count}"
    return f"**{text}**" if succeeded == count else text + (": " + ", ".join(reasons) if reasons else "")


def inside(trials):
    """Median share of the points that are not on the surface, of the trials that tell it."""
    shares = [trial["inside"] / trial["points"] for trial in trials if trial["inside"] is not None]
    return f"{100 * statistics.median(shares):.1f} %" if shares else "–"


def mean_distance(trials):
    """Median of the mean distances between mesh and truth, in spacings, of the trials that tell one."""
    told = [trial["mean"] / trial["spacing"] for trial in trials if trial["mean"] is not None]
    return f"{statistics.median(told):.2f}" if told else "–"


def table(trials, shapes, axis, show):
    levels = [level for level, _ in cells_of(trials, shapes[0]["name"], axis)]
    rows = [[shape["name"], *(show(some) for _, some in cells_of(trials, shape["name"], axis))] for shape in shapes]
    title = "noise / spacing" if axis == "noise" else "points asked for"
    return page.table([title, *(f"{level:g}" if axis == "noise" else f"{level:,}" for level in levels)], rows)


def noise_border(shape, last, first):
    if last is None:
        text = f"the {shape} fails sometimes even without noise"
    else:
        text = f"the {shape} always succeeds up to {last:g}"
    return text + (f" and never from {first:g} on" if first is not None else " and sometimes still at the most tried")


def density_border(shape, last, first):
    text = f"the {shape} " + (f"always succeeds from {last:,} points on" if last is not None
                              else "fails sometimes even with the most points")
    return text + (f" and never with {first:,} or fewer" if first is not None else " and sometimes with the fewest tried")


def border(trials, shapes):
    """The paragraph that says where the method ends, from the table alone."""
    noise = [(shape["name"], *verdict.reliable_until(verdicts_of(trials, shape["name"], "noise"))) for shape in shapes]
    density = [(shape["name"], *verdict.reliable_until(verdicts_of(trials, shape["name"], "density")))
               for shape in shapes]
    lasts = [last for _, last, _ in noise]
    if None in lasts:
        text = "There is no noise, not even none at all, at which every shape always succeeds"
    else:
        text = f"Noise of up to {min(lasts):g} spacings is borne by every shape and seed"
    text += ": " + "; ".join(noise_border(*line) for line in noise) + ". "
    text += "Without noise " + "; ".join(density_border(*line) for line in density) + ". "
    text += interpolation(trials, shapes) + " "
    wrong = [trial["verdict"] for trial in trials if trial["verdict"] != verdict.SUCCESS]
    if not wrong:
        return text + "Nothing failed."
    often = max(verdict.FAILURES, key=wrong.count)
    refused, crashed = wrong.count("refused"), wrong.count("crashed")
    return text + (
        f"Of {len(trials):,} trials {len(wrong):,} failed, most often because {verdict.FAILURES[often]} "
        f"({wrong.count(often):,}). The program itself refused {refused:,} and crashed in {crashed:,}; in the other "
        f"{len(wrong) - refused - crashed:,} it delivered a mesh that is wrong, and no error tells so: noisy scans are "
        "to be smoothed or thinned first, or given to a method that does not interpolate."
    )


def interpolation(trials, shapes):
    """Up to which noise the method does what it is for: a mesh through every point."""
    words = []
    for shape in shapes:
        last = None
        for level, some in cells_of(trials, shape["name"], "noise"):
            if not all(trial["verdict"] == verdict.SUCCESS and trial["inside"] == 0 for trial in some):
                break
            last = level
        words.append(f"{shape['name']} {'not even without noise' if last is None else f'up to {last:g}'}")
    return f"With every point on the surface as well: {', '.join(words)}."


def section(trials, shapes, axis):
    """The three tables of one axis."""
    text = table(trials, shapes, axis, cell)
    text += ["", "Of the points, not on the surface (median):", "", *table(trials, shapes, axis, inside)]
    return text + ["", "Mean distance between mesh and truth, in spacings (median):", "",
                   *table(trials, shapes, axis, mean_distance), ""]


def lines(results):
    trials, shapes = results["trials"], results["shapes"]
    text = page.heading("How much noise, and how few points", results, "results.json")
    text += [NOTES.format(gap=verdict.GAP, seeds=results["seeds"]), "", "## The border", "", border(trials, shapes), ""]
    text += [f"## Noise, {results['points']:,} points asked for", ""]
    text += section(trials, shapes, "noise") + ["## Density, without noise", ""]
    text += section(trials, shapes, "density")
    text += [f"- {name}: {why}" for name, why in verdict.FAILURES.items()] + [""]
    for shape in shapes:
        spacings = [f"{some[0]['spacing']:.3g}" for _, some in cells_of(trials, shape["name"], "density")]
        text.append(f"- {shape['name']}: {shape['what']}, genus {shape['genus']}, {shape['triangles']:,} triangles; "
                    f"spacings from the most to the fewest points: {', '.join(spacings)}")
    errors = sorted({trial["error"] for trial in trials if trial["error"]})
    if errors:
        text += ["", "What the program said when it delivered nothing:", "", *(f"- {error}" for error in errors[:20])]
    return text + ["", page.other_load(results["load"])]
