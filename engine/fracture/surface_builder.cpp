// Sweeps over flat arrays; the only scattered access is to particles and their rotations.
#include "engine/fracture/surface_builder.h"

#include "engine/core/parallel.h"
#include "engine/core/stopwatch.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace rend {

namespace {

constexpr Index grain = 4096;
// |sum of normals| / sum of |normals| below which a vertex lies on a fold: skin at about 74
// degrees, crack faces, which would look like confetti, only where they nearly turn back.
constexpr float skin_fold = 0.8f, crack_fold = 0.45f;

struct RigidMotion {
  Mat3 R;
  Vec3 x, X;
  Vec3 operator()(const Vec3& rest) const { return x + R * (rest - X); }
};

class Builder {
 public:
  Builder(const CrackMesh& crack, const Pieces& pieces, const RotationField& rotations,
          const std::vector<std::uint8_t>& crease, const Snapshot& snapshot,
          const std::vector<float>& nearness, Index smallest_piece, SurfaceMesh& surface)
      : crack_(crack),
        tables_(crack.tables()),
        pieces_(pieces),
        rotations_(rotations),
        crease_(crease),
        now_(snapshot),
        nearness_(nearness),
        out_(surface),
        skin_vertices_(static_cast<Index>(tables_.skin_particle.size())) {
    if (smallest_piece > 1) find_hidden(smallest_piece);
  }

  SurfaceTimes run() {
    const Real start = cpu_seconds();
    number_vertices();
    size_vertices();
    place_skin();
    place_copies();
    const Real placed = cpu_seconds();
    write_triangles();
    const Real written = cpu_seconds();
    write_normals();
    return {placed - start, written - placed, cpu_seconds() - written};
  }

 private:
  void find_hidden(Index smallest_piece) {
    const std::vector<Index> size = pieces_.sizes();
    const Index largest = *std::max_element(size.begin(), size.end());
    hidden_.resize(size.size());
    for (std::size_t id = 0; id < size.size(); ++id) {
      hidden_[id] = size[id] > 0 && size[id] < std::min(smallest_piece, largest);
      any_hidden_ |= hidden_[id] != 0;
    }
  }

  bool hidden(Index particle) const { return any_hidden_ && hidden_[pieces_.of(particle)]; }

  void number_vertices() {
    const auto& copies = crack_.copies();
    dense_ = crack_.free_copies().empty() && !any_hidden_;
    shown_skin_ = skin_vertices_;
    vertex_count_ = skin_vertices_ + static_cast<Index>(copies.size());
    if (dense_) return;
    vertex_of_corner_.resize(static_cast<std::size_t>(vertex_count_));
    vertex_count_ = 0;
    for (Index v = 0; v < skin_vertices_; ++v)
      vertex_of_corner_[v] = hidden(tables_.skin_particle[v]) ? -1 : vertex_count_++;
    shown_skin_ = vertex_count_;
    for (std::size_t c = 0; c < copies.size(); ++c)
      vertex_of_corner_[skin_vertices_ + c] =
          copies[c].node < 0 || hidden(copies[c].member[0]) ? -1 : vertex_count_++;
  }

  /// -1 for a corner that is not shown.
  Index vertex(Index corner) const { return dense_ ? corner : vertex_of_corner_[corner]; }

  void size_vertices() {
    out_.x.resize(vertex_count_);
    out_.rest.resize(vertex_count_);
    out_.normal.resize(vertex_count_);
    out_.damage.resize(vertex_count_);
    out_.stress.resize(vertex_count_);
    out_.speed.resize(vertex_count_);
    out_.nearness.resize(vertex_count_);
    out_.crease.resize(vertex_count_);
  }

  float damage(Index p) const { return now_.damage.empty() ? 0 : now_.damage[p]; }
  float stress(Index p) const { return now_.stress.empty() ? 0 : now_.stress[p]; }
  float nearness(Index p) const { return nearness_.empty() ? 0 : nearness_[p]; }
  float speed(Index p) const { return now_.v.empty() ? 0 : now_.v[p].norm(); }

  void place_skin() {
    parallel_for(skin_vertices_, grain, [&](Index corner) {
      const Index p = tables_.skin_particle[corner], v = vertex(corner);
      if (v < 0) return;
      out_.x[v] = now_.x[p];
      out_.rest[v] = tables_.X[p];
      out_.damage[v] = damage(p);
      out_.stress[v] = stress(p);
      out_.speed[v] = speed(p);
      out_.nearness[v] = nearness(p);
      out_.crease[v] = crease_.empty() ? 0 : crease_[p];
    });
  }

