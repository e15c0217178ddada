#include "plumbline/apps/saved_maps/boost_archive.h"

#include <algorithm>
#include <cassert>
#include <limits>
#include <utility>

#include "plumbline/apps/io/field_reader.h"
#include "plumbline/apps/io/little_endian.h"

namespace plumbline {
namespace {

constexpr std::string_view kSignature = "serialization::archive";
// Sizes of int, long, float and double, and 1 as an int.
constexpr std::string_view kMachine("\4\10\4\10\1\0\0\0", 8);
// Of the library: the first is that of Boost 1.65, and later ones have changed nothing here.
constexpr int kFirstVersion = 15, kLastVersion = 21;
constexpr std::size_t kMaxNameBytes = 127;
constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
constexpr std::uint64_t kUpToTheEnd = std::numeric_limits<std::uint64_t>::max();

using Value = ArchiveSchema::Value;

double LoadNumber(const char* bytes, std::string_view type) {
  if (type == "double") return LoadDouble(bytes);
  if (type == "uint32") return LoadLittleEndian<std::uint32_t>(bytes);
  if (type == "int32") {
    return static_cast<std::int32_t>(LoadLittleEndian<std::uint32_t>(bytes));
  }
  return static_cast<unsigned char>(*bytes);
}

}  // namespace

// Goes through the bytes once. What is begun and not finished is on a stack of its own: objects
// that lead to each other are as deep in each other as there are edges in a graph.
class ArchiveReader {
 public:
  explicit ArchiveReader(BoostArchive* archive)
      : archive_(*archive),
        schema_(*archive->schema_),
        bytes_(archive->bytes_),
        classes_(schema_.num_classes()) {}

  Status Read(std::string_view root_class) {
    PLUMBLINE_RETURN_IF_ERROR(ReadStart());
    PLUMBLINE_RETURN_IF_ERROR(ReadObject(schema_.Find(root_class), kNone));
    while (!stack_.empty()) PLUMBLINE_RETURN_IF_ERROR(Step());
    if (at_ == bytes_.size()) return Status::Ok();
    return Status::DataLoss("byte " + std::to_string(at_) + ": " +
                            std::to_string(bytes_.size() - at_) + " bytes more than there should " +
                            "be");
  }

 private:
  // What is known of a class.
  struct ClassState {
    bool is_registered = false;
    bool is_described = false;
    bool is_tracked = false;
  };
  struct Tracked {
    int type = 0;
    std::size_t object = kNone;
  };
  // An object that is not finished, or several values of one of its members.
  struct Frame {
    int type = 0;
    const Value* element = nullptr;  // of a collection, or the member that is repeated
    bool is_kept = true;
    std::size_t object = kNone;  // that its values belong to
    std::uint64_t size = 0;
    std::uint64_t next = 0;
  };

  Status Damaged(const std::string& problem) const {
    std::string place = "byte " + std::to_string(at_) + ": ";
    if (!stack_.empty()) {
      const Frame& frame = stack_.back();
      const ArchiveClass& of = schema_.Class(frame.type);
      const std::size_t member = frame.element != nullptr || frame.next == 0
                                     ? kNone
                                     : static_cast<std::size_t>(frame.next - 1);
      place += of.name + (member == kNone ? "" : "." + of.members[member].name) + ": ";
    }
    return Status::DataLoss(place + problem);
  }

  std::uint64_t Left() const { return bytes_.size() - at_; }

  Status Need(std::uint64_t size) const {
    if (size <= Left()) return Status::Ok();
    return Damaged(size <= 8 ? "the file ends there"
                             : "it takes " + std::to_string(size) + " bytes, and the file has " +
                                   std::to_string(Left()) + " left");
  }

  template <typename T>
  Status Take(T* value) {
    PLUMBLINE_RETURN_IF_ERROR(Need(sizeof(T)));
    *value = LoadLittleEndian<T>(bytes_.data() + at_);
    at_ += sizeof(T);
    return Status::Ok();
  }

