#include "plumbline/core/slam_graph.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <utility>

#include "plumbline/core/factor_check.h"
#include "plumbline/core/float_environment.h"
#include "plumbline/core/input_limits.h"
#include "plumbline/core/peers.h"
#include "plumbline/core/pose_frame.h"
#include "plumbline/core/sweep_motion.h"

namespace plumbline {
namespace {

constexpr char kPoseLimits[] = "1e7 m or 1e6 rad";
constexpr int kRefused = -1;  // id of what is not added

// Sets one of some flags, of which there are as many as needed so far.
void Set(std::size_t index, std::vector<bool>* flags) {
  if (index >= flags->size()) flags->resize(index + 1);
  (*flags)[index] = true;
}

std::string EdgeName(const char* kind, std::size_t index, int from, int to) {
  return std::string(kind) + " " + std::to_string(index) + " (" + std::to_string(from) + " -> " +
         std::to_string(to) + ")";
}

// Empty if the graph can have this constraint.
template <typename Constraint>
std::string ProblemOfEdge(const SlamGraph& graph, const Constraint& edge) {
  for (const int id : {edge.from, edge.to}) {
    if (id < 0 || id >= graph.num_poses()) return "no pose with id " + std::to_string(id);
  }
  if (edge.from == edge.to) return "joins a pose with itself";
  if (IsWithinLimits(edge.from_from_to)) return "";
  return "relative pose is not finite, or beyond " + std::string(kPoseLimits);
}

// Empty if a relative pose can have this covariance.
std::string ProblemOfCovariance(const Eigen::Matrix3d& covariance) {
  const double asymmetry = (covariance - covariance.transpose()).cwiseAbs().maxCoeff();
  const bool symmetric = asymmetry <= 1e-9 * covariance.cwiseAbs().maxCoeff();
  // Factored from the last row up, as the residual will do: close to singular, the order decides.
  const bool positive = Eigen::Matrix3d(covariance.reverse()).llt().info() == Eigen::Success;
  if (!covariance.allFinite() || !symmetric || !positive) {
    return "covariance is not symmetric positive definite";
  }
  const Eigen::Vector3d sigmas = covariance.diagonal().cwiseSqrt();
  if (sigmas.minCoeff() >= kMinSigma && sigmas.maxCoeff() <= kMaxSigma) return "";
  return "a standard deviation is not within 1e-9 and 1e9";
}

// Empty if the graph can have this factor.
std::string ProblemOfOwnFactor(const SlamGraph& graph, const CustomFactor& factor) {
  for (const int id : factor.poses) {
    if (id >= 0 && id < graph.num_poses()) continue;
    return "sees pose " + std::to_string(id) + ", but the graph has " +
           std::to_string(graph.num_poses()) + " poses";
  }
  for (const std::size_t id : factor.points) {
    if (id < graph.num_returns()) continue;
    return "sees point " + std::to_string(id) + ", but the graph has " +
           std::to_string(graph.num_returns()) + " returns";
  }
  return ProblemOfFactor(factor);
}

// Whether a factor holds the map in the world, in any direction, by the initial guesses.
bool IsHeldBy(const SlamGraph& graph, const CustomFactor& factor) {
  const SeenByFactor seen = SeenBy(graph, factor);
  const Eigen::Vector2d origin =
      seen.points.empty() ? seen.poses.front().translation() : seen.points.front();
  return !HoldOnWorld(factor, seen, origin).isZero(0.0);
}

// The nearest range that is a return, in single precision too.
float ClampRange(const LaserModel& laser, double range_m) {
  const auto rounded = static_cast<float>(
      std::clamp(range_m, laser.min_range_m, std::nextafter(laser.max_range_m, 0.0)));
  if (rounded < laser.min_range_m) return std::nextafter(rounded, HUGE_VALF);
  return rounded < laser.max_range_m ? rounded : std::nextafter(rounded, 0.0F);
}

// Where the measurements put the returns from id `first` on. points: two numbers per return.
void PlacePoints(const SlamGraph& graph, const std::vector<double>& poses, std::size_t first,
                 std::vector<double>* points) {
  const DefaultFloatEnvironment float_environment;
  for (int s = 0; s < graph.num_scans(); ++s) {
    const ScanEntry& scan = graph.scan(s);
    const std::size_t end_of_scan = scan.first_return + scan.num_returns;
    if (end_of_scan <= first) continue;
    const ScanReturns returns = graph.ReturnsOfScan(s);
    const PoseFrame laser(graph.WorldFromLaser(s, poses));
    for (std::size_t r = std::max(first, scan.first_return); r < end_of_scan; ++r) {
      const Eigen::Vector2d end = laser * returns.PointInLaser(r);
      (*points)[2 * r] = end.x();
      (*points)[2 * r + 1] = end.y();
    }
  }
}

// value_of(scan id, returns of the scan, return id)
template <typename Value, typename ValueOf>
std::vector<Value> OfAllReturns(const SlamGraph& graph, const ValueOf& value_of) {
  std::vector<Value> values(graph.num_returns());
  for (int s = 0; s < graph.num_scans(); ++s) {
    const ScanReturns returns = graph.ReturnsOfScan(s);
    const std::size_t end = graph.scan(s).first_return + graph.scan(s).num_returns;
    for (std::size_t r = graph.scan(s).first_return; r < end; ++r) {
      values[r] = value_of(s, returns, r);
    }
  }
  return values;
}

}  // namespace

struct SlamGraph::Return {
  double range_m, bearing_rad;
  int beam;
};

int SlamGraph::Refuse(const std::string& name, const std::string& problem) {
  status_ = Status::InvalidArgument(name + ": " + problem);
  return kRefused;
}

Status SlamGraph::TakeStatus() { return std::exchange(status_, Status::Ok()); }

int SlamGraph::AddLaser(const LaserModel& laser) {
  if (!status_.ok()) return kRefused;
  std::string error;
  if (!laser.Check(&error)) return Refuse("laser " + std::to_string(num_lasers()), error);
  const auto known = laser_ids_.find(laser);
  if (known != laser_ids_.end()) return known->second;
  LaserBeams added(laser);
  std::map<LaserModel, int> added_id = {{laser, num_lasers()}};
  lasers_.push_back(std::move(added));
  laser_ids_.merge(added_id);  // needs no memory: both or none
  return num_lasers() - 1;
}

int SlamGraph::AddPose(const Pose2& initial_world_from_robot, double timestamp_s) {
  if (!status_.ok()) return kRefused;
  if (!IsWithinLimits(initial_world_from_robot) || !(std::abs(timestamp_s) <= kMaxTimeS)) {
    return Refuse(
        "pose " + std::to_string(num_poses()),
        "coordinates or time are not finite, or beyond " + std::string(kPoseLimits) + " or 1e12 s");
  }
  if (num_poses() == 0) gauge_ = {{0, initial_world_from_robot}};
  timestamps_s_.push_back(timestamp_s);
  initial_poses_.insert(
      initial_poses_.end(),
      {initial_world_from_robot.x, initial_world_from_robot.y, initial_world_from_robot.yaw});
  return num_poses() - 1;
}

void SlamGraph::FixPose(int pose_id, const Pose2& world_from_robot) {
  if (!status_.ok()) return;
  const std::string name = "fixed pose " + std::to_string(pose_id);
  if (!HasPose(pose_id)) {
    Refuse(name, "no pose with id " + std::to_string(pose_id));
    return;
  }
  if (!IsWithinLimits(world_from_robot)) {
    Refuse(name, "coordinates are not finite, or beyond " + std::string(kPoseLimits));
    return;
  }
  const auto known = index_of_fixed_pose_.find(pose_id);
  if (known != index_of_fixed_pose_.end()) {
    fixed_poses_[known->second].world_from_robot = world_from_robot;
    return;
  }
  std::map<int, std::size_t> added_index = {{pose_id, fixed_poses_.size()}};
  fixed_poses_.push_back({pose_id, world_from_robot});
  index_of_fixed_pose_.merge(added_index);  // needs no memory: both or none
}

void SlamGraph::FixPose(int pose_id) {
  FixPose(pose_id, HasPose(pose_id) ? InitialPose(pose_id) : Pose2());
}

int SlamGraph::RefuseScan(const std::string& problem) {
  return Refuse("scan " + std::to_string(num_scans()), problem);
}

bool SlamGraph::TakesScan(int pose_id, int laser_id) {
  if (!status_.ok()) return false;
  if (!HasPose(pose_id)) {
    RefuseScan("no pose with id " + std::to_string(pose_id));
  } else if (laser_id < 0 || laser_id >= num_lasers()) {
    RefuseScan("no laser with id " + std::to_string(laser_id));
  }
  return status_.ok();
}

void SlamGraph::ReserveReturns(std::size_t num_returns) {
  returns_.range_m.reserve(num_returns);
  low_beam_.reserve(num_returns);
}

int SlamGraph::AppendScan(int pose_id, int laser_id, const std::vector<Return>& returns) {
  const LaserModel& laser = lasers_[laser_id].model;
  const bool has_own_bearings = std::any_of(returns.begin(), returns.end(), [&](const Return& r) {
    return r.bearing_rad != laser.Bearing(r.beam);
  });
  const std::size_t first_return = returns_.size();
  const auto first_large =
      std::partition_point(returns.begin(), returns.end(),
                           [](const Return& r) { return r.beam < ScanReturns::kSmallBeams; });
  const auto num_small = static_cast<std::size_t>(first_large - returns.begin());
  scan_index_.push_back({off_beam_rad_.size(), first_return + num_small});
  for (const Return& r : returns) {
    if (returns_.size() % kReturnsPerBlock == 0) scan_of_block_.push_back(num_scans());
    returns_.range_m.push_back(ClampRange(laser, r.range_m));
    low_beam_.push_back(static_cast<std::uint16_t>(r.beam % ScanReturns::kSmallBeams));
    if (!has_own_bearings) continue;
    off_beam_rad_.push_back(static_cast<float>(r.bearing_rad - laser.Bearing(r.beam)));
  }
  scans_.push_back({pose_id, laser_id, first_return, returns.size(), has_own_bearings});
  return num_scans() - 1;
}

bool SlamGraph::TakesRanges(int laser_id, const std::vector<double>& ranges) {
  const int num_beams = lasers_[laser_id].model.num_beams;
  if (static_cast<int>(ranges.size()) == num_beams) return true;
  RefuseScan(std::to_string(ranges.size()) + " ranges for a laser of " + std::to_string(num_beams) +
             " beams");
  return false;
}

std::vector<SlamGraph::Return> SlamGraph::ReturnsOf(int laser_id,
                                                    const std::vector<double>& ranges) const {
  const LaserModel& laser = lasers_[laser_id].model;
  std::vector<Return> returns;
  for (int beam = 0; beam < laser.num_beams; ++beam) {
    if (laser.IsReturn(ranges[beam])) returns.push_back({ranges[beam], laser.Bearing(beam), beam});
  }
  return returns;
}

int SlamGraph::AddScan(int pose_id, int laser_id, const std::vector<double>& ranges) {
  const DefaultFloatEnvironment float_environment;
  if (!TakesScan(pose_id, laser_id) || !TakesRanges(laser_id, ranges)) return kRefused;
  return AppendScan(pose_id, laser_id, ReturnsOf(laser_id, ranges));
}

int SlamGraph::AddSweep(int pose_id, int laser_id, const std::vector<double>& ranges,
                        const Pose2& motion, SweepOrder order) {
  const DefaultFloatEnvironment float_environment;
  if (!TakesScan(pose_id, laser_id)) return kRefused;
  const LaserModel& laser = lasers_[laser_id].model;
  if (laser.beam_period_s != 0.0) {
    return RefuseScan(
        "the laser has a beam_period_s, so that the motion within its sweeps is still to be taken "
        "out");
  }
  if (!IsWithinLimits(motion)) {
    return RefuseScan("its motion is not finite, or beyond " + std::string(kPoseLimits));
  }
  if (!TakesRanges(laser_id, ranges)) return kRefused;
  std::vector<Return> returns = ReturnsOf(laser_id, ranges);
  const Pose2 laser_from_robot = laser.robot_from_laser.Inverse();
  for (Return& r : returns) {
    if (order == SweepOrder::kAtOnce) break;
    const int before = order == SweepOrder::kFirstBeamFirst ? r.beam : laser.num_beams - 1 - r.beam;
    const double share = static_cast<double>(before) / laser.num_beams;
    const BeamReturn seen =
        SeenFromBefore({r.range_m, r.bearing_rad},
                       laser_from_robot * PartOfMotion(motion, share) * laser.robot_from_laser);
    r.range_m = seen.range_m;
    r.bearing_rad = seen.bearing_rad;
  }
  return AppendScan(pose_id, laser_id, returns);
}

int SlamGraph::AddPoints(int pose_id, int laser_id,
                         const std::vector<Eigen::Vector2d>& points_in_robot) {
  const DefaultFloatEnvironment float_environment;
  if (!TakesScan(pose_id, laser_id)) return kRefused;
  const LaserModel& laser = lasers_[laser_id].model;
  const Pose2 laser_from_robot = laser.robot_from_laser.Inverse();
  const double middle_beam = 0.5 * (laser.num_beams - 1);
  const double middle_rad = laser.first_bearing_rad + middle_beam * laser.bearing_step_rad;
  std::vector<Return> returns;
  for (std::size_t i = 0; i < points_in_robot.size(); ++i) {
    const Eigen::Vector2d point = laser_from_robot * points_in_robot[i];
    if (!laser.IsReturn(point.norm())) continue;
    const double from_middle_rad = NormalizeAngle(std::atan2(point.y(), point.x()) - middle_rad);
    const double beam =
        laser.num_beams > 1 ? middle_beam + from_middle_rad / laser.bearing_step_rad : 0.0;
    if (beam < -1.0 || beam > laser.num_beams) {
      return RefuseScan("point " + std::to_string(i) + " lies outside of the laser's beams");
    }
    const int nearest = std::clamp(static_cast<int>(std::lround(beam)), 0, laser.num_beams - 1);
    returns.push_back({point.norm(), middle_rad + from_middle_rad, nearest});
  }
  const double direction = laser.bearing_step_rad < 0.0 ? -1.0 : 1.0;
  std::stable_sort(returns.begin(), returns.end(), [&](const Return& a, const Return& b) {
    return direction * a.bearing_rad < direction * b.bearing_rad;
  });
  return AppendScan(pose_id, laser_id, returns);
}

int SlamGraph::AddScanOf(const SlamGraph& other, int scan_id, int pose_id) {
  if (!status_.ok()) return kRefused;
  if (scan_id < 0 || scan_id >= other.num_scans()) {
    return RefuseScan("the other graph has no scan with id " + std::to_string(scan_id));
  }
  if (!HasPose(pose_id)) return RefuseScan("no pose with id " + std::to_string(pose_id));
  const int laser_id = AddLaser(other.LaserOfScan(scan_id));
  std::vector<char> bytes;
  other.PackScan(scan_id, &bytes);
  AddPackedScan(bytes.data());
  scans_.back().pose = pose_id;
  scans_.back().laser = laser_id;
  return num_scans() - 1;
}

void SlamGraph::AddOdometry(const OdometryConstraint& c) {
  if (!status_.ok()) return;
  const std::string problem = ProblemOfEdge(*this, c);
  if (problem.empty()) {
    odometry_.push_back(c);
  } else {
    Refuse(EdgeName("odometry", odometry_.size(), c.from, c.to), problem);
  }
}

void SlamGraph::AddRelativePose(const RelativePoseConstraint& c) {
  if (!status_.ok()) return;
  std::string problem = ProblemOfEdge(*this, c);
  if (problem.empty()) problem = ProblemOfCovariance(c.covariance);
  if (problem.empty()) {
    relative_poses_.push_back(c);
  } else {
    Refuse(EdgeName("relative pose", relative_poses_.size(), c.from, c.to), problem);
  }
}

void SlamGraph::AddFactor(const std::string& name, std::shared_ptr<const ceres::CostFunction> cost,
                          std::vector<int> poses, std::vector<std::size_t> points,
                          std::shared_ptr<ceres::LossFunction> loss) {
  if (!status_.ok()) return;
  CustomFactor factor{name, std::move(cost), std::move(poses), std::move(points), std::move(loss)};
  std::string problem = ProblemOfOwnFactor(*this, factor);
  if (problem.empty()) {
    const int num_residuals = NumResiduals(factor);
    const int known = residuals_of_factor_.emplace(name, num_residuals).first->second;
    if (known != num_residuals) {
      problem = "has " + std::to_string(num_residuals) + " residuals, but the first of its name " +
                std::to_string(known);
    }
  }
  if (!problem.empty()) {
    Refuse("factor " + std::to_string(factors_.size()) + " (\"" + name + "\")", problem);
    return;
  }
  if (!gauge_.empty() && IsHeldBy(*this, factor)) gauge_.clear();
  factors_.push_back(std::move(factor));
}

void SlamGraph::ShareWith(const Peers* peers, std::vector<int> rank_of_pose,
                          std::vector<ScanEntry> all_scans) {
  peers_ = peers;
  rank_of_pose_ = std::move(rank_of_pose);
  all_scans_ = std::move(all_scans);
  id_among_all_.clear();
  for (std::size_t scan = 0; scan < all_scans_.size(); ++scan) {
    if (HasScansOf(all_scans_[scan].pose)) id_among_all_.push_back(static_cast<int>(scan));
  }
}

std::size_t SlamGraph::num_returns_of_all() const {
  const std::vector<ScanEntry>& scans = all_scans();
  return scans.empty() ? 0 : scans.back().first_return + scans.back().num_returns;
}

std::size_t SlamGraph::ReturnIdAmongAll(std::size_t return_id) const {
  const int scan = ScanOfReturn(return_id);
  return all_scans()[IdAmongAll(scan)].first_return + (return_id - scans_[scan].first_return);
}

int SlamGraph::ScanOfReturn(std::size_t return_id) const {
  const std::size_t block = return_id / kReturnsPerBlock;
  const auto first = scans_.begin() + scan_of_block_[block];
  const auto last = block + 1 < scan_of_block_.size()
                        ? scans_.begin() + scan_of_block_[block + 1] + 1
                        : scans_.end();
  const auto after = std::upper_bound(
      first, last, return_id,
      [](std::size_t id, const ScanEntry& scan) { return id < scan.first_return; });
  return static_cast<int>(after - scans_.begin()) - 1;
}

void SlamGraph::PackScan(int scan_id, std::vector<char>* bytes) const {
  const ScanEntry& scan = scans_[scan_id];
  const auto append = [bytes](const auto* values, std::size_t count) {
    const char* begin = reinterpret_cast<const char*>(values);
    bytes->insert(bytes->end(), begin, begin + count * sizeof(*values));
  };
  append(&scan, 1);
  append(returns_.range_m.data() + scan.first_return, scan.num_returns);
  append(low_beam_.data() + scan.first_return, scan.num_returns);
  const ScanIndex& index = scan_index_[scan_id];
  const std::size_t num_small = index.first_large_beam - scan.first_return;
  append(&num_small, 1);
  if (scan.has_own_bearings) {
    append(off_beam_rad_.data() + index.first_own_bearing, scan.num_returns);
  }
  std::vector<std::size_t> moving;  // counted from the scan's first return
  for (std::size_t i = 0; i < scan.num_returns; ++i) {
    if (Moves(scan.first_return + i)) moving.push_back(i);
  }
  const std::size_t num_moving = moving.size();
  append(&num_moving, 1);
  append(moving.data(), num_moving);
}

const char* SlamGraph::AddPackedScan(const char* bytes) {
  const auto take = [&bytes](auto* values, std::size_t count) {
    if (count == 0) return;  // values may be null
    std::memcpy(values, bytes, count * sizeof(*values));
    bytes += count * sizeof(*values);
  };
  const auto extend = [&take](auto* values, std::size_t count) {
    values->resize(values->size() + count);
    take(values->data() + values->size() - count, count);
  };
  ScanEntry scan;
  take(&scan, 1);
  scan.first_return = num_returns();
  extend(&returns_.range_m, scan.num_returns);
  extend(&low_beam_, scan.num_returns);
  std::size_t num_small = 0;
  take(&num_small, 1);
  scan_index_.push_back({off_beam_rad_.size(), scan.first_return + num_small});
  while (scan_of_block_.size() * kReturnsPerBlock < num_returns()) {
    scan_of_block_.push_back(num_scans());
  }
  if (scan.has_own_bearings) extend(&off_beam_rad_, scan.num_returns);
  std::size_t num_moving = 0;
  take(&num_moving, 1);
  std::vector<std::size_t> moving;
  extend(&moving, num_moving);
  for (const std::size_t i : moving) Set(scan.first_return + i, &moves_);
  scans_.push_back(scan);
  return bytes;
}

bool SlamGraph::HasScansOf(int pose_id) const {
  return peers_ == nullptr || rank_of_pose_[pose_id] == peers_->rank();
}

std::vector<double> SlamGraph::RangesOfScan(int scan_id, double no_return_m) const {
  const ScanEntry& scan = scans_[scan_id];
  const ScanReturns returns = ReturnsOfScan(scan_id);
  std::vector<double> ranges_m(LaserOfScan(scan_id).num_beams, no_return_m);
  for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
    ranges_m[returns.Beam(r)] = returns_.range_m[r];
  }
  return ranges_m;
}

