// What the host hands to the vector kernels and back: plain data and function pointers only.
#pragma once

#include "engine/material/law_constants.h"

#include <cstdint>
#include <vector>

namespace rend {

// Lengths inside the tile solver are in cells, volumes in cells^3 and densities relative to a
// reference density; times and stresses are SI. Cells are centred on nodes; a block is 4^3 of them,
// [-0.5, 3.5)^3 around its origin.
inline constexpr int kLanes = 16;
inline constexpr int kNodeRowFloats = 8 * 4;  ///< 8 nodes along z, 3 momenta and the mass each
inline constexpr int kNodeTileFloats =
    64 * kNodeRowFloats + kLanes;                  ///< nodes -2..5 of a block, and a pad
inline constexpr int kGridBlockFloats = 64 * 4;    ///< 4^3 nodes, velocity and mass each
inline constexpr int kMotionFloats = 12 * kLanes;  ///< v and C of sixteen particles

/// FLIP keeps two numbers where other transfers keep one: the impulse of the step beside the
/// momentum of a node, the change beside its velocity.
constexpr int parts_of_node(bool flip) { return flip ? 2 : 1; }

/// Where the attributes of sixteen particles lie in a tile, in groups of sixteen floats. The first
/// ten are always there; the rest only when the scene needs them, and -1 otherwise.
struct TileLayout {
  static constexpr int kPosition = 0;  ///< x, y, z relative to the block
  static constexpr int kStrain = 3;    ///< b^e - I: xx yy zz xy yz zx
  static constexpr int kVolume =
      9;              ///< rest volume, negative once the particle has yielded, 0 in pad lanes
  int tau_c = -1;     ///< state of the material law, see material_response
  int tau_c0 = -1;    ///< initial threshold, when it varies in space and damage needs it
  int velocity = -1;  ///< of the particle, three groups; FLIP only
  int groups = 10;

