// Sweeps over flat arrays; the only scattered access is to carriers of copies and to corners of
// triangles, and each of those is gathered into one place first.
#include "engine/fracture/surface_builder.h"

#include "engine/core/parallel.h"
#include "engine/core/stopwatch.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <memory>

namespace rend {

namespace {

constexpr Index grain = 4096;
constexpr std::size_t ahead = 8;  // tets to fetch in advance
constexpr Index carriers_ahead = 8;
// |sum of normals| / sum of |normals| below which a vertex lies on a fold: skin at about 74
// degrees, crack faces, which would look like confetti, only where they nearly turn back.
constexpr float skin_fold = 0.8f, crack_fold = 0.45f;

// What a particle lends to the copies that it carries, gathered once, in two cache lines.
struct alignas(64) Carrier {
  Mat3 R;
  Vec3 t;  // x - R X
  float damage, stress, speed, nearness;
};

// What triangles want to know of a vertex, in half a cache line.
struct alignas(32) Corner {
  Vec3f x;                 // from the origin of the sweep
  Index piece;             // its complement where crack faces do not count for the normal
  Eigen::Vector4f normal;  // sum, and sum of lengths
};

// Values that are all written before they are read.
template <class T>
class Buffer {
 public:
  void make_room(std::size_t count) {
    if (count <= room_) return;
    room_ = 0;
    values_.reset();
    values_ = std::make_unique_for_overwrite<T[]>(count + count / 4);
    room_ = count + count / 4;
  }
  T& operator[](std::size_t i) const { return values_[i]; }
  std::size_t bytes() const { return room_ * sizeof(T); }

