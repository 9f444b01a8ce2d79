// Particles that share no node with any other for a while: found, and packed sixteen to a tile.
#pragma once

#include "engine/core/aligned_floats.h"
#include "engine/mpm/tile_store.h"

#include <functional>
#include <vector>

namespace rend {

/// Flags blocks that hold one particle which shares no node with another one, even after both have
/// moved `reach` cells; `reach` <= 2. Debris that is too sparse to pay is left alone, and so is
/// every particle for which clear(position in cells, its run) is false.
std::vector<std::uint8_t> find_lone_blocks(
    const TileStore& store, Real reach,
    const std::function<bool(const Vec3&, const TileRun&)>& clear);

/// Copies of the store's lone particles, packed.
class LoneTiles {
 public:
  /// Copies the lone particles and their motion out of the store.
  void pack(const TileStore& store, const float* motion);
  /// Copies them back.
  void unpack(TileStore& store, float* motion) const;
  void clear() { runs_.clear(); }

  bool empty() const { return runs_.empty(); }
  const std::vector<TileRun>& runs() const { return runs_; }
  float* tile(std::int32_t t) { return tiles_.data() + std::size_t(t) * floats_; }
  float* motion(std::int32_t t) { return motion_.data() + std::size_t(t) * kMotionFloats; }
  std::size_t bytes() const {
    return (tiles_.size() + motion_.size()) * sizeof(float) +
           home_.capacity() * sizeof(std::int32_t);
  }

 private:
  std::int32_t home_tile(const TileStore& store, std::size_t slot) const;

  int floats_ = 0;
  std::vector<TileRun> runs_;       ///< one per material
  std::vector<std::int32_t> home_;  ///< which lone block of the store, by slot
  AlignedFloats tiles_, motion_;
};

}  // namespace rend
