// PNG and JPEG: what is written decodes to what was given; a full disk is an error and leaves
// nothing behind.
#include "render/image_file.h"

#include "engine/core/error.h"
#include "engine/core/random.h"

#include <doctest/doctest.h>
#include <png.h>
#include <sys/resource.h>
#include <turbojpeg.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <fstream>

using namespace rend;

namespace {

Image gradient(int width, int height) {
  Image image{width, height, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (const int c : {x * 255 / width, y * 255 / height, 128})
        image.rgb.push_back(static_cast<std::uint8_t>(c));
  return image;
}

Image noise(int width, int height) {
  Image image{width, height, {}};
  Random random(1, 2);
  for (int i = 0; i < 3 * width * height; ++i)
    image.rgb.push_back(static_cast<std::uint8_t>(random.next(0, 256)));
  return image;
}

std::vector<std::uint8_t> decode_png(const std::vector<std::uint8_t>& bytes, int& width,
                                     int& height) {
  png_image png;
  std::memset(&png, 0, sizeof png);
  png.version = PNG_IMAGE_VERSION;
  REQUIRE(png_image_begin_read_from_memory(&png, bytes.data(), bytes.size()));
  png.format = PNG_FORMAT_RGB;
  std::vector<std::uint8_t> out(PNG_IMAGE_SIZE(png));
  REQUIRE(png_image_finish_read(&png, nullptr, out.data(), 0, nullptr));
  width = static_cast<int>(png.width);
  height = static_cast<int>(png.height);
  return out;
}

struct Folder {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("rend_image_test_" + std::to_string(::getpid()));
  Folder() { std::filesystem::create_directories(path); }
  ~Folder() { std::filesystem::remove_all(path); }
};

/// Files of this process may not grow beyond `bytes` while this lives.
struct FileSizeLimit {
  rlimit before{};
  explicit FileSizeLimit(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before);
    const rlimit tight{bytes, before.rlim_max};
    setrlimit(RLIMIT_FSIZE, &tight);
    std::signal(SIGXFSZ, SIG_IGN);
  }
  ~FileSizeLimit() { setrlimit(RLIMIT_FSIZE, &before); }
};

}  // namespace

TEST_CASE("PNG gives back the same pixels") {
  for (const Image& image : {gradient(37, 21), noise(64, 64), gradient(1, 1)})
    for (const int level : {0, 1, 6}) {
      int width = 0, height = 0;
      CHECK(decode_png(encode_png(image, level), width, height) == image.rgb);
      CHECK(width == image.width);
      CHECK(height == image.height);
    }
}

TEST_CASE("JPEG gives back nearly the same pixels") {
  const Image image = gradient(160, 90);
  for (const bool full : {false, true}) {
    const std::vector<std::uint8_t> bytes = encode_jpeg(image, 90, full);
    tjhandle decoder = tjInitDecompress();
    int width = 0, height = 0, sampling = 0, space = 0;
    REQUIRE(tjDecompressHeader3(decoder, bytes.data(), bytes.size(), &width, &height, &sampling,
                                &space) == 0);
    CHECK(width == 160);
    CHECK(height == 90);
    CHECK((sampling == TJSAMP_444) == full);
    std::vector<std::uint8_t> out(image.rgb.size());
    REQUIRE(tjDecompress2(decoder, bytes.data(), bytes.size(), out.data(), width, 0, height,
                          TJPF_RGB, 0) == 0);
    tjDestroy(decoder);
    double error = 0;
    for (std::size_t i = 0; i < out.size(); ++i) error += std::abs(out[i] - image.rgb[i]);
    CHECK(error / static_cast<double>(out.size()) < 2);
  }
}

TEST_CASE("pictures and settings that make no sense are refused") {
  Image image = gradient(8, 8);
  CHECK_THROWS_AS(encode_png(image, 10), Error);
  CHECK_THROWS_AS(encode_jpeg(image, 0), Error);
  image.rgb.pop_back();
  CHECK_THROWS_AS(encode_png(image), Error);
  CHECK_THROWS_AS(encode_jpeg(image), Error);
  CHECK_THROWS_AS(encode_png(Image{}), Error);
}

TEST_CASE("a written file is whole, and replaces the one before") {
  const Folder folder;
  const auto file = folder.path / "a.png";
  write_png(file, gradient(8, 8));
  const Image image = gradient(32, 16);
  write_png(file, image);
  std::ifstream in(file, std::ios::binary);
  const std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(in), {}};
  int width = 0, height = 0;
  CHECK(decode_png(bytes, width, height) == image.rgb);
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path), {}) == 1);
}

TEST_CASE("a disk that is full is an error with the name of the file, small picture or large") {
  const Folder folder;
  const auto file = folder.path / "full.png";
  for (const int side : {20, 400}) {
    const Image image = noise(side, side);
    try {
      const FileSizeLimit limit(512);
      write_png(file, image);
      FAIL("the error was missed");
    } catch (const Error& error) {
      CHECK(std::string(error.what()).find("full.png") != std::string::npos);
    }
    CHECK(std::filesystem::is_empty(folder.path));
  }
  CHECK_THROWS_AS(write_png(folder.path / "missing" / "a.png", gradient(4, 4)), Error);
}
