// Scene files that are wrong: each is refused with the place and a message that helps.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <optional>

#include "engine/core/error.h"
#include "engine/scene/scene_reader.h"

namespace rend {

namespace {

namespace fs = std::filesystem;

const std::string kGood = R"({
  "name": "good",
  "grid": {"dx": 0.05},
  "solver": {"cfl": 0.5},
  "materials": {"clay": {"density": 1000, "youngs_modulus": 1e5, "poisson_ratio": 0.3,
    "yield_surface": {"type": "rankine", "tau_c": 1e4}, "damage": {"type": "granular"}}},
  "bodies": [{"shape": {"type": "box", "size": [1, 0.2, 0.2]}, "material": "clay"}],
  "colliders": [{"shape": {"type": "plane", "normal": [0, 1, 0]},
                 "motion": [{"time": 0}, {"time": 1, "position": [0, 1, 0]}]}],
  "camera": {"eye": [2, 1, 2], "target": [0, 0, 0]},
  "render": {"color_by": "damage"}
})";

std::optional<Error> refusal(const std::string& text, const Overrides& overrides = {}) {
  try {
    parse_scene(text, "bad.json", "/nowhere", {"/nowhere/else"}, overrides);
  } catch (const Error& error) {
    return error;
  }
  return std::nullopt;
}

/// The error of `text`, which must be at `where` (after "bad.json") and say all of `parts`.
void check_refused(const std::string& text, const Overrides& overrides, const std::string& where,
                   std::initializer_list<const char*> parts) {
  const std::optional<Error> error = refusal(text, overrides);
  REQUIRE_MESSAGE(error, "accepted");
  CHECK(error->where() == "bad.json" + where);
  CAPTURE(error->why());
  CHECK(error->why().size() < 1000);
  for (const char* part : parts)
    CHECK_MESSAGE(error->why().find(part) != std::string::npos, std::string(part));
}

struct BadValue {
  const char* pointer;  ///< what is put into the good scene ...
  const char* value;    ///< ... and where
  const char* where;    ///< expected pointer; nullptr: the same one
  std::initializer_list<const char*> parts;
};

