# SPDX-License-Identifier: GPL-3.0-or-later
"""Views with known poses, the same views turned at random, and the comparison of found poses with the known ones.

A pose is a 4 × 4 matrix from a view's frame to the frame of the object.
"""
import dataclasses
import pathlib
import re

import numpy

from tables import scanmill

QUALITY = pathlib.Path(__file__).resolve().parent
#: Points of a view that errors are computed from.
COMPARED = 2000
VIRTUAL_VIEWS = 10
#: Edge of a voxel as register's `resolution: auto` takes it: in spacings, and as a share of the size of a view.
VOXEL_SPACINGS = 4
VOXEL_SHARE = 1 / 10.5
#: Rounds of the fit of found to known poses.
ROUNDS = 10


@dataclasses.dataclass
class Views:
    """Views of one object."""

    names: list
    points: list
    #: Unit vectors to the scanner, in the views' frames.
    directions: list
    poses: list
    spacing: float = 0.0
    voxel: float = 0.0

    def __post_init__(self):
        if self.spacing:
            return
        from scipy.spatial import cKDTree

        distances = [numpy.median(cKDTree(points).query(points, 2)[0][:, 1]) for points in self.points]
        sizes = [numpy.sqrt(((points - points.mean(axis=0)) ** 2).sum(axis=1).mean()) for points in self.points]
        self.spacing = float(numpy.median(distances))
        self.voxel = max(VOXEL_SPACINGS * self.spacing, VOXEL_SHARE * float(numpy.median(sizes)))

    def one(self, number):
        """A single view; its spacing and voxel are its own."""
        return Views(*([values[number]] for values in (self.names, self.points, self.directions, self.poses)))


def moved(pose, points):
    return points @ pose[:3, :3].T + pose[:3, 3]


def matrix(rotation, translation):
    pose = numpy.eye(4)
    pose[:3, :3], pose[:3, 3] = rotation, translation
    return pose


def rotation_of(x, y, z, w):
    """The matrix of a quaternion of any length."""
    x, y, z, w = numpy.array([x, y, z, w]) / numpy.linalg.norm([x, y, z, w])
    return numpy.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def of_conf(conf):
    """The views of a Stanford .conf that exist beside it. Its rotations are the inverse of ours; a Cyberware scanner
    is on the side of +z."""
    import open3d

    found = Views([], [], [], [], 1.0)
    for line in conf.read_text().splitlines():
        words = line.split()
        if not words or words[0] not in ("mesh", "bmesh"):
            continue
        file = conf.parent / words[1]
        if not file.is_file():
            continue
        *shift, x, y, z, w = map(float, words[2:9])
        points = numpy.asarray(open3d.io.read_point_cloud(str(file)).points)
        found.names.append(file.stem)
        found.points.append(points[numpy.isfinite(points).all(axis=1)])
        found.directions.append(numpy.array([0.0, 0.0, 1.0]))
        found.poses.append(matrix(rotation_of(x, y, z, -w), shift))
    return Views(found.names, found.points, found.directions, found.poses)


def read_columns(file):
    """The vertices of a binary PLY without lists, by property."""
    types = {"double": "<f8", "float": "<f4", "int": "<i4", "uint": "<u4", "short": "<i2", "ushort": "<u2",
             "char": "i1", "uchar": "u1"}
    content = file.read_bytes()
    end = content.index(b"end_header\n") + len(b"end_header\n")
    header = content[:end].decode()
    count = int(re.search(r"element vertex (\d+)", header).group(1))
    fields = [(name, types[kind]) for kind, name in re.findall(r"property (\w+) (\S+)", header)]
    return numpy.frombuffer(content, numpy.dtype(fields), count, end)


def of_model(program, model, folder, limit):
    """Views of a virtual scan. Their poses are identities: they are in the frame of the model."""
    report = scanmill.run(program, QUALITY / "registration-scan.yaml", [model], folder, limit)
    outputs = report["cells"][0]["outputs"]
    if not outputs:
        raise scanmill.Broken(f"virtual-scan made no points of {model}")
    rows = read_columns(pathlib.Path(outputs[0]["file"]))
    points = numpy.stack([rows[axis] for axis in "xyz"], axis=1).astype(float)
    numbers = numpy.arange(VIRTUAL_VIEWS)
    height = 1 - (2 * numbers + 1) / VIRTUAL_VIEWS  # the directions of the filter: a Fibonacci sphere
    turn = numbers * numpy.pi * (3 - numpy.sqrt(5))
    ring = numpy.sqrt(1 - height**2)
    directions = numpy.stack([ring * numpy.cos(turn), ring * numpy.sin(turn), height], axis=1)
    return Views([f"view-{number}" for number in numbers], [points[rows["view"] == number] for number in numbers],
                 list(directions), [numpy.eye(4) for _ in numbers])


