// Pictures to PNG and JPEG bytes, and safely to disk.
#include "render/image_file.h"

#include "engine/core/error.h"

#include <fmt/format.h>
#include <png.h>
#include <turbojpeg.h>
#include <unistd.h>

#include <cerrno>
#include <csetjmp>
#include <cstdio>
#include <cstring>

namespace rend {

namespace {

void check(const Image& image) {
  const auto pixels = static_cast<std::size_t>(std::max(image.width, 0)) *
                      static_cast<std::size_t>(std::max(image.height, 0));
  if (pixels == 0 || image.rgb.size() != 3 * pixels)
    throw Error("picture", fmt::format("{} x {} pixels with {} bytes", image.width, image.height,
                                       image.rgb.size()));
}

/// Closes and removes an unfinished file.
class TemporaryFile {
 public:
  explicit TemporaryFile(std::filesystem::path final_name)
      : final_(std::move(final_name)),
        temporary_(final_.string() + ".tmp"),
        file_(std::fopen(temporary_.c_str(), "wb")) {
    if (!file_) fail();
  }
  ~TemporaryFile() {
    if (file_) std::fclose(file_);
    if (!done_) ::unlink(temporary_.c_str());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  void write(const std::vector<std::uint8_t>& bytes) {
    if (std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size()) fail();
  }

  /// A full disk may only show when the buffers are flushed or the file is closed.
  void commit() {
    if (std::fflush(file_) != 0) fail();
    std::FILE* const file = file_;
    file_ = nullptr;
    if (std::fclose(file) != 0) fail();
    if (std::rename(temporary_.c_str(), final_.c_str()) != 0) fail();
    done_ = true;
  }

 private:
  [[noreturn]] void fail() const {
    throw Error(final_.string(), std::string("cannot be written: ") + std::strerror(errno));
  }

  std::filesystem::path final_, temporary_;
  std::FILE* file_ = nullptr;
  bool done_ = false;
};

struct PngSink {
  std::vector<std::uint8_t> bytes;
  std::string message;
};

}  // namespace

std::vector<std::uint8_t> encode_jpeg(const Image& image, int quality, bool full_chroma) {
  check(image);
  if (quality < 1 || quality > 100)
    throw Error("jpeg quality", fmt::format("{}; allowed are 1 to 100", quality));
  const std::unique_ptr<void, int (*)(void*)> encoder(tjInitCompress(), tjDestroy);
  if (!encoder) throw Error("jpeg", "the encoder does not start");
  const int sampling = full_chroma ? TJSAMP_444 : TJSAMP_420;
  std::vector<std::uint8_t> bytes(tjBufSize(image.width, image.height, sampling));
  unsigned char* out = bytes.data();
  unsigned long size = bytes.size();
  if (tjCompress2(encoder.get(), image.rgb.data(), image.width, 0, image.height, TJPF_RGB, &out,
                  &size, sampling, quality, TJFLAG_NOREALLOC) != 0)
    throw Error("jpeg", tjGetErrorStr2(encoder.get()));
  bytes.resize(size);
  return bytes;
}

std::vector<std::uint8_t> encode_png(const Image& image, int level) {
  check(image);
  if (level < 0 || level > 9)
    throw Error("png level", fmt::format("{}; allowed are 0 to 9", level));
  PngSink sink;
  png_structp png = png_create_write_struct(
      PNG_LIBPNG_VER_STRING, &sink,
      [](png_structp p, png_const_charp text) {
        static_cast<PngSink*>(png_get_error_ptr(p))->message = text;
        png_longjmp(p, 1);
      },
      [](png_structp, png_const_charp) {});
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  // libpng reports errors by longjmp: nothing with a destructor may be made between here and the
  // end of the block.
  if (!info || setjmp(png_jmpbuf(png))) {
    png_destroy_write_struct(&png, &info);
    throw Error("png", sink.message.empty() ? "out of memory" : sink.message);
  }
  png_set_write_fn(
      png, &sink,
      [](png_structp p, png_bytep data, png_size_t count) {
        auto& bytes = static_cast<PngSink*>(png_get_io_ptr(p))->bytes;
        bytes.insert(bytes.end(), data, data + count);
      },
      [](png_structp) {});
  png_set_compression_level(png, level);
  png_set_filter(png, 0, PNG_FILTER_SUB);
  png_set_IHDR(png, info, static_cast<png_uint_32>(image.width),
               static_cast<png_uint_32>(image.height), 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
  png_write_info(png, info);
  for (int y = 0; y < image.height; ++y)
    png_write_row(png, image.rgb.data() + 3 * static_cast<std::ptrdiff_t>(y) * image.width);
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return std::move(sink.bytes);
}

void write_png(const std::filesystem::path& file, const Image& image, int level) {
  const std::vector<std::uint8_t> bytes = encode_png(image, level);
  TemporaryFile out(file);
  out.write(bytes);
  out.commit();
}

}  // namespace rend