const BadValue kBadValues[] = {
    // unknown keys
    {"/graivty", "[0, 0, 0]", nullptr, {"unknown key", "did you mean \"gravity\"?"}},
    {"/solver/clf", "0.5", nullptr, {"unknown key", "\"cfl\"", "known here: precision, transfer"}},
    {"/materials/clay/yeild_surface", "{}", nullptr, {"did you mean \"yield_surface\"?"}},
    {"/materials/clay/yield_surface/tauc", "1", nullptr, {"did you mean \"tau_c\"?"}},
    {"/materials/clay/damage/treshold", "1", nullptr, {"did you mean \"threshold\"?"}},
    {"/bodies/0/colour", "1", nullptr, {"unknown key; known here: shape, material"}},
    {"/bodies/0/shape/radius", "1", nullptr, {"unknown key", "known here: type, size"}},
    {"/colliders/0/motion/0/tiem", "1", nullptr, {"did you mean \"time\"?"}},
    {"/render/width", "640", nullptr, {"unknown key"}},
    {"/camera/near", "0.1", nullptr, {"unknown key"}},
    {"/a~1b", "1", nullptr, {"unknown key"}},
    // wrong types
    {"/grid", "7", nullptr, {"is 7 (a number); it must be an object"}},
    {"/grid/dx", "\"0.1\"", nullptr, {"is \"0.1\" (a text); it must be a number between", " m"}},
    {"/grid/dx", "nan", nullptr, {"\"nan\" (a text)"}},
    {"/grid/dx", "[1]", nullptr, {"(a list)"}},
    {"/frames", "true", nullptr, {"true or false", "whole number"}},
    {"/name", "3", nullptr, {"must be a text"}},
    {"/gravity", "9.81", nullptr, {"a list of 3 numbers"}},
    {"/gravity", "[0, -9.81]", nullptr, {"has 2 items", "a list of 3 numbers"}},
    {"/gravity", "[0, \"down\", 0]", "/gravity/1", {"\"down\" (a text)"}},
    {"/gravity", "[0, [], 0]", "/gravity/1", {"(a list)"}},
    {"/materials", "[]", nullptr, {"an object with a name for each entry"}},
    {"/bodies", "{}", nullptr, {"a list of 1 to 1000 objects"}},
    {"/bodies/0", "7", nullptr, {"it must be an object"}},
    {"/bodies/0/velocity_gradient", "[[1,0,0],[0,1,0]]", nullptr, {"3 rows of 3 numbers"}},
    {"/bodies/0/velocity_gradient",
     "[[1,0,0],[0,1],[0,0,1]]",
     "/bodies/0/velocity_gradient/1",
     {"has 2 items"}},
    {"/colliders/0/visible", "1", nullptr, {"true or false"}},
    {"/solver/transfer", "7", nullptr, {"one of \"pic\", \"flip\""}},
    // out of range
    {"/grid/dx", "0", nullptr, {"is 0; it must be between 1e-06 and 1000 m"}},
    {"/grid/dx", "-0.05", nullptr, {"is -0.05"}},
    {"/frame_rate", "0", nullptr, {"1/s"}},
    {"/frames", "0", nullptr, {"between 1 and 1000000"}},
    {"/frames", "-1", nullptr, {"is -1"}},
    {"/frames", "1.5", nullptr, {"is 1.5", "whole number"}},
    {"/frames", "4294967297", nullptr, {"is 4294967297"}},
    {"/frames", "9223372036854775808", nullptr, {"is 9.223372036854776e18"}},
    {"/frames", "18446744073709551616", nullptr, {"whole number"}},
    {"/frames", "1e30", nullptr, {"is 1e30"}},
    {"/seed", "-1", nullptr, {"between 0 and 9007199254740991"}},
    {"/seed", "9007199254740993", nullptr, {"whole number"}},
    {"/solver/cfl", "0", nullptr, {"between 0.01 and 2"}},
    {"/solver/flip_ratio", "1.01", nullptr, {"between 0 and 1"}},
    {"/solver/polypic_modes", "5", nullptr, {"is 5; it must be one of 1, 4, 8"}},
    {"/solver/xpic_order", "0", nullptr, {"between 1 and 20"}},
    {"/solver/time_step", "-1e-3", nullptr, {" s"}},
    {"/materials/clay/density", "0", nullptr, {"kg/m3"}},
    {"/materials/clay/youngs_modulus", "0", nullptr, {"is 0", " Pa"}},
    {"/materials/clay/youngs_modulus", "-5", nullptr, {"is -5"}},
    {"/materials/clay/poisson_ratio", "0.5", nullptr, {"is 0.5; it must be between 0 and 0.4999"}},
    {"/materials/clay/poisson_ratio", "-1", nullptr, {"is -1"}},
    {"/materials/clay/yield_surface/tau_c",
     "-1",
     nullptr,
     {"is -1; it must be between 0 and", " Pa"}},
    {"/materials/clay/damage/threshold", "2", nullptr, {"between 0 and 1"}},
    {"/materials/clay/damage/friction_angle", "90", nullptr, {"deg"}},
    {"/bodies/0/particles_per_cell", "1e9", nullptr, {"is 1000000000"}},
    {"/bodies/0/shape/size/2", "0", nullptr, {"is 0", " m"}},
    {"/bodies/0/velocity", "[1e30, 0, 0]", "/bodies/0/velocity/0", {"m/s"}},
    {"/colliders/0/friction", "-0.1", nullptr, {"is -0.1"}},
    {"/colliders/0/release_time", "-1", nullptr, {"or \"never\""}},
    {"/fracture/stretch", "0.5", nullptr, {"between 1.001 and 1000, or \"auto\""}},
    {"/fracture/stretch", "automatic", nullptr, {"or \"auto\""}},
    {"/fracture/smoothing_iterations", "1e6", nullptr, {"between 0 and 1000"}},
    {"/camera/fov", "0", nullptr, {"between 1 and 120 deg"}},
    {"/camera/fov", "180", nullptr, {"between 1 and 120 deg"}},
    {"/render/floor", "low", nullptr, {"or \"auto\""}},
    {"/name", "\"a\\u0007b\"", nullptr, {"control characters"}},
    // names
    {"/solver/transfer", "flup", nullptr, {"did you mean \"flip\"?", "\"xpic\""}},
    {"/solver/precision", "half", nullptr, {"\"float\", \"double\""}},
    {"/materials/clay/yield_surface/type", "rankin", nullptr, {"\"rankine\"", "\"von_mises\""}},
    {"/materials/clay/damage/type", "some", nullptr, {"\"off\", \"zero\", \"granular\""}},
    {"/bodies/0/material", "cley", nullptr, {"did you mean \"clay\"?"}},
    {"/bodies/0/shape/type", "cube", nullptr, {"\"box\"", "\"mesh\""}},
    {"/colliders/0/shape/type", "torus", nullptr, {"\"plane\", \"box\", \"sphere\", \"cylinder\""}},
    {"/render/color_by", "heat", nullptr, {"\"yielded\""}},
    // missing keys (null removes one)
    {"/grid", "null", "", {"\"grid\" is missing"}},
    {"/grid/dx", "null", "/grid", {"\"dx\" is missing", "[m]"}},
    {"/materials", "null", "", {"\"materials\" is missing"}},
    {"/bodies", "null", "", {"\"bodies\" is missing"}},
    {"/materials/clay/density", "null", "/materials/clay", {"\"density\" is missing", "kg/m3"}},
    {"/materials/clay/yield_surface/tau_c",
     "null",
     "/materials/clay/yield_surface",
     {"\"tau_c\" is missing"}},
    {"/materials/clay/yield_surface/type",
     "null",
     "/materials/clay/yield_surface",
     {"\"type\" is missing"}},
    {"/bodies/0/shape", "null", "/bodies/0", {"\"shape\" is missing"}},
    {"/bodies/0/shape", "{}", nullptr, {"\"type\" is missing", "\"box\""}},
    {"/bodies/0/shape/size", "null", "/bodies/0/shape", {"\"size\" is missing"}},
    {"/bodies/0/material", "null", "/bodies/0", {"\"material\" is missing"}},
    {"/colliders/0/shape/normal", "null", "/colliders/0/shape", {"\"normal\" is missing"}},
    {"/bodies", "[]", nullptr, {"has 0 items"}},
    {"/materials", "{}", nullptr, {"has 0 entries"}},
    {"/materials/", "{}", "/materials", {"1 to 64 bytes"}},
    // what must fit together
    {"/camera/eye", "[0, 0, 0]", nullptr, {"target"}},
    {"/camera/eye", "[0, 5, 0]", nullptr, {"straight above"}},
    {"/colliders/0/shape/normal", "[0, 0, 0]", nullptr, {"[0, 0, 0]"}},
    {"/colliders/0/motion", "[]", nullptr, {"has 0 items"}},
    {"/colliders/0/motion/1/time", "0", nullptr, {"is 0; it must be above 0 s"}},
    {"/colliders/0/position", "[0, 0, 0]", nullptr, {"either motion or position"}},
    {"/colliders/0/rotation", "[0, 0, 0]", nullptr, {"either motion or rotation"}},
    {"/solver/time_step", "0.5", nullptr, {"one frame"}},
    {"/solver/time_step", "1e-300", nullptr, {"steps a frame"}},
    {"/grid/dx", "1e-6", nullptr, {"\"clay\" needs steps of", "at most 1e+06"}},
    {"/materials/clay/strength_field",
     R"({"modulus": 0.5, "length": 1})",
     "/materials/clay/strength_field/modulus",
     {"at least 1"}},
    {"/materials/clay/strength_field",
     R"({"modulus": 8})",
     "/materials/clay/strength_field/length",
     {"correlation length"}},
    {"/materials/clay/yield_surface",
     R"({"type": "rankine", "tau_c": 1, "softening": 1, "fracture_energy": 1})",
     "/materials/clay/yield_surface/softening",
     {"either fracture_energy or softening"}},
    {"/materials/clay/yield_surface",
     R"({"type": "elastic", "fracture_energy": 1})",
     "/materials/clay/yield_surface/fracture_energy",
     {"unknown key"}},
    {"/materials/clay/yield_surface/fracture_energy",
     "1",
     nullptr,
     {"is 1 J/m2", "snaps back", "take dx below 0.00117"}},
    // shapes
    {"/bodies/0/shape",
     R"({"type": "torus", "major_radius": 1, "minor_radius": 1})",
     "/bodies/0/shape/minor_radius",
     {"below major_radius = 1 m"}},
    {"/bodies/0/shape",
     R"({"type": "prism", "depth": 1, "outline": [[0,0],[1,0]]})",
     "/bodies/0/shape/outline",
     {"has 2 items", "3 to 1000 points"}},
    {"/bodies/0/shape",
     R"({"type": "prism", "depth": 1, "outline": [[0,0],[1,0],[0,1,2]]})",
     "/bodies/0/shape/outline/2",
     {"has 3 items"}},
    {"/bodies/0/shape",
     R"({"type": "prism", "depth": 1, "outline": [[0,0],[1,1],[1,0],[0,1]]})",
     "/bodies/0/shape/outline",
     {"corners 0 and 2 meet"}},
    {"/bodies/0/shape",
     R"({"type": "prism", "depth": 1, "outline": [[0,0],[1,0],[1,0],[0,1]]})",
     "/bodies/0/shape/outline",
     {"corners 1 and 2 are the same point"}},
    {"/bodies/0/shape",
     R"({"type": "prism", "depth": 1, "outline": [[0,0],[1,0],[2,0]]})",
     "/bodies/0/shape/outline",
     {"turns back"}},
    {"/bodies/0/shape",
     R"({"type": "mesh", "file": "models/none.off", "height": 1})",
     "/bodies/0/shape/file",
     {"/nowhere/models/none.off, /nowhere/else/models/none.off", "libcgal-demo", "./rend"}},
    {"/bodies/0/shape",
     R"({"type": "mesh", "file": "own/none.obj", "height": 1})",
     "/bodies/0/shape/file",
     {"cannot find the mesh \"own/none.obj\"; looked for"}},
    {"/bodies/0/shape",
     R"({"type": "mesh", "file": "/etc/passwd", "height": 1})",
     "/bodies/0/shape/file",
     {"must end in .obj, .off, .ply, .stl"}},
    // overrides that lead nowhere
    {"/bodies/1/material", "clay", nullptr, {"leads nowhere: /bodies is a list of 1 items"}},
    {"/bodies/-1", "{}", nullptr, {"leads nowhere"}},
    {"/bodies/00", "{}", nullptr, {"leads nowhere"}},
    {"/bodies/first/material", "clay", nullptr, {"leads nowhere"}},
    {"/grid/dx/0", "1", nullptr, {"leads nowhere: /grid/dx is 0.05"}},
    {"/fracture/0/gap", "1", nullptr, {"leads nowhere: the scene has no /fracture"}},
    {"/bodies/0/velocity/1", "1", nullptr, {"leads nowhere: the scene has no /bodies/0/velocity"}},
    {"grid/dx", "1", nullptr, {"JSON pointer such as /grid/dx"}},
    {"", "{}", nullptr, {"JSON pointer"}},
    {"/grid~2", "1", nullptr, {"~0"}},
    {"/name", "bad \xff byte", nullptr, {"UTF-8"}},
};

