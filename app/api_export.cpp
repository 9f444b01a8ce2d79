// The routes of exports.
#include "app/api_export.h"

#include "app/api_body.h"
#include "app/api_query.h"
#include "app/frame_formats.h"
#include "app/frame_table.h"
#include "app/run_directory.h"
#include "app/write_file.h"
#include "engine/core/error.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rend {

namespace {

using nlohmann::json;
using web::Request;
using web::Response;

Response no_export() { return web::problem(404, "no_export", "There is no such export."); }

/// 0 for what is no number: none is given it.
int read_id(const std::string& text) {
  const bool number =
      !text.empty() && text.size() < 10 &&
      std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
  return number ? std::stoi(text) : 0;
}

Index read_frame(const JsonValue& body, const char* key, Index otherwise) {
  if (!body.find(key)) return otherwise;
  const Real value = read_number(body, key, 0, 1e9);
  if (value != std::floor(value)) throw Error(std::string("/") + key, "must be a whole number");
  return static_cast<Index>(value);
}

std::string read_format(const JsonValue& body) {
  const JsonValue* format = body.find("format");
  const std::vector<std::string> names = frame_format_names();
  const bool known =
      format && format->kind == JsonValue::Kind::text &&
      (format->text == "png" || std::find(names.begin(), names.end(), format->text) != names.end());
  if (!known) throw Error("/format", fmt::format("must be png, {}", fmt::join(names, ", ")));
  return format->text;
}

std::string frame_name(const Frame& frame) { return fmt::format("{:06}", frame.snapshot->frame); }

/// Pictures as `rend run` writes them, seen as the viewer sees the scene. The thread of the job has
/// a GL context of its own, so that viewers need not wait.
class PictureExport {
 public:
  PictureExport(GlBackend backend, std::shared_ptr<const Stage> stage, View view)
      : backend_(backend), stage_(std::move(stage)), view_(std::move(view)) {
    view_.accumulate = OutputOptions{}.accumulate;
  }

  std::vector<ExportedFile> operator()(const Frame& frame, const KeepOn& keep_on) {
    if (!renderer_) renderer_ = std::make_shared<Renderer>(backend_);
    const Picture picture =
        draw_picture(*renderer_, *stage_, frame, view_, PictureFormat::png, keep_on);
    return {{"png/" + frame_name(frame) + ".png", picture.bytes, true}};
  }

 private:
  GlBackend backend_;
  std::shared_ptr<const Stage> stage_;
  View view_;
  std::shared_ptr<Renderer> renderer_;
};

/// Surfaces and particles as `rend run --formats` writes them.
std::vector<ExportedFile> mesh_files(const FrameFormat& format, const Frame& frame,
                                     const Model& model) {
  const std::string file = fmt::format("{}.{}", frame_name(frame), format.name);
  return {{"mesh/" + file, format.surface(*frame.surface, frame.snapshot->time)},
          {"particles/" + file, format.particles(*frame.snapshot, model)}};
}

/// What the frames so far have to say together.
struct FrameList {
  std::string table = frame_table_header();
  std::vector<NamedFrame> frames;
};

ExportOrder make_order(const ApiContext& context, const Request& request, const std::string& name,
                       Index first, Index last) {
  const auto [state, frames] = context.session.recording(first, last);
  const FrameFormat* format = name == "png" ? nullptr : &find_frame_format("/format", name);
  std::function<std::vector<ExportedFile>(const Frame&, const KeepOn&)> files_of =
      [format, model = state.model](const Frame& frame, const KeepOn&) {
        return mesh_files(*format, frame, *model);
      };
  if (!format)
    files_of = PictureExport(context.pictures.backend(), state.stage,
                             read_picture_query(request.query).view(*state.stage));
  const auto list = std::make_shared<FrameList>();
  ExportOrder order;
  order.name = fmt::format("{}-{}", plain_name(state.scene_name, "scene"), name);
  order.frames = frames;
  order.files_of = [list, files_of, particles = state.model->X.size()](
                       const RecordedFrame& recorded, const KeepOn& keep_on) {
    const Frame& frame = recorded.frame;
    if (frame.snapshot->x.size() != particles) throw Error("export", "the scene has changed");
    list->table += frame_table_row(frame, recorded.cost);
    list->frames.push_back({frame.snapshot->time, frame_name(frame)});
    return files_of(frame, keep_on);
  };
  order.beside = [list, format] {
    std::vector<ExportedFile> files = {{"frames.csv", list->table}};
    if (format && format->beside)
      for (RunFile& f : format->beside(list->frames)) files.push_back({f.path, std::move(f.bytes)});
    return files;
  };
  return order;
}

json job_json(int id, const ExportStatus& status) {
  return {{"id", id},
          {"status", export_state_name(status.state)},
          {"name", status.name},
          {"done", status.done},
          {"of", status.of},
          {"seconds_left", status.seconds_left},
          {"bytes", status.bytes},
          {"reason", status.reason}};
}

Response post_export(const ApiContext& context, const Request& request) {
  const JsonValue body = parse_body(request.body, {"format", "first", "last"});
  const std::string format = read_format(body);
  const Index first = read_frame(body, "first", 0);
  const Index last = read_frame(body, "last", std::numeric_limits<Index>::max());
  if (last < first) throw Error("/last", "must not be before first");
  if (!context.session.state().stage)
    return web::problem(409, "preparing", "The scene is still being prepared.");
  const auto id = context.exports.start(make_order(context, request, format, first, last));
  if (!id) return web::problem(409, "export_running", "Another export is running.");
  return reply({{"id", *id}});
}

/// The job that runs, so that a page that was loaded again, or another viewer, can follow and end
/// it.
Response get_running_export(const ApiContext& context) {
  const auto id = context.exports.running();
  const auto status = id ? context.exports.status(*id) : std::nullopt;
  return reply({{"running", status ? job_json(*id, *status) : json(nullptr)}});
}

Response get_export(const ApiContext& context, const Request& request) {
  const int id = read_id(request.parts.at(0));
  const auto status = context.exports.status(id);
  return status ? reply(job_json(id, *status)) : no_export();
}

Response delete_export(const ApiContext& context, const Request& request) {
  const int id = read_id(request.parts.at(0));
  if (!context.exports.cancel(id)) return no_export();
  return reply({{"id", id}});
}

Response get_export_file(const ApiContext& context, const Request& request) {
  const int id = read_id(request.parts.at(0));
  auto archive = context.exports.archive(id);
  const auto status = context.exports.status(id);
  if (!archive || !status) return no_export();
  return {200,
          "application/zip",
          "",
          {{"Content-Disposition", fmt::format("attachment; filename=\"{}.zip\"", status->name)}},
          std::move(archive)};
}

}  // namespace

std::vector<web::Route> export_routes(ApiContext c) {
  return {
      {"POST", "/api/exports", [c](const Request& r) { return post_export(c, r); }},
      {"GET", "/api/exports", [c](const Request&) { return get_running_export(c); }},
      {"GET", "/api/exports/{id}", [c](const Request& r) { return get_export(c, r); }},
      {"DELETE", "/api/exports/{id}", [c](const Request& r) { return delete_export(c, r); }},
      {"GET", "/api/exports/{id}/file", [c](const Request& r) { return get_export_file(c, r); }}};
}

}  // namespace rend
