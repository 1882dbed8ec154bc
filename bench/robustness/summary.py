# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of the robustness bench: success rates, reasons of failures, and limits."""
import statistics

import verdict
from tables import page

NOTES = """\
The workflow runs `delaunay`, `alpha-solid` and `sculpt` with their defaults and without clean-up. A trial succeeds if
the mesh is a closed manifold with one connected component and as many handles as the truth, and if its Hausdorff
distance from the truth (as `measure` samples it, in both directions) is at most {largest:g} spacings. This bound is
the same at every noise level. Every other trial fails. Crashes and refusals are counted separately from wrong meshes.

Points are evenly spread: their distance is at least the *spacing*, and they leave no gaps. Noise moves every coordinate
by a normally distributed error; its standard deviation is given in spacings. Seeds per cell: {seeds}."""


def cells_of(trials, shape, axis):
    """(level, trials) of a shape and axis, from the easiest level to the hardest."""
    mine = [trial for trial in trials if trial["shape"] == shape and trial["axis"] == axis]
    levels = sorted({trial["level"] for trial in mine}, reverse=axis == "density")
    return [(level, [trial for trial in mine if trial["level"] == level]) for level in levels]


def verdicts_of(trials, shape, axis, key="verdict"):
    return [(level, [trial[key] for trial in some]) for level, some in cells_of(trials, shape, axis)]


def before_sculpting(trials):
    """Like cell(), for the alpha-solid."""
    return cell(trials, "before")


def cell(trials, key="verdict"):
    """The successes of trials and the reasons of failures: "3/5: 2 genus"."""
    verdicts = [trial[key] for trial in trials]
    succeeded, count = verdict.rate(verdicts)
    reasons = [f"{verdicts.count(name)} {name}" for name in verdict.FAILURES if name in verdicts]
    text = f"{succeeded}/{count}"
    return f"**{text}**" if succeeded == count else text + (": " + ", ".join(reasons) if reasons else "")


def inside(trials, key="inside"):
    """Median share of the points that are not on the surface, over the trials that report it."""
    shares = [trial[key] / trial["points"] for trial in trials if trial[key] is not None]
    return f"{100 * statistics.median(shares):.1f} %" if shares else "–"


def inside_before(trials):
    return inside(trials, "inside_before")


def distance(trials, name):
    """Median distance between mesh and truth in spacings, over the trials that report it."""
    values = [trial[name] / trial["spacing"] for trial in trials if trial[name] is not None]
    return f"{statistics.median(values):.2f}" if values else "–"


def mean_distance(trials):
    return distance(trials, "mean")


def largest_distance(trials):
    return distance(trials, "hausdorff")


def table(trials, shapes, axis, show):
    levels = [level for level, _ in cells_of(trials, shapes[0]["name"], axis)]
    rows = [[shape["name"], *(show(some) for _, some in cells_of(trials, shape["name"], axis))] for shape in shapes]
    title = "noise / spacing" if axis == "noise" else "requested points"
    return page.table([title, *(f"{level:g}" if axis == "noise" else f"{level:,}" for level in levels)], rows)


def noise_border(shape, cells):
    last, never = verdict.reliable_until(cells)
    text = f"{shape}: " + ("some trials fail even without noise" if last is None else
                           f"all trials succeed up to {last:g}")
    if last == cells[-1][0]:
        return text + ", the largest tested"
    return text + (f", none succeeds from {never:g} on" if never is not None else
                   f", some succeed at {cells[-1][0]:g}")


def density_border(shape, cells):
    last, never = verdict.reliable_until(cells)
    text = f"{shape}: " + ("some trials fail even with the most points" if last is None else
                           f"all trials succeed from {last:,} points on")
    if last == cells[-1][0]:
        return text + ", the fewest tested"
    return text + (f", none succeeds with {never:,} or fewer" if never is not None else
                   f", some succeed with {cells[-1][0]:,}")