 private:
  std::size_t room_ = 0;
  std::unique_ptr<T[]> values_;
};

}  // namespace

struct SurfaceScratch::Buffers {
  Buffer<Carrier> carriers;  // by slot of the rotations
  Buffer<Corner> corners;    // by vertex
  Buffer<Index> vertex_of_corner;
};

SurfaceScratch::SurfaceScratch() : buffers_(std::make_unique<Buffers>()) {}
SurfaceScratch::~SurfaceScratch() = default;
std::size_t SurfaceScratch::bytes() const {
  return buffers_->carriers.bytes() + buffers_->corners.bytes() +
         buffers_->vertex_of_corner.bytes();
}

class SurfaceBuilder {
 public:
  SurfaceBuilder(const CrackMesh& crack, const Pieces& pieces, const RotationField& rotations,
                 const std::vector<std::uint8_t>& crease, const Snapshot& snapshot,
                 const std::vector<float>& nearness, Index smallest_piece, SurfaceMesh& surface,
                 SurfaceScratch& scratch)
      : crack_(crack),
        tables_(crack.tables()),
        pieces_(pieces),
        rotations_(rotations),
        crease_(crease),
        now_(snapshot),
        nearness_(nearness),
        out_(surface),
        carriers_(scratch.buffers_->carriers),
        corners_(scratch.buffers_->corners),
        vertex_of_corner_(scratch.buffers_->vertex_of_corner),
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
    vertex_count_ = skin_vertices_ + static_cast<Index>(copies.size());
    if (dense_) return;
    vertex_of_corner_.make_room(static_cast<std::size_t>(vertex_count_));
    vertex_count_ = 0;
    for (Index v = 0; v < skin_vertices_; ++v)
      vertex_of_corner_[v] = hidden(tables_.skin_particle[v]) ? -1 : vertex_count_++;
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
    corners_.make_room(static_cast<std::size_t>(vertex_count_));
    if (!now_.x.empty()) origin_ = now_.x[now_.x.size() / 2];
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
      set_corner(v, p, true);
    });
  }

  // Skin and crack faces do not average over their rim: there, the skin decides.
  void set_corner(Index v, Index particle, bool skin_only) {
    const Index piece = pieces_.of(particle);
    corners_[v] = {(out_.x[v] - origin_).cast<float>(), skin_only ? ~piece : piece,
                   Eigen::Vector4f::Zero()};
  }

  void prefetch_carriers(const VertexCopy& copy) const {
    for (const Index p : copy.member) {
      if (p < 0) return;
      const auto* carrier =
          reinterpret_cast<const char*>(&carriers_[std::max(rotations_.slot(p), 0)]);
      __builtin_prefetch(carrier);
      __builtin_prefetch(carrier + 64);
    }
  }

  void place_copies() {
    const auto& near = crack_.near_crack();
    carriers_.make_room(static_cast<std::size_t>(rotations_.slot_count()));
    parallel_for(static_cast<Index>(near.size()), grain, [&](Index i) {
      const Index p = near[i];
      const Mat3 R = rotations_.of(p).toRotationMatrix();
      carriers_[rotations_.slot(p)] = {
          R, now_.x[p] - R * tables_.X[p], damage(p), stress(p), speed(p), nearness(p)};
    });
    const auto& copies = crack_.copies();
    const auto count = static_cast<Index>(copies.size());
    parallel_for(count, grain, [&](Index c) {
      if (c + carriers_ahead < count) prefetch_carriers(copies[c + carriers_ahead]);
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
        if (copy.tip) {
          x += now_.x[p];
          d += damage(p), s += stress(p), w += speed(p), n += nearness(p);
        } else {
          const Carrier& carrier = carriers_[rotations_.slot(p)];
          x += carrier.R * rest + carrier.t;
          d += carrier.damage, s += carrier.stress, w += carrier.speed, n += carrier.nearness;
        }
      }
      const float share = 1.f / static_cast<float>(members);
      out_.x[v] = x / members;
      out_.damage[v] = d * share;
      out_.stress[v] = s * share;
      out_.speed[v] = w * share;
      out_.nearness[v] = n * share;
      set_corner(v, copy.member[0], copy.on_skin);
    });
  }

  // One sweep over the triangles: while their corners are at hand, their normals are summed up.
  void write_triangles() {
    std::size_t count = 0;
    for (const auto& cut : crack_.skin_cuts())
      count += cut.triangles.count > 0 ? cut.triangles.count : 1;
    for (const auto& cracked : crack_.cracked()) count += cracked.triangles.count;
    out_.triangles.resize(count);
    out_.piece.resize(count);
    Index at = 0;
    const auto add = [&](const Triangle& corner, bool interior) {
      const Triangle t{vertex(corner[0]), vertex(corner[1]), vertex(corner[2])};
      if (t[0] < 0) return;
      Corner &a = corners_[t[0]], &b = corners_[t[1]], &c = corners_[t[2]];
      out_.triangles[at] = t;
      out_.piece[at++] = a.piece < 0 ? ~a.piece : a.piece;
      const Vec3f n = (b.x - a.x).cross(c.x - a.x);
      const Eigen::Vector4f weighted(n.x(), n.y(), n.z(), n.norm());
      if (!interior || a.piece >= 0) a.normal += weighted;
      if (!interior || b.piece >= 0) b.normal += weighted;
      if (!interior || c.piece >= 0) c.normal += weighted;
    };
    for (Index i = 0; i < tables_.skin_count(); ++i) {
      const auto& range = crack_.skin_cuts()[i].triangles;
      if (range.count == 0) add(tables_.skin_uncut[i], false);
      for (const CutTriangle& t : crack_.triangles_of(range)) add(t, false);
    }
    const Index skin_triangles = at;
    const auto& cracked = crack_.cracked();
    for (std::size_t i = 0; i < cracked.size(); ++i) {
      // Tets cracked one after the other need not have been cut in that order.
      if (i + ahead < cracked.size())
        __builtin_prefetch(crack_.triangles_of(cracked[i + ahead].triangles).data());
      for (const CutTriangle& t : crack_.triangles_of(cracked[i].triangles)) add(t, true);
    }
    out_.triangles.resize(static_cast<std::size_t>(at));
    out_.piece.resize(static_cast<std::size_t>(at));
    out_.interior.assign(static_cast<std::size_t>(at), 1);
    std::fill_n(out_.interior.begin(), skin_triangles, std::uint8_t(0));
  }

  void write_normals() {
    parallel_for(vertex_count_, grain, [&](Index v) {
      const Eigen::Vector4f& sum = corners_[v].normal;
      const Vec3f n = sum.head<3>();
      const float length = n.norm();
      const float fold = corners_[v].piece < 0 ? skin_fold : crack_fold;
      if (length < fold * sum[3]) out_.crease[v] = 1;
      out_.normal[v] = length > 0 ? Vec3f(n / length) : Vec3f::UnitY();
    });
  }

  const CrackMesh& crack_;
  const TetTables& tables_;
  const Pieces& pieces_;
  const RotationField& rotations_;
  const std::vector<std::uint8_t>& crease_;
  const Snapshot& now_;
  const std::vector<float>& nearness_;
  SurfaceMesh& out_;
  Buffer<Carrier>& carriers_;
  Buffer<Corner>& corners_;
  Buffer<Index>& vertex_of_corner_;
  Index skin_vertices_;
  Index vertex_count_ = 0;
  bool dense_ = true;
  bool any_hidden_ = false;
  std::vector<std::uint8_t> hidden_;  // by piece id
  Vec3 origin_ = Vec3::Zero();        // near the vertices, so that floats are good for differences
};

void build_surface(const CrackMesh& crack, const Pieces& pieces, const RotationField& rotations,
                   const std::vector<std::uint8_t>& crease, const Snapshot& snapshot,
                   const std::vector<float>& nearness, Index smallest_piece, SurfaceMesh& surface,
                   SurfaceScratch& scratch, SurfaceTimes* times) {
  const SurfaceTimes spent = SurfaceBuilder(crack, pieces, rotations, crease, snapshot, nearness,
                                            smallest_piece, surface, scratch)
                                 .run();
  if (times) *times = spent;
}

}  // namespace rend
