// `rend gallery`.
#include "app/gallery_command.h"

#include "app/gallery_page.h"
#include "app/pipeline.h"
#include "app/progress.h"
#include "app/say.h"
#include "app/view.h"
#include "app/write_file.h"
#include "engine/core/error.h"
#include "render/image_file.h"

#include <fmt/format.h>

#include <algorithm>

namespace rend {

namespace fs = std::filesystem;

namespace {

constexpr double kMemoryLimit = 16e9;  // bytes
constexpr int kStripFrames = 5;

bool is_example_mesh(const BodyDesc& body) { return std::holds_alternative<MeshDesc>(body.shape); }

bool is_local(const SceneDesc& scene) {
  return std::any_of(scene.bodies.begin(), scene.bodies.end(), is_example_mesh);
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void append_right(Image& strip, const Image& image) {
  Image wide{strip.width + image.width, image.height, {}};
  wide.rgb.reserve(3 * static_cast<std::size_t>(wide.width) *
                   static_cast<std::size_t>(wide.height));
  const auto add_row = [&](const Image& from, int y) {
    const auto row = from.rgb.begin() + 3 * static_cast<std::ptrdiff_t>(from.width) * y;
    wide.rgb.insert(wide.rgb.end(), row, row + 3 * static_cast<std::ptrdiff_t>(from.width));
  };
  for (int y = 0; y < image.height; ++y) {
    if (strip.width > 0) add_row(strip, y);
    add_row(image, y);
  }
  strip = std::move(wide);
}

void write_jpeg(const fs::path& file, const Image& image, int quality) {
  const auto bytes = encode_jpeg(image, quality);
  write_file(file, {bytes.begin(), bytes.end()});
}

/// Pictures of one run.
class Pictures {
 public:
  Pictures(Renderer& renderer, const GalleryOptions& options, std::string name, const Stage& stage)
      : renderer_(renderer),
        options_(options),
        name_(std::move(name)),
        stage_(stage),
        local_(is_local(stage.scene)) {}

  /// `frame` is number n of `frames`.
  void take(const Frame& frame, int n, int frames) {
    if (n == std::max(1, 2 * frames / 3)) {
      write_jpeg(file(".jpg"), draw(frame, 960, 540, true), 85);
      // What is embedded is published too, so thumbnails of other people's meshes are left to the
      // server.
      if (!options_.thumbs.empty() && !local_)
        write_jpeg(options_.thumbs / (name_ + ".jpg"), draw(frame, 320, 200, false), 80);
    }
    const int taken = strip_.width / kStripWidth;
    if (taken < kStripFrames && n >= std::max(1, frames * (taken + 1) / kStripFrames)) {
      append_right(strip_, draw(frame, kStripWidth, 144, false));
      if (taken + 1 == kStripFrames) write_jpeg(file("_strip.jpg"), strip_, 80);
    }
  }

 private:
  static constexpr int kStripWidth = 256;

  fs::path file(const char* ending) const {
    return (local_ ? options_.out / "local" : options_.out) / (name_ + ending);
  }

  Image draw(const Frame& frame, int width, int height, bool legend) {
    const View view = default_view(stage_.scene);
    Drawing drawing = make_drawing(stage_, frame, view);
    if (!legend) drawing.list.coloring.caption.clear();
    return renderer_.draw(drawing.list, view.camera, {width, height, options_.accumulate});
  }

  Renderer& renderer_;
  const GalleryOptions& options_;
  std::string name_;
  const Stage& stage_;
  bool local_;
  Image strip_;
};

/// Runs the scene to its end; false when it stopped early.
bool run_one(const SceneDesc& scene, Pictures& pictures, Pipeline& pipeline,
             GalleryFigures& figures, ProgressLine& line) {
  std::vector<double> simulate, post;
  double steps = 0;
  for (int n = 1; n <= scene.frames; ++n) {
    const Frame frame = pipeline.advance();
    const FrameReport& report = frame.snapshot->report;
    if (report.status != Status::ok) {
      line.finish(fmt::format("stopped in frame {}: {}", n, report.reason));
      return false;
    }
    simulate.push_back(report.sim_seconds);
    post.push_back(frame.fracture.seconds);
    steps += static_cast<double>(report.substeps);
    pictures.take(frame, n, scene.frames);
    line.show(static_cast<double>(n) / scene.frames,
              fmt::format("frame {} of {}", n, scene.frames));
  }
  figures = {static_cast<long>(pipeline.model().particle_count()), steps / scene.frames,
             median(simulate), median(post)};
  line.finish(
      fmt::format("{} particles, {:.0f} steps, simulate {:.2g} s, post-process {:.2g} s per frame",
                  figures.particles, figures.steps, figures.simulate, figures.post));
  return true;
}

}  // namespace

int make_gallery(const SceneLibrary& library, const GalleryOptions& options) {
  make_folder(options.out / "local");
  if (!options.thumbs.empty()) make_folder(options.thumbs);
  const fs::path table = options.out / "figures.csv";
  auto figures = read_figures(table);
  for (const std::string& name : options.only) library.read(name);
  Renderer renderer(options.gl);
  std::vector<GalleryEntry> entries;
  int code = 0;
  for (const std::string& name : library.names()) {
    const SceneDesc scene = library.read(name);
    entries.push_back({name, scene.description, is_local(scene)});
    const auto& only = options.only;
    if (!only.empty() && std::find(only.begin(), only.end(), name) == only.end()) continue;
    std::shared_ptr<const Model> model;
    try {
      model = std::make_shared<Model>(build_model(scene, kMemoryLimit));
    } catch (const Error& error) {
      if (!is_local(scene)) throw;
      say("{}: left out: {}\n", name, error.what());
      continue;
    }
    ProgressLine line(name);
    Pipeline pipeline(scene, model);
    const Stage stage = make_stage(scene, *model);
    Pictures pictures(renderer, options, name, stage);
    if (!run_one(scene, pictures, pipeline, figures[name], line)) {
      figures.erase(name);
      code = 4;
    }
    write_file(table, figures_csv(figures));
  }
  sort_entries(entries);
  write_file(options.out / "README.md", gallery_page(entries, figures));
  return code;
}

}  // namespace rend
