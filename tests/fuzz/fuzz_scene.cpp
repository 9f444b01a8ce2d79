// libFuzzer target: the scene reader on any bytes; a text is refused with an Error, or read and written back the same.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "engine/core/error.h"
#include "engine/scene/scene_reader.h"

namespace {

[[noreturn]] void stop(const char* what, const std::string& text) {
  std::fprintf(stderr, "broken: %s\n%s\n", what, text.c_str());
  std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace rend;
  const std::string text(reinterpret_cast<const char*>(data), size);
  SceneDesc scene;
  try {
    scene = parse_scene(text, "fuzz.json", "/nowhere", {}, {});
  } catch (const Error& error) {
    if (error.why().empty() || error.why().size() > 2000) stop("an error says what is wrong, in short", error.why());
    if (!error.where().starts_with("fuzz.json")) stop("an error says where", error.where());
    return 0;
  }
  const std::string written = write_scene(scene);
  if (write_scene(parse_scene(written, "fuzz.json", "/nowhere", {}, {})) != written)
    stop("a scene that was read is written back the same", written);
  return 0;
}
