# SPDX-License-Identifier: GPL-3.0-or-later
"""Registration of views by Open3D and PCL, with the parameters of their documentation.

Coordinates are divided by the edge of a voxel, so that absolute tolerances of the programs mean the same for every
object, and every cloud is moved with its middle to 0, because the weights of Open3D's pose graph depend on the origin.
Seconds are processor seconds.
"""
import itertools
import json
import os
import subprocess
import time

import numpy

#: In voxels: of Open3D's global registration, multiway registration and local refinement.
CONSENSUS = 1.5
GRAPH = 1.5
REFINEMENT = 0.4
#: Least share of the points of a pair's smaller view that have a partner within GRAPH: as in Open3D's reconstruction
#: system.
LEAST_SHARE = 0.3
#: Least number of points of a view, if it has as many, that the refinement moves onto all points of another.
MOVED = 10_000


class Open3d:
    """Global registration, then ICP point to plane. Clouds are numbered in the order of load()."""

    def __init__(self, consensus):
        self.consensus = consensus
        self.seconds = 0.0

    def timed(self, work):
        begin = time.process_time()
        try:
            return work()
        finally:
            self.seconds += time.process_time() - begin

    def load(self, clouds):
        """A cloud is its points, and either the direction to its scanner or the normals."""
        self.views = [self.timed(lambda: self.prepared(points, side)) for points, side in clouds]

    def prepared(self, points, side):
        import open3d

        cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(points))
        if side.ndim == 2:
            cloud.normals = open3d.utility.Vector3dVector(side)
        reduced = cloud.voxel_down_sample(1)
        near = open3d.geometry.KDTreeSearchParamHybrid
        if side.ndim == 1:
            for one in (cloud, reduced):
                one.estimate_normals(near(2, 30))
                one.orient_normals_to_align_with_direction(side)
        else:
            reduced.normalize_normals()
        features = open3d.pipelines.registration.compute_fpfh_feature(reduced, near(5, 100))
        return cloud, reduced, features, cloud.uniform_down_sample(max(1, len(points) // MOVED))

    def pose(self, i, j, seed):
        """From cloud i to cloud j, refined with the reduced points; None without one."""
        import open3d

        open3d.utility.random.seed(seed)
        return self.timed(lambda: self.found(*self.views[i][1:3], *self.views[j][1:3]))

    def found(self, source, source_features, target, target_features):
        pose = self.consensus(source, target, source_features, target_features)
        return None if pose.trace() == 4 else icp(source, target, CONSENSUS, pose)

    def refined(self, i, j, pose):
        return self.timed(lambda: icp(self.views[i][3], self.views[j][0], REFINEMENT, pose))

    def close(self):
        pass

    def graph_clouds(self):
        return [reduced for _, reduced, *_ in self.views]


def icp(source, target, reach, start):
    from open3d.pipelines import registration

    return registration.registration_icp(source, target, reach, start,
                                         registration.TransformationEstimationPointToPlane()).transformation


def ransac(source, target, source_features, target_features):
    from open3d.pipelines import registration

    return registration.registration_ransac_based_on_feature_matching(
        source, target, source_features, target_features, True, CONSENSUS,
        registration.TransformationEstimationPointToPoint(False), 3,
        [registration.CorrespondenceCheckerBasedOnEdgeLength(0.9),
         registration.CorrespondenceCheckerBasedOnDistance(CONSENSUS)],
        registration.RANSACConvergenceCriteria(100000, 0.999)).transformation


def fast_global(source, target, source_features, target_features):
    from open3d.pipelines import registration

    return registration.registration_fgr_based_on_feature_matching(
        source, target, source_features, target_features,
        registration.FastGlobalRegistrationOption(maximum_correspondence_distance=0.5)).transformation


class Pcl:
    """The driver pcl_registration."""

    def __init__(self, driver, folder):
        self.folder = folder
        self.seconds = 0.0
        self.process = subprocess.Popen([driver], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        stderr=subprocess.DEVNULL, text=True)

    def ask(self, request):
        self.process.stdin.write(json.dumps(request) + "\n")
        self.process.stdin.flush()
        answer = json.loads(self.process.stdout.readline())
        if "failed" in answer:
            raise RuntimeError(f"pcl_registration: {answer['failed']}")
        self.seconds += answer.get("seconds", 0)
        return answer

    def load(self, clouds):
        self.ask({"do": "forget"})
        self.clouds = clouds
        path = self.folder / "pcl"
        for points, side in clouds:
            path.with_suffix(".normals").unlink(missing_ok=True)
            path.with_suffix(".points").write_bytes(points.astype("<f8").tobytes())
            if side.ndim == 2:
                path.with_suffix(".normals").write_bytes(side.astype("<f8").tobytes())
            self.ask({"do": "load", "path": str(path), "step": max(1, len(points) // MOVED),
                      "direction": [] if side.ndim == 2 else list(side)})

    def pose(self, i, j, seed):
        answer = self.ask({"do": "pose", "source": i, "target": j, "seed": seed})
        return numpy.reshape(answer["pose"], (4, 4)) if answer["found"] else None

    def refined(self, i, j, pose):
        answer = self.ask({"do": "refine", "source": i, "target": j, "reach": REFINEMENT,
                           "pose": list(map(float, numpy.ravel(pose)))})
        return numpy.reshape(answer["pose"], (4, 4))

    def graph_clouds(self):
        import open3d

        return [open3d.geometry.PointCloud(open3d.utility.Vector3dVector(points)).voxel_down_sample(1)
                for points, _ in self.clouds]

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def makers(driver, folder):
    """By name, functions that start a program."""
    found = {"Open3D RANSAC": lambda: Open3d(ransac), "Open3D FGR": lambda: Open3d(fast_global)}
    if os.access(driver, os.X_OK):
        found["PCL"] = lambda: Pcl(str(driver), folder)
    return found


def restored(pose, voxel, source_middle, target_middle):
    """A pose of clouds whose middles were moved to 0 and whose coordinates are in voxels, as one of the views."""
    result = pose.copy()
    result[:3, 3] = voxel * pose[:3, 3] + target_middle - pose[:3, :3] @ source_middle
    return result


def register(peer, views, seed):
    """The poses of the largest group of views that accepted pairs connect, by view; the candidates of all pairs; the
    accepted pairs; seconds, and those of the second round. Poses of pairs are from the first to the second view.

    As in Open3D's reconstruction system, a second round refines the pairs that the pose graph keeps, now with many
    points, and relaxes the graph again. It begins at the poses of the first round."""
    middles = [points.mean(axis=0) for points in views.points]
    peer.load([((points - middle) / views.voxel, direction)
               for points, middle, direction in zip(views.points, middles, views.directions)])
    begin = time.process_time()
    clouds = peer.graph_clouds()
    others = time.process_time() - begin if isinstance(peer, Pcl) else 0.0
    candidates = {}
    for number, (i, j) in enumerate(itertools.combinations(range(len(clouds)), 2)):
        pose = peer.pose(i, j, 1000 * seed + number)
        if pose is not None:
            candidates[i, j] = pose
    begin = time.process_time()
    accepted = shares_of(clouds, candidates)
    poses, kept = relaxed(clouds, candidates, accepted)
    others += time.process_time() - begin
    first = peer.seconds
    refined = {(i, j): peer.refined(i, j, numpy.linalg.inv(poses[j]) @ poses[i]) for i, j in kept}
    second = peer.seconds - first
    begin = time.process_time()
    poses, _ = relaxed(clouds, refined, shares_of(clouds, refined))
    others += time.process_time() - begin
    nowhere = numpy.zeros(3)
    return ({i: restored(pose, views.voxel, middles[i], nowhere) for i, pose in poses.items()},
            {(i, j): restored(pose, views.voxel, middles[i], middles[j]) for (i, j), pose in candidates.items()},
            list(accepted), peer.seconds + others, second)


def shares_of(clouds, poses):
    """By pair, the shares that are large enough."""
    found = {(i, j): shared(clouds, i, j, pose)[0] for (i, j), pose in poses.items()}
    return {pair: share for pair, share in found.items() if share >= LEAST_SHARE}


def shared(clouds, i, j, pose):
    """The share of the points of the smaller cloud that have a partner, and the information matrix."""
    from open3d.pipelines import registration

    information = registration.get_information_matrix_from_point_clouds(clouds[i], clouds[j], GRAPH, pose)
    return information[5, 5] / min(len(clouds[i].points), len(clouds[j].points)), information


def relaxed(clouds, candidates, accepted):
    """Open3D's multiway registration: poses by view, and the pairs that it keeps. The pairs of a spanning tree with
    the largest shares are certain, as those of successive views are in its documentation; all others are loop
    closures, which are uncertain."""
    from open3d.pipelines import registration

    groups = {i: {i} for i in range(len(clouds))}
    tree = set()
    for i, j in sorted(accepted, key=lambda pair: -accepted[pair]):
        if groups[i] is not groups[j]:
            tree.add((i, j))
            groups[i] |= groups[j]
            for k in groups[j]:
                groups[k] = groups[i]
    members = sorted(max(groups.values(), key=len))
    if len(members) < 2:
        return {}, []
    poses = {members[0]: numpy.eye(4)}
    while len(poses) < len(members):
        for i, j in tree:
            if i in poses and j not in poses:
                poses[j] = poses[i] @ numpy.linalg.inv(candidates[i, j])
            elif j in poses and i not in poses:
                poses[i] = poses[j] @ candidates[i, j]
    graph = registration.PoseGraph()
    for i in members:
        graph.nodes.append(registration.PoseGraphNode(poses[i]))
    for i, j in accepted:
        if i in poses and j in poses:
            graph.edges.append(registration.PoseGraphEdge(
                members.index(i), members.index(j), candidates[i, j], shared(clouds, i, j, candidates[i, j])[1],
                uncertain=(i, j) not in tree))
    registration.global_optimization(
        graph, registration.GlobalOptimizationLevenbergMarquardt(),
        registration.GlobalOptimizationConvergenceCriteria(),
        registration.GlobalOptimizationOption(max_correspondence_distance=GRAPH, edge_prune_threshold=0.25,
                                              reference_node=0))
    return ({i: graph.nodes[number].pose for number, i in enumerate(members)},
            [(members[edge.source_node_id], members[edge.target_node_id]) for edge in graph.edges])


def place(peer, views, target, seed):
    """The pose of a single view on a target (points and normals), the share of its points that have a partner, and
    seconds."""
    import open3d

    points, normals = target
    middles = [views.points[0].mean(axis=0), points.mean(axis=0)]
    clouds = [(views.points[0] - middles[0]) / views.voxel, (points - middles[1]) / views.voxel]
    peer.load([(clouds[0], views.directions[0]), (clouds[1], normals)])
    pose = peer.pose(0, 1, seed)
    if pose is None:
        return None, 0.0, peer.seconds
    pose = peer.refined(0, 1, pose)
    scan, model = (open3d.geometry.PointCloud(open3d.utility.Vector3dVector(cloud)) for cloud in clouds)
    fit = open3d.pipelines.registration.evaluate_registration(scan, model, REFINEMENT, pose).fitness
    return restored(pose, views.voxel, *middles), fit, peer.seconds
