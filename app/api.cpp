// The HTTP interface.
#include "app/api.h"

#include "app/api_body.h"
#include "app/api_export.h"
#include "app/api_pull.h"
#include "app/api_query.h"
#include "app/frame_formats.h"
#include "app/pixel_probe.h"
#include "app/version.h"
#include "engine/core/error.h"
#include "engine/mpm/energy_balance.h"
#include "web/assets.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <cmath>
#include <thread>

namespace rend {

namespace {

using nlohmann::json;
using web::Request;
using web::Response;

json vector_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

json state_json(const SessionState& s, const Session& session, const PictureService& pictures) {
  json out = {{"revision", s.revision},
              {"scene", s.scene_name},
              {"status", run_state_name(s.run)},
              {"message", s.message},
              {"progress", {{"stage", s.progress_stage}, {"share", s.progress_share}}},
              {"first_frame", s.first_frame},
              {"frame", std::max<Index>(s.last_frame, 0)},
              {"notes", s.notes}};
  out["events"] = json::array();
  for (const Event& e : s.events) out["events"].push_back({{"frame", e.frame}, {"name", e.name}});
  if (!s.stage) return out;
  const SceneDesc& scene = s.stage->scene;
  out["title"] = scene.name;
  out["description"] = scene.description;
  out["frames"] = scene.frames;
  out["frame_rate"] = scene.frame_rate;
  out["camera"] = {{"eye", vector_json(scene.camera.eye)},
                   {"target", vector_json(scene.camera.target)},
                   {"fov", scene.camera.fov}};
  out["view"] = {{"color", scene.render.color_by},
                 {"mode", scene.render.particles ? "particles" : "surface"}};
  const Grip grip = suitable_grip(*s.stage);
  out["grip"] = {{"radius", grip.radius}, {"strength", grip.strength}};
  out["pull"] = pull_json(s.pull);
  const auto newest = session.frame(-1);
  if (!newest) return out;
  const FrameReport& r = newest->frame.snapshot->report;
  const double step_seconds = s.frames_per_second > 0 ? 1 / s.frames_per_second : 0;
  out["time"] = r.time;
  out["particles"] = r.particles;
  out["substeps"] = r.substeps;
  out["dt"] = r.dt_min;
  out["frames_per_second"] = s.frames_per_second;
  out["realtime_factor"] = step_seconds > 0 ? 1 / (scene.frame_rate * step_seconds) : 0;
  out["seconds"] = {{"simulate", r.sim_seconds},
                    {"remesh", newest->cost.post_seconds},
                    {"render", pictures.last_render_seconds()},
                    {"encode", pictures.last_encode_seconds()}};
  out["broken_edges"] = newest->frame.fracture.broken_edges;
  out["pieces"] = newest->frame.fracture.pieces;
  out["yielded"] = r.yielded;
  out["damaged"] = r.damaged;
  out["energy_drift"] = energy_drift(r);
  const std::string warning = energy_warning(r);
  out["energy_warning"] = warning.empty() ? json(nullptr) : json(warning);
  out["reason"] =
      r.status == Status::ok
          ? json(nullptr)
          : json{{"status", status_name(r.status)}, {"text", r.reason}, {"frame", r.frame}};
  return out;
}

json control_json(const Control& c, const SceneDesc& now, const SceneDesc& loaded) {
  json out = {
      {"id", c.id},          {"label", c.label},
      {"unit", c.unit},      {"help", c.help},
      {"group", c.group},    {"min", c.min},
      {"max", c.max},        {"scale", c.logarithmic ? "log" : "linear"},
      {"value", c.get(now)}, {"default", c.get(loaded)},
      {"hero", c.hero},      {"applies", c.applies == Applies::live ? "live" : "postprocess"}};
  if (c.whole) out["step"] = 1;
  return out;
}

Response list_scenes(const ApiContext& context) {
  json scenes = json::array();
  for (const std::string& name : context.session.library().names()) {
    try {
      const SceneDesc scene = context.session.library().read(name);
      scenes.push_back({{"name", name}, {"title", scene.name}, {"description", scene.description}});
    } catch (const Error& error) {
      scenes.push_back(
          {{"name", name}, {"title", name}, {"description", ""}, {"problem", error.why()}});
    }
  }
  return reply({{"current", context.session.state().scene_name}, {"scenes", scenes}});
}

Response get_parameters(const ApiContext& context) {
  const SessionState s = context.session.state();
  json parameters = json::array();
  if (s.stage)
    for (const Control& c : s.controls)
      parameters.push_back(control_json(c, s.stage->scene, *s.loaded));
  return reply({{"revision", s.revision}, {"parameters", parameters}});
}

Response patch_parameters(const ApiContext& context, const Request& request) {
  const JsonValue body = parse_body(request.body, {"values"});
  const JsonValue* values = body.find("values");
  if (!values || values->kind != JsonValue::Kind::object)
    throw Error("/values", "must be an object of control ids and numbers");
  SetValues set;
  for (const auto& [id, value] : values->members) {
    if (value.kind != JsonValue::Kind::number) throw Error("/values/" + id, "must be a number");
    set.values[id] = value.number;
  }
  context.session.send(std::move(set));
  return reply({{"revision", context.session.state().revision}});
}

Response post_action(const ApiContext& context, const Request& request) {
  const std::string& action = request.parts.at(0);
  const bool steps = action == "step";
  const JsonValue body =
      steps ? parse_body(request.body, {"frames"}) : parse_body(request.body, {});
  if (action == "play")
    context.session.send(Play{});
  else if (action == "pause")
    context.session.send(Pause{});
  else if (action == "reset")
    context.session.send(Reset{});
  else if (steps) {
    const Real frames = body.find("frames") ? read_number(body, "frames", 1, 1000) : 1;
    if (frames != std::floor(frames))
      throw Error("/frames", "must be a whole number from 1 to 1000");
    context.session.send(Step{static_cast<int>(frames)});
  } else {
    return web::problem(404, "unknown_action", "actions are play, pause, step and reset");
  }
  return reply({{"revision", context.session.state().revision}});
}

Response post_scene(const ApiContext& context, const Request& request) {
  const JsonValue body = parse_body(request.body, {"name"});
  const JsonValue* name = body.find("name");
  if (!name || name->kind != JsonValue::Kind::text)
    throw Error("/name", "must be the name of a scene");
  context.session.send(LoadScene{name->text});
  return reply({{"revision", context.session.state().revision}});
}

Response post_pull(const ApiContext& context, const Request& request) {
  const SetPull set = read_pull(request.body);
  const RunState run = context.session.state().run;
  if (set.pull.radius > 0 && (run == RunState::finished || run == RunState::stopped))
    return web::problem(409, "run_ended", "The run has ended; reset it to pull.");
  context.session.send(set);
  return reply({{"revision", context.session.state().revision}});
}

/// Waits until the wanted picture differs from the one named by `after`.
Response get_picture(const ApiContext& context, const Request& request) {
  const PictureQuery query = read_picture_query(request.query);
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::milliseconds(query.wait_ms);
  while (true) {
    const SessionState state = context.session.state();
    const auto recorded = context.session.frame(query.frame);
    if (!recorded && state.last_frame >= 0)
      return web::problem(404, "no_frame", "this frame is not recorded");
    if (recorded && state.stage) {
      const Frame& frame = recorded->frame;
      const View view = query.view(*state.stage);
      const std::string frame_key =
          fmt::format("{}-{}-{}", state.data, frame.snapshot->frame, state.scene_name);
      const std::string token =
          fmt::format("{:016x}", std::hash<std::string>{}(frame_key + view.key()));
      if (token != query.after) {
        const auto picture =
            context.pictures.picture(frame_key, state.stage, frame, view, query.format);
        if (!picture) return web::problem(503, "stopping", "the server is stopping");
        return {
            200,
            "image/jpeg",
            picture->bytes,
            {{"X-Token", token},
             {"X-Frame", std::to_string(frame.snapshot->frame)},
             {"X-Frames", std::to_string(state.last_frame)},
             {"X-Time", fmt::format("{}", frame.snapshot->time)},
             {"X-Legend", fmt::format("{};{};{}", picture->low, picture->high, picture->caption)},
             {"Cache-Control", "no-store"}}};
      }
    }
    const double left =
        std::chrono::duration<double>(deadline - std::chrono::steady_clock::now()).count();
    if (left <= 0 || *request.stopping)
      return {204, "text/plain", "", {{"Cache-Control", "no-store"}}};
    context.session.state(state.revision, left, request.stopping);
  }
}

Response get_probe(const ApiContext& context, const Request& request) {
  const PictureQuery query = read_picture_query(request.query);
  const PictureShare at = read_picture_share(request.query);
  const SessionState state = context.session.state();
  const auto recorded = context.session.frame(query.frame);
  if (!recorded || !state.stage) return web::problem(404, "no_frame", "this frame is not recorded");
  const Frame& frame = recorded->frame;
  // The frame may be older than a scene that was loaded since.
  if (frame.snapshot->x.size() != state.model->X.size())
    return web::problem(404, "no_frame", "the scene has changed");
  json out = {{"frame", frame.snapshot->frame}, {"matter", nullptr}};
  if (const auto found =
          probe_pixel(*state.stage, *state.model, frame, query.view(*state.stage), at.x, at.y)) {
    out["matter"] = {{"position", vector_json(found->position)},
                     {"rest", vector_json(found->rest)},
                     {"velocity", vector_json(found->velocity)},
                     {"material", found->material},
                     {"particle", found->particle},
                     {"piece", found->piece},
                     {"crack", found->crack},
                     {"damage", found->damage},
                     {"threshold", found->threshold},
                     {"stress", found->stress},
                     {"share_of_break_threshold", found->nearness},
                     {"yielded", found->yielded}};
  }
  return reply(out);
}

Response post_mesh(const ApiContext& context, const Request& request) {
  const auto name = request.query.find("name");
  if (name == request.query.end() || name->second.empty())
    throw Error("name", "is needed: the file's name");
  const UploadedMesh uploaded = context.uploads.add(name->second, request.body);
  return reply({{"name", uploaded.name}, {"notes", uploaded.notes}});
}

/// A recorded frame as a picture, or as a mesh of the given format.
Response get_frame_file(const ApiContext& context, const Request& request,
                        const FrameFormat* format) {
  const Index number = read_frame_number(request.parts.at(0));
  const auto recorded = context.session.frame(number);
  const SessionState state = context.session.state();
  if (!recorded || !state.stage) return web::problem(404, "no_frame", "this frame is not recorded");
  const std::string name = fmt::format("{}-{:06}", state.scene_name, number);
  const auto attachment = [&](const std::string& ending) {
    return std::map<std::string, std::string>{
        {"Content-Disposition", fmt::format("attachment; filename=\"{}.{}\"", name, ending)}};
  };
  if (format)
    return {200, format->media_type,
            format->surface(*recorded->frame.surface, recorded->frame.snapshot->time),
            attachment(format->name)};
  PictureQuery query = read_picture_query(request.query);
  query.quality_still = true;
  const std::string frame_key = fmt::format("{}-{}-{}", state.data, number, state.scene_name);
  const auto picture = context.pictures.picture(frame_key, state.stage, recorded->frame,
                                                query.view(*state.stage), PictureFormat::png);
  if (!picture) return web::problem(503, "stopping", "the server is stopping");
  return {200, "image/png", picture->bytes, attachment("png")};
}

Response get_series(const ApiContext& context, const Request& request) {
  const auto from = request.query.find("from");
  const Index first = from == request.query.end() ? 0 : read_frame_number(from->second);
  json frames = json::array(), columns = json::object();
  const auto add = [&](const char* name, double value) { columns[name].push_back(value); };
  for (const auto& recorded : context.session.frames_from(first)) {
    const FrameReport& r = recorded->frame.snapshot->report;
    frames.push_back(r.frame);
    add("time", r.time);
    add("kinetic_energy", r.kinetic_energy);
    add("elastic_energy", r.elastic_energy);
    add("gravity_energy", r.gravity_energy);
    add("dissipated_energy", r.dissipated_energy);
    add("friction_energy", r.friction_energy);
    add("external_work", r.external_work);
    add("affine_energy", r.affine_energy);
    add("start_energy", r.start_energy);
    add("gravity_change", r.gravity_change);
    add("transfer_loss", r.transfer_loss);
    add("energy_drift", energy_drift(r));
    add("momentum_x", r.momentum.x());
    add("momentum_y", r.momentum.y());
    add("momentum_z", r.momentum.z());
    add("broken_edges", recorded->frame.fracture.broken_edges);
    add("pieces", recorded->frame.fracture.pieces);
    add("sim_seconds", r.sim_seconds);
    add("post_seconds", recorded->cost.post_seconds);
    add("render_seconds", context.pictures.last_render_seconds());
  }
  return reply({{"from", first}, {"frames", frames}, {"columns", columns}});
}

/// The picture of a scene that was embedded at build time, or 204.
Response embedded_thumbnail(const std::string& scene) {
  for (const web::Asset& asset : web::page_assets())
    if (asset.path == "/thumbs/" + scene + ".jpg")
      return {200, "image/jpeg", std::string(asset.bytes), {}};
  return {204, "text/plain", "", {}};
}

Response get_thumbnail(const ApiContext& context, const Request& request) {
  const SessionState state = context.session.state();
  const auto recorded = context.session.frame(-1);
  const std::string& scene = request.parts.at(0);
  if (scene != state.scene_name || !recorded || !state.stage) return embedded_thumbnail(scene);
  View view = default_view(state.stage->scene);
  view.width = 320;
  view.height = 200;
  view.legend = false;
  const auto theme = request.query.find("theme");
  if (theme != request.query.end() && theme->second == "dark") view.theme = Theme::dark;
  const std::string frame_key =
      fmt::format("{}-{}-{}", state.data, recorded->frame.snapshot->frame, state.scene_name);
  const auto picture =
      context.pictures.picture(frame_key, state.stage, recorded->frame, view, PictureFormat::jpeg);
  if (!picture) return {204, "text/plain", "", {}};
  return {200, "image/jpeg", picture->bytes, {{"Cache-Control", "no-store"}}};
}

Response get_state(const ApiContext& context, const Request& request) {
  const WaitQuery wait = read_wait_query(request.query);
  const SessionState state = context.session.state(wait.after, wait.seconds, request.stopping);
  return reply(state_json(state, context.session, context.pictures));
}

Response get_version(const ApiContext& context) {
  return reply({{"version", REND_VERSION},
                {"notice", version_text()},
                {"renderer", context.pictures.describe()},
                {"capabilities", {"upload", "pull", "probe", "export"}}});
}

}  // namespace

std::vector<web::Route> make_api(ApiContext c) {
  std::vector<web::Route> routes = {
      {"GET", "/api/health",
       [](const Request&) {
         return reply({{"ok", true}});
       }},
      {"GET", "/api/version", [c](const Request&) { return get_version(c); }},
      {"GET", "/api/scenes", [c](const Request&) { return list_scenes(c); }},
      {"GET", "/api/scenes/{name}/thumb.jpg",
       [c](const Request& r) { return get_thumbnail(c, r); }},
      {"POST", "/api/scene", [c](const Request& r) { return post_scene(c, r); }},
      {"GET", "/api/state", [c](const Request& r) { return get_state(c, r); }, 0, true},
      {"GET", "/api/parameters", [c](const Request&) { return get_parameters(c); }},
      {"PATCH", "/api/parameters", [c](const Request& r) { return patch_parameters(c, r); }},
      {"POST", "/api/actions/{action}", [c](const Request& r) { return post_action(c, r); }},
      {"POST", "/api/pull", [c](const Request& r) { return post_pull(c, r); }},
      {"GET", "/api/frame.jpg", [c](const Request& r) { return get_picture(c, r); }, 0, true},
      {"GET", "/api/probe", [c](const Request& r) { return get_probe(c, r); }},
      {"POST", "/api/meshes", [c](const Request& r) { return post_mesh(c, r); },
       MeshUploads::kMostBytes, true, "application/octet-stream"},
      {"GET", "/api/series", [c](const Request& r) { return get_series(c, r); }},
      {"GET", "/api/frames/{n}.png",
       [c](const Request& r) { return get_frame_file(c, r, nullptr); }},
  };
  for (const FrameFormat& format : frame_formats())
    routes.push_back({"GET", "/api/frames/{n}/mesh." + format.name,
                      [c, &format](const Request& r) { return get_frame_file(c, r, &format); }});
  for (web::Route& route : export_routes(c)) routes.push_back(std::move(route));
  return routes;
}

}  // namespace rend