  Status ReadStart() {
    const std::string_view start = std::string_view(bytes_).substr(0, 64);
    const std::size_t signature_at = start.find(kSignature);
    if (signature_at != sizeof(std::uint64_t)) {
      return Status::InvalidArgument(
          "it does not begin as binary archives of Boost.Serialization do, written on a machine of "
          "64 bits");
    }
    at_ = signature_at + kSignature.size();
    std::uint16_t version = 0;
    PLUMBLINE_RETURN_IF_ERROR(Take(&version));
    if (version < kFirstVersion || version > kLastVersion) {
      return Status::InvalidArgument("an archive of version " + std::to_string(version) +
                                     " of Boost.Serialization; known are " +
                                     std::to_string(kFirstVersion) + " to " +
                                     std::to_string(kLastVersion));
    }
    PLUMBLINE_RETURN_IF_ERROR(Need(kMachine.size()));
    if (start.substr(at_, kMachine.size()) != kMachine) {
      return Status::InvalidArgument(
          "an archive of a machine with other sizes of numbers or another order of bytes");
    }
    at_ += kMachine.size();
    return Status::Ok();
  }

  // The next value of what was begun last.
  Status Step() {
    Frame& frame = stack_.back();
    if (frame.next == frame.size || (frame.size == kUpToTheEnd && Left() == 0)) {
      stack_.pop_back();
      return Status::Ok();
    }
    const auto index = static_cast<std::size_t>(frame.next++);
    if (frame.element != nullptr && frame.size != kUpToTheEnd) --awaited_;
    const std::size_t slot =
        frame.object == kNone ? kNone : archive_.objects_[frame.object].first_value + index;
    if (frame.element != nullptr) return ReadValue(*frame.element, slot);
    const Value& value = schema_.Values(frame.type)[index];
    return value.is_repeated ? ReadRepeated(frame, value, slot) : ReadValue(value, slot);
  }

  void Keep(std::size_t value, std::size_t slot) {
    if (slot != kNone) archive_.values_[slot] = value;
  }

  Status ReadValue(const Value& value, std::size_t slot) {
    switch (value.kind) {
      case Value::Kind::kNumber:
        return PassNumbers(1, value.size, slot);
      case Value::Kind::kString:
        return PassString(slot);
      case Value::Kind::kObject:
        return ReadObject(value.type, slot);
      case Value::Kind::kPointer:
        break;
    }
    return ReadPointer(value.type, slot);
  }

  // count: no more than the file has bytes.
  Status PassNumbers(std::uint64_t count, std::size_t size, std::size_t slot) {
    Keep(at_, slot);
    PLUMBLINE_RETURN_IF_ERROR(Need(count * size));
    at_ += static_cast<std::size_t>(count * size);
    return Status::Ok();
  }

  Status PassString(std::size_t slot) {
    Keep(at_, slot);
    std::uint64_t size = 0;
    PLUMBLINE_RETURN_IF_ERROR(Take(&size));
    PLUMBLINE_RETURN_IF_ERROR(Need(size));
    at_ += static_cast<std::size_t>(size);
    return Status::Ok();
  }

  Status ReadRepeated(Frame owner, const Value& value, std::size_t slot) {
    assert(owner.object != kNone);
    std::uint64_t count = archive_.CountOf(owner.object, value);
    if (count > bytes_.size()) return Damaged("more values than the file has bytes");
    if (value.times.empty()) count = kUpToTheEnd;
    if (value.kind == Value::Kind::kNumber) return PassNumbers(count, value.size, slot);
    if (count != kUpToTheEnd) PLUMBLINE_RETURN_IF_ERROR(Await(count));
    stack_.push_back({owner.type, &value, owner.is_kept, kNone, count});
    return Status::Ok();
  }

  Status TooMany() const { return Damaged("more elements than the file has bytes left"); }

  // Each element takes a byte at least, beside those that what is not finished still waits for.
  // Else collections in collections, each as large as the file, would take its square of memory.
  Status Await(std::uint64_t count) {
    if (awaited_ > Left() || count > Left() - awaited_) return TooMany();
    awaited_ += count;
    return Status::Ok();
  }

  void Register(int type) {
    if (classes_[type].is_registered) return;
    classes_[type].is_registered = true;
    types_by_id_.push_back(type);
  }

  // A class is described where its first object is.
  Status ReadDescription(int type) {
    ClassState& state = classes_[type];
    if (state.is_described || schema_.Class(type).form == ArchiveClass::Form::kNumbers) {
      return Status::Ok();
    }
    std::uint8_t is_tracked = 0;
    PLUMBLINE_RETURN_IF_ERROR(Take(&is_tracked));
    if (is_tracked > 1) return Damaged("a class that is neither tracked nor untracked");
    PLUMBLINE_RETURN_IF_ERROR(CheckVersion(type));
    state.is_described = true;
    state.is_tracked = is_tracked == 1;
    return Status::Ok();
  }

