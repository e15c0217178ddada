#ifndef PLUMBLINE_TEST_APPS_SAVED_MAPS_POSEGRAPH_WRITER_H_
#define PLUMBLINE_TEST_APPS_SAVED_MAPS_POSEGRAPH_WRITER_H_

#include <cstdint>
#include <fstream>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "plumbline/test/apps/saved_maps/karto_writer.h"

namespace plumbline {

/// Writes x.posegraph.
class PosegraphWriter : private KartoWriter {
 public:
  using KartoWriter::KartoWriter;

  std::string Mapper() {
    const std::uint32_t mapper = 0;
    out_.TrackedObject("Mapper");
    out_.Object("Module");
    const std::map<char, Parameter> parameters = {
        {'b', {"karto::Parameter<kt_bool>", "UseScanMatching", 1.0, {}}},
        {'d', {map_.double_parameter, "MinimumTravelDistance", 0.5, {}}},
        {'u', {"karto::Parameter<kt_int32u>", "ScanBufferSize", 10.0, {}}}};
    Object("Mapper", {parameters.at('b'), parameters.at('d'), parameters.at('u')});
    const std::map<char, std::uint32_t> parameter_ids = {
        {'b', parameter_ids_[0]}, {'d', parameter_ids_[1]}, {'u', parameter_ids_[2]}};
    out_.Bool(true);  // initialized
    if (map_.has_scan_matcher) {
      ScanMatcher(mapper);
    } else {
      out_.Register("ScanMatcher");
      out_.Null();
    }
    const std::uint32_t graph = out_.Pointer("MapperGraph");
    Graph();
    out_.Again("Mapper", mapper);
    out_.Null();  // loop_scan_matcher
    out_.PointerToDerived("karto::BreadthFirstTraversal<karto::LocalizedRangeScan>");
    out_.Object("GraphTraversal");
    out_.Again("MapperGraph", graph);
    SensorManager();
    out_.Collection("vector of listeners", 0);
    // Of what types the mapper's own parameters are.
    const std::string types = "bbdddudddbdu" + std::string(16, 'd') + 'b';
    for (const char type : types + (map_.has_newer_parameters ? "ud" : "")) {
      out_.Again(parameters.at(type).type, parameter_ids.at(type));
    }
    return out_.bytes();
  }

 private:
  void Grid(const std::string& value) {
    out_.Int(2);  // width, height, width_step
    out_.Int(1);
    out_.Int(8);
    out_.Pointer("CoordinateConverter");
    out_.Object("Size2");
    out_.Int(2);
    out_.Int(1);
    out_.Double(20.0);
    Vector(0.0, 0.0);
    for (int i = 0; i < 8; ++i) value == "double" ? out_.Double(0.5) : out_.Bool(true);
  }

  void ScanMatcher(std::uint32_t mapper) {
    out_.Pointer("ScanMatcher");
    out_.Again("Mapper", mapper);
    const std::uint32_t grid = out_.Pointer("CorrelationGrid");
    out_.TrackedObject("Grid of bytes");
    Grid("byte");
    out_.Double(0.03);
    out_.Int(3);
    for (int i = 0; i < 9; ++i) out_.Bool(false);  // kernel
    out_.Object("Rectangle2");
    for (const char* part : {"Vector2 of integers", "Size2"}) {
      out_.Object(part);
      out_.Int(1);
      out_.Int(2);
    }
    out_.Pointer("Grid of doubles");
    Grid("double");
    out_.Pointer("GridIndexLookup");
    out_.Again("CorrelationGrid", grid);
    out_.Int(2);
    out_.Int(1);
    out_.Numbers({0.25});
    for (const std::uint32_t capacity : {3, 0}) {
      out_.Pointer("LookupArray");
      out_.Int(capacity);
      out_.Int(capacity);
      for (std::uint32_t i = 0; i < capacity; ++i) out_.Int(i);
    }
    out_.Numbers({0.0, 0.1});
    out_.Numbers({0.0});
    Pose({});
    out_.Double(0.01);
    out_.Int(2);
    out_.Double(0.01);
    out_.Bool(true);
    for (int i = 0; i < 2 * 1 * 2; ++i) {
      out_.Object("pair of responses");
      out_.Double(0.0);
      Pose({});
    }
  }

  // Each edge with its vertices, and each vertex with its edges, as far as they are new.
  void Graph() {
    out_.TrackedObject("Graph");
    edge_ids_.resize(map_.edges.size());
    vertex_ids_.resize(map_.scans.size());
    scan_ids_.resize(map_.scans.size());
    out_.Collection("vector of edges", map_.edges.size());
    for (std::size_t i = 0; i < map_.edges.size(); ++i) Edge(i);
    out_.Collection("map of maps", map_.lasers.size());
    for (const KartoLaser& laser : map_.lasers) {
      out_.Object("pair of maps");
      Name(laser.name);
      const std::vector<std::size_t> scans = ScansOf(laser);
      out_.Collection("map of vertices", scans.size());
      for (const std::size_t scan : scans) {
        out_.Object("pair of vertices");
        out_.Int(static_cast<std::uint32_t>(map_.scans[scan].id));
        Vertex(scan);
      }
    }
  }