struct BadText {
  std::string text;
  const char* where;
  std::initializer_list<const char*> parts;
};

std::string repeated(const std::string& piece, std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text += piece;
  return text;
}

/// `kGood` with `extra` as its first member.
std::string with(const std::string& extra) { return "{" + extra + ", " + kGood.substr(1); }

}  // namespace

TEST_CASE("the scene that the bad ones are made from is good") { CHECK_FALSE(refusal(kGood)); }

TEST_CASE("wrong values are refused at their place") {
  static_assert(std::size(kBadValues) >= 60);
  for (const BadValue& bad : kBadValues) {
    CAPTURE(std::string(bad.pointer));
    CAPTURE(std::string(bad.value));
    check_refused(kGood, {{bad.pointer, bad.value}},
                  std::string("#") + (bad.where ? bad.where : bad.pointer), bad.parts);
  }
}

TEST_CASE("text that is not strict JSON is refused at its line or pointer") {
  const std::string nul("\0", 1);
  const BadText texts[] = {
      {"", ":1:1", {"not valid JSON", "unexpected end of input"}},
      {"{", ":1:1", {"not valid JSON"}},
      {"{\n  \"grid\": {\"dx\": 0.1},\n  \"name\": }", ":3:11", {"unexpected '}'"}},
      {kGood + "x", ":12:2", {"end of input"}},
      {kGood + kGood, ":12:2", {"end of input"}},
      {kGood + nul + "x", "", {"NUL byte"}},
      {"// a scene\n" + kGood, ":1:1", {"not valid JSON"}},
      {"/* a scene */" + kGood, ":1:1", {"not valid JSON"}},
      {"\xef\xbb\xbf\xef\xbb\xbf" + kGood, ":1:4", {"not valid JSON"}},
      {with("\"seed\": NaN"), ":1:10", {"invalid literal"}},
      {with("\"seed\": Infinity"), ":1:10", {"invalid literal"}},
      {with("\"seed\": -Infinity"), ":1:11", {"invalid number"}},
      {with("\"frame_rate\": 1e999"), ":1:20", {"number overflow"}},
      {with("\"seed\": 01"), ":1:11", {"not valid JSON"}},
      {with("\"seed\": 1,"), ":1:12", {"not valid JSON"}},
      {with("'seed': 1"), ":1:2", {"not valid JSON"}},
      {with("\"description\": \"\xff\""), ":1:18", {"invalid string"}},
      {with("\"description\": \"\xc0\xaf\""), ":1:18", {"invalid string"}},
      {with("\"description\": \"\\ud800\""), ":1:24", {"surrogate"}},
      {with("\"description\": \"a\\u0000b\""), "#/description", {"NUL"}},
      {with("\"a\\u0000b\": 1"), "#/", {"NUL"}},
      {with("\"description\": \"tab\tinside\""), ":1:21", {"control character"}},
      {with("\"frames\": 1, \"frames\": 2"), "#/frames", {"given twice"}},
      {with("\"solver\": {\"cfl\": 1, \"c\\u0066l\": 1}"), "#/solver/cfl", {"given twice"}},
      {with("\"x\": [0, {\"y\": 1, \"y\": 1}]"), "#/x/1/y", {"given twice"}},
      {"[1, 2]", "#", {"must be an object"}},
      {"null", "#", {"must be an object"}},
  };
  for (const BadText& bad : texts) {
    CAPTURE(bad.text);
    check_refused(bad.text, {}, bad.where, bad.parts);
  }
}

