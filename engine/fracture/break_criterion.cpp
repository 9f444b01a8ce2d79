// One cheap sweep over all edges finds the few particles on which the dear test is worth while.
#include "engine/fracture/break_criterion.h"

#include "engine/core/parallel.h"

#include <algorithm>
#include <cmath>

namespace rend {

namespace {

constexpr Index chunk = 4096;

// tau_c0 / E, the elastic strain in uniaxial stress when yielding starts; 0 for a material that
// never yields.
Real yield_strain(const MaterialDesc& material) {
  const YieldSurface& surface = material.yield_surface;
  const auto tau_c = find_parameter(surface.type, "tau_c");
  if (!tau_c || !(material.youngs_modulus > 0)) return 0;
  // Von Mises measures the Frobenius norm of the deviator, sqrt(2/3) of the uniaxial stress.
  const Real uniaxial = yield_surface_name(surface.type) == "von_mises" ? std::sqrt(1.5) : 1;
  return uniaxial * surface.value[*tau_c] / material.youngs_modulus;
}

// Both ends of an edge remember the largest share.
void raise(std::vector<float>& nearness, Index a, Index b, Real share) {
  const float value = static_cast<float>(std::clamp(share, 0., 1.));
  nearness[a] = std::max(nearness[a], value);
  nearness[b] = std::max(nearness[b], value);
}

struct alignas(16) Point {
  float x, y, z, suspect;
};

}  // namespace

BreakCriterion::BreakCriterion(const SceneDesc& scene, const Model& model, const TetTables& tables)
    : tables_(&tables), material_(model.material), strength_(model.strength) {
  material_.resize(model.X.size(), 0);
  const std::size_t count =
      material_.empty() ? 1 : 1u + *std::max_element(material_.begin(), material_.end());
  yield_strain_.assign(std::max(count, scene.materials.size()), 0);
  settings_ = scene.fracture;
  set_materials(scene.materials);
}

void BreakCriterion::set_materials(const std::vector<MaterialDesc>& materials) {
  for (std::size_t m = 0; m < materials.size(); ++m) yield_strain_[m] = yield_strain(materials[m]);
  set(settings_);
}

void BreakCriterion::set(const FractureDesc& settings) {
  settings_ = settings;
  stretch_.resize(yield_strain_.size());
  for (std::size_t m = 0; m < stretch_.size(); ++m)
    stretch_[m] = settings.stretch.value_or(std::max(1.5, 1.3 * std::exp(yield_strain_[m])));
}

BreakCriterion::Suspects BreakCriterion::scan_edges(const Snapshot& snapshot,
                                                    const CrackMesh& crack) const {
  const TetTables& t = *tables_;
  const Index n = t.particle_count();
  const bool by_gap = settings_.break_test == BreakTest::gap;
  std::vector<Point> points(static_cast<std::size_t>(n));
  const Vec3 origin = n > 0 ? snapshot.x[n / 2] : Vec3::Zero();
  parallel_for(n, chunk, [&](Index p) {
    const Vec3f x = (snapshot.x[p] - origin).cast<float>();
    const bool damaged =
        (p < static_cast<Index>(snapshot.damage.size()) && snapshot.damage[p] > 0) ||
        (p < static_cast<Index>(snapshot.yielded.size()) && snapshot.yielded[p]);
    points[p] = {x.x(), x.y(), x.z(), damaged ? 1.f : 0.f};
  });
  std::vector<float> limit2(stretch_.size());
  for (std::size_t m = 0; m < limit2.size(); ++m) {
    const Real limit = (by_gap ? 2 : 1) * stretch_[m];
    limit2[m] = static_cast<float>(limit * limit);
  }
  const float* length2 = crack.edge_length2().data();
  std::vector<Suspects> parts(static_cast<std::size_t>((n + chunk - 1) / chunk));
  parallel_chunks(n, chunk, [&](Index begin, Index end) {
    Suspects& part = parts[begin / chunk];
    for (Index a = begin; a < end; ++a) {
      const Point pa = points[a];
      const float limit = limit2[material_[a]];
      for (Index e = t.edge_row[a]; e < t.edge_row[a + 1]; ++e) {
        const Point& pb = points[t.edge_to[e]];
        const float dx = pb.x - pa.x, dy = pb.y - pa.y, dz = pb.z - pa.z;
        const float l2 = dx * dx + dy * dy + dz * dz;
        // A broken edge has no positive length; one branch for both, for neither can be foretold.
        if ((std::fabs(l2 - length2[e]) > 0.2f * length2[e]) & (length2[e] > 0)) {
          if (by_gap && pa.suspect + pb.suspect > 0)
            part.strained.push_back({a, t.edge_to[e]});
          else if (l2 > limit * length2[e])
            part.broken.push_back(e);
          else if (!by_gap)
            part.strained.push_back({a, t.edge_to[e]});
        }
      }
    }
  });
  Suspects all;
  std::size_t strained = 0;
  for (const Suspects& part : parts) strained += part.strained.size();
  all.strained.reserve(strained);
  for (Suspects& part : parts) {
    all.broken.insert(all.broken.end(), part.broken.begin(), part.broken.end());
    all.strained.insert(all.strained.end(), part.strained.begin(), part.strained.end());
    part = {};
  }
  return all;
}

void BreakCriterion::find_gaps(const Snapshot& snapshot, const CrackMesh& crack,
                               const std::vector<Edge>& strained, RotationField& rotations,
                               Verdict& verdict) const {
  const TetTables& t = *tables_;
  std::vector<Index> looked_at;
  std::vector<Index> slot(t.X.size(), -1);  // in looked_at
  for (const Edge& e : strained)
    for (Index p : e)
      if (slot[p] < 0) slot[p] = 0, looked_at.push_back(p);
  std::sort(looked_at.begin(), looked_at.end());
  const auto damage = [&](Index p) { return snapshot.damage.empty() ? 0.f : snapshot.damage[p]; };
  const auto suspect = [&](Index p) {
    return damage(p) > 0 || (!snapshot.yielded.empty() && snapshot.yielded[p]);
  };
  const auto elastic_strain = [&](Index p) {
    const Real strength = strength_.empty() ? 1 : strength_[p];
    const Real bears = std::max(0.f, 1 - damage(p)) * strength * yield_strain_[material_[p]];
    return bears > 0 ? std::exp(bears) - 1 : 0;
  };
  // How matter moves at a particle while it holds together, and the strain that it bears.
  struct Whole {
    Mat3 M;
    Real strain;
  };
  std::vector<Whole> whole;
  const auto look_at = [&](std::size_t first) {
    const std::span<const Index> fresh(looked_at.begin() + static_cast<std::ptrdiff_t>(first),
                                       looked_at.end());
    rotations.fit_robust(fresh, snapshot.x, crack);
    whole.resize(looked_at.size());
    parallel_for(static_cast<Index>(fresh.size()), 256, [&](Index i) {
      const Index p = fresh[i];
      const Mat3 R = rotations.of(p).toRotationMatrix();
      const Real sound = std::clamp(1. - damage(p), 0., 1.);
      Whole& at = whole[first + i];
      at = {R, elastic_strain(p)};
      if (sound > 0) at.M += sound * (fit_affine_robust(p, snapshot.x, crack, R) - R);
    });
    for (std::size_t i = first; i < looked_at.size(); ++i)
      slot[looked_at[i]] = static_cast<Index>(i);
  };
  look_at(0);
  // Share of the allowed gap that an edge has used up.
  const auto share = [&](Index p, Index q, const Mat3& M, Real strain) {
    const Vec3 X = t.X[q] - t.X[p], expected = M * X;
    const Real length = X.norm(), gap = (snapshot.x[q] - snapshot.x[p] - expected).norm();
    const Real spread = std::max(1., expected.norm() / length);
    return gap / (settings_.gap * t.mean_edge[t.body[p]] * spread + strain * length);
  };
  // A neighbour across the crack may have kept the lengths of all its edges: the motion of this
  // side tells.
  const std::size_t marked = looked_at.size();
  for (std::size_t i = 0; i < marked; ++i)
    for (Index b : crack.linked(looked_at[i]))
      if (slot[b] < 0 &&
          share(looked_at[i], b, whole[i].M, std::min(whole[i].strain, elastic_strain(b))) > 1) {
        slot[b] = 0;
        looked_at.push_back(b);
      }
  look_at(marked);
  for (std::size_t i = 0; i < looked_at.size(); ++i) {
    const Index a = looked_at[i];
    for (Index e = t.edge_row[a]; e < t.edge_row[a + 1]; ++e) {
      const Index b = t.edge_to[e];
      if (slot[b] < 0 || crack.broken(e) || !(suspect(a) || suspect(b))) continue;
      const Whole& other = whole[slot[b]];
      const Real used =
          share(a, b, 0.5 * (whole[i].M + other.M), std::min(whole[i].strain, other.strain));
      if (used > 1)
        verdict.edges.push_back(e);
      else
        raise(verdict.nearness, a, b, used);
    }
  }
}

void BreakCriterion::find_stretch_shares(const Snapshot& snapshot,
                                         const std::vector<Edge>& strained,
                                         std::vector<float>& nearness) const {
  for (const auto& [a, b] : strained) {
    const Real length = (tables_->X[b] - tables_->X[a]).norm();
    const Real stretch = (snapshot.x[b] - snapshot.x[a]).norm() / length;
    raise(nearness, a, b, (stretch - 1) / (stretch_[material_[a]] - 1));
  }
}

BreakCriterion::Verdict BreakCriterion::find(const Snapshot& snapshot, const CrackMesh& crack,
                                             RotationField& rotations) const {
  Suspects suspects = scan_edges(snapshot, crack);
  Verdict verdict{std::move(suspects.broken), std::vector<float>(snapshot.x.size(), 0)};
  if (settings_.break_test == BreakTest::stretch)
    find_stretch_shares(snapshot, suspects.strained, verdict.nearness);
  else if (!suspects.strained.empty())
    find_gaps(snapshot, crack, suspects.strained, rotations, verdict);
  std::vector<Index>& edges = verdict.edges;
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return verdict;
}

}  // namespace rend
