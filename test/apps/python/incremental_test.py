"""Poses that are refined while a graph grows."""

import gc
import math
import pickle
import threading

import numpy as np
import pytest

import plumbline
from conftest import Room

NUM_POSES, BATCH = 40, 8
COVARIANCE = np.diag([1e-4, 1e-4, 1e-5])


class Host:
    """A robot that drives a circle in a room, and refines its poses on the way."""

    def __init__(self, num_free_poses=16):
        turn = 2.0 * math.pi / NUM_POSES * np.arange(NUM_POSES)
        self.truth = np.stack([1.5 * np.cos(turn), 1.2 * np.sin(turn), turn + 0.5 * math.pi], 1)
        self.rng = np.random.default_rng(3)
        self.graph = plumbline.SlamGraph()
        self.model = plumbline.LaserModel(
            num_beams=120, first_bearing_rad=-math.pi, bearing_step_rad=2.0 * math.pi / 120
        )
        self.graph.add_laser(self.model)
        self.poses = np.empty((0, 3))
        options = plumbline.SolverOptions(num_threads=1)
        self.solver = plumbline.IncrementalSolver(
            options, plumbline.IncrementalOptions(num_free_poses=num_free_poses)
        )

    def receive(self, num_poses):
        bearings = self.model.first_bearing_rad + self.model.bearing_step_rad * np.arange(120)
        for i in range(len(self.poses), len(self.poses) + num_poses):
            here = self.truth[i]
            if i > 0:
                step = plumbline.Pose2(self.truth[i - 1]).between(self.truth[i])
                step = step * plumbline.Pose2(self.rng.normal(0.0, 0.005, 3))
                here = list(plumbline.Pose2(self.poses[-1]) * step)
            self.graph.add_pose(here, 0.5 * i)
            self.poses = np.vstack([self.poses, here])
            noise = self.rng.normal(0.0, 0.01, 120)
            self.graph.add_scan(i, 0, Room.ranges(self.truth[i], bearings) + noise)
            if i > 0:
                self.graph.add_odometry(i - 1, i, step)

    def update(self, **arguments):
        return self.solver.update(self.graph, self.poses, **arguments)

    def drive(self, num_poses=NUM_POSES):
        while len(self.poses) < num_poses:
            self.receive(BATCH)
            summary = self.update()
        return summary

    def error(self, poses):
        """Largest distance of a pose from others [m]."""
        return np.max(np.linalg.norm(self.poses[:, :2] - poses[: len(self.poses), :2], axis=1))


@pytest.fixture
def host():
    return Host()


def test_a_drive_ends_where_solving_all_at_once_ends(host):
    host.drive()
    state = host.solver.get_state(host.graph)
    np.testing.assert_array_equal(state.poses, host.poses)
    assert state.points.shape == (host.graph.num_returns, 2)
    options = plumbline.SolverOptions(measure_rounds=True)
    energy = plumbline.solve(host.graph, state, options).round_energies[0].marginal_energy
    at_once = host.graph.initial_state()
    summary = plumbline.solve(host.graph, at_once, options)
    assert summary.termination == plumbline.TerminationType.CONVERGED
    assert energy < 1.01 * summary.final_marginal_energy
    assert summary.round_energies[0].marginal_energy > 1.01 * summary.final_marginal_energy
    assert 0.0 < host.error(at_once.poses) < 0.004
    assert host.error(host.truth) < 0.015


def test_an_update_moves_the_newest_poses(host):
    host.drive(32)
    before = host.poses.copy()
    host.receive(BATCH)
    placed = host.poses.copy()
    summary = host.update()
    assert summary.num_free_poses == 16
    assert BATCH <= summary.num_placed_poses <= 16
    assert summary.num_rounds >= 1 and summary.num_steps >= 1
    assert 0.0 < summary.final_cost <= summary.initial_cost
    assert summary.ignored_edges == ()
    np.testing.assert_array_equal(host.poses[:24], before[:24])
    assert np.all(np.any(host.poses[32:] != placed[32:], axis=1))
    summary = host.update(scope=plumbline.UpdateScope.ALL)
    assert summary.num_free_poses == NUM_POSES


def test_a_false_closure_is_ignored_and_listed(host):
    host.drive()
    host.graph.add_relative_pose(2, 36, (1.5, -0.8, 0.4), COVARIANCE)
    (ignored,) = host.update().ignored_edges
    assert (ignored.edge, ignored.from_pose, ignored.to_pose) == (0, 2, 36)
    assert ignored.sigmas > 30.0
    assert host.error(host.truth) < 0.015


def test_poses_are_refined_in_place(host):
    host.receive(BATCH)
    room_for_more = np.zeros((NUM_POSES, 3))
    room_for_more[:BATCH] = host.poses
    newest = room_for_more[BATCH - 1]
    host.solver.update(host.graph, room_for_more[:BATCH])
    assert np.any(newest != host.poses[-1])
    assert np.all(room_for_more[BATCH:] == 0.0)
    host.update()
    state = host.solver.get_state(host.graph)
    points, expected = state.points, state.points.copy()
    del state
    host.drive()
    poses, refined = host.poses, host.poses.copy()
    del host.solver, host.graph, host.poses
    gc.collect()
    np.testing.assert_array_equal(points, expected)
    np.testing.assert_array_equal(poses, refined)


def test_poses_of_another_process_can_be_refined(host):
    host.receive(BATCH)
    poses = pickle.loads(pickle.dumps(host.poses))
    host.solver.update(host.graph, poses)
    assert np.any(poses != host.poses)


