// What a scene's fields are, independent of JSON: the tables call this, reader, writer and schema
// implement it.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/core/types.h"

namespace rend {

/// Name and meaning of one key.
struct Field {
  const char* key;
  const char* help;  ///< one short sentence
  bool required = false;
  bool input_only = false;  ///< a shorthand: accepted, never written
};

/// Unit and allowed closed range of a number.
struct Range {
  const char* unit;
  Real min;
  Real max;
};

using Names = std::span<const char* const>;

class FieldVisitor;

/// A list of objects, or, with `name` set, an object whose keys name them.
struct Sequence {
  std::size_t size;
  std::size_t min;
  std::size_t max;
  std::function<void(std::size_t)> resize;
  std::function<void(FieldVisitor&, std::size_t)> describe;
  std::function<std::string&(std::size_t)> name;
};

/// Visits every field of an object once; the value passed in is the default, so tables and defaults
/// cannot drift.
class FieldVisitor {
 public:
  virtual ~FieldVisitor() = default;

  virtual void number(const Field&, Real& value, const Range&) = 0;
  /// Left out when empty.
  virtual void optional_number(const Field&, std::optional<Real>& value, const Range&) = 0;
  /// A number, or `word` when empty.
  virtual void number_or_word(const Field&, std::optional<Real>& value, const char* word,
                              const Range&) = 0;
  /// `allowed` may list the only right values.
  virtual void integer(const Field&, std::int64_t& value, std::int64_t min, std::int64_t max,
                       std::span<const std::int64_t> allowed) = 0;
  virtual void flag(const Field&, bool& value) = 0;
  virtual void text(const Field&, std::string& value, std::size_t max_length) = 0;
  virtual void choice(const Field&, int& value, Names names) = 0;
  virtual void vector(const Field&, Vec3& value, const Range&) = 0;
  virtual void matrix(const Field&, Mat3& value, const Range&) = 0;
  virtual void points(const Field&, std::vector<Eigen::Vector2d>& value, std::size_t min,
                      std::size_t max, const Range&) = 0;
  /// The name of an entry of `names`, kept as its index.
  virtual void reference(const Field&, std::size_t& value, std::span<const std::string> names) = 0;
  virtual void mesh_file(const Field&, std::string& file, std::string& path) = 0;
  virtual void object(const Field&, const std::function<void(FieldVisitor&)>& fields) = 0;
  virtual void sequence(const Field&, const Sequence& sequence) = 0;
  /// A choice that decides which fields follow in the same object.
  virtual void variant(const Field&, int& value, Names names,
                       const std::function<void(FieldVisitor&, int)>& fields) = 0;

  /// True when values flow into the object (reading, or a sample for the schema).
  virtual bool fills() const = 0;
  /// True when a scene that is being read has this key.
  virtual bool given(const char*) const { return false; }
  /// Two keys of which a scene may give only one; call after both were visited.
  virtual void exclusive(const char*, const char*) {}
};

/// A choice kept in an enumeration whose values count from 0 in the order of `names`.
template <class E>
void choose(FieldVisitor& visitor, const Field& field, E& value, Names names) {
  int index = static_cast<int>(value);
  visitor.choice(field, index, names);
  value = static_cast<E>(index);
}

/// A list of objects that `describe` knows.
template <class T, class Describe>
Sequence sequence_of(std::vector<T>& items, std::size_t min, std::size_t max, Describe describe) {
  return {items.size(),
          min,
          max,
          [&items](std::size_t count) { items.resize(count); },
          [&items, describe](FieldVisitor& visitor, std::size_t i) { describe(visitor, items[i]); },
          {}};
}

}  // namespace rend