  // Of a class or of the elements of a collection.
  Status CheckVersion(int type) {
    std::uint32_t version = 0;
    PLUMBLINE_RETURN_IF_ERROR(Take(&version));
    if (version == 0) return Status::Ok();
    return Damaged("version " + std::to_string(version) + " of " + schema_.Class(type).name +
                   "; only version 0 is known");
  }

  Status ReadObject(int type, std::size_t slot) {
    Register(type);
    PLUMBLINE_RETURN_IF_ERROR(ReadDescription(type));
    return classes_[type].is_tracked ? ReadTracked(type, slot) : Begin(type, slot);
  }

  Status ReadPointer(int base, std::size_t slot) {
    if (!schema_.Class(base).is_abstract) Register(base);
    constexpr std::uint16_t kNull = 0xffff;
    std::uint16_t id = 0;
    PLUMBLINE_RETURN_IF_ERROR(Take(&id));
    if (id == kNull) return Status::Ok();
    if (id > types_by_id_.size()) return Damaged("class " + std::to_string(id) + " is not known");
    if (id == types_by_id_.size()) PLUMBLINE_RETURN_IF_ERROR(ReadNewClass());
    const int type = types_by_id_[id];
    if (!schema_.IsA(type, base)) {
      return Damaged("a pointer to an object of " + schema_.Class(type).name + ", which is no " +
                     schema_.Class(base).name);
    }
    PLUMBLINE_RETURN_IF_ERROR(ReadDescription(type));
    if (!classes_[type].is_tracked) {
      return Damaged("objects of " + schema_.Class(type).name +
                     " are not tracked, though a pointer leads to one");
    }
    return ReadTracked(type, slot);
  }

  Status ReadNewClass() {
    std::uint64_t size = 0;
    PLUMBLINE_RETURN_IF_ERROR(Take(&size));
    if (size > kMaxNameBytes) return Damaged("the name of a class takes too many bytes");
    PLUMBLINE_RETURN_IF_ERROR(Need(size));
    std::string name = bytes_.substr(at_, static_cast<std::size_t>(size));
    at_ += name.size();
    // ROS 1 has some where ROS 2 has none, as in "Parameter<kt_double >".
    name.erase(std::remove(name.begin(), name.end(), ' '), name.end());
    const int type = schema_.Find(name);
    if (type < 0) return Damaged("an object of class " + Quote(name) + ", which is not known");
    if (classes_[type].is_registered) return Damaged("class " + Quote(name) + " was there before");
    Register(type);
    return Status::Ok();
  }

  Status ReadTracked(int type, std::size_t slot) {
    std::uint32_t id = 0;
    PLUMBLINE_RETURN_IF_ERROR(Take(&id));
    if (id > tracked_.size()) return Damaged("object " + std::to_string(id) + " is not known");
    if (id == tracked_.size()) {
      tracked_.push_back({type, IsKept(type) ? archive_.objects_.size() : kNone});
      return Begin(type, slot);
    }
    if (tracked_[id].type != type) {
      return Damaged("object " + std::to_string(id) + " is of class " +
                     schema_.Class(tracked_[id].type).name + ", not " + schema_.Class(type).name);
    }
    Keep(tracked_[id].object, slot);
    return Status::Ok();
  }

  bool IsKept(int type) const {
    return schema_.Class(type).is_kept && (stack_.empty() || stack_.back().is_kept);
  }

  // An object that has not been read before.
  Status Begin(int type, std::size_t slot) {
    const ArchiveClass& of = schema_.Class(type);
    const std::vector<Value>& values = schema_.Values(type);
    Frame frame;
    frame.type = type;
    frame.is_kept = IsKept(type);
    frame.size = values.size();
    if (of.form != ArchiveClass::Form::kMembers) {
      PLUMBLINE_RETURN_IF_ERROR(Take(&frame.size));
      frame.element = &values[0];
    }
    const bool is_numbers = of.form == ArchiveClass::Form::kNumbers;
    if (is_numbers && frame.size > Left()) return TooMany();
    if (of.form == ArchiveClass::Form::kCollection) PLUMBLINE_RETURN_IF_ERROR(CheckVersion(type));
    if (frame.element != nullptr && !is_numbers) PLUMBLINE_RETURN_IF_ERROR(Await(frame.size));
    if (frame.is_kept) {
      frame.object = archive_.objects_.size();
      archive_.objects_.push_back({type, frame.size, archive_.values_.size()});
      const std::uint64_t num_values = is_numbers ? 1 : frame.size;
      archive_.values_.resize(archive_.values_.size() + static_cast<std::size_t>(num_values),
                              kNone);
      Keep(frame.object, slot);
    }
    if (is_numbers) {
      return PassNumbers(frame.size, values[0].size,
                         frame.is_kept ? archive_.values_.size() - 1 : kNone);
    }
    stack_.push_back(frame);
    return Status::Ok();
  }

