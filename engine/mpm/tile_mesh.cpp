// Element tiles: filled once, evaluated every step, read once a frame.
#include "engine/mpm/tile_mesh.h"

#include "engine/core/parallel.h"
#include "engine/core/random.h"
#include "engine/core/small_matrix.h"
#include "engine/mpm/block_index.h"
#include "engine/mpm/time_step.h"

#include <Eigen/LU>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace rend {

namespace {

constexpr int kBatchElements = 64;
constexpr int kGroup = kLanes;
constexpr int kRow[6] = {0, 1, 2, 0, 1, 2}, kColumn[6] = {0, 1, 2, 1, 2, 0};

// C_p^-1 of a lane.
Mat3 plastic_of(const float* lane) {
  Mat3 C = Mat3::Identity();
  for (int i = 0; i < 6; ++i) {
    const Real value = lane[(ElementLayout::kPlastic + i) * kGroup];
    C(kRow[i], kColumn[i]) += value;
    if (i >= 3) C(kColumn[i], kRow[i]) += value;
  }
  return C;
}

void set_plastic(float* lane, const Mat3& C) {
  for (int i = 0; i < 6; ++i)
    lane[(ElementLayout::kPlastic + i) * kGroup] =
        static_cast<float>(C(kRow[i], kColumn[i]) - (i < 3 ? 1 : 0));
}

// A symmetric F_p^-1 with this C_p^-1: which one does not matter to an isotropic law.
Mat3 root_of(const Mat3& C) {
  const SymmetricEigen e = symmetric_eigen(C);
  return e.U * e.value.cwiseMax(1e-12).cwiseSqrt().asDiagonal() * e.U.transpose();
}

}  // namespace

TileMesh::Sums& TileMesh::Sums::operator+=(const Sums& other) {
  dissipation += other.dissipation;
  rate = std::max(rate, other.rate);
  clamped += other.clamped;
  return *this;
}

