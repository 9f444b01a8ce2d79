// The byte stream from the mesh loader process to the program.
#pragma once

#include <cstdint>

namespace rend {

/// Precedes 3 float32 a vertex and 3 uint32 a triangle, or `triangles` bytes of error text.
struct MeshStreamHeader {
  std::uint32_t magic;
  std::uint32_t is_error;
  std::uint64_t vertices;
  std::uint64_t triangles;
};

inline constexpr std::uint32_t mesh_stream_magic = 0x6d646e72;

}  // namespace rend
