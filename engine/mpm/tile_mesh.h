// Elements of the tile solver: sixteen to a tile, forces on the particles at their corners.
#pragma once

#include "engine/core/aligned_floats.h"
#include "engine/mpm/mesh_elements.h"
#include "engine/mpm/tile_kernel.h"

#include <vector>

namespace rend {

/// What MeshForce is to the reference solver. Lengths are in cells. Elements remember b^e through
/// C_p^-1, which needs no rotation: b^e = F C_p^-1 F^T, so that the laws of the particles apply as
/// they are. Flat and inverted elements go one by one through update_element.
class TileMesh {
 public:
  /// One material for both paths.
  struct Law {
    SolverMaterial scalar;
    MaterialConstants lanes;
  };

  /// @throws Error as MeshElements.
  TileMesh(const SceneDesc& scene, const Model& model, std::vector<Law> laws);

  bool empty() const { return order_.empty(); }
  bool carries(Index particle) const {
    return !on_mesh_.empty() && on_mesh_[static_cast<std::size_t>(particle)] != 0;
  }
  Index element_count() const { return static_cast<Index>(order_.size()); }

  /// Where the caller writes the position of every vertex [cells] before evaluate().
  double* position(Index particle) { return x_.data() + 3 * static_cast<std::size_t>(particle); }

  struct Sums {
    Real dissipation = 0;  ///< [Pa cells^3]
    Real rate = 0;         ///< see MeshForce [1/s]
    Index clamped = 0;
    Sums& operator+=(const Sums& other);
  };
  Sums evaluate(const TileKernels& kernels);

  /// Force of the last evaluation on a vertex [Pa cells^2].
  Vec3 force(Index particle) const;

  /// Energy and largest stress of the elements at the positions of the last evaluation.
  struct Measure {
    Real energy = 0;            ///< sum [Pa cells^3]
    std::vector<float> stress;  ///< per element place [Pa]
  };
  Measure measure(const TileKernels& kernels) const;
  /// @pre `measure` is of the present state.
  VertexState at_vertex(const Measure& measure, Index particle) const;

  /// Thresholds that have softened scale with the new tau_c0.
  void set_law(std::size_t material, Law law);

  /// Stored strain of one element in the order of MeshElements, for comparisons.
  struct Element {
    Mat3 elastic_strain;  ///< b^e - I
    Real tau_c;
  };
  std::vector<Element> elements() const;

  /// Everything that save() must keep.
  struct State {
    std::vector<float> tiles, pull;
  };
  State state() const;
  bool fits(const State& state) const;
  void restore(const State& state);
  std::uint64_t hash() const;
  double bytes() const;

 private:
  struct Batch {
    std::int32_t first_tile, count;  // elements of one material, at most kBatchElements
    std::uint16_t material;
  };

  ElementTask task(const Batch& batch) const;
  struct Single;
  Single single(Index place, std::uint16_t material) const;
  // Calls visit(Single) for the elements that the kernels left.
  template <class F>
  void each_left(const Batch& batch, std::uint64_t left, F&& visit) const;
  float* lane(Index place) const;

  Real dx_;
  std::vector<Law> laws_;
  std::vector<Batch> batches_;
  std::vector<Index> order_;  // place of element e of MeshElements
  std::vector<std::uint8_t> on_mesh_;
  std::vector<Index> first_use_;
  std::vector<Index> uses_;  // 4 * place + corner
  std::vector<std::int32_t> corners_;
  std::vector<double> x_;
  mutable AlignedFloats tiles_;  // kernels read and write through one task
  mutable std::vector<float> pull_;
  std::int32_t tile_count_ = 0;
};

}  // namespace rend
