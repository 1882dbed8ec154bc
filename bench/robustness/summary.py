# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of the robustness bench: success rates, why the others failed, and where the border runs."""
import statistics

import verdict
from tables import page

NOTES = """\
`delaunay`, `alpha-solid` and `sculpt` as they are, without any parameter and without any clean-up before them. A
success is a closed manifold of one piece, with as many handles as the truth, whose Hausdorff distance from the truth
(as `measure` samples it, both ways) is at most {largest:g} spacings, however much noise there is. Everything else is a
failure, and what the program would not or could not do is counted apart from what it did wrong.

Points keep their distance, the *spacing*, from each other and leave no gap on the surface; every coordinate is then
moved by a normally distributed error whose deviation is given as a share of the spacing. Seeds in each
cell: {seeds}."""


def cells_of(trials, shape, axis):
    """(level, trials) of one line, from the easiest to the hardest."""
    mine = [trial for trial in trials if trial["shape"] == shape and trial["axis"] == axis]
    levels = sorted({trial["level"] for trial in mine}, reverse=axis == "density")
    return [(level, [trial for trial in mine if trial["level"] == level]) for level in levels]


def verdicts_of(trials, shape, axis, key="verdict"):
    return [(level, [trial[key] for trial in some]) for level, some in cells_of(trials, shape, axis)]


def before_sculpting(trials):
    """As cell(), of the alpha-solid."""
    return cell(trials, "before")


def cell(trials, key="verdict"):
    """Successes of trials, and why the others failed: "3/5: 2 genus"."""
    verdicts = [trial[key] for trial in trials]
    succeeded, count = verdict.rate(verdicts)
    reasons = [f"{verdicts.count(name)} {name}" for name in verdict.FAILURES if name in verdicts]
    text = f"{succeeded}/{count}"
    return f"**{text}**" if succeeded == count else text + (": " + ", ".join(reasons) if reasons else "")


def inside(trials, key="inside"):
    """Median share of the points that are not on the surface, of the trials that tell it."""
    shares = [trial[key] / trial["points"] for trial in trials if trial[key] is not None]
    return f"{100 * statistics.median(shares):.1f} %" if shares else "–"


def inside_before(trials):
    return inside(trials, "inside_before")


def distance(trials, name):
    """Median of a distance between mesh and truth, in spacings, of the trials that tell it."""
    told = [trial[name] / trial["spacing"] for trial in trials if trial[name] is not None]
    return f"{statistics.median(told):.2f}" if told else "–"


def mean_distance(trials):
    return distance(trials, "mean")


def largest_distance(trials):
    return distance(trials, "hausdorff")


def table(trials, shapes, axis, show):
    levels = [level for level, _ in cells_of(trials, shapes[0]["name"], axis)]
    rows = [[shape["name"], *(show(some) for _, some in cells_of(trials, shape["name"], axis))] for shape in shapes]
    title = "noise / spacing" if axis == "noise" else "points asked for"
    return page.table([title, *(f"{level:g}" if axis == "noise" else f"{level:,}" for level in levels)], rows)


def noise_border(shape, cells):
    last, never = verdict.reliable_until(cells)
    text = f"the {shape} " + ("fails sometimes even without noise" if last is None else
                              f"always succeeds up to {last:g}")
    if last == cells[-1][0]:
        return text + ", the most tried"
    return text + (f" and never from {never:g} on" if never is not None else
                   f" and at {cells[-1][0]:g} still sometimes")


def density_border(shape, cells):
    last, never = verdict.reliable_until(cells)
    text = f"the {shape} " + ("fails sometimes even with the most points" if last is None else
                              f"always succeeds from {last:,} points on")
    if last == cells[-1][0]:
        return text + ", the fewest tried"
    return text + (f" and never with {never:,} or fewer" if never is not None else
                   f" and with {cells[-1][0]:,} still sometimes")


def border(trials, shapes):
    """The paragraph that says where the method ends, from the table alone."""
    names = [shape["name"] for shape in shapes]
    noise, density = ({name: verdicts_of(trials, name, axis) for name in names} for axis in ("noise", "density"))
    lasts = [verdict.reliable_until(cells)[0] for cells in noise.values()]
    if None in lasts:
        text = "There is no noise, not even none at all, at which every shape always succeeds"
    else:
        text = f"Noise of up to {min(lasts):g} spacings is borne by every shape and seed"
    text += ": " + "; ".join(noise_border(name, cells) for name, cells in noise.items()) + ". "
    borders = (density_border(name, cells) for name, cells in density.items())
    text += f"Without noise {'; '.join(borders)}. "
    text += f"{interpolation(trials, shapes)} {before(trials, shapes)} {hopeless(trials)}"
    wrong = [trial["verdict"] for trial in trials if trial["verdict"] != verdict.SUCCESS]
    if not wrong:
        return text + "Nothing failed."
    often = max(verdict.FAILURES, key=wrong.count)
    refused, crashed = wrong.count("refused"), wrong.count("crashed")
    delivered = [trial for trial in trials if trial["verdict"] not in (verdict.SUCCESS, *verdict.OF_THE_PROGRAM)]
    warned = sum(trial["warned"] for trial in delivered)
    return text + (
        f"Of {len(trials):,} trials {len(wrong):,} failed, most often because {verdict.FAILURES[often]} "
        f"({wrong.count(often):,}). The program itself refused {refused:,} and crashed in {crashed:,}; in the other "
        f"{len(delivered):,} it delivered a mesh that is wrong, with a warning in {warned:,} of them: noisy scans are "
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


def hopeless(trials):
    """From which noise on a point is always moved farther than a mesh may be away; a sentence, or nothing."""
    levels = sorted({trial["level"] for trial in trials if trial["axis"] == "noise"})
    for level in levels:
        some = [trial for trial in trials if trial["axis"] == "noise" and trial["level"] == level]
        if all(trial["farthest_move"] > trial["bound"] for trial in some):
            return f"From {level:g} on the farthest point itself is moved farther than the mesh may be away. "
    return ""


def before(trials, shapes):
    """Up to which noise the alpha-solid alone would have done."""
    borders = []
    for shape in shapes:
        last, _ = verdict.reliable_until(verdicts_of(trials, shape["name"], "noise", "before"))
        borders.append(f"{shape['name']} {'not even without noise' if last is None else f'up to {last:g}'}")
    return f"The alpha-solid before sculpting, which leaves points inside, always succeeds: {', '.join(borders)}."


SHOWN = {
    "Of the points, not on the surface (median):": inside,
    "Before sculpting, successes of the alpha-solid:": before_sculpting,
    "Before sculpting, of the points, inside the solid (median):": inside_before,
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
    text = page.heading("How much noise, and how few points", results, "results.json")
    text += [NOTES.format(largest=verdict.LARGEST, seeds=results["seeds"]), ""]
    text += ["## The border", "", border(trials, shapes), ""]
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