def border(trials, shapes):
    """The paragraphs about the limits of the method, from the tables alone."""
    names = [shape["name"] for shape in shapes]
    noise, density = ({name: verdicts_of(trials, name, axis) for name in names} for axis in ("noise", "density"))
    lasts = [verdict.reliable_until(cells)[0] for cells in noise.values()]
    if None in lasts:
        text = "At no noise level, not even 0, do all trials succeed."
    else:
        text = f"All trials succeed with noise of up to {min(lasts):g} spacings."
    text += " Limits of noise, in spacings:\n\n"
    text += "".join(f"- {noise_border(name, cells)}\n" for name, cells in noise.items())
    text += "\nLimits of the number of points, without noise:\n\n"
    text += "".join(f"- {density_border(name, cells)}\n" for name, cells in density.items()) + "\n"
    text += f"{interpolation(trials, shapes)} {before(trials, shapes)} {hopeless(trials)}\n\n"
    wrong = [trial["verdict"] for trial in trials if trial["verdict"] != verdict.SUCCESS]
    if not wrong:
        return text + "No trial failed."
    often = max(verdict.FAILURES, key=wrong.count)
    refused, crashed = wrong.count("refused"), wrong.count("crashed")
    delivered = [trial for trial in trials if trial["verdict"] not in (verdict.SUCCESS, *verdict.OF_THE_PROGRAM)]
    warned = sum(trial["warned"] for trial in delivered)
    return text + (
        f"{len(wrong):,} of {len(trials):,} trials failed. The most frequent reason: {verdict.FAILURES[often]} "
        f"({wrong.count(often):,}). The program refused {refused:,} and crashed in {crashed:,}; in the other "
        f"{len(delivered):,} it delivered a wrong mesh, with a warning in {warned:,} of them. Smooth or thin noisy "
        "scans first, or use a method that does not interpolate the points."
    )


def interpolation(trials, shapes):
    """The largest noise at which every mesh is correct and passes through every point."""
    words = []
    for shape in shapes:
        last = None
        for level, some in cells_of(trials, shape["name"], "noise"):
            if not all(trial["verdict"] == verdict.SUCCESS and trial["inside"] == 0 for trial in some):
                break
            last = level
        words.append(f"{shape['name']} {'none' if last is None else f'{last:g}'}")
    return f"Noise up to which all trials succeed and all points are on the surface: {', '.join(words)}."


def hopeless(trials):
    """A sentence with the noise that always moves some point farther than the allowed distance; or an empty text."""
    levels = sorted({trial["level"] for trial in trials if trial["axis"] == "noise"})
    for level in levels:
        some = [trial for trial in trials if trial["axis"] == "noise" and trial["level"] == level]
        if all(trial["farthest_move"] > trial["bound"] for trial in some):
            return f"From {level:g} on, noise moves some point of every scan farther than the allowed distance."
    return ""


def before(trials, shapes):
    """The largest noise at which every alpha-solid is correct, before sculpting."""
    borders = []
    for shape in shapes:
        last, _ = verdict.reliable_until(verdicts_of(trials, shape["name"], "noise", "before"))
        borders.append(f"{shape['name']} {'none' if last is None else f'{last:g}'}")
    return f"Noise up to which all alpha-solids succeed before sculpting, with points inside: {', '.join(borders)}."


SHOWN = {
    "Share of points that are not on the surface (median):": inside,
    "Successes of the alpha-solid, before sculpting:": before_sculpting,
    "Share of points inside the solid, before sculpting (median):": inside_before,
    "Mean distance between mesh and truth, in spacings (median):": mean_distance,
    "Hausdorff distance between mesh and truth, in spacings (median):": largest_distance,
}


def section(trials, shapes, axis):
    """The tables of one axis."""
    text = table(trials, shapes, axis, cell)
    for title, show in SHOWN.items():
        text += ["", title, "", *table(trials, shapes, axis, show)]
    return text + [""]


def lines(results):
    trials, shapes = results["trials"], results["shapes"]
    text = page.heading("Tolerance to noise and to few points", results, "results.json")
    text += [NOTES.format(largest=verdict.LARGEST, seeds=results["seeds"]), ""]
    text += ["## Limits", "", border(trials, shapes), ""]
    text += [f"## Noise, {results['points']:,} requested points", ""]
    text += section(trials, shapes, "noise") + ["## Density, without noise", ""]
    text += section(trials, shapes, "density")
    text += [f"- {name}: {why}" for name, why in verdict.FAILURES.items()] + [""]
    for shape in shapes:
        spacings = [f"{some[0]['spacing']:.3g}" for _, some in cells_of(trials, shape["name"], "density")]
        text.append(f"- {shape['name']}: {shape['what']}, genus {shape['genus']}, {shape['triangles']:,} triangles; "
                    f"spacings from the most to the fewest points: {', '.join(spacings)}")
    errors = sorted({trial["error"] for trial in trials if trial["error"]})
    if errors:
        text += ["", "Errors of trials without a result:", "", *(f"- {error}" for error in errors[:20])]
    return text + ["", page.other_load(results["load"])]
