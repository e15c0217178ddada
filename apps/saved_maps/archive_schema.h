#ifndef PLUMBLINE_APPS_SAVED_MAPS_ARCHIVE_SCHEMA_H_
#define PLUMBLINE_APPS_SAVED_MAPS_ARCHIVE_SCHEMA_H_

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace plumbline {

/// As ArchiveMember::times: as many values as there are up to the end of the file.
constexpr char kToTheEnd[] = "to the end";

/// What a class writes of one of its members.
struct ArchiveMember {
  /// "bool", "uint8", "int32", "uint32", "uint64", "double" or "string"; a class, for an object in
  /// place; a class and a star, for a pointer to an object of it or of a class derived from it.
  std::string type;
  /// "base" for a base class.
  std::string name;
  /// Names of members before it: as many values, one after the other, as the product of these
  /// numbers and sizes. Empty: one value.
  std::vector<std::string> times = {};
};

/// What a class writes of itself into an archive of Boost.Serialization.
struct ArchiveClass {
  enum class Form {
    kMembers,     ///< its members, in this order
    kCollection,  ///< of the standard library: its size, and as many of its only member
    kNumbers,     ///< likewise, but of numbers, which need no description of the class
  };
  std::string name;  ///< which objects give that are written through pointers to a base class
  std::vector<ArchiveMember> members = {};
  Form form = Form::kMembers;
  bool is_abstract = false;
  /// Whether a reader keeps what it holds, or just passes it.
  bool is_kept = true;
};

/// Classes that refer to each other by name, resolved: all names have to be there.
class ArchiveSchema {
 public:
  /// What a member is made of.
  struct Value {
    enum class Kind { kNumber, kString, kObject, kPointer };
    Kind kind = Kind::kNumber;
    std::size_t size = 0;  ///< of a number [bytes]
    int type = 0;          ///< class of an object, or of what a pointer leads to
    bool is_repeated = false;
    std::vector<int> times;  ///< members; empty if it is repeated: to the end of the file
  };

  explicit ArchiveSchema(std::vector<ArchiveClass> classes);

  /// Classes are numbers, in the order of the table.
  const ArchiveClass& Class(int type) const { return classes_[type]; }
  /// Of each member of a class.
  const std::vector<Value>& Values(int type) const { return values_[type]; }
  int num_classes() const { return static_cast<int>(classes_.size()); }
  /// The class of this name; negative if there is none.
  int Find(std::string_view name) const;
  /// The member of this name; negative if there is none.
  int FindMember(int type, std::string_view name) const;
  /// Whether a class is this other one or derived from it.
  bool IsA(int type, int base) const;

 private:
  Value Resolve(int type, const ArchiveMember& member) const;

  std::vector<ArchiveClass> classes_;
  std::vector<std::vector<Value>> values_;
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SAVED_MAPS_ARCHIVE_SCHEMA_H_