  BoostArchive& archive_;
  const ArchiveSchema& schema_;
  const std::string& bytes_;
  std::size_t at_ = 0;
  std::uint64_t awaited_ = 0;  // elements of collections and repeated members on the stack
  std::vector<ClassState> classes_;
  std::vector<int> types_by_id_;
  std::vector<Tracked> tracked_;
  std::vector<Frame> stack_;
};

bool BoostArchive::IsArchive(std::string_view start) {
  return start.substr(0, 64).find(kSignature) <= sizeof(std::uint64_t);
}

Status BoostArchive::Read(std::string bytes, const ArchiveSchema& schema,
                          std::string_view root_class) {
  bytes_ = std::move(bytes);
  schema_ = &schema;
  return ArchiveReader(this).Read(root_class);
}

std::uint64_t BoostArchive::CountOf(std::size_t object, const Value& member) const {
  const Entry& entry = objects_[object];
  std::uint64_t count = 1;
  for (const int factor : member.times) {
    const Value& of = schema_->Values(entry.type)[factor];
    const std::size_t value = values_[entry.first_value + factor];
    std::uint64_t size = 0;
    if (of.kind == Value::Kind::kObject) {
      size = objects_[value].size;
    } else if (of.size == sizeof(std::uint32_t)) {
      size = LoadLittleEndian<std::uint32_t>(bytes_.data() + value);
    } else {
      size = LoadLittleEndian<std::uint64_t>(bytes_.data() + value);
    }
    if (size != 0 && count > bytes_.size() / size) return bytes_.size() + 1;
    count *= size;
  }
  return count;
}

bool ArchiveObject::IsA(std::string_view class_name) const {
  if (is_null()) return false;
  const ArchiveSchema& schema = *archive_->schema_;
  return schema.IsA(archive_->objects_[index_].type, schema.Find(class_name));
}

double ArchiveObject::Number(std::string_view member) const {
  const ArchiveSchema& schema = *archive_->schema_;
  const int type = archive_->objects_[index_].type;
  const int index = MemberIndex(member);
  return LoadNumber(archive_->bytes_.data() + ValueOf(index),
                    schema.Class(type).members[index].type);
}

std::vector<double> ArchiveObject::Numbers(std::string_view member) const {
  const int index = MemberIndex(member);
  const Value& value = archive_->schema_->Values(archive_->objects_[index_].type)[index];
  std::vector<double> numbers(static_cast<std::size_t>(archive_->CountOf(index_, value)));
  const char* bytes = archive_->bytes_.data() + ValueOf(index);
  for (double& number : numbers) {
    number = LoadDouble(bytes);
    bytes += sizeof(double);
  }
  return numbers;
}

std::string_view ArchiveObject::String(std::string_view member) const {
  const char* begin = archive_->bytes_.data() + Place(member);
  const auto size = LoadLittleEndian<std::uint64_t>(begin);
  return {begin + sizeof(size), static_cast<std::size_t>(size)};
}

ArchiveObject ArchiveObject::Object(std::string_view member) const {
  return ObjectOf(MemberIndex(member));
}

std::size_t ArchiveObject::Place(std::string_view member) const {
  return ValueOf(MemberIndex(member));
}

std::size_t ArchiveObject::size() const {
  return static_cast<std::size_t>(archive_->objects_[index_].size);
}

ArchiveObject ArchiveObject::operator[](std::size_t element) const { return ObjectOf(element); }

int ArchiveObject::MemberIndex(std::string_view member) const {
  const int index = archive_->schema_->FindMember(archive_->objects_[index_].type, member);
  assert(index >= 0);
  return index;
}

std::size_t ArchiveObject::ValueOf(std::size_t index) const {
  return archive_->values_[archive_->objects_[index_].first_value + index];
}

ArchiveObject ArchiveObject::ObjectOf(std::size_t index) const {
  const std::size_t object = ValueOf(index);
  return object == kNone ? ArchiveObject() : ArchiveObject(archive_, object);
}

}  // namespace plumbline