def turned(views, seed):
    """Every view in a random frame of its own; its pose undoes the motion."""
    random = numpy.random.default_rng(seed)
    size = float(numpy.linalg.norm(numpy.ptp(numpy.vstack([moved(pose, points) for pose, points in
                                                           zip(views.poses, views.points)]), axis=0)))
    result = Views(views.names, [], [], [], views.spacing, views.voxel)
    for points, direction, pose in zip(views.points, views.directions, views.poses):
        motion = matrix(rotation_of(*random.normal(size=4)), size * random.normal(size=3))
        result.points.append(moved(motion, points))
        result.directions.append(motion[:3, :3] @ direction)
        result.poses.append(pose @ numpy.linalg.inv(motion))
    return result


def write(views, folder):
    """Files of doubles; the column `normal` has the direction to the scanner in every row."""
    folder.mkdir(parents=True, exist_ok=True)
    files = []
    for name, points, direction in zip(views.names, views.points, views.directions):
        files.append(folder / f"{name}.ply")
        header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(points)}",
                  *(f"property double {axis}" for axis in ("x", "y", "z", "nx", "ny", "nz")), "end_header", ""]
        rows = numpy.hstack([points, numpy.tile(direction, (len(points), 1))])
        files[-1].write_bytes("\n".join(header).encode() + rows.astype("<f8").tobytes())
    return files


def displacement(first, second, points):
    """The rms distance between the points in two poses."""
    return float(numpy.sqrt((moved(first - second, points) ** 2).sum(axis=1).mean()))


def fitted(sources, targets):
    """The rigid motion with the least squared distances."""
    middle, aim = sources.mean(axis=0), targets.mean(axis=0)
    left, _, right = numpy.linalg.svd((sources - middle).T @ (targets - aim))
    flip = numpy.diag([1, 1, numpy.sign(numpy.linalg.det(left @ right))])
    rotation = (left @ flip @ right).T
    return matrix(rotation, aim - rotation @ middle)


def errors_of(found, views, bound):
    """By view, the rms distance of its points from their known positions, in spacings, after one rigid motion of all
    found poses. That motion is fitted to the largest group of views that it brings within `bound`."""
    samples = {i: views.points[i][:: max(1, len(views.points[i]) // COMPARED)] for i in found}

    def errors_after(motion):
        return {i: displacement(motion @ found[i], views.poses[i], samples[i]) / views.spacing for i in found}

    def after_fit(group):
        return errors_after(fitted(numpy.vstack([moved(found[i], samples[i]) for i in group]),
                                   numpy.vstack([moved(views.poses[i], samples[i]) for i in group])))

    best = after_fit(list(found))
    for i in found:
        if max(best.values()) <= bound:
            break
        errors = errors_after(views.poses[i] @ numpy.linalg.inv(found[i]))
        wide = 4 * bound  # the first view's own error displaces the others
        for _ in range(ROUNDS):
            group = [j for j, error in errors.items() if error <= wide]
            errors = after_fit(group or [i])
            wide = max(bound, wide / 2)
        if sum(error <= bound for error in errors.values()) > sum(error <= bound for error in best.values()):
            best = errors
    return best


def overlapping(views, least):
    """Pairs of views of which one shares at least this part of its points with the other: within a voxel, with
    similar normals."""
    import open3d

    clouds = []
    for points, direction, pose in zip(views.points, views.directions, views.poses):
        cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(moved(pose, points) / views.voxel))
        cloud = cloud.voxel_down_sample(1)
        cloud.estimate_normals(open3d.geometry.KDTreeSearchParamHybrid(2, 30))
        cloud.orient_normals_to_align_with_direction(pose[:3, :3] @ direction)
        clouds.append((numpy.asarray(cloud.points), numpy.asarray(cloud.normals)))

    def share(first, second):
        from scipy.spatial import cKDTree

        distances, nearest = cKDTree(second[0]).query(first[0])
        alike = (first[1] * second[1][nearest]).sum(axis=1) > 0.8
        return float(((distances <= 1) & alike).mean())

    return [(i, j) for j in range(len(clouds)) for i in range(j)
            if max(share(clouds[i], clouds[j]), share(clouds[j], clouds[i])) >= least]
