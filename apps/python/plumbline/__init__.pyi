"""Types of the package; its docstrings are in the extension."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from os import PathLike
from typing import Any, ClassVar, Final, TypeVar, Union, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

_Array = NDArray[np.float64]
_IntArray = NDArray[np.int32]
_Path = Union[str, PathLike[str]]
_PoseLike = Union["Pose2", Sequence[float]]
_Progress = Callable[["IterationSummary"], object]
_SeedingProgress = Callable[["SeedingPhase", int, int], object]
_Self = TypeVar("_Self")

class _Choice:
    name: Final[str]
    value: Final[int]
    def __init__(self, value: int) -> None: ...

class _Options:
    def __init__(self, **fields: Any) -> None: ...
    def __copy__(self: _Self) -> _Self: ...
    def __deepcopy__(self: _Self, memo: object) -> _Self: ...

class _Checked(_Options):
    def check(self) -> None: ...

class Error(Exception): ...
class InvalidArgumentError(Error, ValueError): ...
class NotFoundError(Error, FileNotFoundError): ...
class DataLossError(Error, ValueError): ...
class UnavailableError(Error, RuntimeError): ...

class InputWarning(UserWarning):
    id: str

class Pose2:
    @overload
    def __init__(self) -> None: ...
    @overload
    def __init__(self, x: float, y: float, yaw: float) -> None: ...
    @overload
    def __init__(self, numbers: Sequence[float]) -> None: ...
    x: float
    y: float
    yaw: float
    def __mul__(self, b_from_c: _PoseLike) -> Pose2: ...
    def inverse(self) -> Pose2: ...
    def between(self, other: _PoseLike) -> Pose2: ...
    def transform(self, points: ArrayLike) -> _Array: ...
    def __iter__(self) -> Iterator[float]: ...

class LaserModel(_Checked):
    num_beams: int
    first_bearing_rad: float
    bearing_step_rad: float
    min_range_m: float
    max_range_m: float
    beam_period_s: float
    robot_from_laser: Pose2
    def __eq__(self, other: object) -> bool: ...

class SweepOrder(_Choice):
    FIRST_BEAM_FIRST: ClassVar[SweepOrder]
    LAST_BEAM_FIRST: ClassVar[SweepOrder]
    AT_ONCE: ClassVar[SweepOrder]

class OdometryConstraint:
    from_pose: Final[int]
    to_pose: Final[int]
    is_measured: Final[bool]
    from_from_to: Final[Pose2]

class RelativePoseConstraint:
    from_pose: Final[int]
    to_pose: Final[int]
    from_from_to: Final[Pose2]
    covariance: Final[_Array]

class FixedPose:
    pose: Final[int]
    world_from_robot: Final[Pose2]

class ScanEntry:
    pose: Final[int]
    laser: Final[int]
    first_return: Final[int]
    num_returns: Final[int]

class MeasurementCorrections:
    pass

class MapState:
    @overload
    def __init__(self) -> None: ...
    @overload
    def __init__(self, poses: ArrayLike, points: ArrayLike) -> None: ...
    @property
    def poses(self) -> _Array: ...
    @poses.setter
    def poses(self, rows: ArrayLike) -> None: ...
    @property
    def points(self) -> _Array: ...
    @points.setter
    def points(self, rows: ArrayLike) -> None: ...
    def __copy__(self) -> MapState: ...
    def __deepcopy__(self, memo: object) -> MapState: ...
    def copy(self) -> MapState: ...
    def __eq__(self, other: object) -> bool: ...

class SlamGraph:
    def __init__(self) -> None: ...
    def add_laser(self, laser: LaserModel) -> int: ...
    def add_pose(self, world_from_robot: _PoseLike, timestamp_s: float) -> int: ...
    def fix_pose(self, pose: int, world_from_robot: _PoseLike | None = ...) -> None: ...
    def add_scan(self, pose: int, laser: int, ranges: ArrayLike) -> int: ...
    def add_sweep(
        self,
        pose: int,
        laser: int,
        ranges: ArrayLike,
        motion: _PoseLike,
        order: SweepOrder = ...,
    ) -> int: ...
    def add_points(self, pose: int, laser: int, points_in_robot: ArrayLike) -> int: ...
    def add_odometry(self, from_pose: int, to_pose: int, from_from_to: _PoseLike) -> None: ...
    def add_relative_pose(
        self,
        from_pose: int,
        to_pose: int,
        from_from_to: _PoseLike,
        covariance: ArrayLike,
    ) -> None: ...
    num_poses: Final[int]
    num_scans: Final[int]
    num_lasers: Final[int]
    num_returns: Final[int]
    initial_poses: Final[_Array]
    timestamps_s: Final[_Array]
    ranges_m: Final[_Array]
    bearings_rad: Final[_Array]
    beams: Final[_IntArray]
    scan_of_return: Final[_IntArray]
    odometry: Final[list[OdometryConstraint]]
    relative_poses: Final[list[RelativePoseConstraint]]
    fixed_poses: Final[list[FixedPose]]
    def copy(self) -> SlamGraph: ...
    def scan(self, scan: int) -> ScanEntry: ...
    def laser(self, laser: int) -> LaserModel: ...
    def initial_state(self) -> MapState: ...
    def extend_state(self, state: MapState) -> None: ...
    def measured_map(self, poses: ArrayLike) -> _Array: ...
    def corrected(self, corrections: MeasurementCorrections) -> SlamGraph: ...

class SolverType(_Choice):
    REDUCED: ClassVar[SolverType]
    ALTERNATING_CG: ClassVar[SolverType]
    PUBLISHED: ClassVar[SolverType]
    CERES: ClassVar[SolverType]
    POSE_GRAPH: ClassVar[SolverType]
    SGD: ClassVar[SolverType]

class UpdateScope(_Choice):
    AUTOMATIC: ClassVar[UpdateScope]
    ALL: ClassVar[UpdateScope]

class StartType(_Choice):
    ODOMETRY: ClassVar[StartType]
    ICP: ClassVar[StartType]
    ICP_POINT_TO_LINE: ClassVar[StartType]
    ICP_GLOBAL: ClassVar[StartType]
    SEED: ClassVar[StartType]

class SeedingPhase(_Choice):
    MATCHING_SCANS: ClassVar[SeedingPhase]
    CLOSING_LOOPS: ClassVar[SeedingPhase]
    TYING_SESSIONS: ClassVar[SeedingPhase]

class MotionOptions(_Checked):
    rotation_per_rotation: float
    rotation_per_translation_rad_m: float
    translation_per_translation: float
    translation_per_rotation_m_rad: float
    translation_floor_m: float
    rotation_floor_rad: float

class RangeBeamOptions(_Checked):
    sigma_range_m: float
    sigma_bearing_rad: float

class ManifoldOptions(_Checked):
    sigma_m: float
    robust_gate_sigmas: float

class DownweightedStep(_Checked):
    step: int
    sigma_factor: float

class FactorOptions(_Checked):
    motion: MotionOptions
    beam: RangeBeamOptions
    manifold: ManifoldOptions
    shape: bool
    downweighted_steps: tuple[DownweightedStep, ...]
    ignored_relative_poses: tuple[int, ...]

class AssociationOptions(_Checked):
    several_poses: bool
    landmark_size_m: float

class RoundOptions(_Checked):
    max_coarse_rounds: int
    max_fine_rounds: int
    coarse_radius_m: float
    fine_radius_m: float

class ReducedOptions(_Checked):
    max_rounds: int
    relative_tolerance: float
    lines_follow: bool

class AlternatingCgOptions(_Checked):
    max_sweeps: int
    scan_iterations_per_sweep: int
    relative_cost_tolerance: float

class PublishedOptions(_Checked):
    max_passes: int
    sigma_from_start: bool

class SolverOptions(_Checked):
    type: SolverType
    factors: FactorOptions
    test_edges: bool
    association: AssociationOptions
    rounds: RoundOptions
    reduced: ReducedOptions
    alternating_cg: AlternatingCgOptions
    published: PublishedOptions
    ceres: Mapping[str, bool | int | float | str]
    ceres_reduced: bool
    num_threads: int
    measure_rounds: bool

class WindowOptions(_Checked):
    num_free_poses: int
    max_fixed_poses: int

class IncrementalOptions(_Checked):
    num_free_poses: int
    max_rounds: int

class CalibrationOptions(_Options):
    laser_mounting: bool
    range_bias: bool
    range_scale: bool
    odometry_scale: bool

class SeedingOptions(_Checked):
    keyframe_distance_m: float

class MapLogOptions(_Checked):
    start: StartType
    seeding: SeedingOptions
    solver: SolverOptions
    calibration: CalibrationOptions

class TerminationType(_Choice):
    FAILURE: ClassVar[TerminationType]
    NO_IMPROVEMENT: ClassVar[TerminationType]
    USER_STOPPED: ClassVar[TerminationType]
    MAX_ITERATIONS: ClassVar[TerminationType]
    CONVERGED: ClassVar[TerminationType]

class IterationSummary:
    iteration: Final[int]
    round: Final[int]
    phase: Final[str]
    cost: Final[float]
    cost_change: Final[float]
    gradient_max_norm: Final[float]
    step_norm: Final[float]
    evaluations: Final[int]
    iteration_time_s: Final[float]
    total_time_s: Final[float]
    poses: Final[_Array | None]

class RoundSummary:
    radius_m: Final[float]
    gate_sigmas: Final[float]
    num_lines: Final[int]
    num_shape_pairs: Final[int]
    initial_cost: Final[float]
    final_cost: Final[float]
    marginal_energy: Final[float]
    kept: Final[bool]
    iterations: Final[int]
    stop_reason: Final[str]

class LandmarkRoundSummary:
    gate_sigmas: Final[float]
    num_landmarks: Final[int]
    num_observations: Final[int]
    initial_cost: Final[float]
    final_cost: Final[float]
    moved_sigmas: Final[float]

class RoundEnergy:
    round: Final[int]
    iteration: Final[int]
    total_time_s: Final[float]
    marginal_energy: Final[float]

class TermSummary:
    name: Final[str]
    count: Final[int]
    initial_cost: Final[float]
    final_cost: Final[float]
    residuals_per_block: Final[int]
    sigma: Final[float]
    unit: Final[str]
    def whitened_rms(self) -> float: ...

class AcceptanceTest:
    seed_energy: Final[float]
    final_energy: Final[float]
    num_held_out: Final[int]
    seed_held_out_error: Final[float]
    final_held_out_error: Final[float]
    held_out_noise: Final[float]
    num_worse_stretches: Final[int]
    def is_better(self) -> bool: ...
    def text(self) -> str: ...

class WorseStretch:
    first: Final[int]
    last: Final[int]
    seed_error: Final[float]
    state_error: Final[float]

class IgnoredEdge:
    edge: Final[int]
    from_pose: Final[int]
    to_pose: Final[int]
    off_m: Final[float]
    off_rad: Final[float]
    sigmas: Final[float]

class PointDisplacements:
    mean_m: Final[float]
    max_m: Final[float]
    max_beam_sigmas: Final[float]

class SolverSummary:
    termination: Final[TerminationType]
    message: Final[str]
    solver: Final[str]
    num_poses: Final[int]
    num_points: Final[int]
    rounds: Final[tuple[RoundSummary, ...]]
    landmark_rounds: Final[tuple[LandmarkRoundSummary, ...]]
    iterations: Final[tuple[IterationSummary, ...]]
    terms: Final[tuple[TermSummary, ...]]
    final_marginal_energy: Final[float]
    round_energies: Final[tuple[RoundEnergy, ...]]
    num_relative_poses: Final[int]
    seed_chi2: Final[float]
    final_chi2: Final[float]
    started_from_constraints: Final[bool]
    acceptance: Final[AcceptanceTest]
    put_back: Final[tuple[WorseStretch, ...]]
    downweighted_steps: Final[tuple[DownweightedStep, ...]]
    ignored_edges: Final[tuple[IgnoredEdge, ...]]
    displacements: Final[PointDisplacements]
    association_time_s: Final[float]
    setup_time_s: Final[float]
    solve_time_s: Final[float]
    total_time_s: Final[float]
    def brief_report(self) -> str: ...
    def full_report(self) -> str: ...

class IncrementalSummary:
    num_free_poses: Final[int]
    num_placed_poses: Final[int]
    num_rounds: Final[int]
    num_steps: Final[int]
    initial_cost: Final[float]
    final_cost: Final[float]
    ignored_edges: Final[tuple[IgnoredEdge, ...]]
    contradicted_closures: Final[tuple[IgnoredEdge, ...]]
    alarms: Final[tuple[Alarm, ...]]
    association_time_s: Final[float]
    minimization_time_s: Final[float]
    total_time_s: Final[float]

class CalibratedParameter:
    name: Final[str]
    given: Final[float]
    value: Final[float]
    sigma: Final[float]
    prior_sigma: Final[float]
    def is_determined(self) -> bool: ...

class Calibration:
    parameters: Final[tuple[CalibratedParameter, ...]]
    steps: Final[int]
    settled: Final[bool]
    time_s: Final[float]
    corrections: Final[MeasurementCorrections]

class FreeSpaceConflict:
    num_compared: Final[int]
    num_conflicting: Final[int]
    def share(self) -> float: ...

class ConflictPeak:
    conflict: Final[FreeSpaceConflict]
    pose: Final[int]
    usual_ratio: Final[float]

class SpaceConflict:
    viewer_scan: Final[int]
    scan: Final[int]
    world_point: Final[_Array]

class MapConsistency:
    within_pass: Final[FreeSpaceConflict]
    between_passes: Final[FreeSpaceConflict]
    num_pairs_within: Final[int]
    num_pairs_between: Final[int]
    worst_within: Final[ConflictPeak]
    worst_between: Final[ConflictPeak]
    contradicted_share: Final[float]
    usual_ratio_at_rest: Final[float]
    places: Final[tuple[SpaceConflict, ...]]
    def ratio(self) -> float: ...
    def is_contradictory(self) -> bool: ...

class OdometrySignReport:
    num_backward_steps: Final[int]
    num_decided: Final[int]
    num_contradicting: Final[int]
    sign_lost: Final[bool]

class SystematicError:
    value: Final[float]
    sigma: Final[float]
    def is_significant(self) -> bool: ...

class ClockOffset:
    value_s: Final[float]
    sigma_s: Final[float]
    def is_significant(self) -> bool: ...

class RandomError:
    estimated: Final[bool]
    num_spans: Final[int]
    sigma_per_sqrt_m: Final[float]
    sigma_per_sqrt_rad: Final[float]

class PoseNoise:
    position_m: Final[float]
    yaw_rad: Final[float]

class OdometryNoiseReport:
    gross_translation_scale: Final[float]
    clock_offset: Final[ClockOffset]
    translation_scale: Final[SystematicError]
    rotation_scale: Final[SystematicError]
    heading_drift_rad_m: Final[SystematicError]
    translation: Final[RandomError]
    rotation: Final[RandomError]
    num_leaps: Final[int]
    num_still_steps: Final[int]
    motion: Final[MotionOptions]
    is_prediction: Final[bool]
    given_poses: Final[PoseNoise]

class ClosureOutcome(_Choice):
    ACCEPTED: ClassVar[ClosureOutcome]
    NO_MATCH: ClassVar[ClosureOutcome]
    LOW_OVERLAP: ClassVar[ClosureOutcome]
    FREE_SPACE_CONFLICT: ClassVar[ClosureOutcome]
    AMBIGUOUS: ClassVar[ClosureOutcome]
    CONTRADICTED: ClassVar[ClosureOutcome]

class LoopClosureRecord:
    from_pose: Final[int]
    to_pose: Final[int]
    from_from_to: Final[Pose2]
    outcome: Final[ClosureOutcome]

class SuspectStep:
    first_pose_after: Final[int]
    evidence: Final[float]
    broken: Final[bool]
    unmatched: Final[bool]
    turned_rad: Final[float]
    num_closures_across: Final[int]
    num_alternatives: Final[int]
    def is_unresolved(self) -> bool: ...

class LoopClosingReport:
    num_candidates: Final[int]
    num_closures: Final[int]
    num_contradicted: Final[int]
    matches: Final[tuple[LoopClosureRecord, ...]]
    suspect_steps: Final[tuple[SuspectStep, ...]]
    def is_unresolved(self) -> bool: ...

class HypothesisKind(_Choice):
    MATCHING: ClassVar[HypothesisKind]
    ODOMETRY: ClassVar[HypothesisKind]
    ODOMETRY_ALONE: ClassVar[HypothesisKind]
    ODOMETRY_HEADINGS: ClassVar[HypothesisKind]
    WITHOUT_CLUSTER: ClassVar[HypothesisKind]
    WITH_MATCH: ClassVar[HypothesisKind]
    BROKEN_STEPS: ClassVar[HypothesisKind]
    JOINED_PARTS: ClassVar[HypothesisKind]

class WeighedHypothesis:
    kind: Final[HypothesisKind]
    num_closures: Final[int]
    conflict: Final[FreeSpaceConflict]
    score: Final[float]
    adopted: Final[bool]
    poses: Final[_Array]

class SequentialSeedingReport:
    odometry_sign: Final[OdometrySignReport]
    num_keyframes: Final[int]
    num_reversed_steps: Final[int]
    num_recovered: Final[int]
    num_unmatched: Final[int]

class SeedingReport:
    start: Final[StartType]
    sequential: Final[SequentialSeedingReport]
    moving_share: Final[float]
    odometry_noise: Final[OdometryNoiseReport]
    loops: Final[LoopClosingReport]
    consistency: Final[MapConsistency]
    hypotheses: Final[tuple[WeighedHypothesis, ...]]
    pose_graph: Final[tuple[RelativePoseConstraint, ...]]
    corrections: Final[MeasurementCorrections]
    alarm: Final[bool]
    def repaired(self) -> bool: ...

def solve(
    graph: SlamGraph,
    state: MapState,
    options: SolverOptions = ...,
    progress: _Progress | None = ...,
) -> SolverSummary: ...
def solve_window(
    graph: SlamGraph,
    state: MapState,
    window: WindowOptions = ...,
    options: SolverOptions = ...,
    progress: _Progress | None = ...,
) -> SolverSummary: ...
def solve_poses(
    graph: SlamGraph,
    state: MapState,
    free_poses: Sequence[int],
    window: WindowOptions = ...,
    options: SolverOptions = ...,
    progress: _Progress | None = ...,
) -> SolverSummary: ...
def solve_with_calibration(
    graph: SlamGraph,
    state: MapState,
    calibration: CalibrationOptions = ...,
    options: SolverOptions = ...,
    progress: _Progress | None = ...,
) -> tuple[SolverSummary, Calibration]: ...
def seed_graph(
    graph: SlamGraph,
    seeding: SeedingOptions = ...,
    options: SolverOptions = ...,
    progress: _Progress | None = ...,
) -> tuple[MapState, SeedingReport]: ...

class Residuals:
    odometry: Final[_Array]
    relative_poses: Final[_Array]
    beams: Final[_Array]
    surfaces: Final[_Array]

def evaluate_residuals(
    graph: SlamGraph,
    state: MapState,
    options: SolverOptions = ...,
) -> Residuals: ...
def compute_pose_covariances(
    graph: SlamGraph,
    state: MapState,
    pairs: Sequence[tuple[int, int]],
    options: SolverOptions = ...,
) -> _Array: ...
def relative_pose_covariance(
    world_from_a: _PoseLike,
    world_from_b: _PoseLike,
    aa: ArrayLike,
    ab: ArrayLike,
    bb: ArrayLike,
) -> _Array: ...

class IncrementalSolver:
    def __init__(
        self,
        options: SolverOptions = ...,
        incremental: IncrementalOptions = ...,
    ) -> None: ...
    def update(
        self,
        graph: SlamGraph,
        poses: _Array,
        scope: UpdateScope = ...,
    ) -> IncrementalSummary: ...
    def get_state(self, graph: SlamGraph) -> MapState: ...

class FrozenStretch:
    laser: Final[int]
    first_scan: Final[int]
    last_scan: Final[int]
    num_repeated: Final[int]
    moved_m: Final[float]
    turned_rad: Final[float]

class ScanPlace:
    scan: Final[int | None]
    time_s: Final[float]
    world_position: Final[_Array]
    def text(self) -> str: ...

class Alarm:
    place: Final[ScanPlace]
    reason: Final[str]
    wrong_share: Final[float | None]

class MappingReport:
    range_noise_m: Final[float]
    frozen_laser: Final[tuple[FrozenStretch, ...]]
    sweep_order: Final[SweepOrder | None]
    seeding: Final[SeedingReport]
    solver: Final[SolverSummary]
    misplaced_poses: Final[tuple[int, ...]]
    calibration: Final[Calibration]
    consistency: Final[MapConsistency]
    alarms: Final[tuple[Alarm, ...]]

class LogMapping:
    def __init__(self) -> None: ...
    graph: Final[SlamGraph]
    state: Final[MapState]
    start_poses: Final[_Array]
    before_from_after: Final[Pose2]
    report: Final[MappingReport]

def map_log(
    graph: SlamGraph,
    options: MapLogOptions = ...,
    seeding_progress: _SeedingProgress | None = ...,
    progress: _Progress | None = ...,
    into: LogMapping | None = ...,
) -> LogMapping: ...
def alarm_text(alarms: Sequence[Alarm]) -> str: ...

class OnlinePose:
    scan: Final[int]
    is_in_map: Final[bool]
    map_from_robot: Final[Pose2]
    map_from_odometry: Final[Pose2]
    num_pending: Final[int]

class OnlineMap:
    poses: Final[_Array]
    points: Final[_Array]
    is_in_map: Final[bool]
    map_from_odometry: Final[Pose2]
    num_closures: Final[int]
    num_remappings: Final[int]
    alarms: Final[tuple[Alarm, ...]]

class OnlineMapper:
    @overload
    def __init__(self, lasers: Sequence[LaserModel], options: MapLogOptions = ...) -> None: ...
    @overload
    def __init__(
        self,
        lasers: Sequence[LaserModel],
        saved_map: SlamGraph,
        map_from_robot: Pose2 | ArrayLike | None = ...,
        options: MapLogOptions = ...,
        keeps_scans: bool = ...,
    ) -> None: ...
    def add_scan(
        self,
        timestamp_s: float,
        ranges: ArrayLike,
        odometry: Pose2 | ArrayLike | None = ...,
        laser: int = ...,
    ) -> OnlinePose: ...
    def get_map(self) -> OnlineMap: ...
    def wait(self) -> None: ...
    def map_now(self) -> LogMapping: ...
    def finish(self) -> LogMapping: ...
    def finish_with_map(self) -> list[LogMapping]: ...

def read_log(
    path: _Path,
    max_scans: int = ...,
    scan_topic: str = ...,
    odom_topic: str = ...,
    odom_frame: str | None = ...,
    sweep_time_s: float | None = ...,
    echo: str = ...,
    slice_height_m: tuple[float, float] | None = ...,
    laser_frame: str = ...,
    clock: str = ...,
    beam_direction: str = ...,
    flaser_fov_rad: float | None = ...,
) -> SlamGraph: ...

class PoseGraphInput:
    graph: Final[SlamGraph]
    format: Final[str]
    num_robot_poses: Final[int]
    names: Final[tuple[int, ...]]
    def write(self, path: _Path, poses: ArrayLike) -> None: ...

def read_pose_graph(path: _Path) -> PoseGraphInput: ...
def write_pose_graph(
    path: _Path,
    graph: SlamGraph,
    poses: ArrayLike = ...,
    motion: MotionOptions = ...,
) -> None: ...
def read_trajectory(path: _Path) -> tuple[_Array, _Array]: ...
def write_trajectory(path: _Path, timestamps_s: ArrayLike, poses: ArrayLike) -> None: ...
def read_points_ply(path: _Path) -> _Array: ...
def write_points_ply(path: _Path, graph: SlamGraph, state: MapState) -> None: ...
def write_points_pcd(path: _Path, graph: SlamGraph, state: MapState) -> None: ...

class OccupancyGrid:
    resolution_m: Final[float]
    left_m: Final[float]
    bottom_m: Final[float]
    cells: Final[NDArray[np.uint8]]

def build_occupancy_grid(
    graph: SlamGraph,
    state: MapState,
    resolution_m: float = ...,
) -> OccupancyGrid: ...
def write_map(stem: _Path, grid: OccupancyGrid) -> None: ...

class ErrorStatistics:
    mean: Final[float]
    std: Final[float]
    rmse: Final[float]
    median: Final[float]
    p95: Final[float]
    max: Final[float]

class PoseErrorStatistics:
    num_matched: Final[int]
    num_unmatched: Final[int]
    translation_m: Final[ErrorStatistics]
    rotation_deg: Final[ErrorStatistics]

class Relation(_Options):
    from_s: float
    to_s: float
    from_from_to: Pose2

class RelationsOptions(_Checked):
    tolerance_s: float
    local_span_s: float

class RelationsMetric:
    all: Final[PoseErrorStatistics]
    local: Final[PoseErrorStatistics]
    revisits: Final[PoseErrorStatistics]

class TrajectoryMetricsOptions(_Checked):
    max_time_difference_s: float
    delta_frames: int
    delta_m: float

class TrajectoryMetrics:
    absolute: Final[PoseErrorStatistics]
    relative_frames: Final[PoseErrorStatistics]
    relative_metres: Final[PoseErrorStatistics]

def read_relations(path: _Path) -> list[Relation]: ...
def measure_relations(
    relations: Sequence[Relation],
    timestamps_s: ArrayLike,
    poses: ArrayLike,
    options: RelationsOptions = ...,
) -> RelationsMetric: ...
def measure_trajectory(
    timestamps_s: ArrayLike,
    poses: ArrayLike,
    true_timestamps_s: ArrayLike,
    true_poses: ArrayLike,
    options: TrajectoryMetricsOptions = ...,
) -> TrajectoryMetrics: ...

class MapQualityOptions(_Checked):
    radius_m: float

class MapQuality:
    wall_thickness_m: Final[float]
    mean_map_entropy: Final[float]
    num_samples: Final[int]

def measure_map_quality(points: ArrayLike, options: MapQualityOptions = ...) -> MapQuality: ...
def measure_map_consistency(graph: SlamGraph, poses: ArrayLike) -> MapConsistency: ...