TileMesh::TileMesh(const SceneDesc& scene, const Model& model, std::vector<Law> laws)
    : dx_(scene.grid.dx), laws_(std::move(laws)) {
  MeshElements mesh(scene, model);
  if (mesh.empty()) return;
  on_mesh_ = std::move(mesh.on_mesh);
  const std::size_t count = mesh.elements.size();

  // One material after the other, neighbours in space near each other.
  std::vector<std::uint64_t> key(count);
  for (std::size_t e = 0; e < count; ++e) {
    const Vec3 at = model.X[static_cast<std::size_t>(mesh.elements[e].corner[0])] / dx_;
    key[e] = BlockIndex::key(at.array().floor().cast<int>());
  }
  std::vector<Index> sorted(count);
  std::iota(sorted.begin(), sorted.end(), 0);
  std::stable_sort(sorted.begin(), sorted.end(), [&](Index a, Index b) {
    const auto i = static_cast<std::size_t>(a), j = static_cast<std::size_t>(b);
    return std::pair(mesh.elements[i].material, key[i]) <
           std::pair(mesh.elements[j].material, key[j]);
  });
  order_.resize(count);
  for (std::size_t n = 0; n < count; ++n) {
    const MeshElement& element = mesh.elements[static_cast<std::size_t>(sorted[n])];
    if (batches_.empty() || batches_.back().material != element.material ||
        batches_.back().count == kBatchElements) {
      batches_.push_back({tile_count_, 0, element.material});
    }
    Batch& batch = batches_.back();
    if (batch.count % kLanes == 0) ++tile_count_;
    order_[static_cast<std::size_t>(sorted[n])] = batch.first_tile * kLanes + batch.count++;
  }

  const std::size_t floats = std::size_t(tile_count_) * ElementLayout::kFloats;
  tiles_.reserve(floats);
  std::fill(tiles_.data(), tiles_.data() + floats, 0.0f);
  corners_.resize(std::size_t(tile_count_) * ElementLayout::kCorners);
  pull_.assign(std::size_t(tile_count_) * kLanes * ElementLayout::kPull, 0.0f);
  x_.assign(3 * model.X.size(), 0.0);
  const auto place_element = [&](const MeshElement& element, std::size_t place, bool pad) {
    float* to = lane(static_cast<Index>(place));
    const Mat3 map = (dx_ * element.rest_inverse).cast<float>().cast<Real>();
    for (int i = 0; i < 9; ++i)
      to[(ElementLayout::kMap + i) * kGroup] = static_cast<float>(map(i / 3, i % 3));
    // The map is rounded; C_p^-1 starts with what that changes, so that rest is free of stress.
    const Mat3 F = (dx_ * element.rest_inverse).inverse() * map;
    set_plastic(to, (F.transpose() * F).inverse());
    const Real threshold = laws_[element.material].scalar.tau_c0 * element.strength;
    to[ElementLayout::kVolume * kGroup] =
        pad ? 0 : static_cast<float>(element.volume / (dx_ * dx_ * dx_));
    to[ElementLayout::kTauC * kGroup] = to[ElementLayout::kTauC0 * kGroup] =
        static_cast<float>(threshold);
    to[ElementLayout::kLightness * kGroup] = static_cast<float>(element.lightness);
    for (std::size_t k = 0; k < 4; ++k)
      corners_[place / kLanes * ElementLayout::kCorners + k * kLanes + place % kLanes] =
          element.corner[k];
  };
  for (std::size_t n = 0; n < count; ++n) {
    const auto e = static_cast<std::size_t>(sorted[n]);
    const auto place = static_cast<std::size_t>(order_[e]);
    place_element(mesh.elements[e], place, false);
    const bool last = n + 1 == count || order_[static_cast<std::size_t>(sorted[n + 1])] !=
                                            static_cast<Index>(place + 1);
    if (last)
      for (std::size_t p = place + 1; p % kLanes != 0; ++p)
        place_element(mesh.elements[e], p, true);
  }
  first_use_ = std::move(mesh.first_use);
  uses_ = std::move(mesh.uses);
  for (Index& use : uses_) use = 4 * order_[static_cast<std::size_t>(use / 4)] + use % 4;
}

float* TileMesh::lane(Index place) const {
  return tiles_.data() + std::size_t(place / kLanes) * ElementLayout::kFloats + place % kLanes;
}

ElementTask TileMesh::task(const Batch& batch) const {
  const auto first = static_cast<std::size_t>(batch.first_tile);
  ElementTask task;
  task.material = &laws_[batch.material].lanes;
  task.x = x_.data();
  task.corners = corners_.data() + first * ElementLayout::kCorners;
  task.tiles = tiles_.data() + first * ElementLayout::kFloats;
  task.count = batch.count;
  task.pull = pull_.data() + first * kLanes * ElementLayout::kPull;
  return task;
}

// One element, taken out of its tile.
struct TileMesh::Single {
  Index place;
  float* lane;
  MeshElement element;  // lengths in cells
  Mat3 D;

  float& at(int group) const { return lane[group * kGroup]; }
};

TileMesh::Single TileMesh::single(Index place, std::uint16_t material) const {
  Single out{place, lane(place), {}, {}};
  const std::int32_t* corner =
      corners_.data() + std::size_t(place / kLanes) * ElementLayout::kCorners + place % kLanes;
  MeshElement& element = out.element;
  for (int i = 0; i < 9; ++i) element.rest_inverse(i / 3, i % 3) = out.at(ElementLayout::kMap + i);
  element.volume = std::abs(out.at(ElementLayout::kVolume));
  element.lightness = out.at(ElementLayout::kLightness);
  element.material = material;
  const Real full = laws_[material].scalar.tau_c0;
  element.strength = full > 0 ? out.at(ElementLayout::kTauC0) / full : 1;
  const auto x = [&](int k) {
    const double* at = x_.data() + 3 * static_cast<std::size_t>(corner[k * kLanes]);
    return Vec3(at[0], at[1], at[2]);
  };
  for (int k = 0; k < 3; ++k) out.D.col(k) = x(k + 1) - x(0);
  return out;
}