  void place_copies() {
    const auto& near = crack_.near_crack();
    motion_.resize(static_cast<std::size_t>(rotations_.slot_count()));
    parallel_for(static_cast<Index>(near.size()), grain, [&](Index i) {
      const Index p = near[i];
      motion_[rotations_.slot(p)] = {rotations_.of(p).toRotationMatrix(), now_.x[p], tables_.X[p]};
    });
    const auto& copies = crack_.copies();
    parallel_for(static_cast<Index>(copies.size()), grain, [&](Index c) {
      const VertexCopy& copy = copies[c];
      const Index v = vertex(skin_vertices_ + c);
      if (v < 0) return;
      const Vec3& rest = crack_.nodes()[copy.node];
      out_.rest[v] = rest;
      out_.crease[v] = copy.on_skin;
      Vec3 x = Vec3::Zero();
      float d = 0, s = 0, w = 0, n = 0;
      int members = 0;
      for (; members < 4 && copy.member[members] >= 0; ++members) {
        const Index p = copy.member[members];
        x += copy.tip ? now_.x[p] : motion_[rotations_.slot(p)](rest);
        d += damage(p), s += stress(p), w += speed(p), n += nearness(p);
      }
      const float share = 1.f / static_cast<float>(members);
      out_.x[v] = x / members;
      out_.damage[v] = d * share;
      out_.stress[v] = s * share;
      out_.speed[v] = w * share;
      out_.nearness[v] = n * share;
    });
  }

  void write_triangles() {
    std::size_t count = 0;
    for (const auto& cut : crack_.skin_cuts())
      count += cut.triangles.count > 0 ? cut.triangles.count : 1;
    for (const auto& cracked : crack_.cracked()) count += cracked.triangles.count;
    out_.triangles.resize(count);
    out_.piece.resize(count);
    Index at = 0;
    const auto add = [&](const Triangle& t, Index particle) {
      if (hidden(particle)) return;
      out_.piece[at] = pieces_.of(particle);
      out_.triangles[at++] = {vertex(t[0]), vertex(t[1]), vertex(t[2])};
    };
    const auto write = [&](const CrackMesh::Range& range) {
      for (const CutTriangle& t : crack_.triangles_of(range)) add(t, crack_.particle_of(t[0]));
    };
    for (Index i = 0; i < tables_.skin_count(); ++i) {
      const auto& range = crack_.skin_cuts()[i].triangles;
      if (range.count > 0)
        write(range);
      else
        add(tables_.skin_uncut[i], tables_.skin_particle[tables_.skin_uncut[i][0]]);
    }
    skin_triangles_ = at;
    for (const auto& cracked : crack_.cracked()) write(cracked.triangles);
    out_.triangles.resize(static_cast<std::size_t>(at));
    out_.piece.resize(static_cast<std::size_t>(at));
    out_.interior.assign(static_cast<std::size_t>(at), 1);
    std::fill_n(out_.interior.begin(), skin_triangles_, std::uint8_t(0));
  }

  // Skin and crack faces do not average over their rim: there, the skin decides and the corner is
  // marked.
  void write_normals() {
    std::vector<Eigen::Vector4f> sum(static_cast<std::size_t>(vertex_count_),
                                     Eigen::Vector4f::Zero());
    const auto add = [&](Index triangle, bool interior) {
      const Triangle& t = out_.triangles[triangle];
      const Vec3& a = out_.x[t[0]];
      const Vec3f u = (out_.x[t[1]] - a).cast<float>(), v = (out_.x[t[2]] - a).cast<float>();
      const Vec3f n = u.cross(v);
      const Eigen::Vector4f weighted(n.x(), n.y(), n.z(), n.norm());
      for (Index k : t)
        if (!interior || (k >= shown_skin_ && !on_rim(k))) sum[k] += weighted;
    };
    for (Index i = 0; i < skin_triangles_; ++i) add(i, false);
    rim_known_ = true;
    for (Index i = skin_triangles_; i < out_.triangle_count(); ++i) add(i, true);
    parallel_for(vertex_count_, grain, [&](Index v) {
      const Vec3f n = sum[v].head<3>();
      const float length = n.norm();
      const float fold = v < shown_skin_ || out_.crease[v] ? skin_fold : crack_fold;
      if (length < fold * sum[v][3]) out_.crease[v] = 1;
      out_.normal[v] = length > 0 ? Vec3f(n / length) : Vec3f::UnitY();
    });
  }

  // Before normals are written, only rims carry the mark among the copies.
  bool on_rim(Index v) const { return rim_known_ && out_.crease[v]; }

  const CrackMesh& crack_;
  const TetTables& tables_;
  const Pieces& pieces_;
  const RotationField& rotations_;
  const std::vector<std::uint8_t>& crease_;
  const Snapshot& now_;
  const std::vector<float>& nearness_;
  SurfaceMesh& out_;
  Index skin_vertices_;
  Index shown_skin_ = 0;
  Index vertex_count_ = 0;
  Index skin_triangles_ = 0;
  bool dense_ = true;
  bool any_hidden_ = false;
  bool rim_known_ = false;
  std::vector<std::uint8_t> hidden_;  // by piece id
  std::vector<Index> vertex_of_corner_;
  std::vector<RigidMotion> motion_;
};

}  // namespace

void build_surface(const CrackMesh& crack, const Pieces& pieces, const RotationField& rotations,
                   const std::vector<std::uint8_t>& crease, const Snapshot& snapshot,
                   const std::vector<float>& nearness, Index smallest_piece, SurfaceMesh& surface,
                   SurfaceTimes* times) {
  const SurfaceTimes spent =
      Builder(crack, pieces, rotations, crease, snapshot, nearness, smallest_piece, surface).run();
  if (times) *times = spent;
}

}  // namespace rend
