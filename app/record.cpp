// Recorded particles.
#include "app/record.h"

#include "engine/core/error.h"

#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>
#include <type_traits>

namespace rend {

namespace {

constexpr std::uint64_t kMagic = 0x3230434552444e52ull;  // "RNDREC02"

std::uint64_t hash_bytes(const char* bytes, std::size_t count) {
  std::uint64_t hash = 0xcbf29ce484222325ull;
  for (std::size_t k = 0; k < count; ++k) hash = (hash ^ static_cast<unsigned char>(bytes[k])) * 0x100000001b3ull;
  return hash;
}

/// Appends to bytes.
class Writer {
 public:
  template <class T>
  void operator()(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    out.append(reinterpret_cast<const char*>(&value), sizeof(T));
  }
  void operator()(const Vec3& v) { out.append(reinterpret_cast<const char*>(v.data()), 3 * sizeof(Real)); }
  template <class T>
  void operator()(const std::vector<T>& values) {
    out.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
  }

  std::string out;
};

/// Takes from bytes; never reads past the end.
class Reader {
 public:
  Reader(const std::string& bytes, const std::string& file) : bytes_(bytes), file_(file) {}

  template <class T>
  void operator()(T& value) {
    take(&value, sizeof(T));
  }
  void operator()(Vec3& v) { take(v.data(), 3 * sizeof(Real)); }
  template <class T>
  void operator()(std::vector<T>& values) {
    take(values.data(), values.size() * sizeof(T));
  }

 private:
  void take(void* to, std::size_t count) {
    if (count > bytes_.size() - at_) throw Error(file_, "is cut short");
    std::memcpy(to, bytes_.data() + at_, count);
    at_ += count;
  }

  const std::string& bytes_;
  std::string file_;
  std::size_t at_ = 0;
};

/// Every number of a report, in one order for writing and reading.
template <class Archive, class Report>
void visit_report(Archive& archive, Report& r) {
  archive(r.frame), archive(r.time), archive(r.substeps), archive(r.dt_min), archive(r.dt_max);
  archive(r.sim_seconds), archive(r.particles), archive(r.mass), archive(r.momentum), archive(r.angular_momentum);
  archive(r.kinetic_energy), archive(r.elastic_energy), archive(r.gravity_energy), archive(r.dissipated_energy);
  archive(r.start_energy), archive(r.gravity_change), archive(r.affine_energy), archive(r.power), archive(r.friction_energy), archive(r.transfer_loss), archive(r.energy_turnover);
  archive(r.external_work), archive(r.max_speed), archive(r.yielded), archive(r.damaged), archive(r.state_hash);
}

template <class Archive, class S>
void visit_arrays(Archive& archive, S& s) {
  archive(s.x), archive(s.v), archive(s.damage), archive(s.stress), archive(s.yielded);
}

}  // namespace

std::uint64_t fingerprint(const Model& model) {
  return hash_bytes(reinterpret_cast<const char*>(model.X.data()), model.X.size() * sizeof(Vec3));
}

std::string encode_snapshot(const Snapshot& snapshot, std::uint64_t model_fingerprint) {
  Writer write;
  write(kMagic), write(model_fingerprint), write(static_cast<std::uint64_t>(snapshot.x.size()));
  visit_report(write, snapshot.report);
  visit_arrays(write, snapshot);
  write(hash_bytes(write.out.data(), write.out.size()));
  return std::move(write.out);
}

Snapshot read_snapshot(const std::filesystem::path& file, std::uint64_t model_fingerprint) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw Error(file.string(), "cannot be read");
  std::stringstream text;
  text << in.rdbuf();
  const std::string bytes = text.str();
  Reader read(bytes, file.string());
  std::uint64_t magic = 0, model = 0, count = 0;
  read(magic), read(model), read(count);
  if (magic != kMagic) throw Error(file.string(), "is not a recorded frame of this version of rend");
  std::uint64_t sum = 0;
  std::memcpy(&sum, bytes.data() + bytes.size() - sizeof(sum), sizeof(sum));
  if (sum != hash_bytes(bytes.data(), bytes.size() - sizeof(sum))) throw Error(file.string(), "is damaged (checksum)");
  if (model != model_fingerprint) throw Error(file.string(), "belongs to another scene or sampling");
  Snapshot snapshot;
  visit_report(read, snapshot.report);
  snapshot.x.resize(count), snapshot.v.resize(count), snapshot.damage.resize(count);
  snapshot.stress.resize(count), snapshot.yielded.resize(count);
  visit_arrays(read, snapshot);
  snapshot.frame = snapshot.report.frame;
  snapshot.time = snapshot.report.time;
  return snapshot;
}

}  // namespace rend
