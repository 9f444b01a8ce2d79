// The command line.
#include "app/command_line.h"

#include "app/bench_command.h"
#include "app/check_command.h"
#include "app/gallery_command.h"
#include "app/probe_command.h"
#include "app/run_command.h"
#include "app/say.h"
#include "app/scene_library.h"
#include "app/serve_command.h"
#include "app/version.h"
#include "engine/core/error.h"
#include "engine/core/parallel.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cstdlib>
#include <functional>
#include <iostream>

namespace rend {

namespace {

constexpr int kBadInput = 2;
constexpr int kFailure = 1;

std::filesystem::path source_root() {
  const char* root = std::getenv("REND_ROOT");
  return root ? root : ".";
}

const std::map<std::string, GlBackend> kBackends = {
    {"auto", GlBackend::automatic}, {"osmesa", GlBackend::osmesa}, {"egl", GlBackend::egl}};

Overrides parse_overrides(const std::vector<std::string>& texts) {
  Overrides overrides;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    if (text.empty() || text[0] != '/' || equals == std::string::npos)
      throw Error("--set " + text, "must look like /json/pointer=value, for example /grid/dx=0.02");
    overrides.emplace_back(text.substr(0, equals), text.substr(equals + 1));
  }
  return overrides;
}

/// Options as "--port N (8080)": a word for the value and the default, without CLI11's type and range codes, which
/// errors give.
class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_option_name(const CLI::Option* option, bool positional) const override {
    std::string name = CLI::Formatter::make_option_name(option, positional);
    if (const auto code = name.find("{false}"); code != std::string::npos) name.erase(code, 7);
    return name;
  }

  std::string make_option_opts(const CLI::Option* option) const override {
    if (!option->get_option_text().empty()) return " " + option->get_option_text();
    std::string text;
    const std::string type = option->get_type_name();
    if (option->get_items_expected_max() > 0 && !option->get_positional()) text += type.starts_with("INT") ? " N" : " TEXT";
    if (option->get_expected_max() > 1) text += " ...";
    if (!option->get_default_str().empty()) text += " (" + option->get_default_str() + ")";
    if (option->get_required()) text += " (needed)";
    return text;
  }
};

/// What the subcommands fill in; the chosen one leaves its work in `action`.
struct CommandLine {
  std::string scene;
  std::vector<std::string> set;
  std::string size = "1280x720", formats = "ply";
  RunOptions run;
  ServeOptions serve;
  GalleryOptions gallery;
  bool thumbs = false;
  std::string material, path;
  std::vector<int> only;
  BenchOptions bench;
  int threads = 0;
  GlBackend gl = GlBackend::automatic;
  std::function<int()> action;

  SceneDesc read() const { return SceneLibrary(source_root()).read_any(scene, parse_overrides(set)); }
};

void parse_size(const std::string& text, int& width, int& height) {
  char rest = 0;
  const bool right = std::sscanf(text.c_str(), "%dx%d%c", &width, &height, &rest) == 2;
  if (!right || width < 16 || height < 16 || width > 8192 || height > 8192)
    throw Error("--size " + text, "must look like 1280x720, with both numbers from 16 to 8192");
}

void add_scene_option(CLI::App& command, CommandLine& line) {
  command.add_option("SCENE", line.scene, "Scene file, or the name of a scene in scenes/")->required();
  command.add_option("--set", line.set, "Replace a value of the scene, e.g. /grid/dx=0.02 (repeatable)")->option_text("/POINTER=VALUE");
}

void add_serve(CLI::App& app, CommandLine& line) {
  CLI::App* command = app.add_subcommand("serve", "Serve the page: watch a scene tear and steer it in a browser");
  line.scene = "tear";
  command->add_option("SCENE", line.scene, "Scene file or name to start with")->capture_default_str();
  command->add_option("--port", line.serve.server.port, "Port; 0 picks a free one")
      ->check(CLI::Range(0, 65535))->capture_default_str();
  command->add_option("--listen", line.serve.server.address, "Address to listen on; others than loopback need --token")
      ->option_text("ADDRESS (127.0.0.1)");
  command->add_option("--token", line.serve.server.token, "Secret that browsers from elsewhere must present")
      ->option_text("SECRET");
  command->callback([&line] {
    line.action = [&line] {
      SceneLibrary library(source_root());
      const bool is_file = line.scene.ends_with(".json");
      line.serve.scene = is_file ? library.add(line.scene) : line.scene;
      line.serve.gl = line.gl;
      return serve(std::move(library), line.serve);
    };
  });
}

