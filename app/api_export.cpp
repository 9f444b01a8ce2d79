// The routes of exports.
#include "app/api_export.h"

#include "app/api_body.h"
#include "app/api_query.h"
#include "app/frame_formats.h"
#include "app/frame_table.h"
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

constexpr int kExportPasses = 8;  // as `rend run` has them

Response reply(const json& body) { return {200, "application/json", body.dump(), {}}; }

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

/// Pictures as `rend run` writes them, seen as the viewer sees the scene.
ExportOrder picture_order(const ApiContext& context, const SessionState& state, View view) {
  view.accumulate = kExportPasses;
  ExportOrder order;
  order.name = state.scene_name + "-png";
  order.files_of = [&pictures = context.pictures, state, view](const RecordedFrame& recorded) {
    const std::string name = frame_name(recorded.frame);
    const auto picture =
        pictures.picture(fmt::format("{}-{}-{}", state.data, name, state.scene_name), state.stage,
                         recorded.frame, view, PictureFormat::png);
    if (!picture) throw Error("export", "the server is stopping");
    return std::vector<ExportedFile>{{"png/" + name + ".png", picture->bytes, true}};
  };
  return order;
}

/// Surfaces and particles as `rend run --formats` writes them.
ExportOrder mesh_order(const SessionState& state, const FrameFormat& format) {
  ExportOrder order;
  order.name = fmt::format("{}-{}", state.scene_name, format.name);
  order.files_of = [&format, model = state.model](const RecordedFrame& recorded) {
    const Snapshot& snapshot = *recorded.frame.snapshot;
    if (snapshot.x.size() != model->X.size()) throw Error("export", "the scene has changed");
    const std::string file = fmt::format("{}.{}", frame_name(recorded.frame), format.name);
    return std::vector<ExportedFile>{
        {"mesh/" + file, format.surface(*recorded.frame.surface, snapshot.time)},
        {"particles/" + file, format.particles(snapshot, *model)}};
  };
  return order;
}

Response post_export(const ApiContext& context, const Request& request) {
  const JsonValue body = parse_body(request.body, {"format", "first", "last"});
  const std::string format = read_format(body);
  const Index first = read_frame(body, "first", 0);
  const Index last = read_frame(body, "last", std::numeric_limits<Index>::max());
  if (last < first) throw Error("/last", "must not be before first");
  const SessionState state = context.session.state();
  if (!state.stage) return web::problem(409, "preparing", "The scene is still being prepared.");
  ExportOrder order =
      format == "png"
          ? picture_order(context, state, read_picture_query(request.query).view(*state.stage))
          : mesh_order(state, find_frame_format("/format", format));
  std::string table = frame_table_header();
  std::vector<NamedFrame> named;
  for (auto& recorded : context.session.frames_from(first)) {
    const Frame& frame = recorded->frame;
    if (frame.snapshot->frame > last) break;
    table += frame_table_row(frame, recorded->cost);
    named.push_back({frame.snapshot->time, frame_name(frame)});
    order.frames.push_back(std::move(recorded));
  }
  order.beside = {{"frames.csv", table}};
  if (format != "png")
    if (const auto beside = find_frame_format("/format", format).beside)
      for (RunFile& f : beside(named)) order.beside.push_back({f.path, std::move(f.bytes)});
  const auto id = context.exports.start(std::move(order));
  if (!id) return web::problem(409, "export_running", "Another export is running.");
  return reply({{"id", *id}});
}

Response get_export(const ApiContext& context, const Request& request) {
  const int id = read_id(request.parts.at(0));
  const auto status = context.exports.status(id);
  if (!status) return no_export();
  return reply({{"id", id},
                {"status", export_state_name(status->state)},
                {"name", status->name},
                {"done", status->done},
                {"of", status->of},
                {"seconds_left", status->seconds_left},
                {"bytes", status->bytes},
                {"reason", status->reason}});
}

Response delete_export(const ApiContext& context, const Request& request) {
  const int id = read_id(request.parts.at(0));
  if (!context.exports.cancel(id)) return no_export();
  return reply({{"id", id}});
}

Response get_export_file(const ApiContext& context, const Request& request) {
  const int id = read_id(request.parts.at(0));
  const auto archive = context.exports.archive(id);
  const auto status = context.exports.status(id);
  if (archive.empty() || !status) return no_export();
  return {200,
          "application/zip",
          "",
          {{"Content-Disposition", fmt::format("attachment; filename=\"{}.zip\"", status->name)}},
          std::make_shared<const web::FileBody>(archive)};
}

}  // namespace

std::vector<web::Route> export_routes(ApiContext c) {
  return {
      {"POST", "/api/exports", [c](const Request& r) { return post_export(c, r); }},
      {"GET", "/api/exports/{id}", [c](const Request& r) { return get_export(c, r); }},
      {"DELETE", "/api/exports/{id}", [c](const Request& r) { return delete_export(c, r); }},
      {"GET", "/api/exports/{id}/file", [c](const Request& r) { return get_export_file(c, r); }}};
}

}  // namespace rend
