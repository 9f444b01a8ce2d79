// A block of floats aligned for the widest vectors, not initialised.
#pragma once

#include <cstddef>
#include <memory>
#include <new>

namespace rend {

/// Owns `size()` floats at a 64-byte boundary. Growing loses the contents.
class AlignedFloats {
 public:
  float* data() { return data_.get(); }
  const float* data() const { return data_.get(); }
  std::size_t size() const { return size_; }

  /// Makes room for `count` floats, a 32nd more when it has to grow.
  void reserve(std::size_t count) {
    if (count <= size_) return;
    data_.reset();
    size_ = 0;
    const std::size_t padded = (count + count / 32 + 15) / 16 * 16;
    data_.reset(new (std::align_val_t(64)) float[padded]);
    size_ = padded;
  }

 private:
  struct Delete {
    void operator()(float* p) const { ::operator delete[](p, std::align_val_t(64)); }
  };
  std::unique_ptr<float[], Delete> data_;
  std::size_t size_ = 0;
};

}  // namespace rend