std::vector<std::string> parse_formats(const std::string& text) {
  std::vector<std::string> formats;
  if (text == "none") return formats;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t comma = std::min(text.find(',', start), text.size());
    formats.push_back(find_frame_format("--formats", text.substr(start, comma - start)).name);
    start = comma + 1;
  }
  return formats;
}

/// What `run` and `remesh` write, and how. Returns the option of the run directory.
CLI::Option* add_output_options(CLI::App& command, CommandLine& line) {
  OutputOptions& output = line.run.output;
  CLI::Option* out = command.add_option("--out", output.out, "Run directory to write")->option_text("DIR");
  command.add_option("--size", line.size, "Picture size")->option_text("WxH (1280x720)");
  command.add_option("--passes", output.accumulate, "Render passes per picture: 1 is fast, 64 is fine")
      ->check(CLI::Range(1, 1024))->capture_default_str();
  command.add_option("--png-level", output.png_level, "PNG compression, 0 to 9")->check(CLI::Range(0, 9))
      ->capture_default_str();
  command.add_flag("--png,!--no-png", output.png, "Write png/000001.png ... (on by default)");
  command.add_option("--formats", line.formats, "Files of mesh/ and particles/: ply, vtp, obj, glb with commas between; or none")
      ->option_text("LIST (ply)");
  return out;
}

void finish_output_options(CommandLine& line) {
  OutputOptions& output = line.run.output;
  parse_size(line.size, output.width, output.height);
  output.formats = parse_formats(line.formats);
  output.gl = line.gl;
}

void add_run(CLI::App& app, CommandLine& line) {
  CLI::App* command = app.add_subcommand("run", "Run a scene without a browser: pictures, meshes and a table");
  CLI::Option* resume =
      command->add_option("--resume", line.path, "Go on with this run directory from its newest checkpoint")
          ->option_text("DIR");
  CLI::Option* scene =
      command->add_option("SCENE", line.scene, "Scene file, or the name of a scene in scenes/")->excludes(resume);
  command->add_option("--set", line.set, "Replace a value of the scene, e.g. /grid/dx=0.02 (repeatable)")->option_text("/POINTER=VALUE")
      ->excludes(resume);
  add_output_options(*command, line)->excludes(resume);
  command->add_option("--frames", line.run.frames, "Frames to run in all, instead of the scene's")
      ->check(CLI::Range(1, 1000000));
  command->add_option("--checkpoint-every", line.run.checkpoint_every,
                      "Keep the exact state every N frames, for --resume; needs record/")
      ->check(CLI::Range(1, 1000000));
  command->add_flag("--record,!--no-record", line.run.output.record, "Write record/, which remesh needs (on by default)");
  command->callback([&line, scene] {
    line.action = [&line, scene] {
      finish_output_options(line);
      line.run.resume = !line.path.empty();
      if (line.run.resume) {
        line.run.output.out = line.path;
        line.scene = (std::filesystem::path(line.path) / "scene.json").string();
      } else if (scene->count() == 0 || line.run.output.out.empty()) {
        throw Error("run", "needs SCENE and --out DIR, or --resume DIR");
      }
      if (!line.run.output.record && (line.run.resume || line.run.checkpoint_every > 0))
        throw Error("--no-record", "does not go with checkpoints: to go on, a run reads record/");
      return run_scene(line.read(), line.run);
    };
  });
}

void add_remesh(CLI::App& app, CommandLine& line) {
  CLI::App* command =
      app.add_subcommand("remesh", "Make surfaces and pictures again from a recorded run, without simulating");
  command->add_option("RUN", line.path, "Run directory that was written by rend run")->required();
  command->add_option("--set", line.set, "Replace a value of the scene, e.g. /fracture/gap=0.4 (repeatable)")->option_text("/POINTER=VALUE");
  add_output_options(*command, line)->required();
  command->add_option("--only", line.only, "Frame to write (repeatable); all frames by default")->option_text("N");
  command->callback([&line] {
    line.action = [&line] {
      finish_output_options(line);
      line.run.output.record = false;
      line.scene = (std::filesystem::path(line.path) / "scene.json").string();
      return remesh_run(line.read(), line.path, line.run.output, line.only);
    };
  });
}