def test_the_poses_of_a_state_can_be_refined(host):
    host.receive(BATCH)
    state = host.graph.initial_state()
    poses = state.poses
    host.solver.update(host.graph, state.poses)
    assert state.poses is poses
    assert np.any(poses != host.graph.initial_poses)


@pytest.mark.parametrize(
    "change, error, message",
    [
        (lambda p: p[:-1], ValueError, "poses: 7 rows for a graph of 8 poses"),
        (lambda p: np.vstack([p, p[:1]]), ValueError, "poses: 9 rows for a graph of 8 poses"),
        (lambda p: p.ravel(), ValueError, r"poses: .*\(24,\)"),
        (lambda p: np.where(np.arange(8)[:, None] == 3, math.nan, p), ValueError, "poses: row 3"),
        (lambda p: 1e9 + p, ValueError, "poses: row 0"),
        (lambda p: p.astype(np.float32), ValueError, "must be of type float64"),
        (lambda p: np.asfortranarray(p), ValueError, "must be of type float64, row by row"),
        (lambda p: np.broadcast_to(p[:1], p.shape), ValueError, "row by row"),
        (lambda p: p.astype(complex), TypeError, "poses: .*complex128"),
        (lambda p: p.tolist(), TypeError, "numpy.ndarray"),
        (lambda p: None, TypeError, "numpy.ndarray"),
    ],
)
def test_an_update_refuses_poses(host, change, error, message):
    host.receive(BATCH)
    poses = change(host.poses)
    with pytest.raises(error, match=message):
        host.solver.update(host.graph, poses)
    host.update()


def test_read_only_poses_are_refused(host):
    host.receive(BATCH)
    host.poses.setflags(write=False)
    with pytest.raises(ValueError, match="writable"):
        host.update()
    np.testing.assert_array_equal(host.poses, host.graph.initial_poses)


def test_a_solver_goes_with_one_graph(host):
    host.receive(BATCH)
    with pytest.raises(plumbline.InvalidArgumentError, match="not the one of the last update"):
        host.solver.get_state(host.graph)
    host.update()
    before = host.poses.copy()
    for other in (host.graph.copy(), plumbline.SlamGraph()):
        with pytest.raises(plumbline.InvalidArgumentError, match="a copy is another graph"):
            host.solver.update(other, other.initial_poses)
        with pytest.raises(plumbline.InvalidArgumentError, match="a copy is another graph"):
            host.solver.get_state(other)
    host.receive(1)
    with pytest.raises(plumbline.InvalidArgumentError, match="not the one of the last update"):
        host.solver.get_state(host.graph)
    np.testing.assert_array_equal(host.poses[:BATCH], before)


@pytest.mark.parametrize(
    "options, incremental, message",
    [
        ({"num_threads": 0}, {}, "num_threads = 0"),
        ({"type": plumbline.SolverType.CERES}, {}, "no other solver type"),
        ({}, {"num_free_poses": 0}, "num_free_poses = 0"),
        ({}, {"max_rounds": 0}, "max_rounds = 0"),
    ],
)
def test_options_are_checked(host, options, incremental, message):
    host.receive(BATCH)
    solver = plumbline.IncrementalSolver(
        plumbline.SolverOptions(**options), plumbline.IncrementalOptions(**incremental)
    )
    with pytest.raises(plumbline.InvalidArgumentError, match=message):
        solver.update(host.graph, host.poses)
    np.testing.assert_array_equal(host.poses, host.graph.initial_poses)


def first_refusal(host, other_call):
    """Updates all poses again and again, beside a thread that repeats other_call(), until one of
    them raises UnavailableError: its message."""
    start = host.graph.initial_poses
    messages, is_over = [], threading.Event()

    def attempt(work):
        try:
            work()
        except plumbline.UnavailableError as error:
            messages.append(str(error))
            is_over.set()

    def repeat():
        while not is_over.is_set():
            attempt(other_call)

    thread = threading.Thread(target=repeat)
    thread.start()
    for _ in range(1000):
        if is_over.is_set():
            break
        host.poses[:] = start
        attempt(lambda: host.update(scope=plumbline.UpdateScope.ALL))
    is_over.set()
    thread.join()
    return messages[0]


def test_a_solver_works_in_one_thread_at_a_time(host):
    host.drive(16)
    in_use = "the incremental solver is at work in another thread"
    assert first_refusal(host, lambda: host.solver.get_state(host.graph)) == in_use
    poses = host.poses.copy()
    assert first_refusal(host, lambda: host.solver.update(host.graph, poses)) == in_use
    host.update()


def test_the_graph_cannot_change_during_an_update(host):
    host.drive(16)
    message = first_refusal(host, lambda: host.graph.fix_pose(0))
    assert message.startswith("the graph cannot change while the library works on it")
    host.graph.fix_pose(0)


def test_several_solvers_refine_the_same_graph_at_a_time(host):
    host.receive(16)
    arrays = [host.poses.copy() for _ in range(3)]
    threads = [
        threading.Thread(target=plumbline.IncrementalSolver().update, args=(host.graph, poses))
        for poses in arrays
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    host.update()
    for poses in arrays:
        np.testing.assert_array_equal(poses, host.poses)


def test_an_empty_graph_is_fine():
    graph, solver = plumbline.SlamGraph(), plumbline.IncrementalSolver()
    assert solver.update(graph, np.empty((0, 3))).num_free_poses == 0
    assert solver.get_state(graph) == plumbline.MapState()
