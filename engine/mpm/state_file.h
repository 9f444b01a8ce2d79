// Exact binary state of a solver: a checked header and values in a fixed order.
#pragma once

#include "engine/core/error.h"

#include <cstdint>
#include <cstring>
#include <iosfwd>
#include <string>
#include <type_traits>
#include <vector>

namespace rend {

/// Collects values and writes them with magic, version, kind of solver, scene hash, length and
/// checksum.
class StateWriter {
 public:
  template <class T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T> || sizeof(T) % sizeof(double) == 0);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
  }
  template <class T>
  void put(const std::vector<T>& values) {
    put(static_cast<std::uint64_t>(values.size()));
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  }
  void write(std::ostream& out, const std::string& kind, std::uint64_t scene_hash) const;

 private:
  std::string bytes_;
};

/// Reads all of a state before any of it is used.
class StateReader {
 public:
  /// @throws Error when the data is damaged, of another version, of another kind of solver or of
  /// another scene.
  StateReader(std::istream& in, const std::string& kind, std::uint64_t scene_hash);

  template <class T>
  void get(T& value) {
    take(&value, sizeof(T));
  }
  /// An array that must have `count` entries.
  template <class T>
  void get(std::vector<T>& values, std::size_t count) {
    std::uint64_t size = 0;
    get(size);
    if (size != count)
      fail("it holds " + std::to_string(size) + " entries where " + std::to_string(count) +
           " belong");
    values.resize(count);
    take(values.data(), count * sizeof(T));
  }
  /// An array of any length.
  template <class T>
  void get(std::vector<T>& values) {
    std::uint64_t size = 0;
    get(size);
    if (size > (bytes_.size() - at_) / sizeof(T)) fail("it ends too early");
    values.resize(size);
    take(values.data(), size * sizeof(T));
  }
  /// @throws Error unless the values called `what` fit, for those that a damaged file could not
  /// have but a forged one could.
  static void require(bool fits, const char* what);
  /// Call after the last get(); what is left over is an error.
  void finish() const;

 private:
  [[noreturn]] static void fail(const std::string& why);
  void take(void* to, std::size_t size);

  std::string bytes_;
  std::size_t at_ = 0;
};

/// Mixes bytes into a hash; order matters.
std::uint64_t hash_bytes(std::uint64_t seed, const void* data, std::size_t size);

template <class T>
std::uint64_t hash_values(std::uint64_t seed, const std::vector<T>& values) {
  return hash_bytes(seed, values.data(), values.size() * sizeof(T));
}

}  // namespace rend