  std::vector<std::size_t> ScansOf(const KartoLaser& laser) const {
    std::vector<std::size_t> scans;
    for (std::size_t i = 0; i < map_.scans.size(); ++i) {
      if (map_.scans[i].laser == laser.name) scans.push_back(i);
    }
    return scans;
  }

  void Edge(std::size_t i) {
    out_.Register("Edge");
    if (edge_ids_[i]) return out_.Again("Edge", *edge_ids_[i]);
    edge_ids_[i] = out_.Pointer("Edge");
    Vertex(map_.edges[i].from);
    Vertex(map_.edges[i].to);
    out_.Register("EdgeLabel");
    out_.PointerToDerived("karto::LinkInfo");
    out_.TrackedObject("EdgeLabel");
    Pose({});
    Pose(map_.edges[i].difference);
    Pose(map_.edges[i].difference);
    out_.Object("Matrix3");
    out_.Number<std::uint64_t>(3);
    for (int row = 0; row < 3; ++row) {
      out_.Number<std::uint64_t>(3);
      for (int column = 0; column < 3; ++column) {
        out_.Double(map_.edges[i].covariance[3 * row + column]);
      }
    }
  }

  void Vertex(std::size_t i) {
    out_.Register("Vertex");
    if (vertex_ids_[i]) return out_.Again("Vertex", *vertex_ids_[i]);
    vertex_ids_[i] = out_.Pointer("Vertex");
    scan_ids_[i] = out_.Pointer("karto::LocalizedRangeScan");
    Scan(map_.scans[i]);
    std::vector<std::size_t> edges;
    for (std::size_t edge = 0; edge < map_.edges.size(); ++edge) {
      const int scan = static_cast<int>(i);
      if (map_.edges[edge].from == scan || map_.edges[edge].to == scan) edges.push_back(edge);
    }
    out_.Collection("vector of edges", edges.size());
    for (const std::size_t edge : edges) Edge(edge);
    out_.Double(1.0);
  }

  void SensorManager() {
    out_.Pointer("MapperSensorManager");
    out_.Collection("map of managers", map_.lasers.size());
    for (const KartoLaser& laser : map_.lasers) {
      out_.Object("pair of managers");
      Name(laser.name);
      out_.Pointer("ScanManager");
      MapOfScans(ScansOf(laser));
      out_.Collection("vector of scans", 0);
      out_.Null();  // last_scan
      out_.Int(10);
      out_.Double(10.0);
      out_.Int(0);
    }
    out_.Int(10);
    out_.Double(10.0);
    out_.Int(0);
    std::vector<std::size_t> all;
    for (const KartoLaser& laser : map_.lasers) {
      for (const std::size_t scan : ScansOf(laser)) all.push_back(scan);
    }
    MapOfScans(all);
  }

  void MapOfScans(const std::vector<std::size_t>& scans) {
    out_.Collection("map of scans", scans.size());
    for (const std::size_t scan : scans) {
      out_.Object("pair of scans");
      out_.Int(static_cast<std::uint32_t>(map_.scans[scan].id));
      out_.Again("karto::LocalizedRangeScan", *scan_ids_[scan]);
    }
  }

  std::vector<std::optional<std::uint32_t>> edge_ids_, vertex_ids_, scan_ids_;
};

inline std::string PosegraphBytes(const KartoMap& map) { return PosegraphWriter(map).Mapper(); }
inline std::string DataBytes(const KartoMap& map) { return KartoWriter(map).Dataset(); }

/// stem.posegraph and stem.data.
inline void WriteKartoMap(const std::string& stem, const KartoMap& map) {
  std::ofstream(stem + ".posegraph", std::ios::binary) << PosegraphBytes(map);
  std::ofstream(stem + ".data", std::ios::binary) << DataBytes(map);
}

/// Three scans of four beams, the corners of a triangle, each seen from the one before.
inline KartoMap SmallKartoMap() {
  KartoMap map;
  map.lasers.push_back({"laser", {0.1, -0.2, 0.3}, 4, -1.5, 1.0});
  const std::vector<Pose2> poses = {{0.0, 0.0, 0.0}, {1.0, 0.5, 0.75}, {0.5, 1.5, 2.5}};
  for (int i = 0; i < 3; ++i) {
    const Pose2 odometric = Pose2(3.0, 4.0, 0.5) * poses[i] * Pose2(0.01 * i, 0.0, 0.02 * i);
    map.scans.push_back({i, 100.0 + i, odometric, poses[i], {1.0 + i, 2.0, 25.0, 4.0}});
  }
  for (const auto& [from, to] : {std::pair(0, 1), std::pair(1, 2), std::pair(0, 2)}) {
    map.edges.push_back({from, to, Between(poses[from], poses[to]) * Pose2(0.02, 0.01, -0.01)});
  }
  return map;
}

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_APPS_SAVED_MAPS_POSEGRAPH_WRITER_H_
