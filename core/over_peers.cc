#include "plumbline/core/over_peers.h"

#include <string>

namespace plumbline {
namespace {

Status StatusOf(StatusCode code, const std::string& message) {
  switch (code) {
    case StatusCode::kOk:
      break;
    case StatusCode::kInvalidArgument:
      return Status::InvalidArgument(message);
    case StatusCode::kNotFound:
      return Status::NotFound(message);
    case StatusCode::kDataLoss:
      return Status::DataLoss(message);
    case StatusCode::kUnavailable:
      return Status::Unavailable(message);
  }
  return Status::Ok();
}

}  // namespace

std::vector<std::size_t> OwnShare(const Peers* peers, std::size_t count) {
  std::vector<std::size_t> own;
  const std::size_t size = peers == nullptr ? 1 : peers->size();
  for (std::size_t i = peers == nullptr ? 0 : peers->rank(); i < count; i += size) own.push_back(i);
  return own;
}

Status FirstFailure(const Peers* peers, const Status& own) {
  if (peers == nullptr) return own;
  peers->WaitForAll();
  std::vector<char> report;
  if (!own.ok()) {
    const std::string name =
        peers->rank() == 0 ? "" : "rank " + std::to_string(peers->rank()) + ": ";
    const std::string message = name + own.message();
    report.push_back(static_cast<char>(own.code()));
    report.insert(report.end(), message.begin(), message.end());
  }
  for (const std::vector<char>& of_rank :
       peers->Exchange(std::vector<std::vector<char>>(peers->size(), report))) {
    if (of_rank.empty()) continue;
    return StatusOf(static_cast<StatusCode>(of_rank.front()),
                    std::string(of_rank.begin() + 1, of_rank.end()));
  }
  return Status::Ok();
}

}  // namespace plumbline