template <class F>
void TileMesh::each_left(const Batch& batch, std::uint64_t left, F&& visit) const {
  for (; left; left &= left - 1)
    visit(single(batch.first_tile * kLanes + std::countr_zero(left), batch.material));
}

TileMesh::Sums TileMesh::evaluate(const TileKernels& kernels) {
  return ordered_sum(static_cast<Index>(batches_.size()), 1, Sums(), [&](Index b) {
    const Batch& batch = batches_[static_cast<std::size_t>(b)];
    const Law& law = laws_[batch.material];
    ElementTask now = task(batch);
    kernels.elements(now);
    const Real stiffness =
        wave_stiffness(law.scalar.lame.mu, law.scalar.lame.lambda, now.extremes.least_stress) /
        law.scalar.desc.density;
    Sums sums{now.extremes.dissipation, std::sqrt(now.shape2 * stiffness) / dx_, 0};
    each_left(batch, now.left, [&](const Single& one) {
      Mat3 plastic = root_of(plastic_of(one.lane));
      Real tau_c = one.at(ElementLayout::kTauC);
      const ElementUpdate update = update_element(law.scalar, one.element, one.D, plastic, tau_c);
      if (update.yielded && !update.clamped) set_plastic(one.lane, plastic * plastic.transpose());
      one.at(ElementLayout::kTauC) = static_cast<float>(tau_c);
      if (update.yielded) one.at(ElementLayout::kVolume) = static_cast<float>(-one.element.volume);
      float* pull = pull_.data() + std::size_t(one.place) * ElementLayout::kPull;
      for (int i = 0; i < 9; ++i) pull[i] = static_cast<float>(update.pull(i % 3, i / 3));
      sums += {one.element.volume * update.dissipation, update.rate / dx_, update.clamped};
    });
    return sums;
  });
}

Vec3 TileMesh::force(Index particle) const {
  const auto i = static_cast<std::size_t>(particle);
  Vec3 sum = Vec3::Zero();
  for (Index u = first_use_[i]; u < first_use_[i + 1]; ++u) {
    const Index use = uses_[static_cast<std::size_t>(u)];
    const float* pull = pull_.data() + std::size_t(use / 4) * ElementLayout::kPull;
    const int corner = use % 4;
    for (int a = 0; a < 3; ++a)
      sum[a] += corner > 0 ? Real{pull[3 * (corner - 1) + a]}
                           : -(Real{pull[a]} + Real{pull[3 + a]} + Real{pull[6 + a]});
  }
  return sum;
}

TileMesh::Measure TileMesh::measure(const TileKernels& kernels) const {
  Measure out;
  out.stress.resize(std::size_t(tile_count_) * kLanes);
  out.energy = ordered_sum(static_cast<Index>(batches_.size()), 1, 0.0, [&](Index b) {
    const Batch& batch = batches_[static_cast<std::size_t>(b)];
    const SolverMaterial& material = laws_[batch.material].scalar;
    alignas(64) float energy[kBatchElements], stress[kBatchElements];
    ElementTask now = task(batch);
    kernels.measure_elements(now, energy, stress);
    const Index first = batch.first_tile * kLanes;
    Real sum = 0;
    for (int i = 0; i < batch.count; ++i) {
      out.stress[static_cast<std::size_t>(first + i)] = stress[i];
      sum += Real{energy[i]} * std::abs(lane(first + i)[ElementLayout::kVolume * kGroup]);
    }
    each_left(batch, now.left, [&](const Single& one) {
      Mat3 plastic = root_of(plastic_of(one.lane));
      Real tau_c = one.at(ElementLayout::kTauC);
      sum +=
          one.element.volume * element_energy_density(material, one.element, one.D, plastic, tau_c);
      const ElementUpdate update = update_element(material, one.element, one.D, plastic, tau_c);
      out.stress[static_cast<std::size_t>(one.place)] =
          static_cast<float>(symmetric_eigen(update.tau).value.maxCoeff());
    });
    return sum;
  });
  return out;
}