MapState SlamGraph::InitialState() const {
  MapState state;
  ExtendState(&state);
  return state;
}

void SlamGraph::ExtendState(MapState* state) const {
  state->poses.insert(state->poses.end(), initial_poses_.begin() + state->poses.size(),
                      initial_poses_.end());
  const std::size_t first = state->points.size() / 2;
  state->points.resize(2 * num_returns());
  PlacePoints(*this, state->poses, first, &state->points);
}

std::vector<double> SlamGraph::MeasuredMap(const std::vector<double>& poses) const {
  std::vector<double> points(2 * num_returns());
  PlacePoints(*this, poses, 0, &points);
  return points;
}

std::vector<int> SlamGraph::ScansOfReturns() const {
  return OfAllReturns<int>(*this, [](int scan, const ScanReturns&, std::size_t) { return scan; });
}

std::vector<int> SlamGraph::Beams() const {
  return OfAllReturns<int>(
      *this, [](int, const ScanReturns& returns, std::size_t r) { return returns.Beam(r); });
}

std::vector<double> SlamGraph::Bearings() const {
  return OfAllReturns<double>(
      *this, [](int, const ScanReturns& returns, std::size_t r) { return returns.Bearing(r); });
}

void SlamGraph::Correct(const MeasurementCorrections& corrections) {
  for (std::size_t i = 0; i < corrections.odometry.size(); ++i) {
    odometry_[i].from_from_to = corrections.odometry[i];
  }
  for (std::size_t i = 0; i < corrections.robot_from_laser.size(); ++i) {
    LaserModel model = lasers_[i].model;
    model.robot_from_laser = corrections.robot_from_laser[i];
    lasers_[i] = LaserBeams(model);
  }
  if (!corrections.robot_from_laser.empty()) {
    laser_ids_.clear();
    for (int id = 0; id < num_lasers(); ++id) laser_ids_.emplace(laser(id), id);
  }
  const std::vector<std::size_t>& moving = corrections.moving_returns;
  for (int s = 0; s < num_scans() && !moving.empty(); ++s) {
    const std::size_t first = all_scans()[IdAmongAll(s)].first_return;
    auto id = std::lower_bound(moving.begin(), moving.end(), first);
    for (; id != moving.end() && *id < first + scans_[s].num_returns; ++id) {
      Set(scans_[s].first_return + (*id - first), &moves_);
    }
  }
  if (!corrections.range_m.empty()) SetRanges(corrections.range_m);
  if (!corrections.bearing_rad.empty()) SetBearings(corrections.bearing_rad);
}

