"""Solving from Python: results, stops, locks, memory."""

import os
import signal
import threading

import numpy as np
import pytest

import plumbline


def endless():
    """Options of a solve that goes on for hours."""
    options = plumbline.SolverOptions(type=plumbline.SolverType.ALTERNATING_CG)
    options.alternating_cg.max_sweeps = 10**9
    options.alternating_cg.relative_cost_tolerance = 0.0
    return options


def when_busy(graph, action):
    """A thread that calls action() once the library works on the graph without Python's lock."""

    def wait():
        while True:
            try:
                graph.fix_pose(0)
            except plumbline.UnavailableError:
                return action()

    thread = threading.Thread(target=wait)
    thread.start()
    return thread


def test_a_solve_improves_the_poses(room):
    state = room.graph.initial_state()
    before = room.error(state)
    summary = plumbline.solve(room.graph, state)
    assert summary.termination == plumbline.TerminationType.CONVERGED
    assert summary.num_poses == room.NUM_POSES
    assert summary.acceptance.final_energy < summary.acceptance.seed_energy
    assert room.error(state) < 0.2 * before
    assert room.error(state) < 0.01
    assert "reduced" in summary.full_report()


@pytest.mark.parametrize("name", ["REDUCED", "ALTERNATING_CG", "CERES"])
def test_every_solver_can_be_chosen(room, name):
    state = room.graph.initial_state()
    options = plumbline.SolverOptions(type=getattr(plumbline.SolverType, name), num_threads=1)
    summary = plumbline.solve(room.graph, state, options)
    assert summary.solver.startswith(name.lower())
    assert room.error(state) < 0.01


def test_options_of_ceres_have_its_names():
    options = plumbline.SolverOptions(ceres={"linear_solver_type": "dense_schur"})
    assert options.ceres["linear_solver_type"] == "DENSE_SCHUR"
    options.ceres = {"max_num_iterations": 3, "jacobi_scaling": False, "eta": 0.25}
    assert options.ceres["linear_solver_type"] == "SPARSE_SCHUR"
    assert options.ceres["max_num_iterations"] == 3
    assert options.ceres["jacobi_scaling"] is False
    assert options.ceres["eta"] == 0.25
    with pytest.raises(TypeError):
        options.ceres["eta"] = 0.5
    options.ceres_reduced = True
    options.ceres = {**options.ceres, "eta": 0.5}
    assert options.ceres_reduced
    assert options.ceres["max_num_iterations"] == 3


def test_pose_graphs_are_solved_without_scans():
    graph = plumbline.SlamGraph()
    for i in range(3):
        graph.add_pose((0.9 * i, 0.1, 0.0), i)
    covariance = np.diag([1e-4, 1e-4, 1e-5])
    graph.add_relative_pose(0, 1, (1, 0, 0), covariance)
    graph.add_relative_pose(1, 2, (1, 0, 0), covariance)
    np.testing.assert_array_equal(graph.relative_poses[0].covariance, covariance)
    state = graph.initial_state()
    for name in ("POSE_GRAPH", "SGD"):
        options = plumbline.SolverOptions(type=getattr(plumbline.SolverType, name))
        solved = state.copy()
        plumbline.solve(graph, solved, options)
        np.testing.assert_allclose(solved.poses[:, 0], [0, 1, 2], atol=1e-3)
    np.testing.assert_allclose(state.poses[:, 0], [0, 0.9, 1.8])


def test_fixed_poses_stay(room):
    place = np.array([5.0, 6.0, 0.5])
    room.graph.fix_pose(3, place)
    assert room.graph.fixed_poses[0].pose == 3
    state = room.graph.initial_state()
    plumbline.solve(room.graph, state)
    np.testing.assert_array_equal(state.poses[3], place)


