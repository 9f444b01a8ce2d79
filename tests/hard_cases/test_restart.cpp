// Values that are not numbers, thread counts, restart and damaged state files (H12, H15, H16).
#include "engine/core/error.h"
#include "engine/core/parallel.h"
#include "engine/mpm/energy_balance.h"
#include "engine/mpm/state_file.h"
#include "tests/effort.h"
#include "tests/hard_cases/hard_run.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>

using namespace rend;

namespace {

constexpr Real kNaN = std::numeric_limits<Real>::quiet_NaN();

struct Case {
  const char* name;
  SceneDesc scene;
  Model model;
};

// A block that breaks up on a floor; a bar that two grips tear; debris that meets a spinning body.
std::vector<Case> three_scenes() {
  std::vector<Case> cases;
  SceneDesc floor = plain_scene();
  floor.gravity = Vec3(0, -1, 0);
  floor.materials[0] = with_surface(floor.materials[0], "rankine", 8, 20);
  floor.materials[0].damage.type = DamageType::granular;
  floor.colliders.push_back(plane(Vec3(0, 1, 0), Vec3(0, -2, 0), Contact::separate, 0.3));
  cases.push_back({"rubble", floor, block(Vec3i(7, 6, 7), Vec3(2, -6, 1)).model});

  SceneDesc bar = plain_scene();
  bar.materials[0] = with_surface(bar.materials[0], "von_mises", 6, 8);
  bar.materials[0].damage.type = DamageType::zero;
  bar.colliders = grips(4, 1.5, 4);
  cases.push_back({"torn bar", bar, block(Vec3i(16, 4, 4)).model});

  SceneDesc debris = plain_scene();
  debris.gravity = Vec3(0.1, -0.5, 0);
  MaterialDesc heavy = with_surface(debris.materials[0], "rankine", 20, 5);
  heavy.density = 3;
  debris.materials.push_back(heavy);
  LatticeModel bodies = block(Vec3i(6, 6, 6));
  bodies.spin(0, Vec3::Zero(), Vec3(0, 0, 3));
  Random random(4, 4);
  for (int n = 0; n < 30; ++n) {
    const Vec3 at(random.next(-12, 12), random.next(4, 9), random.next(-12, 12));
    bodies.add_box(at, Vec3i(1, 1, 1), 0.5, -0.6 * at, 0, 1);
  }
  cases.push_back({"debris", debris, bodies.model});
  return cases;
}

// A state file in memory, and what tests do to it.
struct StateBytes {
  static constexpr std::size_t kHeader = 56, kChecksum = 48;
  std::string bytes;

  explicit StateBytes(const Solver& solver) {
    std::ostringstream out;
    solver.save(out);
    bytes = out.str();
  }
  // Makes the checksum right again, as one who forges a file would.
  void sign() {
    const std::uint64_t sum = hash_bytes(hash_bytes(0, bytes.data(), kChecksum),
                                         bytes.data() + kHeader, bytes.size() - kHeader);
    std::memcpy(bytes.data() + kChecksum, &sum, sizeof(sum));
  }
};

void load(Solver& solver, const std::string& bytes) {
  std::istringstream in(bytes);
  solver.load(in);
}

}  // namespace

