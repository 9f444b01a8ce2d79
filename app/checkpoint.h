// Checkpoints of a run (checkpoint/000040.bin): the exact state of the solver after a frame, from which
// `rend run --resume` goes on with the same bits.
#pragma once

#include "engine/core/types.h"
#include "engine/scene/scene_desc.h"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace rend {

/// A hash of all of a scene that decides how it moves and breaks; not of its length, camera and colours.
std::uint64_t motion_hash(const SceneDesc& scene);

struct Checkpoint {
  Index frame = 0;
  std::string state;  ///< as Solver::save() wrote it
};

/// Writes checkpoint/FRAME.bin of a run directory so that a power cut leaves it whole or absent, and drops all but
/// the two newest. @throws Error when the disk refuses.
void write_checkpoint(const std::filesystem::path& run_directory, const Checkpoint& checkpoint,
                      std::uint64_t scene_hash);

/// @throws Error naming the file when it is damaged, from another version or of another scene.
Checkpoint read_checkpoint(const std::filesystem::path& file, std::uint64_t scene_hash);

/// Forgets the checkpoints of an earlier run.
void drop_checkpoints(const std::filesystem::path& run_directory);

/// The checkpoints of a run directory, newest first. @throws Error when there are none.
std::vector<std::filesystem::path> checkpoint_files(const std::filesystem::path& run_directory);

}  // namespace rend
