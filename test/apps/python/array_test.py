"""Arrays of the module: whose memory they are, and how long it lives."""

import copy
import gc

import numpy as np
import pytest

import plumbline


def test_arrays_outlive_their_owners(room):
    state = room.graph.initial_state()
    poses, row, points = state.poses, state.poses[3], state.points[10:20]
    expected = poses.copy(), row.copy(), points.copy()
    graph_arrays = [room.graph.ranges_m, room.graph.initial_poses, room.graph.timestamps_s]
    graph_expected = [a.copy() for a in graph_arrays]
    residuals = plumbline.evaluate_residuals(room.graph, state)
    beams = residuals.beams
    beams_expected = beams.copy()
    covariance = plumbline.solve(room.graph, state.copy()).acceptance
    del state, room.graph, residuals
    gc.collect()
    scratch = [np.full(5000, 7.0) for _ in range(200)]  # takes memory that was given back
    for array, value in zip([poses, row, points, beams], [*expected, beams_expected]):
        np.testing.assert_array_equal(array, value)
    for array, value in zip(graph_arrays, graph_expected):
        np.testing.assert_array_equal(array, value)
    assert covariance.final_energy > 0.0 and len(scratch) == 200


def test_parts_of_a_mapping_outlive_it(room):
    mapping = plumbline.map_log(room.graph)
    graph, points, noise = mapping.graph, mapping.state.points, mapping.report.seeding.odometry_noise
    start = mapping.start_poses
    expected = points.copy(), start.copy(), noise.motion.rotation_floor_rad
    plumbline.map_log(room.graph, into=mapping)
    del mapping
    gc.collect()
    np.testing.assert_array_equal(points, expected[0])
    np.testing.assert_array_equal(start, expected[1])
    assert noise.motion.rotation_floor_rad == expected[2]
    assert graph.num_poses == room.NUM_POSES


def test_a_solve_writes_into_the_same_arrays(room):
    state = room.graph.initial_state()
    poses, points = state.poses, state.points
    before = poses.copy()
    plumbline.solve(room.graph, state)
    assert state.poses is poses and state.points is points
    assert np.any(poses != before)


def test_a_state_can_be_changed_in_place(room):
    state = room.graph.initial_state()
    state.poses[2, 0] += 1.0
    other = room.graph.initial_state()
    assert state != other
    other.poses[2, 0] += 1.0
    assert state == other
    other.poses = other.poses.tolist()
    assert state == other
    assert copy.deepcopy(state) == state and copy.copy(state).poses is not state.poses


def test_a_state_can_be_saved_and_made_again(room, tmp_path):
    state = room.graph.initial_state()
    np.savez(tmp_path / "state.npz", poses=state.poses, points=state.points)
    loaded = np.load(tmp_path / "state.npz")
    assert plumbline.MapState(loaded["poses"], loaded["points"]) == state


def test_arrays_of_a_graph_are_copies(room):
    ranges = room.graph.ranges_m
    ranges[:] = -1.0
    assert np.all(room.graph.ranges_m > 0.0)
    assert ranges.shape == room.graph.beams.shape == room.graph.scan_of_return.shape
    scan = room.graph.scan(2)
    returns = slice(scan.first_return, scan.first_return + scan.num_returns)
    assert np.all(room.graph.scan_of_return[returns] == 2)


def test_a_measured_map_is_where_the_beams_end(room):
    poses = room.truth
    points = room.graph.measured_map(poses)
    bearings = room.graph.bearings_rad + poses[room.graph.scan_of_return, 2]
    ends = poses[room.graph.scan_of_return, :2] + room.graph.ranges_m[:, None] * np.stack(
        [np.cos(bearings), np.sin(bearings)], axis=1
    )
    np.testing.assert_allclose(points, ends, atol=1e-12)


def test_a_sweep_is_seen_from_where_it_began(room):
    beams, model = np.arange(room.NUM_BEAMS), room.graph.laser(0)
    bearings = model.first_bearing_rad + model.bearing_step_rad * beams
    order = plumbline.SweepOrder
    for kind, before in [(order.FIRST_BEAM_FIRST, beams), (order.LAST_BEAM_FIRST, beams[::-1])]:
        graph = plumbline.SlamGraph()
        laser = graph.add_laser(model)
        x = 0.3 * before / room.NUM_BEAMS
        ranges = [room.ranges(np.array([x[i], 0, 0]), bearings[i : i + 1])[0] for i in beams]
        for _ in range(3):
            graph.add_pose((0, 0, 0), 0.0)
        assert graph.add_sweep(0, laser, ranges, (0.3, 0, 0), kind) == 0
        assert graph.add_sweep(1, laser, ranges, (0.3, 0, 0), order=order.AT_ONCE) == 1
        graph.add_scan(2, laser, ranges)
        per_scan = np.max(np.abs(graph.measured_map(graph.initial_poses)), axis=1).reshape(3, -1)
        np.testing.assert_allclose(per_scan[0], 3.0, atol=1e-9)  # on the walls
        assert np.max(np.abs(per_scan[1] - 3.0)) > 0.1
        np.testing.assert_allclose(per_scan[1], per_scan[2], atol=1e-12)


@pytest.mark.parametrize("kind", [np.float32, np.float64, np.int64, np.uint8, list])
def test_numbers_of_any_real_type_are_taken(kind):
    graph = plumbline.SlamGraph()
    laser = graph.add_laser(plumbline.LaserModel(num_beams=3, bearing_step_rad=0.1))
    graph.add_pose((0, 0, 0), 0)
    ranges = [1, 2, 3] if kind is list else np.array([1, 2, 3], dtype=kind)
    graph.add_scan(0, laser, ranges)
    assert graph.ranges_m.tolist() == [1.0, 2.0, 3.0]


def test_arrays_in_any_order_of_memory_are_taken(room):
    poses = np.asfortranarray(room.truth)[::-1][::-1]
    np.testing.assert_array_equal(
        room.graph.measured_map(poses), room.graph.measured_map(room.truth)
    )


def test_poses_are_motions_of_the_plane():
    a, b = plumbline.Pose2(1, 2, np.pi / 2), plumbline.Pose2([1, 0, 0])
    assert list(a * b) == pytest.approx([1, 3, np.pi / 2])
    assert list(a.between(a * b)) == pytest.approx([1, 0, 0])
    assert list(a * a.inverse()) == pytest.approx([0, 0, 0])
    np.testing.assert_allclose(a.transform([[1, 0], [0, 1]]), [[1, 3], [0, 2]], atol=1e-12)
