"""A map that is made while the robot drives."""

import math

import numpy as np
import pytest

import plumbline
from conftest import Room

NUM_SCANS = 60


class Drive:
    """A robot that drives a circle in a room, with wheels that read 3 % too much."""

    def __init__(self):
        turn = 2.0 * math.pi / NUM_SCANS * np.arange(NUM_SCANS)
        self.truth = np.stack([1.5 * np.cos(turn), 1.2 * np.sin(turn), turn + 0.5 * math.pi], 1)
        self.laser = plumbline.LaserModel(
            num_beams=120, first_bearing_rad=-math.pi, bearing_step_rad=2.0 * math.pi / 120
        )
        bearings = self.laser.first_bearing_rad + self.laser.bearing_step_rad * np.arange(120)
        rng = np.random.default_rng(5)
        self.ranges = [Room.ranges(pose, bearings) + rng.normal(0.0, 0.01, 120) for pose in self.truth]
        self.odometry = [plumbline.Pose2(5.0, 1.0, 0.3)]
        for before, after in zip(self.truth, self.truth[1:]):
            x, y, yaw = plumbline.Pose2(before).between(after)
            self.odometry.append(self.odometry[-1] * plumbline.Pose2(1.03 * x, 1.03 * y, yaw))

    def add(self, mapper, i):
        return mapper.add_scan(0.5 * i, self.ranges[i], self.odometry[i])

    def error(self, i, pose):
        return np.linalg.norm(list(plumbline.Pose2(self.truth[0]).between(self.truth[i]))[:2] - pose[:2])


@pytest.fixture(scope="module")
def drive():
    return Drive()


def test_maps_while_driving_and_ends_as_the_batch(drive):
    mapper = plumbline.OnlineMapper([drive.laser])
    for i in range(NUM_SCANS):
        now = drive.add(mapper, i)
        assert now.scan == i and now.num_pending >= 1
        assert drive.error(i, np.array(list(now.map_from_robot))) < 0.1
        assert list(now.map_from_odometry * drive.odometry[i]) == pytest.approx(
            list(now.map_from_robot), abs=1e-9
        )
    mapper.wait()
    online = mapper.get_map()
    assert online.poses.shape == (NUM_SCANS, 3)
    assert online.points.shape[1] == 2 and len(online.points) > 100
    assert np.max(np.abs(online.points)) < 6.0
    assert online.alarms == ()
    graph = plumbline.SlamGraph()
    graph.add_laser(drive.laser)
    for i in range(NUM_SCANS):
        graph.add_pose(drive.odometry[0].between(drive.odometry[i]), 0.5 * i)
        graph.add_scan(i, 0, drive.ranges[i])
        if i > 0:
            graph.add_odometry(i - 1, i, drive.odometry[i - 1].between(drive.odometry[i]))
    so_far = mapper.map_now().state
    assert mapper.finish().state == plumbline.map_log(graph).state == so_far
    with pytest.raises(plumbline.InvalidArgumentError, match="has finished"):
        drive.add(mapper, NUM_SCANS - 1)


def test_bad_scans_are_refused_and_change_nothing(drive):
    mapper = plumbline.OnlineMapper([drive.laser])
    drive.add(mapper, 0)
    for arguments, message in [
        ((0.5, drive.ranges[1][:-1], drive.odometry[1]), "scan 1: .*119"),
        ((-0.5, drive.ranges[1], drive.odometry[1]), "scan 1: its time"),
        ((math.nan, drive.ranges[1], drive.odometry[1]), "scan 1: "),
        ((0.5, drive.ranges[1], (99.0, 0.0, 0.0)), "scan 1: the odometry jumps"),
        ((0.5, drive.ranges[1], drive.odometry[1], 1), "scan 1: laser 1 is unknown"),
    ]:
        with pytest.raises(plumbline.InvalidArgumentError, match=message):
            mapper.add_scan(*arguments)
    assert len(mapper.get_map().poses) == 1
    assert mapper.add_scan(0.5, drive.ranges[1]).scan == 1
    with pytest.raises(plumbline.InvalidArgumentError, match="keyframe_distance_m"):
        options = plumbline.MapLogOptions()
        options.seeding.keyframe_distance_m = -1.0
        drive.add(plumbline.OnlineMapper([drive.laser], options), 0)


def saved_map(drive, is_fixed):
    graph = plumbline.SlamGraph()
    graph.add_laser(drive.laser)
    for i in range(NUM_SCANS):
        graph.add_pose(drive.truth[i], 0.5 * i)
        graph.add_scan(i, 0, drive.ranges[i])
        if i > 0:
            graph.add_odometry(i - 1, i, plumbline.Pose2(drive.truth[i - 1]).between(drive.truth[i]))
        if is_fixed:
            graph.fix_pose(i)
    return graph


@pytest.mark.parametrize("is_fixed", [False, True])
def test_drives_in_a_saved_map(drive, is_fixed):
    start = plumbline.Pose2(drive.truth[0]) * plumbline.Pose2(0.1, -0.1, 0.05)
    mapper = plumbline.OnlineMapper([drive.laser], saved_map(drive, is_fixed), start)
    errors = []
    for i in range(NUM_SCANS):
        now = drive.add(mapper, i)
        mapper.wait()
        if now.is_in_map:
            errors.append(np.hypot(*(np.array(list(now.map_from_robot)) - drive.truth[i])[:2]))
    assert len(errors) > NUM_SCANS - 3
    assert np.sqrt(np.mean(np.square(errors[5:]))) < 0.05
    assert mapper.get_map().is_in_map
    maps = mapper.finish_with_map()
    assert isinstance(maps, list) and all(len(m.state.poses) >= NUM_SCANS for m in maps)


def test_a_saved_map_that_is_no_map_is_refused(drive):
    with pytest.raises(plumbline.InvalidArgumentError, match="the saved map has no scan"):
        drive.add(plumbline.OnlineMapper([drive.laser], plumbline.SlamGraph()), 0)
    with pytest.raises(plumbline.InvalidArgumentError, match="no saved map"):
        plumbline.OnlineMapper([drive.laser]).finish_with_map()
