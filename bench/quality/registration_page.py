# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of registration.py."""
import statistics

from tables import page

OURS = "Scanmill"

NOTES = """\
Every start puts each view into a random frame of its own, with seeds 1, 2, …; the programs get the same points and the
direction to the scanner. All lengths are in spacings, the median distance of nearest neighbours. *Seconds* are
processor seconds of one thread, mean per start, without reading files.

*Scanmill* runs the filter `register` with its defaults. The others get the voxels of its `resolution: auto`, the
larger of 4 spacings and the size of a view / 10.5, and normals on the side of the scanner:

- *Open3D RANSAC*: voxel down-sampling, normals (2 voxels, at most 30 neighbours), FPFH (5 voxels, at most 100), RANSAC
  on features (mutual filter, 1.5 voxels, edge length 0.9, 100,000 iterations, confidence 0.999), ICP point to plane
  within 1.5 voxels.
- *Open3D FGR*: fast global registration within 0.5 voxels instead of RANSAC.
- *PCL*: the same normals, FPFH within 5 voxels, `SampleConsensusPrerejective` with the parameters of its tutorial (3
  samples, 5 similar features, similarity 0.95, 2.5 voxels, inlier fraction 0.25, 50,000 iterations), ICP point to plane
  within 1.5 voxels.

All three accept a pair if 30 % of the smaller view's points have a partner within 1.5 voxels, and continue with
Open3D's multiway registration: the pairs of the spanning tree with the largest shares are certain, all others
uncertain, and `global_optimization` prunes them. As in Open3D's reconstruction system a second round refines the
remaining pairs, point to plane within 0.4 voxels, with every k-th point (at least 10,000) of one view and all of the
other, and optimises again. Coordinates are in voxels and every view begins around the origin; otherwise the pose graph
is worse by several spacings."""

VIEWS_NOTES = """\
*Right* are views within the bound of their known poses, *near* those beyond it but within 2 voxels, *wrong* the other
placed ones, *refused* those without a pose; numbers over all starts. The known poses are those of the `.conf` for raw
views and exact for virtual ones (10 views, angles up to 75 degrees, rays 0.25 % of the diagonal apart, noise half of
that). Errors are rms displacements of a view's points after one rigid motion of all placed views, which is fitted to
the largest group that it brings within the bound. *Largest error* is that of placed views.

*Pairs* are those that share at least 15 % of their points. *Found* is the share of them whose own pose is within 2
voxels before any acceptance (of Scanmill only accepted pairs are known), *placed* the share that is within 2 voxels in
the result. *False* is the share of accepted pairs, of any overlap, that are not within 2 voxels. The first table has
means over the cases, and the sum of their seconds per start."""

TARGET_NOTES = """\
A single virtual view, another one in every start, is placed on the mesh of its model. *Right* is within half a spacing,
*near* within 2 voxels, *equal* elsewhere, but with a mean distance from the model within 5 % of that in the known pose
(symmetric parts), *wrong* anywhere else. Open3D and PCL get random points of the mesh at the spacing of the view, with
the triangles' normals; the pose is refined as above, and counts as refused if fewer than 80 % of the points have a
partner within 0.4 voxels, the share that `register` asks for. The last column counts the reasons of Scanmill's
refusals."""

TITLES = {"bunny": "Bunny, raw", "buddha": "Happy Buddha, raw"}


def programs_of(record):
    """Starts by program, in the order of the first start."""
    found = {}
    for start in record["starts"]:
        found.setdefault(start["program"], []).append(start)
    return found


def title_of(record):
    return TITLES.get(record["case"], record["case"].split("-", 1)[-1])


def percent(part, whole):
    return f"{100 * part / whole:.0f} %" if whole else ""


def mean(starts, name):
    return statistics.mean(start[name] for start in starts)


def row_of_views(record, program, starts):
    def total(name):
        return sum(start[name] for start in starts)

    largest = max((max(start["errors"].values(), default=0) for start in starts), default=0)
    return [f"{title_of(record)}, {record['bound']:g}", program, len(starts),
            *(total(name) for name in ("right", "near", "wrong", "refused")), f"{largest:.2f}",
            percent(total("pairs-right"), total("pairs")), percent(total("pairs-placed"), total("pairs")),
            percent(total("accepted-wrong"), total("accepted")), f"{mean(starts, 'seconds'):.1f}"]