TEST_CASE("H12 a value that is not a number is found in its frame, with its particle and step") {
  struct Injection {
    const char* name;
    bool names_particle;
    std::function<void(Model&)> before;
    std::function<void(Solver&)> at;
  };
  const std::vector<Injection> injections = {
      {"v of particle 57", true, [](Model& m) { m.velocity[57][1] = kNaN; }, {}},
      {"v infinite", true, [](Model& m) { m.velocity[57][1] = 1e300 * 1e300; }, {}},
      {"velocity gradient", false, [](Model& m) { m.velocity_gradient[0](0, 1) = kNaN; }, {}},
      {"gravity, mid-run", false, {}, [](Solver& s) { s.set_gravity(Vec3(0, kNaN, 0)); }},
      {"pull, mid-run",
       false,
       {},
       [](Solver& s) {
         s.set_pull({Vec3::Zero(), Vec3(kNaN, 0, 0), 3});
       }},
  };
  for (const Injection& injection : injections)
    for (const SolverKind& kind : all_solvers()) {
      CAPTURE(injection.name);
      CAPTURE(kind.name);
      SceneDesc scene = plain_scene();
      Model model = block(Vec3i(6, 6, 6)).model;
      if (injection.before) injection.before(model);
      const auto solver = make(kind, scene, model);
      FrameReport good = solver->snapshot().report;
      if (injection.at) {
        good = solver->advance(0.1);
        REQUIRE(good.status == Status::ok);
        injection.at(*solver);
      }
      const FrameReport bad = solver->advance(0.1);
      CHECK(bad.status == Status::not_finite);
      CHECK(bad.culprit >= 0);
      if (injection.names_particle) CHECK(bad.culprit == 57);
      CHECK(bad.reason.find(fmt::format("Particle {} ", bad.culprit)) != std::string::npos);
      CHECK(bad.reason.find("step 1 of the frame") != std::string::npos);
      CHECK(solver->time() == good.time);
      CHECK(bad.state_hash == good.state_hash);
      if (injection.at) {
        solver->set_pull({});
        solver->set_gravity(Vec3::Zero());
        CHECK(solver->advance(0.1).status == Status::ok);
      }
      note("H12", fmt::format("NaN in {}", injection.name), kind.name,
           fmt::format("stops: {} in the same frame, step 1, particle {}", status_name(bad.status),
                       bad.culprit));
    }
  for (const SolverKind& kind : all_solvers()) {
    Model model = block(Vec3i(6, 6, 6)).model;
    model.X[57][2] = kNaN;
    CHECK_THROWS_WITH_AS(make(kind, plain_scene(), model), doctest::Contains("particle 57"), Error);
    note("H12", "NaN in x of particle 57", kind.name, "refused before the first step, names it");
  }
}

TEST_CASE("H15 H16 three scenes: the same bits for 1 to 4 threads, twice, and after a restart") {
  for (const Case& c : three_scenes())
    for (const SolverKind& kind : all_solvers()) {
      CAPTURE(c.name);
      CAPTURE(kind.name);
      constexpr int kFrames = 6;
      constexpr Real kFrame = 0.25;
      std::vector<FrameReport> first;
      std::vector<std::string> saved;
      for (const int threads : {1, 1, 2, 3, 4}) {
        set_thread_count(threads);
        const auto solver = make(kind, c.scene, c.model);
        for (std::size_t n = 0; n < kFrames; ++n) {
          const FrameReport r = solver->advance(kFrame);
          REQUIRE(r.status == Status::ok);
          if (first.size() == n) {
            first.push_back(r);
            saved.push_back(StateBytes(*solver).bytes);
          }
          CHECK(r.state_hash == first[n].state_hash);
          CHECK(r.dissipated_energy == first[n].dissipated_energy);
          CHECK(r.external_work == first[n].external_work);
          CHECK(r.transfer_loss == first[n].transfer_loss);
          CHECK(StateBytes(*solver).bytes == saved[n]);
        }
      }
      set_thread_count(0);
      CHECK(first.back().yielded > 0);
      for (std::size_t from = 0; from < kFrames; from += 2) {
        const auto solver = make(kind, c.scene, c.model);
        load(*solver, saved[from]);
        CHECK(solver->snapshot().report.state_hash == first[from].state_hash);
        CHECK(solver->snapshot().report.transfer_loss == first[from].transfer_loss);
        for (std::size_t n = from + 1; n < kFrames; ++n) {
          const FrameReport r = solver->advance(kFrame);
          CHECK(r.state_hash == first[n].state_hash);
          CHECK(r.substeps == first[n].substeps);
          CHECK(r.dissipated_energy == first[n].dissipated_energy);
          CHECK(r.transfer_loss == first[n].transfer_loss);
          CHECK(r.energy_turnover == first[n].energy_turnover);
          CHECK(StateBytes(*solver).bytes == saved[n]);
        }
      }
      note("H15, H16", fmt::format("{}: 1, 2, 3, 4 threads, twice, restart", c.name), kind.name,
           "same bits");
    }
}

