"""Bad input raises an exception that names the culprit, and changes nothing."""

import inspect
import math
import pathlib
import re

import numpy as np
import pytest

import plumbline
from conftest import Room

COVARIANCE = np.diag([1e-4, 1e-4, 1e-5])


@pytest.mark.parametrize(
    "call, error, message",
    [
        (lambda g: g.add_pose((0, math.nan, 0), 1), ValueError, "pose 12: .* not finite"),
        (lambda g: g.add_pose((0, 0, 0), math.inf), ValueError, "time are not finite"),
        (lambda g: g.add_pose((0, 0), 1), TypeError, "add_pose"),
        (lambda g: g.add_pose("abc", 1), TypeError, "add_pose"),
        (lambda g: g.add_scan(12, 0, np.ones(180)), IndexError, "no pose with id 12, there are 12"),
        (lambda g: g.add_scan(-1, 0, np.ones(180)), IndexError, "no pose with id -1"),
        (lambda g: g.add_scan(0, 1, np.ones(180)), IndexError, "no laser with id 1"),
        (lambda g: g.add_scan(0, 0, np.ones(7)), ValueError, "7 ranges for a laser of 180 beams"),
        (lambda g: g.add_scan(0, 0, np.ones((180, 1))), ValueError, r"ranges: .*\(180, 1\)"),
        (lambda g: g.add_scan(0, 0, np.ones(180, complex)), TypeError, "ranges: .*complex128"),
        (lambda g: g.add_scan(0, 0, ["a"] * 180), TypeError, "ranges: an array of type <U1"),
        (lambda g: g.add_scan(0, 0, np.array([None] * 180)), TypeError, "ranges: .*object"),
        (lambda g: g.add_sweep(0, 0, np.ones(7), (0, 0, 0)), ValueError, "7 ranges for a laser"),
        (lambda g: g.add_sweep(12, 0, np.ones(180), (0, 0, 0)), IndexError, "no pose with id 12"),
        (lambda g: g.add_sweep(0, 1, np.ones(180), (0, 0, 0)), IndexError, "no laser with id 1"),
        (lambda g: g.add_sweep(0, 0, np.ones(180), (0, math.nan, 0)), ValueError, "its motion is"),
        (lambda g: g.add_sweep(0, 0, np.ones(180), (0, 0, 0), 0), TypeError, "SweepOrder"),
        (lambda g: g.add_points(0, 0, np.ones((4, 3))), ValueError, r"points_in_robot: .*\(4, 3\)"),
        (lambda g: g.add_points(0, 9, np.ones((4, 2))), IndexError, "no laser with id 9"),
        (lambda g: g.fix_pose(99), IndexError, "no pose with id 99"),
        (lambda g: g.fix_pose(0, (math.inf, 0, 0)), ValueError, "fixed pose 0"),
        (lambda g: g.add_odometry(0, 12, (1, 0, 0)), IndexError, "no pose with id 12"),
        (lambda g: g.add_odometry(3, 3, (1, 0, 0)), ValueError, r"odometry 11 \(3 -> 3\)"),
        (lambda g: g.add_relative_pose(0, 1, (1, 0, 0), -COVARIANCE), ValueError, "covariance is"),
        (lambda g: g.add_relative_pose(0, 1, (1, 0, 0), np.ones(3)), ValueError, "covariance: "),
        (lambda g: g.add_relative_pose(0, 1, (1, 0, 0), COVARIANCE[:2]), ValueError, "covariance:"),
        (lambda g: g.add_laser(plumbline.LaserModel()), ValueError, "laser 1: num_beams = 0"),
        (lambda g: g.scan(12), IndexError, "no scan with id 12"),
        (lambda g: g.laser(-1), IndexError, "no laser with id -1"),
        (lambda g: g.measured_map(np.zeros((3, 3))), ValueError, "poses: 3 rows .* 12 poses"),
        (lambda g: g.measured_map(np.full((12, 3), np.nan)), ValueError, "poses: row 0"),
        (lambda g: plumbline.measure_map_consistency(g, [[0, 0]]), ValueError, r"\(N, 3\)"),
    ],
)
def test_a_graph_refuses(room, call, error, message):
    before = repr(room.graph), len(room.graph.odometry), len(room.graph.relative_poses)
    with pytest.raises(error, match=message):
        call(room.graph)
    assert before == (
        repr(room.graph),
        len(room.graph.odometry),
        len(room.graph.relative_poses),
    )
    assert room.graph.add_pose((0, 0, 0), 99.0) == 12