  int floats() const { return groups * kLanes; }
};

/// One material as the kernels read it.
struct MaterialConstants {
  LawConstants<float> law;
  float density = 1;     ///< relative to the reference density
  float tau_c0 = 1;      ///< [Pa], unless the layout has one per particle
  int response = 0;      ///< index into the table of laws: 3 * yield surface + damage
  bool on_mesh = false;  ///< vertices of elements: no strain of their own, see TileMesh
};

/// Numbers of one step.
struct StepConstants {
  TileLayout layout;
  float dt = 0;             ///< of the motion [s]
  float stress_factor = 0;  ///< -4 dt' / (reference density dx^2), dt' of the next scatter
  float affine_keep = 1;    ///< particles carry keep C + swap C^T; stored C is that already
  float affine_swap = 0;
  float flip_ratio = 0;  ///< read by the FLIP kernels alone
  /// Velocities of nodes, and momenta on the way there, are relative to this one, which much of the
  /// matter has in common: then rounding takes its share of the differences only [cells/s].
  float common_velocity[4] = {0, 0, 0, 0};
};

/// A run of particles of one material in one block; 16 to a tile, the last tile padded.
struct ParticleRun {
  float* tiles = nullptr;
  float* motion = nullptr;  ///< v and C of each tile, kMotionFloats each
  const MaterialConstants* material = nullptr;
  std::int32_t count = 0;
};

/// Where sixteen particles of islands have their nodes, and how fast they were when the leg began.
struct alignas(64) IslandLanes {
  float origin[kLanes];  ///< index of the node at the origin of the particle's block
  float stride_x[kLanes], stride_y[kLanes];  ///< from node to node; 1 along z
  float velocity[3][kLanes];                 ///< [cells/s]
};

/// Particles of islands on nodes that no others share.
struct IslandTask {
  /// Sixteen particles. Those without `out` are ghosts, of another part of the same island: they
  /// add to the nodes that they have in common with this one.
  struct alignas(64) Tile {
    std::int32_t base[kLanes];  ///< for the kernel: first node of the stencil, and strides
    std::int32_t stride_x[kLanes], stride_y[kLanes];
    std::int32_t count = 0;  ///< particles
    const float* particles = nullptr;
    const float* motion = nullptr;
    const IslandLanes* lanes = nullptr;
    float* out = nullptr;  ///< v and C after the step, may be `motion`
    float density = 0;     ///< see MaterialConstants
  };
  Tile* tiles = nullptr;
  std::int32_t tile_count = 0;
  std::int32_t first_node = 0;  ///< index of nodes[0]
  std::int32_t node_count = 0;  ///< that stencils may begin at
  float* nodes = nullptr;       ///< 4 floats each, with room for a stencil more
  float fall[3] = {0, 0, 0};    ///< velocity that gravity has given since the leg began [cells/s]
  float strayed = 0;  ///< out: most that a velocity component differs from free fall [cells/s]
};

/// What a run reports after a pass.
struct RunExtremes {
  float speed2 = 0;          ///< max |v|^2 [cells^2/s^2]
  float gradient2 = 0;       ///< max |C|_F^2 [1/s^2]
  float least_stress = 0;    ///< min principal Kirchhoff stress, at most 0 [Pa]
  float dissipation = 0;     ///< let go in this step [Pa cells^3]
  std::int32_t clamped = 0;  ///< particles whose stretch was raised to kSmallestStretch
  bool finite = true;
};

/// One block's share of a pass over the particles.
struct BlockTask {
  const ParticleRun* runs = nullptr;
  RunExtremes* extremes = nullptr;  ///< one per run
  std::int32_t run_count = 0;
  const float* grid = nullptr;  ///< as GridTask leaves it, one grid block after the other
  const std::int32_t* neighbors =
      nullptr;            ///< 27 grid blocks, index 9 x + 3 y + z of offsets -1, 0, 1
  float low[3], high[3];  ///< bounds of the particles at the last re-bin
  /// out: touched node rows, one after the other; with FLIP each is followed by the row of the
  /// impulses of the next step, which the momenta then leave out
  float* rows = nullptr;
  std::uint64_t touched = 0;      ///< out: bit 8 x + y of every touched row
  std::uint64_t allowed = ~0ull;  ///< rows that `rows` has room for
  float excess = 0;               ///< out: farthest that a particle is beyond low or high
};

/// A block of particles that a grid block sums up.
struct RowSource {
  std::int32_t block = 0;     ///< index of the particle block
  std::int32_t neighbor = 0;  ///< index of this grid block in that block's neighbors
};

/// Node rows of all particle blocks, as the particle pass left them.
struct RowsOfBlock {
  const float* rows = nullptr;
  std::uint64_t touched = 0;
};

/// Sums, normalises and accelerates the nodes of one grid block.
struct GridTask {
  const RowSource* sources = nullptr;
  std::int32_t source_count = 0;
  const RowsOfBlock* blocks = nullptr;
  float velocity_gain[4] = {0, 0, 0, 0};    ///< dt g [cells/s]
  float common_velocity[4] = {0, 0, 0, 0};  ///< see StepConstants
  /// out: kGridBlockFloats, velocities without the common one; with FLIP as many more, the change
  /// of the velocities in this step
  float* nodes = nullptr;
  std::uint32_t touched = 0;  ///< out: bit 4 x + y of every row with mass
  float max_speed = 0;        ///< out: largest velocity component, the common one added [cells/s]
};

/// The passes over particles: scatter stored motion; gather, respond and scatter; gather, respond
/// and store. The last two are for blocks with vertices of elements, whose forces come in between.
enum class Pass { scatter, fused, gather, mesh_scatter, mesh_gather };

/// Where the attributes of sixteen elements lie in an element tile, in groups of sixteen floats.
struct ElementLayout {
  static constexpr int kMap = 0;      ///< B, the inverse of a reference shape, row major [1/cells]
  static constexpr int kPlastic = 9;  ///< C_p^-1 - I with b^e = (D B) C_p^-1 (D B)^T
  static constexpr int kVolume = 15;  ///< at rest [cells^3], negative once yielded, 0 in pad lanes
  static constexpr int kTauC = 16;    ///< state of the material law, see material_response
  static constexpr int kTauC0 = 17;
  static constexpr int kLightness = 18;  ///< see MeshElement
  static constexpr int kGroups = 19;
  static constexpr int kFloats = kGroups * kLanes;
  static constexpr int kCorners = 4 * kLanes;  ///< corner 0 of all sixteen, then corner 1, ...
  static constexpr int kPull = 9;  ///< per element: forces on corners 1, 2, 3 [Pa cells^2]
};

/// Up to four element tiles of one material.
struct ElementTask {
  const MaterialConstants* material = nullptr;
  const double* x = nullptr;  ///< positions by particle id [cells]
  const std::int32_t* corners = nullptr;
  float* tiles = nullptr;
  std::int32_t count = 0;  ///< elements, at most 64
  float* pull = nullptr;   ///< out
  float shape2 = 0;        ///< out: max of |sum_q g_q g_q^T| / lightness [1/cells^2]
  RunExtremes extremes;    ///< out
  std::uint64_t left = 0;  ///< out: flat or inverted elements, left to the caller
};

/// The kernels of one instruction set.
struct TileKernels {
  const char* name;  ///< "avx512", "avx2" or "sse4"
  /// By whether the transfer is FLIP, and by pass.
  void (*particles[2][5])(const StepConstants&, BlockTask&);
  /// The same passes for particles that share no node with others; gain is dt g [cells/s].
  void (*lone[3])(const StepConstants&, const ParticleRun&, const float* gain, RunExtremes&);
  /// The nodes' step of islands but for gravity; v and C are then as `lone` wants them.
  void (*islands)(IslandTask&);
  void (*grid[2])(GridTask&);  ///< by whether the transfer is FLIP
  /// Return mapping of tiles where they are, as a step of length 0 would do it.
  void (*respond)(const TileLayout&, const MaterialConstants&, float* tiles, int tile_count,
                  RunExtremes& extremes);
  /// Elastic energy density, largest principal stress [Pa] and, where `motion` is given, power of
  /// the stress [Pa/s] of `tiles` tiles of one material.
  void (*measure)(const TileLayout&, const MaterialConstants&, const float* tile, int tiles,
                  float* energy, float* stress, const float* motion, float* power);
  /// Return mapping of elements and the forces on their corners.
  void (*elements)(ElementTask&);
  /// Energy density and largest principal stress [Pa] of the same elements, as they are.
  void (*measure_elements)(ElementTask&, float* energy, float* stress);
};

/// Kernels of the best instruction set of this CPU, or of the one that the environment variable
/// REND_SIMD names: "avx512", "avx2" or "sse4". nullptr when there is none, or for any other name
/// ("none"): the reference solver runs.
const TileKernels* tile_kernels();

/// Kernels of every instruction set that this CPU can run, best first.
std::vector<const TileKernels*> all_tile_kernels();

}  // namespace rend
