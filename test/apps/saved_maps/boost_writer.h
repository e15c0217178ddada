#ifndef PLUMBLINE_TEST_APPS_SAVED_MAPS_BOOST_WRITER_H_
#define PLUMBLINE_TEST_APPS_SAVED_MAPS_BOOST_WRITER_H_

#include <cstdint>
#include <cstring>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace plumbline {

/// Writes archives of Boost.Serialization value by value, as its binary_oarchive does on a machine
/// of 64 bits; independent of the reader under test.
class BoostWriter {
 public:
  explicit BoostWriter(std::uint16_t version) {
    Text("serialization::archive");
    Number(version);
    bytes_ += std::string("\4\10\4\10\1\0\0\0", 8);
  }

  template <typename T>
  void Number(T value) {
    char stored[sizeof(T)];
    std::memcpy(stored, &value, sizeof(T));  // tests run on little-endian machines
    bytes_.append(stored, sizeof(T));
  }
  void Double(double value) { Number(value); }
  void Int(std::uint32_t value) { Number(value); }
  void Bool(bool value) { Number<std::uint8_t>(value ? 1 : 0); }
  void Text(const std::string& text) {
    Number<std::uint64_t>(text.size());
    bytes_ += text;
  }

  /// What comes before an object in place.
  void Object(const std::string& type) {
    Register(type);
    Describe(type, false);
  }
  /// Of a class that pointers lead to elsewhere in the program.
  void TrackedObject(const std::string& type) {
    Register(type);
    Describe(type, true);
    Int(num_objects_++);
  }
  /// Of a vector or map.
  void Collection(const std::string& type, std::size_t size) {
    Object(type);
    Number<std::uint64_t>(size);
    Int(0);
  }
  void Numbers(const std::vector<double>& numbers) {
    Register("vector of numbers");
    Number<std::uint64_t>(numbers.size());
    for (const double number : numbers) Double(number);
  }

  void Null() { Number<std::uint16_t>(0xffff); }
  /// What comes before an object behind a pointer to a class that has objects.
  std::uint32_t Pointer(const std::string& type) {
    Register(type);
    return PointerToDerived(type);
  }
  /// Of a pointer to an abstract class, or to a base that is registered: a class that is new gives
  /// its name.
  std::uint32_t PointerToDerived(const std::string& type) {
    const bool is_new = ids_.count(type) == 0;
    Number(static_cast<std::uint16_t>(is_new ? ids_.size() : ids_[type]));
    if (is_new) Text(type);
    Register(type);
    Describe(type, true);
    Int(num_objects_);
    return num_objects_++;
  }
  /// A pointer to an object that was there.
  void Again(const std::string& type, std::uint32_t object) {
    Number(static_cast<std::uint16_t>(ids_.at(type)));
    Int(object);
  }

  void Register(const std::string& type) { ids_.emplace(type, ids_.size()); }
  const std::string& bytes() const { return bytes_; }

 private:
  void Describe(const std::string& type, bool is_tracked) {
    if (!described_.insert(type).second) return;
    Bool(is_tracked);
    Int(0);
  }

  std::string bytes_;
  std::map<std::string, std::size_t> ids_;
  std::set<std::string> described_;
  std::uint32_t num_objects_ = 0;
};

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_APPS_SAVED_MAPS_BOOST_WRITER_H_
