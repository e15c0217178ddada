#include "plumbline/apps/saved_maps/archive_schema.h"

#include <cassert>
#include <utility>

namespace plumbline {
namespace {

// Of the binary representation; 0 for what is no number.
std::size_t SizeOfNumber(std::string_view type) {
  if (type == "bool" || type == "uint8") return 1;
  if (type == "int32" || type == "uint32") return 4;
  return type == "uint64" || type == "double" ? 8 : 0;
}

}  // namespace

ArchiveSchema::ArchiveSchema(std::vector<ArchiveClass> classes) : classes_(std::move(classes)) {
  for (int type = 0; type < num_classes(); ++type) {
    values_.emplace_back();
    for (const ArchiveMember& member : classes_[type].members) {
      values_.back().push_back(Resolve(type, member));
    }
  }
}

ArchiveSchema::Value ArchiveSchema::Resolve(int type, const ArchiveMember& member) const {
  Value value;
  value.size = SizeOfNumber(member.type);
  if (member.type == "string") {
    value.kind = Value::Kind::kString;
  } else if (value.size == 0) {
    const bool is_pointer = member.type.back() == '*';
    value.kind = is_pointer ? Value::Kind::kPointer : Value::Kind::kObject;
    value.type = Find(member.type.substr(0, member.type.size() - (is_pointer ? 1 : 0)));
    assert(value.type >= 0);
  }
  value.is_repeated = !member.times.empty();
  for (const std::string& factor : member.times) {
    if (factor == kToTheEnd) break;
    value.times.push_back(FindMember(type, factor));
    assert(value.times.back() >= 0);
  }
  return value;
}

int ArchiveSchema::Find(std::string_view name) const {
  for (int type = 0; type < num_classes(); ++type) {
    if (classes_[type].name == name) return type;
  }
  return -1;
}

int ArchiveSchema::FindMember(int type, std::string_view name) const {
  const std::vector<ArchiveMember>& members = classes_[type].members;
  for (std::size_t i = 0; i < members.size(); ++i) {
    if (members[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

bool ArchiveSchema::IsA(int type, int base) const {
  if (type == base) return true;
  const int member = FindMember(type, "base");
  return member >= 0 && IsA(values_[type][member].type, base);
}

}  // namespace plumbline