void SlamGraph::SetRanges(const std::vector<double>& ranges_m) {
  for (const ScanEntry& scan : scans_) {
    const LaserModel& model = laser(scan.laser);
    for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
      returns_.range_m[r] = ClampRange(model, ranges_m[r]);
    }
  }
}

void SlamGraph::SetBearings(const std::vector<double>& bearings_rad) {
  std::vector<float> off_beam_rad;
  for (int s = 0; s < num_scans(); ++s) {
    ScanEntry& scan = scans_[s];
    const LaserModel& model = laser(scan.laser);
    const ScanReturns returns = ReturnsOfScan(s);
    const std::size_t first_own = off_beam_rad.size();
    bool has_own_bearings = false;
    for (std::size_t r = scan.first_return; r < scan.first_return + scan.num_returns; ++r) {
      const double off_rad = bearings_rad[r] - model.Bearing(returns.Beam(r));
      off_beam_rad.push_back(static_cast<float>(off_rad));
      has_own_bearings = has_own_bearings || off_rad != 0.0;
    }
    if (!has_own_bearings) off_beam_rad.resize(first_own);
    scan.has_own_bearings = has_own_bearings;
    scan_index_[s].first_own_bearing = first_own;
  }
  off_beam_rad_ = std::move(off_beam_rad);
}

SlamGraph SlamGraph::Corrected(const MeasurementCorrections& corrections) const& {
  SlamGraph corrected = *this;
  corrected.Correct(corrections);
  return corrected;
}

SlamGraph SlamGraph::Corrected(const MeasurementCorrections& corrections) && {
  Correct(corrections);
  return std::move(*this);
}

}  // namespace plumbline
