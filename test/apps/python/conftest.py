"""What the tests of the Python module share."""

import math
import os
import pathlib
import subprocess

import numpy as np
import pytest

import plumbline

PROGRAMS = pathlib.Path(os.environ["PLUMBLINE_PROGRAMS_DIR"])
ROOT = pathlib.Path(__file__).parents[3]


class Room:
    """A square room of 6 m, and a robot that drives along its middle and turns."""

    NUM_POSES, NUM_BEAMS = 12, 180

    def __init__(self):
        rng = np.random.default_rng(1)
        self.truth = np.array([[0.1 * i, 0.05 * i, 0.1 * i] for i in range(self.NUM_POSES)])
        self.graph = plumbline.SlamGraph()
        laser = plumbline.LaserModel(
            num_beams=self.NUM_BEAMS,
            first_bearing_rad=-math.pi,
            bearing_step_rad=2.0 * math.pi / self.NUM_BEAMS,
            max_range_m=30.0,
        )
        self.laser = self.graph.add_laser(laser)
        bearings = laser.first_bearing_rad + laser.bearing_step_rad * np.arange(self.NUM_BEAMS)
        for i, pose in enumerate(self.truth):
            guess = pose + (i > 0) * rng.normal(0.0, [0.03, 0.03, 0.01])
            self.graph.add_pose(guess, 0.5 * i)
            ranges = self.ranges(pose, bearings)
            self.graph.add_scan(i, self.laser, ranges + rng.normal(0.0, 0.01, ranges.shape))
            if i > 0:
                before = plumbline.Pose2(self.truth[i - 1])
                self.graph.add_odometry(i - 1, i, before.between(pose))

    @staticmethod
    def ranges(pose, bearings):
        direction = np.stack([np.cos(bearings + pose[2]), np.sin(bearings + pose[2])])
        with np.errstate(divide="ignore", invalid="ignore"):
            to_walls = (3.0 * np.sign(direction) - pose[:2, None]) / direction
        return np.min(np.where(direction == 0.0, np.inf, to_walls), axis=0)

    def error(self, state):
        """Largest distance of a pose from the truth [m]."""
        return np.max(np.linalg.norm(state.poses[:, :2] - self.truth[:, :2], axis=1))


@pytest.fixture
def room():
    return Room()


@pytest.fixture(scope="session")
def small_log(tmp_path_factory):
    """A simulated log, with its truth beside it."""
    folder = tmp_path_factory.mktemp("small_log")
    run = [PROGRAMS / "plumbline_simulate", f"--world={ROOT}/datasets/small_building.world"]
    outputs = [f"--log={folder}/small.clf", f"--truth={folder}/truth.tum"]
    subprocess.run(run + outputs, check=True, stdout=subprocess.DEVNULL)
    return folder / "small.clf"


@pytest.fixture(scope="session")
def fr079():
    """The folder of the real logs."""
    folder = pathlib.Path(os.environ.get("PLUMBLINE_DATASETS", "/nowhere"))
    if not (folder / "fr079.clf.gz").exists():
        pytest.skip("PLUMBLINE_DATASETS names no folder with fr079.clf.gz")
    return folder
