"""From a log to a map: the same as plumbline_slam, byte by byte, and the files of both."""

import re
import subprocess
import sys
import warnings

import numpy as np
import pytest
from conftest import PROGRAMS, ROOT

import plumbline

NUM_SCANS = 150


def run_slam(log, folder, *flags):
    command = [PROGRAMS / "plumbline_slam", f"--log={log}", f"--output_dir={folder}", *flags]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)


def write_results(mapping, folder):
    """The files of a map, as plumbline_slam names them."""
    folder.mkdir()
    graph, state = mapping.graph, mapping.state
    plumbline.write_trajectory(folder / "trajectory.tum", graph.timestamps_s, state.poses)
    plumbline.write_points_ply(folder / "points.ply", graph, state)
    plumbline.write_points_pcd(folder / "points.pcd", graph, state)
    plumbline.write_map(folder / "map", plumbline.build_occupancy_grid(graph, state))


def expect_same_files(folder, other, names):
    for name in names:
        assert (folder / name).read_bytes() == (other / name).read_bytes(), name


@pytest.fixture(scope="module")
def mapping(small_log):
    return plumbline.map_log(plumbline.read_log(small_log, max_scans=NUM_SCANS))


@pytest.fixture(scope="module")
def results(mapping, tmp_path_factory):
    folder = tmp_path_factory.mktemp("results") / "python"
    write_results(mapping, folder)
    return folder


def test_a_short_log_gives_the_bytes_of_plumbline_slam(small_log, results, tmp_path):
    run_slam(small_log, tmp_path / "slam", f"--max_scans={NUM_SCANS}")
    names = ["trajectory.tum", "points.ply", "points.pcd", "map.pgm", "map.yaml"]
    expect_same_files(results, tmp_path / "slam", names)


def test_a_real_log_gives_the_bytes_of_plumbline_slam(fr079, tmp_path):
    log = fr079 / "fr079.clf.gz"
    run_slam(log, tmp_path / "slam")
    mapping = plumbline.map_log(plumbline.read_log(log))
    write_results(mapping, tmp_path / "python")
    expect_same_files(tmp_path / "python", tmp_path / "slam", ["trajectory.tum", "points.ply"])
    relations = plumbline.read_relations(fr079 / "fr079.relations")
    metric = plumbline.measure_relations(
        relations, mapping.graph.timestamps_s, mapping.state.poses
    )
    assert metric.all.num_matched > 1000
    assert metric.all.translation_m.mean < 0.035
    assert not mapping.report.alarms


def test_the_truth_is_near(mapping, small_log):
    times, truth = plumbline.read_trajectory(small_log.parent / "truth.tum")
    poses = mapping.state.poses
    errors = plumbline.measure_trajectory(mapping.graph.timestamps_s, poses, times, truth)
    assert errors.absolute.num_matched == NUM_SCANS
    assert errors.absolute.translation_m.rmse < 0.02
    raw = plumbline.measure_map_quality(mapping.graph.measured_map(truth[:NUM_SCANS]))
    assert plumbline.measure_map_quality(mapping.state.points).wall_thickness_m < (
        raw.wall_thickness_m
    )
    consistency = plumbline.measure_map_consistency(mapping.graph, poses)
    assert not consistency.is_contradictory()
    assert consistency.within_pass.num_compared > 1000
    assert plumbline.alarm_text(mapping.report.alarms) == ""


def test_steps_one_by_one_give_a_map_as_well(small_log):
    graph = plumbline.read_log(small_log, max_scans=60)
    seen = []
    state, report = plumbline.seed_graph(graph, progress=lambda *a: seen.append(a))
    assert seen[0] == (plumbline.SeedingPhase.MATCHING_SCANS, 0, 60)
    assert report.sequential.num_keyframes > 0 and not report.alarm
    summary = plumbline.solve(graph.corrected(report.corrections), state)
    assert summary.acceptance.final_energy <= summary.acceptance.seed_energy


def test_a_stopped_mapping_keeps_the_best_map(small_log):
    graph = plumbline.read_log(small_log, max_scans=60)
    kept = plumbline.LogMapping()

    def interrupt(iteration):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        plumbline.map_log(graph, progress=interrupt, into=kept)
    assert kept.state.poses.shape == (60, 3)
    assert kept.report.solver.termination == plumbline.TerminationType.USER_STOPPED
    with pytest.raises(KeyboardInterrupt):
        plumbline.map_log(graph, seeding_progress=lambda *a: interrupt(a), into=kept)
    np.testing.assert_array_equal(kept.state.poses, graph.initial_poses)
    with pytest.raises(TypeError, match="into: it is no LogMapping"):
        plumbline.map_log(graph, into=3)


