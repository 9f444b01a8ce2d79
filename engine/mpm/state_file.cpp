// Layout of a state file: header of fixed size, then the values.
#include "engine/mpm/state_file.h"

#include "engine/core/random.h"

#include <algorithm>
#include <cstddef>
#include <istream>
#include <iterator>
#include <ostream>

namespace rend {

namespace {

constexpr std::uint32_t kVersion = 4;
constexpr std::uint32_t kByteOrder = 0x01020304;

struct Header {
  char magic[8] = {'R', 'E', 'N', 'D', 'S', 'T', 'A', 'T'};
  std::uint32_t version = kVersion;
  std::uint32_t byte_order = kByteOrder;
  char kind[16] = {};
  std::uint64_t scene_hash = 0;
  std::uint64_t size = 0;
  std::uint64_t checksum = 0;  // of all before it and of the values
};

std::uint64_t checksum_of(const Header& header, const std::string& bytes) {
  return hash_bytes(hash_bytes(0, &header, offsetof(Header, checksum)), bytes.data(), bytes.size());
}

}  // namespace

std::uint64_t hash_bytes(std::uint64_t seed, const void* data, std::size_t size) {
  const char* bytes = static_cast<const char*>(data);
  std::uint64_t hash = mix_bits(seed ^ size);
  for (std::size_t at = 0; at < size; at += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes + at, std::min<std::size_t>(8, size - at));
    hash = mix_bits(hash ^ word);
  }
  return hash;
}

void StateWriter::write(std::ostream& out, const std::string& kind,
                        std::uint64_t scene_hash) const {
  Header header;
  kind.copy(header.kind, sizeof(header.kind) - 1);
  header.scene_hash = scene_hash;
  header.size = bytes_.size();
  header.checksum = checksum_of(header, bytes_);
  out.write(reinterpret_cast<const char*>(&header), sizeof(header));
  out.write(bytes_.data(), static_cast<std::streamsize>(bytes_.size()));
}

StateReader::StateReader(std::istream& in, const std::string& kind, std::uint64_t scene_hash) {
  Header header;
  const Header expected;
  if (!in.read(reinterpret_cast<char*>(&header), sizeof(header)))
    fail("it is shorter than its header");
  if (std::memcmp(header.magic, expected.magic, sizeof(header.magic)) != 0)
    fail("it does not start with the mark of a state file");
  if (header.byte_order != kByteOrder) fail("it was written on a machine of another byte order");
  if (header.version != kVersion)
    fail("it has version " + std::to_string(header.version) + "; this program reads version " +
         std::to_string(kVersion));
  const std::string saved(header.kind, strnlen(header.kind, sizeof(header.kind)));
  if (kind != saved)
    fail("it was saved by the " + saved + " solver, not by the " + kind + " solver");
  if (header.scene_hash != scene_hash) fail("it belongs to another scene");
  bytes_.assign(std::istreambuf_iterator<char>(in), {});
  if (bytes_.size() < header.size) fail("it is cut short");
  if (bytes_.size() > header.size) fail("it goes on after its end");
  if (checksum_of(header, bytes_) != header.checksum)
    fail("its checksum does not match: it is damaged");
}

void StateReader::finish() const {
  if (at_ != bytes_.size()) fail("it holds more than a state");
}

void StateReader::require(bool fits, const char* what) {
  if (!fits) fail(std::string("its ") + what + " do not fit this scene");
}

void StateReader::fail(const std::string& why) { throw Error("state", why); }

void StateReader::take(void* to, std::size_t size) {
  if (size > bytes_.size() - at_) fail("it ends too early");
  if (size != 0) std::memcpy(to, bytes_.data() + at_, size);  // an empty array has no address
  at_ += size;
}

}  // namespace rend