@pytest.mark.parametrize(
    "change, message",
    [
        (lambda s: s.poses.__setitem__((3, 1), math.nan), "pose 3 of the state is not finite"),
        (lambda s: s.points.__setitem__((7, 0), 1e9), "point 7 of the state is beyond"),
        (lambda s: setattr(s, "poses", s.poses[:5]), "the graph has 12 poses"),
        (lambda s: setattr(s, "points", np.zeros((0, 2))), "the state has 36 and 0"),
        (lambda s: setattr(s.poses, "shape", (36, 1)), "poses of the state: the array is no longer"),
        (lambda s: s.points.resize((3, 2), refcheck=False), "coordinates|own"),
        (lambda s: s.points.setflags(write=False), "points of the state: the array is read-only"),
    ],
)
def test_a_solve_refuses_a_state(room, change, message):
    state = room.graph.initial_state()
    with pytest.raises(ValueError, match=message):
        change(state)
        plumbline.solve(room.graph, state)


def test_a_state_of_another_graph_is_refused(room):
    other = plumbline.SlamGraph()
    other.add_pose((0, 0, 0), 0)
    state = other.initial_state()
    calls = [
        lambda: plumbline.solve(room.graph, state),
        lambda: plumbline.solve_window(room.graph, state),
        lambda: plumbline.evaluate_residuals(room.graph, state),
        lambda: plumbline.compute_pose_covariances(room.graph, state, [(0, 0)]),
        lambda: plumbline.build_occupancy_grid(room.graph, state),
        lambda: plumbline.write_points_ply("never.ply", room.graph, state),
    ]
    for call in calls:
        with pytest.raises(plumbline.InvalidArgumentError, match="graph has 12 poses"):
            call()
    with pytest.raises(plumbline.InvalidArgumentError, match="more than the graph has"):
        other.extend_state(room.graph.initial_state())


@pytest.mark.parametrize(
    "set_option, error, message",
    [
        (lambda o: setattr(o, "num_threads", 0), ValueError, "num_threads = 0"),
        (lambda o: setattr(o, "num_threads", "2"), TypeError, "SolverOptions.num_threads: '2'"),
        (lambda o: setattr(o, "num_threads", 10**20), TypeError, "num_threads: 1000"),
        (lambda o: setattr(o, "test_edges", 1), TypeError, "test_edges: 1 does not fit.* bool"),
        (lambda o: setattr(o, "type", "reduced"), TypeError, "type: 'reduced'.*SolverType"),
        (lambda o: setattr(o, "max_rounds", 3), AttributeError, "max_rounds"),
        (
            lambda o: setattr(o.factors.beam, "sigma_range_m", math.nan),
            ValueError,
            "factors.beam.sigma_range_m = nan",
        ),
        (
            lambda o: setattr(o, "ceres", {"dogleg_type": "x"}),
            ValueError,
            "ceres: dogleg_type = 'x', but it must be traditional_dogleg or subspace_dogleg",
        ),
        (lambda o: setattr(o, "ceres", {"dogleg": "x"}), ValueError, "there is no option 'dogleg'"),
        (lambda o: setattr(o, "ceres", {"eta": math.inf}), ValueError, "eta = 'inf'"),
        (lambda o: setattr(o, "ceres", 5), TypeError, "not iterable"),
        (lambda o: setattr(o, "ceres_reduced", 1), TypeError, "ceres_reduced: 1 does not fit"),
        (
            lambda o: setattr(o.factors, "ignored_relative_poses", [-1]),
            TypeError,
            "ignored_relative_poses",
        ),
    ],
)
def test_options_are_checked(room, set_option, error, message):
    options = plumbline.SolverOptions()
    state = room.graph.initial_state()
    with pytest.raises(error, match=message):
        set_option(options)
        plumbline.solve(room.graph, state, options)
    assert state == room.graph.initial_state()


