// Checkpoint files.
#include "app/checkpoint.h"

#include "app/write_file.h"
#include "engine/core/error.h"
#include "engine/mpm/state_file.h"
#include "engine/scene/scene_reader.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <sstream>

namespace rend {

namespace {

constexpr std::uint64_t kMagic = 0x3130504b43444e52ull;  // "RNDCKP01"
constexpr std::size_t kKept = 2;

struct Header {
  std::uint64_t magic = kMagic;
  std::uint64_t scene_hash = 0;
  std::int64_t frame = 0;
  std::uint64_t size = 0;
  std::uint64_t checksum = 0;  // of all before it and of the state
};

std::uint64_t checksum_of(const Header& header, const std::string& state) {
  return hash_bytes(hash_bytes(0, &header, offsetof(Header, checksum)), state.data(), state.size());
}

std::filesystem::path folder_of(const std::filesystem::path& run_directory) { return run_directory / "checkpoint"; }

std::vector<std::filesystem::path> newest_first(const std::filesystem::path& run_directory) {
  std::vector<std::filesystem::path> files;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder_of(run_directory), ignored))
    if (entry.path().extension() == ".bin") files.push_back(entry.path());
  std::sort(files.rbegin(), files.rend());
  return files;
}

void flush_to_disk(const std::filesystem::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return;
  ::fsync(file);
  ::close(file);
}

}  // namespace

std::uint64_t motion_hash(const SceneDesc& scene) {
  SceneDesc part = scene;
  part.name = part.description = "";
  part.frames = 1;
  part.camera = {};
  part.render = {};
  for (BodyDesc& body : part.bodies)
    if (auto* mesh = std::get_if<MeshDesc>(&body.shape)) mesh->file = std::filesystem::absolute(mesh->path);
  const std::string text = write_scene(part);
  return hash_bytes(0, text.data(), text.size());
}

void write_checkpoint(const std::filesystem::path& run_directory, const Checkpoint& checkpoint,
                      std::uint64_t scene_hash) {
  Header header;
  header.scene_hash = scene_hash;
  header.frame = checkpoint.frame;
  header.size = checkpoint.state.size();
  header.checksum = checksum_of(header, checkpoint.state);
  const std::filesystem::path folder = folder_of(run_directory);
  make_folder(folder);
  const std::filesystem::path whole = folder / fmt::format("{:06}.bin", checkpoint.frame);
  const std::filesystem::path part = folder / "next";
  write_file(part, std::string(reinterpret_cast<const char*>(&header), sizeof(header)) + checkpoint.state);
  // The new file must be on the disk before the old ones go.
  flush_to_disk(part);
  std::error_code code;
  std::filesystem::rename(part, whole, code);
  if (code) throw Error(whole.string(), "cannot be written: " + code.message());
  flush_to_disk(folder);
  const auto files = newest_first(run_directory);
  for (std::size_t n = kKept; n < files.size(); ++n) std::filesystem::remove(files[n], code);
}

Checkpoint read_checkpoint(const std::filesystem::path& file, std::uint64_t scene_hash) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw Error(file.string(), "cannot be read");
  std::stringstream text;
  text << in.rdbuf();
  const std::string bytes = text.str();
  Header header;
  if (bytes.size() < sizeof(header)) throw Error(file.string(), "is cut short");
  std::memcpy(&header, bytes.data(), sizeof(header));
  if (header.magic != kMagic) throw Error(file.string(), "is not a checkpoint of this version of rend");
  Checkpoint out;
  out.frame = header.frame;
  out.state = bytes.substr(sizeof(header));
  if (out.state.size() < header.size) throw Error(file.string(), "is cut short");
  if (out.state.size() > header.size || checksum_of(header, out.state) != header.checksum)
    throw Error(file.string(), "is damaged (checksum)");
  if (header.scene_hash != scene_hash) throw Error(file.string(), "belongs to another scene: scene.json has changed");
  return out;
}

void drop_checkpoints(const std::filesystem::path& run_directory) {
  std::error_code ignored;
  for (const auto& file : newest_first(run_directory)) std::filesystem::remove(file, ignored);
}

std::vector<std::filesystem::path> checkpoint_files(const std::filesystem::path& run_directory) {
  std::vector<std::filesystem::path> files = newest_first(run_directory);
  if (files.empty())
    throw Error(folder_of(run_directory).string(), "holds no checkpoints; run with --checkpoint-every N");
  return files;
}

}  // namespace rend