void add_check(CLI::App& app, CommandLine& line) {
  CLI::App* command = app.add_subcommand("check", "Validate a scene; print particles, memory, time step and speed");
  add_scene_option(*command, line);
  command->callback([&line] {
    line.action = [&line] {
      check_scene(line.read());
      return 0;
    };
  });
}

void add_probe(CLI::App& app, CommandLine& line) {
  CLI::App* command =
      app.add_subcommand("probe", "Drive one material point along deformation gradients from a CSV file; prints CSV");
  add_scene_option(*command, line);
  command->add_option("--material", line.material, "Material of the scene")->required()->option_text("NAME (needed)");
  command->add_option("--path", line.path, "CSV file with the header F11,F12,...,F33, one row a step")->required()
      ->option_text("FILE.csv (needed)");
  command->callback([&line] {
    line.action = [&line] {
      probe_material(line.read(), line.material, line.path, std::cout);
      return 0;
    };
  });
}

void add_bench(CLI::App& app, CommandLine& line) {
  CLI::App* command = app.add_subcommand("bench", "Speed against error, measured here and now");
  line.bench.name = bench_names().front();
  command->add_option("NAME", line.bench.name, "Which benchmark")->check(CLI::IsMember(bench_names()))
      ->capture_default_str();
  command->add_flag("--quick", line.bench.quick, "Smaller problems, under two minutes");
  command->add_option("--csv", line.bench.csv, "Write the table to this file too")->option_text("FILE");
  command->add_option("--out", line.bench.out, "Folder for table, CSV and plots of accuracy and cracks")->option_text("DIR");
  command->callback([&line] {
    line.action = [&line] {
      line.bench.scenes = source_root() / "scenes";
      run_bench(line.bench);
      return 0;
    };
  });
}

void add_gallery(CLI::App& app, CommandLine& line) {
  CLI::App* command = app.add_subcommand("gallery", "Run the scenes of scenes/ and make the page docs/gallery from them");
  command->add_option("--out", line.gallery.out, "Folder of the page instead of docs/gallery")->option_text("DIR");
  command->add_option("--only", line.gallery.only, "Scene to run (repeatable); others keep what they have")->option_text("NAME");
  command->add_option("--passes", line.gallery.accumulate, "Render passes per picture")->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->add_flag("--thumbs", line.thumbs, "Also write the thumbnails that the page embeds, web/page/thumbs");
  command->callback([&line] {
    line.action = [&line] {
      const std::filesystem::path root = source_root();
      line.gallery.gl = line.gl;
      if (line.gallery.out.empty()) line.gallery.out = root / "docs" / "gallery";
      if (line.thumbs) line.gallery.thumbs = root / "web" / "page" / "thumbs";
      return make_gallery(SceneLibrary(root), line.gallery);
    };
  });
}

}  // namespace

int run_command_line(int argc, char** argv) {
  CLI::App app{"Rend tears things: ductile fracture with the Material Point Method, watched in a browser."};
  app.name("rend");
  app.set_version_flag("--version", version_text());
  app.require_subcommand(1);
  app.footer("`./rend test` runs every test. Scene files are described in docs/scene-format.md.");
  CommandLine line;
  app.add_option("--threads", line.threads, "Worker threads; 0 is one per core")->check(CLI::Range(0, 1024));
  app.add_option("--gl", line.gl, "How to rasterise: auto, osmesa or egl")
      ->transform(CLI::CheckedTransformer(kBackends, CLI::ignore_case).description(""))->option_text("auto|osmesa|egl");
  app.fallthrough();
  app.formatter(std::make_shared<HelpFormatter>());
  add_serve(app, line);
  add_run(app, line);
  add_remesh(app, line);
  add_check(app, line);
  add_probe(app, line);
  add_gallery(app, line);
  add_bench(app, line);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kBadInput;
  }
  try {
    set_thread_count(line.threads);
    const int code = line.action();
    if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return code;
    say("rend: standard output cannot be written\n");
    return kFailure;
  } catch (const Error& error) {
    say("rend: {}\n", error.what());
    return kBadInput;
  } catch (const std::bad_alloc&) {
    say("rend: not enough memory\n");
    return kFailure;
  }
}

}  // namespace rend