def test_options_are_made_and_copied_by_value():
    with pytest.raises(TypeError, match="SolverOptions has no field 'threads'"):
        plumbline.SolverOptions(threads=2)
    reduced = plumbline.ReducedOptions(max_rounds=3)
    options = plumbline.MapLogOptions(solver=plumbline.SolverOptions(reduced=reduced))
    reduced.max_rounds = 4
    solver = options.solver
    assert solver.reduced.max_rounds == 3
    solver.reduced.max_rounds = 5
    assert options.solver.reduced.max_rounds == 5
    options.solver = plumbline.SolverOptions()
    del options
    assert solver.reduced.max_rounds == plumbline.ReducedOptions().max_rounds
    steps = [plumbline.DownweightedStep(step=1, sigma_factor=2.0)]
    factors = plumbline.FactorOptions(downweighted_steps=steps)
    assert isinstance(factors.downweighted_steps, tuple)
    assert factors.downweighted_steps[0].sigma_factor == 2.0


def test_solves_refuse_what_they_cannot_use(room):
    state = room.graph.initial_state()
    with pytest.raises(TypeError, match="progress: a int cannot be called"):
        plumbline.solve(room.graph, state, progress=3)
    with pytest.raises(IndexError, match="no pose with id 12"):
        plumbline.solve_poses(room.graph, state, [0, 12])
    with pytest.raises(IndexError, match="no pose with id -1"):
        plumbline.compute_pose_covariances(room.graph, state, [(0, -1)])
    with pytest.raises(ValueError, match="ab: 2 rows of 3 numbers"):
        pose, one = plumbline.Pose2(), np.eye(3)
        plumbline.relative_pose_covariance(pose, pose, one, one[:2], one)
    with pytest.raises(plumbline.InvalidArgumentError, match="no laser returns"):
        plumbline.solve(plumbline.SlamGraph(), plumbline.MapState())
    with pytest.raises(plumbline.InvalidArgumentError, match="no relative poses"):
        options = plumbline.SolverOptions(type=plumbline.SolverType.POSE_GRAPH)
        plumbline.solve(room.graph, state, options)
    with pytest.raises(plumbline.UnavailableError, match="stopped"):
        plumbline.seed_graph(room.graph, progress=lambda *arguments: False)
    room.graph.add_pose((0, 0, 0), 50.0)
    with pytest.raises(plumbline.InvalidArgumentError, match="odometry"):
        plumbline.seed_graph(room.graph)
    assert state == state.copy()


def test_options_for_the_scans_of_a_bag_are_checked(tmp_path):
    with pytest.raises(plumbline.InvalidArgumentError, match="echo is neither"):
        plumbline.read_log("a.bag", echo="last")
    (tmp_path / "a.bag").write_text("#ROSBAG V2.0\n")
    with pytest.raises(plumbline.InvalidArgumentError, match="slice_height_m is no band"):
        plumbline.read_log(tmp_path / "a.bag", slice_height_m=(1.0, 0.0))


def test_errors_are_of_the_kinds_that_python_has(tmp_path):
    assert issubclass(plumbline.InvalidArgumentError, (plumbline.Error, ValueError))
    with pytest.raises(FileNotFoundError, match="none.clf"):
        plumbline.read_log(tmp_path / "none.clf")
    with pytest.raises(plumbline.NotFoundError):
        plumbline.read_trajectory(str(tmp_path / "none.tum"))
    with pytest.raises(FileNotFoundError, match="\udcff.clf"):
        plumbline.read_log("\udcff.clf")  # a name that is no valid text
    (tmp_path / "bad.tum").write_text("1 2 3\n")
    with pytest.raises(plumbline.InvalidArgumentError, match="bad.tum:1: "):
        plumbline.read_trajectory(tmp_path / "bad.tum")
    with pytest.raises(plumbline.UnavailableError, match="no_folder"):
        plumbline.write_trajectory(tmp_path / "no_folder" / "a.tum", [0], [[0, 0, 0]])
    with pytest.raises(ValueError, match="2 timestamps_s, but 1 poses"):
        plumbline.write_trajectory(tmp_path / "a.tum", [0, 1], [[0, 0, 0]])
    with pytest.raises(ValueError, match="poses: row 0 is not finite"):
        plumbline.write_trajectory(tmp_path / "a.tum", [0], [[0, math.nan, 0]])
    assert [path.name for path in tmp_path.iterdir()] == ["bad.tum"]


def reachable(value, found):
    """Objects of all classes of the module that hang together with this one, by class."""
    if isinstance(value, (list, tuple)):
        for element in value[:2]:
            reachable(element, found)
    elif type(value).__module__ == "plumbline":
        found.setdefault(f"plumbline.{type(value).__name__}", []).append(value)
        for field in getattr(value, "_fields", ()):
            reachable(getattr(value, field), found)
    return found