def test_what_is_skipped_is_a_warning(tmp_path):
    scan = "FLASER 2 {} 2 {} 0 0 {} 0 0 {} host 0\n"
    lines = [scan.format(r, x, x, x) for r, x in [(1, 0), ("oops", 1), (1, 2)]]
    (tmp_path / "a.clf").write_text("".join(lines))
    with pytest.warns(plumbline.InputWarning, match="skipped .*a.clf:2: ") as caught:
        graph = plumbline.read_log(tmp_path / "a.clf")
    assert [warning.message.id for warning in caught] == ["skipped_record", "skipped_records"]
    assert graph.num_scans == 2
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(UserWarning):
            plumbline.read_log(str(tmp_path / "a.clf"))


def test_results_are_read_as_they_were_written(mapping, results):
    times, poses = plumbline.read_trajectory(results / "trajectory.tum")
    np.testing.assert_allclose(times, mapping.graph.timestamps_s, atol=1e-6)
    np.testing.assert_allclose(poses[:, :2], mapping.state.poses[:, :2], atol=1e-8)
    points = plumbline.read_points_ply(results / "points.ply")
    np.testing.assert_array_equal(points, mapping.state.points)


def test_a_grid_is_an_array_of_cells(mapping):
    grid = plumbline.build_occupancy_grid(mapping.graph, mapping.state, resolution_m=0.1)
    cells = grid.cells
    assert cells.dtype == np.uint8 and set(np.unique(cells)) == {0, 1, 2}
    column, row = np.floor((mapping.state.poses[0, :2] - [grid.left_m, grid.bottom_m]) / 0.1)
    assert cells[int(row), int(column)] == 1  # the robot stood there


@pytest.mark.parametrize("name", ["a.g2o", "a.toro"])
def test_pose_graphs_are_read_as_they_were_written(room, tmp_path, name):
    room.graph.add_relative_pose(0, 5, (0.5, 0.2, 0.4), np.diag([1e-4, 1e-4, 1e-5]))
    plumbline.write_pose_graph(tmp_path / name, room.graph, poses=room.truth)
    read = plumbline.read_pose_graph(tmp_path / name)
    assert read.format == name[2:] and read.num_robot_poses == room.NUM_POSES
    assert read.names == tuple(range(room.NUM_POSES))
    np.testing.assert_allclose(read.graph.initial_poses, room.truth, atol=1e-12)
    np.testing.assert_array_equal(read.graph.ranges_m, room.graph.ranges_m)
    assert len(read.graph.relative_poses) == room.NUM_POSES
    read.write(tmp_path / "again", read.graph.initial_poses)
    assert (tmp_path / "again").read_bytes() == (tmp_path / name).read_bytes()
    with pytest.raises(ValueError, match="11 rows for a file of 12 poses"):
        read.write(tmp_path / "again", room.truth[1:])


def test_the_example_maps_a_log(small_log, tmp_path):
    example = ROOT / "apps/python/examples/map_log.py"
    command = [sys.executable, example, small_log, tmp_path / "out", "--max-scans=60"]
    run = subprocess.run(command, check=True, capture_output=True, text=True)
    assert "reduced: " in run.stdout
    written = {path.name for path in (tmp_path / "out").iterdir()}
    assert {"trajectory.tum", "points.ply", "map.pgm", "map.yaml"} <= written
    picture = tmp_path / "out/map.png"
    assert picture.exists() or "matplotlib is not installed" in run.stdout


def test_the_code_in_the_readme_works(small_log, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (code,) = re.findall(
        r"```python\n(.*?)```", (ROOT / "apps/python/README.md").read_text(), re.DOTALL
    )
    assert "fr079.clf.gz" in code
    names = {"ranges": np.full(360, 2.0)}
    exec(code.replace("fr079.clf.gz", str(small_log)), names)  # pylint: disable=exec-used
    assert (tmp_path / "map.tum").exists()
    assert names["state"].points.shape == (360, 2)
