#include "plumbline/apps/io/foreign_format.h"

#include <algorithm>
#include <filesystem>

#include "plumbline/apps/io/text_reader.h"

namespace plumbline {
namespace {

using namespace std::string_view_literals;

constexpr std::size_t kStartBytes = 512;

constexpr char kUnpack[] = "unpack it and give the log that is in it";
constexpr char kRecordScans[] =
    "it does not say from where its points were seen; give the bag or log of the scans";
constexpr char kGiveLog[] = "give the log or the bag that the map was made of";
constexpr char kGiveBag[] = "give the bag that the messages come from";
constexpr char kWriteCarmen[] =
    "write each of its scans as a line of a CARMEN log: FLASER n r1 ... rn x y theta x y theta "
    "time host time [m, rad, s], with the poses of the laser and of the robot by odometry";
constexpr char kExportRawlog[] =
    "'rawlog-edit --export-2d-scans-txt -i FILE' and 'rawlog-edit --export-odometry-txt -i FILE' "
    "of "
    "MRPT write its scans and its odometry as text, of which each scan makes a line of a CARMEN "
    "log: FLASER n r1 ... rn x y theta x y theta time host time [m, rad, s], with the poses of the "
    "laser and of the robot";

}  // namespace

const std::vector<ForeignFormat>& ForeignFormats() {
  static const std::vector<ForeignFormat> formats = {
      // Wrapped.
      {"a ZIP archive", {"PK\x03\x04"sv}, {".zip"}, kUnpack},
      {"a 7z archive", {"7z\xBC\xAF\x27\x1C"sv}, {".7z"}, kUnpack},
      {"a RAR archive", {"Rar!\x1A\x07"sv}, {".rar"}, kUnpack},
      {"a tar archive", {"ustar"sv}, {".tar", ".tgz"}, kUnpack, 257},
      {"a file compressed by bzip2", {"BZh"sv}, {".bz2"}, "expand it with bunzip2"},
      {"a file compressed by xz", {"\xFD\x37zXZ\0"sv}, {".xz"}, "expand it with unxz"},
      {"a file compressed by lz4", {"\x04\x22\x4D\x18"sv}, {".lz4"}, "expand it with lz4 -d"},
      // Without gzip they do not come here.
      {"a bag compressed by gzip",
       {"#ROSBAG V"sv, "SQLite format 3\0"sv, "\x89MCAP"sv},
       {},
       "expand it with gunzip"},
      {"a bag of ROS",
       {},
       {".bag", ".db3", ".mcap"},
       "it does not begin as a bag does; it may be damaged or incomplete"},
      // Not what was meant.
      {"a pointer of Git LFS",
       {"version https://git-lfs"sv},
       {},
       "git lfs pull fetches the file itself"},
      {"a page of HTML or XML",
       {"<"sv},
       {".html", ".xml"},
       "if it comes from a download, that has failed; fetch the file itself"},
      {"text in UTF-16",
       {"\xFF\xFE"sv, "\xFE\xFF"sv},
       {},
       "iconv -f UTF-16 -t UTF-8 makes text that is read"},
      // Recordings.
      {"a capture of network packets (pcap)",
       {"\xD4\xC3\xB2\xA1"sv, "\xA1\xB2\xC3\xD4"sv, "\x4D\x3C\xB2\xA1"sv, "\xA1\xB2\x3C\x4D"sv,
        "\x0A\x0D\x0D\x0A"sv},
       {".pcap", ".pcapng"},
       "play it into the ROS driver of the laser, and record scans and odometry in a bag"},
      {"a map of MRPT (simplemap)",
       {"mrpt::maps::CSimpleMap"sv, "CSimpleMap"sv, "CSensFrameProbSequence"sv},
       {".simplemap"},
       "give the log or the bag that it was made of; else 'sm-cli export-rawlog' of MOLA makes a "
       "rawlog "
       "of it, 'sm-cli export-keyframes' a trajectory (TUM), and " +
           std::string(kExportRawlog),
       1},
      {"a rawlog of MRPT",
       {"CActionCollection"sv, "CObservation"sv, "CSensoryFrame"sv, "mrpt::"sv},
       {".rawlog"},
       kExportRawlog,
       1},
      {"a log of LCM", {"\xED\xA1\xDA\x01"sv}, {".lcm", ".lcmlog"}, kWriteCarmen},
      {"a log of Player", {"## Player version"sv}, {}, kWriteCarmen},
      {"a recording of Rerun", {"RRF0"sv, "RRF1"sv, "RRF2"sv}, {".rrd"}, kWriteCarmen},
      {"a pose graph of iSAM",
       {"ODOMETRY "sv, "LANDMARK "sv, "POINT2D "sv},
       {},
       "write it as g2o: VERTEX_SE2 id x y yaw for each pose, and EDGE_SE2 with the information "
       "matrix for each ODOMETRY i j x y yaw and its square root of it"},
      {"messages printed by rostopic echo -p", {"%time,"sv}, {}, kGiveBag},
      {"messages printed by rostopic or ros2 topic echo", {"header:"sv}, {}, kGiveBag},
      // Tables.
      {"an HDF5 file", {"\x89HDF\r\n\x1A\n"sv}, {".h5", ".hdf5"}, kWriteCarmen},
      {"a MATLAB file", {"MATLAB "sv}, {".mat"}, kWriteCarmen},
      {"an array of NumPy", {"\x93NUMPY"sv}, {".npy", ".npz"}, kWriteCarmen},
      {"JSON", {"{"sv}, {".json", ".jsonl"}, kWriteCarmen},
      {"a message of protobuf", {}, {".pb", ".proto"}, kWriteCarmen},
      {"a table of text", {}, {".csv", ".tsv", ".txt", ".dat"}, kWriteCarmen},
      {"a trajectory (TUM)",
       {},
       {".tum"},
       "give the log that it belongs to; plumbline_convert --trajectory puts the two together"},
      // Clouds.
      {"a point cloud (PCD)",
       {"# .PCD"sv, "VERSION 0.7"sv, "VERSION .7"sv},
       {".pcd"},
       kRecordScans},
      {"a point cloud (PLY)", {"ply\n"sv, "ply\r\n"sv}, {".ply"}, kRecordScans},
      {"a point cloud (LAS)", {"LASF"sv}, {".las", ".laz"}, kRecordScans},
      {"a point cloud (E57)", {"ASTM-E57"sv}, {".e57"}, kRecordScans},
      // Maps.
      {"a picture (PGM)", {"P5\n"sv, "P5 "sv, "P2\n"sv, "P2 "sv}, {".pgm"}, kGiveLog},
      {"a picture (PNG)", {"\x89PNG"sv}, {".png"}, kGiveLog},
      {"the description of an occupancy grid", {"image:"sv}, {}, kGiveLog},
      {"a YAML file",
       {},
       {".yaml", ".yml"},
       "of a bag it would be the metadata.yaml; of a map there is nothing to read"}};
  return formats;
}

Status RefuseForeignContent(const std::string& path) {
  const std::string start = StartOfFile(path, kStartBytes);
  for (const ForeignFormat& format : ForeignFormats()) {
    for (const std::string_view bytes : format.starts) {
      if (start.compare(std::min(format.start_at, start.size()), bytes.size(), bytes) != 0)
        continue;
      return Status::InvalidArgument(path + ": " + format.name +
                                     ", which is not read: " + format.advice);
    }
  }
  return Status::Ok();
}

Status RefuseForeignName(const std::string& path) {
  std::filesystem::path name(path);
  if (name.extension() == ".gz") name = name.stem();
  const std::string ending = name.extension().string();
  for (const ForeignFormat& format : ForeignFormats()) {
    if (std::count(format.endings.begin(), format.endings.end(), ending) == 0) continue;
    return Status::InvalidArgument(path + ": " + format.name +
                                   " by its name, and no CARMEN log: " + format.advice);
  }
  return Status::Ok();
}

}  // namespace plumbline
