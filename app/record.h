// Recorded particles of a run (record/000001.bin): what `rend remesh` needs to make surfaces again.
#pragma once

#include "engine/mpm/snapshot.h"
#include "engine/scene/model.h"

#include <filesystem>

namespace rend {

/// Exact binary form of a snapshot with a header, the fingerprint of the model it belongs to and a checksum.
std::string encode_snapshot(const Snapshot& snapshot, std::uint64_t model_fingerprint);

/// @throws Error naming the file when it is damaged, cut short, from another version or of another model.
Snapshot read_snapshot(const std::filesystem::path& file, std::uint64_t model_fingerprint);

/// A hash of all rest positions: tells whether recorded particles belong to a model.
std::uint64_t fingerprint(const Model& model);

}  // namespace rend