TEST_CASE("H16 vector widths with fused arithmetic agree to the bit") {
  for (const Case& c : three_scenes()) {
    std::uint64_t hash = 0;
    for (const TileKernels* kernels : all_tile_kernels()) {
      if (std::string(kernels->name) == "sse4") continue;  // has no fused multiply-add
      const auto solver = make({kernels->name, kernels}, c.scene, c.model);
      const std::uint64_t now = solver->advance(1).state_hash;
      if (hash == 0) hash = now;
      CHECK(now == hash);
    }
  }
}

TEST_CASE("H16 damaged and forged state files are refused or harmless") {
  const Case c = three_scenes()[2];
  for (const SolverKind& kind : main_solvers()) {
    CAPTURE(kind.name);
    const auto writer = make(kind, c.scene, c.model);
    REQUIRE(writer->advance(0.5).status == Status::ok);
    const StateBytes good(*writer);
    const auto reader = make(kind, c.scene, c.model);
    const std::uint64_t untouched = reader->snapshot().report.state_hash;
    Random random(7, 7);
    const auto somewhere = [&](std::size_t from) {
      return from + static_cast<std::size_t>(random.next() *
                                             static_cast<Real>(good.bytes.size() - from - 1));
    };
    int refused = 0;
    const auto must_refuse = [&](const std::string& bytes) {
      CHECK_THROWS_AS(load(*reader, bytes), Error);
      ++refused;
    };
    for (std::size_t n = 0; n <= StateBytes::kHeader; ++n) must_refuse(good.bytes.substr(0, n));
    for (int n = 0; n < 100; ++n) must_refuse(good.bytes.substr(0, somewhere(0)));
    must_refuse(good.bytes + "x");
    for (int n = 0; n < 200; ++n) {
      StateBytes flipped = good;
      flipped.bytes[n < 56 ? static_cast<std::size_t>(n) : somewhere(StateBytes::kHeader)] ^=
          static_cast<char>(1 << (n % 8));
      must_refuse(flipped.bytes);
    }
    CHECK(reader->snapshot().report.state_hash == untouched);

    // Forged: the checksum is right, the contents are not. Refused, or it runs by the common rule.
    int ran = 0, turned_down = 0;
    const int forgeries = test::by_effort(150, 600, 20000);
    for (int n = 0; n < forgeries; ++n) {
      StateBytes forged = good;
      const int changes = 1 + n % 3;
      for (int k = 0; k < changes; ++k) {
        const std::size_t at = somewhere(StateBytes::kHeader);
        if (n % 2 == 0)
          forged.bytes[at] = static_cast<char>(random.next(0, 255));
        else
          for (std::size_t b = at; b < std::min(at + 8, forged.bytes.size()); ++b)
            forged.bytes[b] = static_cast<char>(random.next(0, 255));
      }
      forged.sign();
      const auto victim = make(kind, c.scene, c.model);
      try {
        load(*victim, forged.bytes);
      } catch (const Error&) {
        ++turned_down;
        CHECK(victim->advance(0.01).status == Status::ok);
        continue;
      }
      ++ran;
      const FrameReport r = victim->advance(0.02);
      CHECK((r.status == Status::ok || !r.reason.empty()));
      victim->snapshot();
    }
    note("H16", "damaged state files", kind.name,
         fmt::format(
             "{} of {} cut or flipped files refused; of {} forged ones {} refused, {} ran by the "
             "rules",
             refused, refused, forgeries, turned_down, ran));
  }
}
