#include "plumbline/apps/saved_maps/karto_classes.h"

#include <string>
#include <utility>
#include <vector>

namespace plumbline {
namespace {

using Classes = std::vector<ArchiveClass>;
using Form = ArchiveClass::Form;

void AddVector(const std::string& element, Classes* classes) {
  classes->push_back({"vector<" + element + ">", {{element, "element"}}, Form::kCollection});
}

void AddMap(const std::string& key, const std::string& value, Classes* classes) {
  const std::string both = '<' + key + ", " + value + '>';
  classes->push_back({"pair" + both, {{key, "first"}, {value, "second"}}});
  classes->push_back({"map" + both, {{"pair" + both, "element"}}, Form::kCollection});
}

void AddAbstract(const std::string& name, std::vector<ArchiveMember> members, Classes* classes) {
  classes->push_back({name, std::move(members)});
  classes->back().is_abstract = true;
}

void AddGeometry(Classes* classes) {
  classes->push_back({"Vector2<int32>", {{"int32", "x"}, {"int32", "y"}}});
  classes->push_back({"Vector2<double>", {{"double", "x"}, {"double", "y"}}});
  classes->push_back({"Size2<int32>", {{"int32", "width"}, {"int32", "height"}}});
  classes->push_back(
      {"Rectangle2<int32>", {{"Vector2<int32>", "position"}, {"Size2<int32>", "size"}}});
  classes->push_back({"Pose2", {{"Vector2<double>", "position"}, {"double", "heading"}}});
  classes->push_back(
      {"BoundingBox2", {{"Vector2<double>", "minimum"}, {"Vector2<double>", "maximum"}}});
  // Arrays within an array, each with its size before it.
  classes->push_back({"Matrix3",
                      {{"uint64", "num_rows"},
                       {"uint64", "num_columns_0"},
                       {"double", "row_0", {"num_columns_0"}},
                       {"uint64", "num_columns_1"},
                       {"double", "row_1", {"num_columns_1"}},
                       {"uint64", "num_columns_2"},
                       {"double", "row_2", {"num_columns_2"}}}});
  classes->push_back({"vector<double>", {{"double", "element"}}, Form::kNumbers});
  // Ends of beams, which pose and ranges give again.
  AddVector("Vector2<double>", classes);
  classes->back().is_kept = false;
}

void AddParameter(const std::string& name, const std::string& value, Classes* classes) {
  classes->push_back(
      {"karto::Parameter<" + name + '>', {{"karto::AbstractParameter", "base"}, {value, "value"}}});
}

void AddParameters(Classes* classes) {
  AddAbstract("karto::AbstractParameter", {{"string", "name"}, {"string", "description"}}, classes);
  AddParameter("kt_bool", "bool", classes);
  AddParameter("kt_double", "double", classes);
  AddParameter("kt_int32u", "uint32", classes);
  AddParameter("kt_int32s", "int32", classes);
  AddParameter("std::string", "string", classes);
  AddParameter("karto::Pose2", "Pose2", classes);
  AddMap("string", "int32", classes);
  classes->push_back({"karto::ParameterEnum",
                      {{"karto::Parameter<kt_int32s>", "base"}, {"map<string, int32>", "names"}}});
  AddVector("karto::AbstractParameter*", classes);
  AddMap("string", "karto::AbstractParameter*", classes);
}

void AddObjects(Classes* classes) {
  classes->push_back({"karto::NonCopyable"});
  classes->push_back({"karto::ParameterManager",
                      {{"karto::NonCopyable", "base"},
                       {"vector<karto::AbstractParameter*>", "parameters"},
                       {"map<string, karto::AbstractParameter*>", "lookup"}}});
  classes->push_back({"karto::Name", {{"string", "name"}, {"string", "scope"}}});
  AddAbstract("karto::Object",
              {{"karto::NonCopyable", "base"},
               {"karto::ParameterManager*", "parameters"},
               {"karto::Name", "name"}},
              classes);
  AddAbstract("karto::Module", {{"karto::Object", "base"}}, classes);
  AddAbstract("karto::CustomData", {{"karto::Object", "base"}}, classes);
}

void AddSensors(Classes* classes) {
  AddAbstract("karto::Sensor",
              {{"karto::Object", "base"}, {"karto::Parameter<karto::Pose2>*", "offset_pose"}},
              classes);
  classes->push_back({"karto::LaserRangeFinder",
                      {{"karto::Sensor", "base"},
                       {"karto::Parameter<kt_double>*", "minimum_angle"},
                       {"karto::Parameter<kt_double>*", "maximum_angle"},
                       {"karto::Parameter<kt_double>*", "angular_resolution"},
                       {"karto::Parameter<kt_double>*", "minimum_range"},
                       {"karto::Parameter<kt_double>*", "maximum_range"},
                       {"karto::Parameter<kt_double>*", "range_threshold"},
                       {"karto::Parameter<kt_bool>*", "is_360_laser"},
                       {"karto::ParameterEnum*", "type"},
                       {"uint32", "number_of_range_readings"}}});
}

void AddScans(Classes* classes) {
  AddVector("karto::CustomData*", classes);
  classes->push_back({"karto::SensorData",
                      {{"int32", "state_id"},
                       {"int32", "unique_id"},
                       {"karto::Name", "sensor_name"},
                       {"double", "time"},
                       {"vector<karto::CustomData*>", "custom_data"},
                       {"karto::Object", "base"}}});
  classes->push_back({"karto::LaserRangeScan",
                      {{"uint32", "number_of_range_readings"},
                       {"karto::SensorData", "base"},
                       {"double", "range_readings", {"number_of_range_readings"}}}});
  classes->push_back({"karto::LocalizedRangeScan",
                      {{"Pose2", "odometric_pose"},
                       {"Pose2", "corrected_pose"},
                       {"Pose2", "barycenter_pose"},
                       {"vector<Vector2<double>>", "point_readings"},
                       {"vector<Vector2<double>>", "unfiltered_point_readings"},
                       {"BoundingBox2", "bounding_box"},
                       {"bool", "is_dirty"},
                       {"karto::LaserRangeScan", "base"}}});
}

void AddDataset(Classes* classes) {
  classes->push_back({"karto::DatasetInfo",
                      {{"karto::Object", "base"},
                       {"karto::Parameter<std::string>", "title"},
                       {"karto::Parameter<std::string>", "author"},
                       {"karto::Parameter<std::string>", "description"},
                       {"karto::Parameter<std::string>", "copyright"}}});
  AddMap("karto::Name", "karto::Sensor*", classes);
  AddMap("int32", "karto::Object*", classes);
  AddVector("karto::Object*", classes);
  classes->push_back({"karto::Dataset",
                      {{"map<karto::Name, karto::Sensor*>", "sensor_name_lookup"},
                       {"map<int32, karto::Object*>", "data"},
                       {"vector<karto::Object*>", "lasers"},
                       {"karto::DatasetInfo*", "dataset_info"}}});
}

void AddGrid(const std::string& name, const std::string& value, Classes* classes) {
  classes->push_back({name,
                      {{"int32", "width"},
                       {"int32", "height"},
                       {"int32", "width_step"},
                       {"karto::CoordinateConverter*", "coordinate_converter"},
                       {value, "data", {"width_step", "height"}}}});
}

void AddScanMatcher(Classes* classes) {
  classes->push_back(
      {"karto::CoordinateConverter",
       {{"Size2<int32>", "size"}, {"double", "scale"}, {"Vector2<double>", "offset"}}});
  AddGrid("karto::Grid<kt_int8u>", "uint8", classes);
  AddGrid("karto::Grid<kt_double>", "double", classes);
  classes->push_back({"karto::CorrelationGrid",
                      {{"karto::Grid<kt_int8u>", "base"},
                       {"double", "smear_deviation"},
                       {"int32", "kernel_size"},
                       {"uint8", "kernel", {"kernel_size", "kernel_size"}},
                       {"Rectangle2<int32>", "region_of_interest"}}});
  classes->push_back(
      {"karto::LookupArray",
       {{"uint32", "capacity"}, {"uint32", "size"}, {"int32", "array", {"capacity"}}}});
  classes->push_back({"karto::GridIndexLookup<kt_int8u>",
                      {{"karto::Grid<kt_int8u>*", "grid"},
                       {"uint32", "capacity"},
                       {"uint32", "size"},
                       {"vector<double>", "angles"},
                       {"karto::LookupArray*", "lookup_array", {"capacity"}}}});
  classes->push_back({"pair<double, Pose2>", {{"double", "first"}, {"Pose2", "second"}}});
  classes->back().is_kept = false;
  classes->push_back(
      {"karto::ScanMatcher",
       {{"karto::Mapper*", "mapper"},
        {"karto::CorrelationGrid*", "correlation_grid"},
        {"karto::Grid<kt_double>*", "search_space_probabilities"},
        {"karto::GridIndexLookup<kt_int8u>*", "grid_lookup"},
        {"vector<double>", "x_poses"},
        {"vector<double>", "y_poses"},
        {"Pose2", "search_center"},
        {"double", "search_angle_resolution"},
        {"uint32", "number_of_angles"},
        {"double", "search_angle_resolution_again"},
        {"bool", "do_penalize"},
        {"pair<double, Pose2>", "pose_response", {"x_poses", "y_poses", "number_of_angles"}}}});
}

void AddGraph(Classes* classes) {
  classes->push_back({"karto::EdgeLabel"});
  classes->push_back({"karto::LinkInfo",
                      {{"karto::EdgeLabel", "base"},
                       {"Pose2", "pose_1"},
                       {"Pose2", "pose_2"},
                       {"Pose2", "pose_difference"},
                       {"Matrix3", "covariance"}}});
  classes->push_back({"karto::Edge",
                      {{"karto::Vertex*", "source"},
                       {"karto::Vertex*", "target"},
                       {"karto::EdgeLabel*", "label"}}});
  AddVector("karto::Edge*", classes);
  classes->push_back({"karto::Vertex",
                      {{"karto::LocalizedRangeScan*", "object"},
                       {"vector<karto::Edge*>", "edges"},
                       {"double", "score"}}});
  AddMap("int32", "karto::Vertex*", classes);
  AddMap("karto::Name", "map<int32, karto::Vertex*>", classes);
  classes->push_back({"karto::Graph",
                      {{"vector<karto::Edge*>", "edges"},
                       {"map<karto::Name, map<int32, karto::Vertex*>>", "vertices"}}});
  AddAbstract("karto::GraphTraversal", {{"karto::Graph*", "graph"}}, classes);
  classes->push_back({"karto::BreadthFirstTraversal<karto::LocalizedRangeScan>",
                      {{"karto::GraphTraversal", "base"}}});
  classes->push_back({"karto::MapperGraph",
                      {{"karto::Graph", "base"},
                       {"karto::Mapper*", "mapper"},
                       {"karto::ScanMatcher*", "loop_scan_matcher"},
                       {"karto::GraphTraversal*", "traversal"}}});
}

void AddScanManagers(Classes* classes) {
  AddMap("int32", "karto::LocalizedRangeScan*", classes);
  AddVector("karto::LocalizedRangeScan*", classes);
  classes->push_back({"karto::ScanManager",
                      {{"map<int32, karto::LocalizedRangeScan*>", "scans"},
                       {"vector<karto::LocalizedRangeScan*>", "running_scans"},
                       {"karto::LocalizedRangeScan*", "last_scan"},
                       {"uint32", "running_buffer_maximum_size"},
                       {"double", "running_buffer_maximum_distance"},
                       {"uint32", "next_state_id"}}});
  AddMap("karto::Name", "karto::ScanManager*", classes);
  classes->push_back({"karto::MapperSensorManager",
                      {{"map<karto::Name, karto::ScanManager*>", "scan_managers"},
                       {"uint32", "running_buffer_maximum_size"},
                       {"double", "running_buffer_maximum_distance"},
                       {"int32", "next_scan_id"},
                       {"map<int32, karto::LocalizedRangeScan*>", "scans"}}});
}

void AddMapper(Classes* classes) {
  // Of the parameters that the mapper's base has, pointers to these; newer versions have more.
  constexpr int kFewestParameters = 29;
  classes->push_back({"karto::MapperListener"});
  AddVector("karto::MapperListener*", classes);
  ArchiveClass mapper = {"karto::Mapper",
                         {{"karto::Module", "base"},
                          {"bool", "initialized"},
                          {"karto::ScanMatcher*", "sequential_scan_matcher"},
                          {"karto::MapperGraph*", "graph"},
                          {"karto::MapperSensorManager*", "sensor_manager"},
                          {"vector<karto::MapperListener*>", "listeners"}}};
  for (int i = 0; i < kFewestParameters; ++i) {
    mapper.members.push_back({"karto::AbstractParameter*", "parameter_" + std::to_string(i)});
  }
  mapper.members.push_back({"karto::AbstractParameter*", "more_parameters", {kToTheEnd}});
  classes->push_back(mapper);
}

}  // namespace

const ArchiveSchema& KartoClasses() {
  static const ArchiveSchema schema = [] {
    Classes classes;
    AddGeometry(&classes);
    AddParameters(&classes);
    AddObjects(&classes);
    AddSensors(&classes);
    AddScans(&classes);
    AddDataset(&classes);
    AddScanMatcher(&classes);
    AddGraph(&classes);
    AddScanManagers(&classes);
    AddMapper(&classes);
    return ArchiveSchema(std::move(classes));
  }();
  return schema;
}

}  // namespace plumbline
