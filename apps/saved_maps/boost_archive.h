#ifndef PLUMBLINE_APPS_SAVED_MAPS_BOOST_ARCHIVE_H_
#define PLUMBLINE_APPS_SAVED_MAPS_BOOST_ARCHIVE_H_

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "plumbline/apps/saved_maps/archive_schema.h"
#include "plumbline/core/status.h"

namespace plumbline {

class BoostArchive;

/// An object of an archive, which has to outlive it, or none, as a null pointer. Members are asked
/// for by their names; they have to be there, and of the type that is asked for.
class ArchiveObject {
 public:
  /// None.
  ArchiveObject() = default;

  bool is_null() const { return archive_ == nullptr; }
  /// Whether it is of this class or of one derived from it; false for none.
  bool IsA(std::string_view class_name) const;

  /// The number at Place().
  double Number(std::string_view member) const;
  /// All of a member that is repeated, doubles.
  std::vector<double> Numbers(std::string_view member) const;
  std::string_view String(std::string_view member) const;
  /// An object in place, or what a pointer leads to.
  ArchiveObject Object(std::string_view member) const;
  /// Index of a number's first byte; of the first number, where there are several.
  std::size_t Place(std::string_view member) const;

  /// Of a collection: the number of its elements.
  std::size_t size() const;
  /// Of a collection of objects or pointers.
  ArchiveObject operator[](std::size_t element) const;

  bool operator==(const ArchiveObject& other) const {
    return archive_ == other.archive_ && index_ == other.index_;
  }

 private:
  friend class BoostArchive;
  ArchiveObject(const BoostArchive* archive, std::size_t index)
      : archive_(archive), index_(index) {}
  int MemberIndex(std::string_view member) const;
  // Of a member or element.
  std::size_t ValueOf(std::size_t index) const;
  ArchiveObject ObjectOf(std::size_t index) const;

  const BoostArchive* archive_ = nullptr;
  std::size_t index_ = 0;
};

/// A binary archive of Boost.Serialization, read without that library: what it reads is code of the
/// program that wrote it, it trusts every length, and goes one call deeper for every pointer, which
/// a graph of a thousand vertices takes beyond the stack. The layout is that of Boost's
/// basic_iarchive.cpp, basic_binary_iarchive.hpp and basic_binary_iprimitive.hpp.
///
/// Archives do not say what their classes are made of: a schema does. They say which classes are
/// tracked, and number classes and objects in the order in which they come. Objects are tracked
/// that pointers lead to, so that each is there once.
class BoostArchive {
 public:
  /// Whether a file begins like an archive, of any kind.
  static bool IsArchive(std::string_view start);

  /// Takes bytes that hold an object of the root class and nothing behind it. The schema has to
  /// outlive the archive. DataLoss, naming the byte and the member, where they do not fit the
  /// schema: the bytes are damaged, cut off, or were written by other classes. InvalidArgument for
  /// archives that are not binary, or of other machines or versions. Takes memory in proportion to
  /// the bytes, whatever lengths they state.
  Status Read(std::string bytes, const ArchiveSchema& schema, std::string_view root_class);

  ArchiveObject root() const { return {this, 0}; }
  const std::string& bytes() const { return bytes_; }

 private:
  friend class ArchiveObject;
  friend class ArchiveReader;

  struct Entry {
    int type = 0;
    std::uint64_t size = 0;       // members, or elements
    std::size_t first_value = 0;  // in values_; of numbers there is one, the first
  };
  // How many values a member that is repeated has, by the members before it; what is beyond the
  // number of bytes stands for all that is.
  std::uint64_t CountOf(std::size_t object, const ArchiveSchema::Value& member) const;

  std::string bytes_;
  const ArchiveSchema* schema_ = nullptr;
  std::vector<Entry> objects_;
  std::vector<std::size_t> values_;  // places of numbers and strings, indices of objects, or kNone
};

}  // namespace plumbline

#endif  // PLUMBLINE_APPS_SAVED_MAPS_BOOST_ARCHIVE_H_
