// Pictures to bytes: PNG for files, JPEG for the browser.
#pragma once

#include "render/renderer.h"

#include <filesystem>

namespace rend {

/// JPEG bytes; quality 1..100. `full_chroma` for stills.
std::vector<std::uint8_t> encode_jpeg(const Image& image, int quality = 85, bool full_chroma = false);

/// PNG bytes at zlib level 0..9.
std::vector<std::uint8_t> encode_png(const Image& image, int level = 1);

/// Writes to a temporary name and renames. @throws Error naming the file when the disk refuses.
void write_png(const std::filesystem::path& file, const Image& image, int level = 1);

}  // namespace rend
