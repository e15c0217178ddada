#include "plumbline/apps/report/calibration_report.h"

#include <iomanip>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

namespace plumbline {
namespace {

struct NamedSwitch {
  const char* name;
  bool CalibrationOptions::*on;
};

constexpr NamedSwitch kSwitches[] = {{"mounting", &CalibrationOptions::laser_mounting},
                                     {"range_bias", &CalibrationOptions::range_bias},
                                     {"range_scale", &CalibrationOptions::range_scale},
                                     {"odometry_scale", &CalibrationOptions::odometry_scale}};

bool SwitchOn(const std::string& name, CalibrationOptions* options) {
  for (const NamedSwitch& known : kSwitches) {
    if (name != known.name) continue;
    options->*known.on = true;
    return true;
  }
  return false;
}

}  // namespace

Status ParseCalibration(const std::string& names, CalibrationOptions* options) {
  CalibrationOptions result = *options;
  std::istringstream list(names);
  std::set<std::string> seen;
  for (std::string name; std::getline(list, name, ',');) {
    if (!seen.insert(name).second) return Status::InvalidArgument("'" + name + "' comes twice");
    if (SwitchOn(name, &result)) continue;
    std::string message = "'" + name + "' is nothing to calibrate; known are";
    for (const NamedSwitch& known : kSwitches) message += std::string(" ") + known.name;
    return Status::InvalidArgument(message);
  }
  *options = result;
  return Status::Ok();
}

std::string CalibrationText(const Calibration& calibration) {
  if (calibration.parameters.empty()) return "";
  std::ostringstream text;
  text << std::fixed << std::setprecision(4) << std::left << std::setw(20) << "Calibration"
       << std::right << std::setw(10) << "given" << std::setw(10) << "found" << std::setw(10)
       << "+-" << '\n';
  for (const CalibratedParameter& p : calibration.parameters) {
    text << "  " << std::left << std::setw(18) << p.name << std::right << std::setw(10) << p.given
         << std::setw(10) << p.value << std::setw(10) << p.sigma
         << (p.IsDetermined() ? "" : "  not determined by the data") << '\n';
  }
  text << (calibration.settled ? "  settled after " : "  not settled after ") << calibration.steps
       << " steps (" << std::setprecision(2) << calibration.time_s << " s)\n";
  return text.str();
}

Json CalibrationJson(const Calibration& calibration) {
  if (calibration.parameters.empty()) return nullptr;
  Json parameters = Json::object();
  for (const CalibratedParameter& p : calibration.parameters) {
    parameters[p.name] = {{"given", p.given},
                          {"value", p.value},
                          {"sigma", p.sigma},
                          {"prior_sigma", p.prior_sigma},
                          {"determined", p.IsDetermined()}};
  }
  return {{"parameters", parameters},
          {"steps", calibration.steps},
          {"settled", calibration.settled},
          {"time_s", calibration.time_s}};
}

}  // namespace plumbline