VertexState TileMesh::at_vertex(const Measure& measure, Index particle) const {
  VertexState out;
  const auto i = static_cast<std::size_t>(particle);
  for (Index u = first_use_[i]; u < first_use_[i + 1]; ++u) {
    const Index place = uses_[static_cast<std::size_t>(u)] / 4;
    const float* at = lane(place);
    // Batches are of one material and found by their first tile.
    const auto batch =
        std::upper_bound(batches_.begin(), batches_.end(), place / kLanes,
                         [](std::int32_t tile, const Batch& b) { return tile < b.first_tile; });
    const Real tau_c = at[ElementLayout::kTauC * kGroup];
    out.add(tau_c, at[ElementLayout::kTauC0 * kGroup],
            element_is_damaged(laws_[std::prev(batch)->material].scalar, tau_c),
            std::signbit(at[ElementLayout::kVolume * kGroup]),
            measure.stress[static_cast<std::size_t>(place)]);
  }
  return out;
}

void TileMesh::set_law(std::size_t material, Law law) {
  const Real before = laws_[material].scalar.tau_c0, now = law.scalar.tau_c0;
  laws_[material] = std::move(law);
  for (const Batch& batch : batches_) {
    if (batch.material != material) continue;
    for (int i = 0; i < batch.count; ++i) {
      float* at = lane(batch.first_tile * kLanes + i);
      float& tau_c = at[ElementLayout::kTauC * kGroup];
      float& tau_c0 = at[ElementLayout::kTauC0 * kGroup];
      const Real strength = before > 0 ? tau_c0 / before : 1;
      tau_c0 = static_cast<float>(now * strength);
      if (tau_c > 0 || before == 0)
        tau_c = before > 0 ? static_cast<float>(tau_c * (now / before)) : tau_c0;
    }
  }
}

std::vector<TileMesh::Element> TileMesh::elements() const {
  std::vector<Element> by_place(std::size_t(tile_count_) * kLanes);
  for (const Batch& batch : batches_)
    for (Index place = batch.first_tile * kLanes, i = 0; i < batch.count; ++i, ++place) {
      const Single one = single(place, batch.material);
      const Mat3 F = one.D * one.element.rest_inverse;
      by_place[static_cast<std::size_t>(place)] = {
          F * plastic_of(one.lane) * F.transpose() - Mat3::Identity(),
          one.at(ElementLayout::kTauC)};
    }
  std::vector<Element> out;
  for (const Index place : order_) out.push_back(by_place[static_cast<std::size_t>(place)]);
  return out;
}

TileMesh::State TileMesh::state() const {
  return {std::vector<float>(tiles_.data(),
                             tiles_.data() + std::size_t(tile_count_) * ElementLayout::kFloats),
          pull_};
}

bool TileMesh::fits(const State& state) const {
  return state.tiles.size() == std::size_t(tile_count_) * ElementLayout::kFloats &&
         state.pull.size() == pull_.size();
}

void TileMesh::restore(const State& state) {
  std::copy(state.tiles.begin(), state.tiles.end(), tiles_.data());
  pull_ = state.pull;
}

std::uint64_t TileMesh::hash() const {
  std::uint64_t hash = 0;
  const std::size_t floats = std::size_t(tile_count_) * ElementLayout::kFloats;
  for (std::size_t i = 0; i < floats; ++i)
    hash = mix_bits(hash ^ std::bit_cast<std::uint32_t>(tiles_.data()[i]));
  return hash;
}

double TileMesh::bytes() const {
  return static_cast<double>(tiles_.size() * sizeof(float) + pull_.size() * sizeof(float) +
                             x_.size() * sizeof(double) +
                             (order_.size() + first_use_.size() + uses_.size()) * sizeof(Index) +
                             corners_.size() * sizeof(std::int32_t) + on_mesh_.size());
}

}  // namespace rend