TEST_CASE("a document that is too deep or too big is refused while it is read") {
  const auto deep = [](std::size_t levels) {
    return with("\"x\": " + repeated("[", levels) + repeated("]", levels));
  };
  check_refused(deep(31), {}, "#/x", {"unknown key"});
  for (const std::size_t levels : {32, 100000, 1000000}) {
    const std::optional<Error> error = refusal(deep(levels));
    REQUIRE(error);
    CHECK(error->where() == "bad.json#/x" + repeated("/0", 31));
    CHECK(error->why() == "nested deeper than 32 levels");
  }
  CHECK(refusal(repeated("{\"a\":", 100000)));
  CHECK(refusal(repeated("[", 100000)));
  check_refused(with("\"x\": [" + repeated("0,", 1000000) + "0]"), {}, "#/x/99998",
                {"more than 100000 values"});
  check_refused(with("\"gravity\": [" + repeated("0,", 50000) + "0]"), {}, "#/gravity",
                {"has 50001 items"});
  check_refused(with("\"x\": \"" + repeated("a", 17 << 20) + "\""), {}, "", {"at most 16777216"});
  check_refused(with("\"" + repeated("k", 100000) + "\": 1"), {}, "#/" + repeated("k", 100000),
                {"unknown key"});
}

TEST_CASE("bodies whose cracks differ in width cannot share a fracture energy") {
  const std::string body = R"({"shape": {"type": "sphere", "radius": 1}, "material": "clay"})";
  const std::string mesh_body = body.substr(0, body.size() - 1) + R"(, "force": "mesh"})";
  const std::string energy = "/materials/clay/yield_surface/fracture_energy";
  CHECK_FALSE(refusal(kGood, {{energy, "200"}, {"/bodies", "[" + body + "," + body + "]"}}));
  check_refused(kGood, {{energy, "200"}, {"/bodies", "[" + body + "," + mesh_body + "]"}},
                "#" + energy, {"particle and with mesh forces", "its own material"});
}