def reasons_of(starts):
    """Such as "3 ambiguous"; the word is in brackets in the message."""
    words = [start["reason"].partition("(")[2].partition(")")[0] or start["reason"] for start in starts
             if start.get("reason")]
    return ", ".join(f"{words.count(word)} {word}" for word in sorted(set(words)))


def row_of_target(record, program, starts):
    outcomes = [start["outcome"] for start in starts]
    errors = [start["error"] for start in starts if start["outcome"] == "right"]
    return [title_of(record), program, len(starts),
            *(outcomes.count(outcome) for outcome in ("right", "near", "equal", "wrong", "refused")),
            f"{max(errors):.2f}" if errors else "", f"{mean(starts, 'seconds'):.1f}", reasons_of(starts)]


def of_kind(results, kind):
    return [record for record in results["records"] if record["kind"] == kind]


def refusals(records):
    """A sentence about the views that we refused."""
    found = []
    for record in records:
        words = [reason.partition(":")[0] for start in programs_of(record).get(OURS, [])
                 for reason in start["reasons"].values()]
        if words:
            counts = ", ".join(f"{words.count(word)} {word}" for word in sorted(set(words)))
            found.append(f"{title_of(record)} {counts}")
    return f"Reasons of Scanmill's refusals: {'; '.join(found)}." if found else "Scanmill refused no view."


def sums(records):
    """Rows of all cases together, by program: means of the shares of the cases."""
    rows = {}
    for record in records:
        for program, starts in programs_of(record).items():
            counts = {name: mean(starts, name) / record["views"] for name in ("right", "near", "wrong", "refused")}
            pairs = {name: mean(starts, name) / mean(starts, "pairs") for name in ("pairs-right", "pairs-placed")}
            rows.setdefault(program, []).append([*counts.values(), *pairs.values(), mean(starts, "seconds")])
    lines = []
    for program, cases in rows.items():
        *shares, seconds = (sum(column) for column in zip(*cases))
        lines.append([program, len(cases), *(percent(share, len(cases)) for share in shares), f"{seconds:.0f}"])
    return lines


def lines_of(results):
    lines = [*page.heading("Views without poses", results, "registration.json"), NOTES, ""]
    if records := of_kind(results, "views"):
        lines += ["## Views of one object", "", VIEWS_NOTES, ""]
        lines += page.table(["all cases", "cases", "right", "near", "wrong", "refused", "pairs found", "pairs placed",
                             "seconds"], sums(records))
        lines.append("")
        lines += page.table(["object, bound", "program", "starts", "right", "near", "wrong", "refused", "largest error",
                             "pairs found", "pairs placed", "false", "seconds"],
                            [row_of_views(record, *item) for record in records for item in programs_of(record).items()])
        lines += ["", refusals(records), ""]
        lines += page.table(["object", "views", "points", "voxel, spacings", "pairs"],
                            [[title_of(record), record["views"], f"{record['points']:,}",
                              f"{record['voxel'] / record['spacing']:.1f}", record["starts"][0]["pairs"]]
                             for record in records])
        lines.append("")
    if records := of_kind(results, "target"):
        lines += ["## One view on its model", "", TARGET_NOTES, ""]
        lines += page.table(["model", "program", "starts", "right", "near", "equal", "wrong", "refused",
                             "largest error of right ones", "seconds", "reasons"],
                            [row_of_target(record, *item) for record in records
                             for item in programs_of(record).items()])
        lines.append("")
    loads = [run["load"] for record in results["records"] for run in record["runs"] if "load" in run]
    return [*lines, *load_of(loads)]


def load_of(loads):
    took = sum(load["took_seconds"] for load in loads)
    others = sum(load["others_cpu_seconds"] for load in loads) / took if took else 0
    return [f"The whole bench took {took:.0f} s, with {others:.1f} cores used by other processes."]