def odd_values(graph, rng):
    """By the type that a signature asks for: values that fit, and some that do so only at first."""
    state = graph.initial_state()
    broken = state.copy()
    broken.points[0] = rng.choice([np.nan, 1e300])
    values = reachable(plumbline.map_log(graph), {})
    for kind in vars(plumbline).values():
        if hasattr(kind, "check"):
            reachable(kind(), values)
    graphs = values.setdefault("plumbline.SlamGraph", [])
    graphs[:] = [graph, graph, graph, plumbline.SlamGraph()]
    values["plumbline.MapState"] = [state, state.copy(), broken, plumbline.MapState([[0, 0, 0]], [])]
    solver, updated = plumbline.IncrementalSolver(), plumbline.IncrementalSolver()
    updated.update(graph, graph.initial_poses)
    values["plumbline.IncrementalSolver"] = [solver, updated]
    mapper = plumbline.OnlineMapper([graph.laser(0)])
    mapper.add_scan(0.0, np.ones(graph.laser(0).num_beams), (0.0, 0.0, 0.0))
    values["plumbline.OnlineMapper"] = [mapper, plumbline.OnlineMapper([graph.laser(0)])]
    values["plumbline.UpdateScope"] = list(plumbline.UpdateScope.__members__.values())
    values["numpy.ndarray"] = [graph.initial_poses, np.zeros((12, 3)), np.full((12, 3), np.nan)]
    values["plumbline.Relation"] = [plumbline.Relation(), plumbline.Relation(to_s=2.0)]
    values["int"] = [-1, 0, 1, 2, 3, 12, 10**6, 10**20, np.int32(4)]
    values["float"] = [0.05, 1.0, -1.0, math.nan, math.inf, 1e300, np.float64(2.0)]
    values["str"] = ["", "x", "JACOBI", "\x00", "\udcff"]
    values["os.PathLike"] = ["a.tum", "a.g2o", "a.ply", "a", "no/file", "", "\x00", "."]
    values["List"] = [[], [0, 1], [3, 3], [-1], [(0, 1), (1, 1)], values["plumbline.Relation"]]
    values["object"] = [
        None, 1, "x", [], {}, [[0, 1, 2]], (0.1, 0.2, 0.3), np.zeros(0), np.ones(180), np.arange(12.0),
        np.full(180, np.nan), np.zeros((12, 3)), rng.normal(size=(12, 3)), np.full((12, 3), 1e9),
        np.zeros((0, 3)), rng.normal(size=(50, 2)), np.array("x"), np.ones((2, 2), bool), np.eye(3),
        lambda *arguments: True, lambda *arguments: False, lambda: None, object(), state,
    ]  # fmt: skip
    return values


def all_callables():
    """Functions, and methods and setters that are yet to be given their object."""
    for value in vars(plumbline).values():
        if inspect.isbuiltin(value):
            yield value
        elif inspect.isclass(value):
            members = [m for name, m in vars(value).items() if not name.startswith("_")]
            for member in members:
                yield from (member.fget, member.fset) if isinstance(member, property) else [member]


def types_of_arguments(function):
    """As the signature in its docstring has them."""
    signature = re.search(r"\((.*)\) -> ", function.__doc__ or "")
    return re.findall(r"\w+: ([\w.]+)", signature.group(1)) if signature else []


def choose(wanted, values, rng):
    """A value of the wanted type, mostly."""
    if rng.random() < 0.1 or wanted not in values:
        wanted = rng.choice(list(values))
    return values[wanted][rng.integers(len(values[wanted]))]


def test_no_call_crashes(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    rng = np.random.default_rng(7)
    targets = [(f, types_of_arguments(f)) for f in all_callables() if callable(f)]
    done = set()
    for _ in range(8):
        values = odd_values(Room().graph, rng)
        for i in rng.permutation(len(targets)):
            target, types = targets[i]
            try:
                repr(target(*(choose(wanted, values, rng) for wanted in types)))
                done.add(i)
            except Exception as error:  # pylint: disable=broad-except
                assert str(error), f"{target} raised {type(error)} without a word"
    assert len(done) > 300
    assert not list(pathlib.Path().glob("*.tmp"))