def test_options_reach_the_solver(room):
    options = plumbline.SolverOptions()
    options.factors.beam.sigma_range_m = 0.5
    state = room.graph.initial_state()
    state.points += 0.01
    loose = plumbline.evaluate_residuals(room.graph, state, options)
    tight = plumbline.evaluate_residuals(room.graph, state)
    sigma_m = plumbline.SolverOptions().factors.beam.sigma_range_m
    assert loose.beams.shape == (room.graph.num_returns, 2)
    assert loose.surfaces.shape == (room.graph.num_returns,)
    assert loose.odometry.shape == (room.NUM_POSES - 1, 3)
    assert np.max(np.abs(tight.beams)) > 0.5
    np.testing.assert_allclose(loose.beams[:, 0] * 0.5, tight.beams[:, 0] * sigma_m)


def test_energies_of_rounds_are_measured_on_request(room):
    state = room.graph.initial_state()
    assert plumbline.solve(room.graph, state.copy()).round_energies == ()
    options = plumbline.SolverOptions(measure_rounds=True)
    summary = plumbline.solve(room.graph, state, options)
    energies = summary.round_energies
    assert [e.round for e in energies] == list(range(len(summary.landmark_rounds) + 1))
    assert energies[0].iteration == 0
    assert energies[-1].iteration == len(summary.iterations)
    assert energies[-1].marginal_energy < energies[0].marginal_energy
    assert energies[0].total_time_s <= energies[-1].total_time_s <= summary.total_time_s


def test_progress_sees_iterations_that_outlive_the_solve(room):
    seen = []
    state = room.graph.initial_state()
    summary = plumbline.solve(room.graph, state, progress=seen.append)
    assert len(seen) == len(summary.iterations) > 1
    for shown, kept in zip(seen, summary.iterations):
        assert shown.cost == kept.cost
        assert shown.poses.shape == (room.NUM_POSES, 3)
        assert kept.poses is None
    assert np.all(np.abs(seen[-1].poses - state.poses) < 0.1)


def test_false_from_progress_stops_with_the_best_state(room):
    state = room.graph.initial_state()
    before = room.error(state)
    rows = []

    def stop_at_third(iteration):
        rows.append(iteration.iteration)
        return len(rows) < 3

    summary = plumbline.solve(room.graph, state, endless(), progress=stop_at_third)
    assert summary.termination == plumbline.TerminationType.USER_STOPPED
    assert len(rows) == 3
    assert room.error(state) < before


def test_an_exception_in_progress_stops_and_is_raised(room):
    class Mine(Exception):
        pass

    def fail(iteration):
        if iteration.iteration >= 3:
            raise Mine(iteration.iteration)

    state = room.graph.initial_state()
    before = room.error(state)
    with pytest.raises(Mine) as raised:
        plumbline.solve(room.graph, state, endless(), progress=fail)
    assert raised.value.args[0] >= 3
    assert room.error(state) < before


def test_ctrl_c_stops_a_solve_with_the_best_state(room):
    state = room.graph.initial_state()
    points = state.points
    before = room.error(state), points.copy()
    thread = when_busy(room.graph, lambda: os.kill(os.getpid(), signal.SIGINT))
    with pytest.raises(KeyboardInterrupt):
        plumbline.solve(room.graph, state, endless())
    thread.join()
    assert room.error(state) < before[0]
    assert state.points is points
    assert np.any(points != before[1])
    room.graph.add_pose((0, 0, 0), 99.0)  # it is no longer in use


def test_the_graph_cannot_change_while_it_is_solved(room):
    errors = []

    def change(iteration):
        try:
            room.graph.add_pose((0, 0, 0), 1.0)
        except plumbline.UnavailableError as error:
            errors.append(str(error))
        return False

    plumbline.solve(room.graph, room.graph.initial_state(), progress=change)
    assert errors == [
        "the graph cannot change while the library works on it, in a callback or in a thread"
    ]
    assert room.graph.num_poses == room.NUM_POSES
    grown = room.graph.copy()
    grown.add_pose((0, 0, 0), 1.0)
    assert (grown.num_poses, room.graph.num_poses) == (room.NUM_POSES + 1, room.NUM_POSES)


def test_threads_solve_the_same_graph_at_a_time(room):
    states = [room.graph.initial_state() for _ in range(3)]
    threads = [threading.Thread(target=plumbline.solve, args=(room.graph, s)) for s in states]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    expected = room.graph.initial_state()
    plumbline.solve(room.graph, expected)
    assert states[0] == states[1] == states[2] == expected