TEST_CASE("files that cannot be read are named") {
  const auto where = [](const fs::path& file) {
    try {
      read_scene(file);
    } catch (const Error& error) {
      return error.where();
    }
    return std::string("accepted");
  };
  CHECK(where("/nowhere/none.json") == "/nowhere/none.json");
  CHECK(where("/") == "/");
}

TEST_CASE("a mesh is taken from the first folder that has it") {
  const fs::path base = fs::temp_directory_path() / "rend_mesh_folders";
  fs::remove_all(base);
  for (const char* folder : {"scenes", "first", "second"})
    fs::create_directories(base / folder / "sub");
  const auto put = [&](const char* folder) {
    std::ofstream(base / folder / "sub" / "a.off") << "OFF";
  };
  const auto found = [&] {
    const SceneDesc scene =
        parse_scene(kGood, "bad.json", base / "scenes", {base / "first", base / "second"},
                    {{"/bodies/0/shape", R"({"type": "mesh", "file": "sub/a.off", "height": 2})"}});
    const auto& mesh = std::get<MeshDesc>(scene.bodies[0].shape);
    CHECK(mesh.file == "sub/a.off");
    CHECK(mesh.height == 2);
    return fs::path(mesh.path);
  };
  put("second");
  CHECK(found() == base / "second/sub/a.off");
  put("first");
  CHECK(found() == base / "first/sub/a.off");
  put("scenes");
  CHECK(found() == base / "scenes/sub/a.off");
  fs::create_directories(base / "scenes/sub/b.off");
  CHECK_THROWS_AS(
      parse_scene(kGood, "bad.json", base / "scenes", {},
                  {{"/bodies/0/shape", R"({"type": "mesh", "file": "sub/b.off", "height": 2})"}}),
      Error);
  fs::remove_all(base);
}

}  // namespace rend