def test_a_window_moves_the_newest_poses_only(room):
    state = room.graph.initial_state()
    window = plumbline.WindowOptions(num_free_poses=4)
    before = state.poses.copy()
    summary = plumbline.solve_window(room.graph, state, window)
    assert summary.num_poses < room.NUM_POSES + 1
    moved = np.any(state.poses != before, axis=1)
    assert np.all(moved[-4:]) and not np.any(moved[:-4])
    plumbline.solve_poses(room.graph, state, [2, 5])
    assert np.flatnonzero(np.any(state.poses != before, axis=1)).tolist() == [2, 5, 8, 9, 10, 11]


def test_a_state_follows_a_growing_graph(room):
    state = room.graph.initial_state()
    old_points = state.points
    pose = room.graph.add_pose((1.0, 0.5, 1.0), 9.0)
    with pytest.raises(plumbline.InvalidArgumentError, match="ExtendState"):
        plumbline.solve(room.graph, state)
    room.graph.add_scan(pose, room.laser, np.full(room.NUM_BEAMS, 1.0))
    room.graph.extend_state(state)
    assert state.poses.shape == (room.NUM_POSES + 1, 3)
    assert state.points.shape == (len(old_points) + room.NUM_BEAMS, 2)
    np.testing.assert_array_equal(state.points[: len(old_points)], old_points)


def test_covariances_are_those_of_the_poses(room):
    state = room.graph.initial_state()
    plumbline.solve(room.graph, state)
    aa, ab, bb, fixed = plumbline.compute_pose_covariances(
        room.graph, state, [(3, 3), (3, 7), (7, 7), (0, 0)]
    )
    np.testing.assert_allclose(aa, aa.T, rtol=1e-6)
    assert np.all(np.linalg.eigvalsh(aa) > 0.0)
    assert np.all(fixed == 0.0)
    assert np.sqrt(aa[0, 0]) < 0.01
    relative = plumbline.relative_pose_covariance(state.poses[3], state.poses[7], aa, ab, bb)
    assert relative.shape == (3, 3) and np.all(np.linalg.eigvalsh(relative) > 0.0)


def test_calibration_finds_a_range_bias(room):
    biased = plumbline.SlamGraph()
    laser = biased.add_laser(room.graph.laser(0))
    bearings = room.graph.laser(0).first_bearing_rad + np.arange(room.NUM_BEAMS) * (
        room.graph.laser(0).bearing_step_rad
    )
    for i, pose in enumerate(room.truth):
        biased.add_pose(pose, i)
        biased.add_scan(i, laser, room.ranges(pose, bearings) + 0.02)
    for step in room.graph.odometry:
        biased.add_odometry(step.from_pose, step.to_pose, step.from_from_to)
    what = plumbline.CalibrationOptions(range_bias=True)
    summary, calibration = plumbline.solve_with_calibration(biased, biased.initial_state(), what)
    (bias,) = calibration.parameters
    assert bias.name == "range_bias_m" and abs(bias.value + 0.02) < 0.005
    corrected = biased.corrected(calibration.corrections)
    np.testing.assert_allclose(corrected.ranges_m, biased.ranges_m + bias.value, atol=1e-9)
    assert summary.termination != plumbline.TerminationType.FAILURE


def resident_bytes():
    with open("/proc/self/statm", encoding="ascii") as statm:
        return int(statm.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def test_a_hundred_solves_take_no_memory(room):
    options = plumbline.SolverOptions(num_threads=1)
    start = room.graph.initial_state()

    def solve_once():
        state = start.copy()
        plumbline.solve(room.graph, state, options, progress=lambda iteration: iteration.poses)
        plumbline.evaluate_residuals(room.graph, state, options)

    for _ in range(20):
        solve_once()
    before = resident_bytes()
    for _ in range(100):
        solve_once()
    # A copy of the state per solve would be three times as much.
    assert resident_bytes() - before < 100 * start.points.nbytes / 3
