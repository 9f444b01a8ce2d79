// glTF: one buffer, one view and one accessor an array.
#include "app/glb.h"

#include "render/color_map.h"
#include "render/corner_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

namespace rend {

namespace {

constexpr int kFloat = 5126, kUnsignedInt = 5125, kUnsignedShort = 5123;
constexpr int kArrayBuffer = 34962, kElementBuffer = 34963;
constexpr int kPoints = 0, kTriangles = 4;

/// Collects arrays; every text member is the inside of a JSON array.
class Writer {
 public:
  /// Returns the accessor's number.
  int add(const void* values, std::size_t count, std::size_t item, const char* shape, int type,
          int target, const std::string& more = "") {
    comma(views_), comma(accessors_);
    views_ += fmt::format("{{\"buffer\":0,\"byteOffset\":{},\"byteLength\":{},\"target\":{}}}",
                          data_.size(), count * item, target);
    accessors_ +=
        fmt::format("{{\"bufferView\":{},\"componentType\":{},\"count\":{},\"type\":\"{}\"{}}}",
                    count_, type, count, shape, more);
    data_.append(static_cast<const char*>(values), count * item);
    data_.resize((data_.size() + 3) / 4 * 4);
    return count_++;
  }

  void attribute(const std::string& name, int accessor) {
    comma(attributes_);
    attributes_ += fmt::format("\"{}\":{}", name, accessor);
  }

  void floats(const std::string& name, const std::vector<float>& values, int components) {
    const std::size_t count = values.size() / static_cast<std::size_t>(components);
    std::string range;
    if (name == "POSITION") {
      float low[3] = {0, 0, 0}, high[3] = {0, 0, 0};
      for (std::size_t k = 0; k < values.size(); ++k) {
        low[k % 3] = k < 3 ? values[k] : std::min(low[k % 3], values[k]);
        high[k % 3] = k < 3 ? values[k] : std::max(high[k % 3], values[k]);
      }
      range = fmt::format(",\"min\":[{},{},{}],\"max\":[{},{},{}]", low[0], low[1], low[2], high[0],
                          high[1], high[2]);
    }
    attribute(name, add(values.data(), count, 4 * static_cast<std::size_t>(components),
                        components == 3 ? "VEC3" : "SCALAR", kFloat, kArrayBuffer, range));
  }

  /// Linear light, 16 bits a channel.
  void colors(const std::vector<float>& damage, const std::vector<std::uint8_t>& crack) {
    const auto pack = [](const Rgb& color) {
      std::array<std::uint16_t, 4> out{0, 0, 0, 65535};
      const Rgb linear = to_linear(color);
      for (std::size_t k = 0; k < 3; ++k)
        out[k] = static_cast<std::uint16_t>(65535 * std::clamp(linear[k], 0.f, 1.f) + 0.5f);
      return out;
    };
    std::array<std::array<std::uint16_t, 4>, 256> ramp;
    for (std::size_t k = 0; k < ramp.size(); ++k)
      ramp[k] = pack(ramp_color(ColorMap::damage, static_cast<float>(k) / 255));
    const auto torn = pack(hex_color(kCrack));
    std::vector<std::array<std::uint16_t, 4>> color(damage.size());
    for (std::size_t v = 0; v < color.size(); ++v)
      color[v] = !crack.empty() && crack[v]
                     ? torn
                     : ramp[static_cast<std::size_t>(255 * std::clamp(damage[v], 0.f, 1.f) + 0.5f)];
    attribute("COLOR_0", add(color.data(), color.size(), sizeof(color[0]), "VEC4", kUnsignedShort,
                             kArrayBuffer, ",\"normalized\":true"));
  }

  void primitive(const std::vector<std::uint32_t>& corners, int material, int mode) {
    comma(primitives_);
    primitives_ += fmt::format("{{\"attributes\":{{{}}},\"material\":{},\"mode\":{}", attributes_,
                               material, mode);
    if (mode == kTriangles)
      primitives_ += fmt::format(",\"indices\":{}", add(corners.data(), corners.size(), 4, "SCALAR",
                                                        kUnsignedInt, kElementBuffer));
    primitives_ += "}";
  }

  std::string finish(Real time) {
    std::string json = fmt::format(
        "{{\"asset\":{{\"version\":\"2.0\",\"generator\":\"rend " REND_VERSION
        "\"}},\"scene\":0,\"scenes\":[{{\"nodes\":[0]}}],"
        "\"nodes\":[{{\"mesh\":0,\"extras\":{{\"time\":{},\"units\":\"m, s, Pa\"}}}}],"
        "\"meshes\":[{{\"primitives\":[{}]}}],\"materials\":[{},{}],"
        "\"accessors\":[{}],\"bufferViews\":[{}],\"buffers\":[{{\"byteLength\":{}}}]}}",
        time, primitives_, material("skin"), material("crack"), accessors_, views_, data_.size());
    json.resize((json.size() + 3) / 4 * 4, ' ');
    std::string out = "glTF";
    const auto number = [&](std::size_t value) {
      const auto word = static_cast<std::uint32_t>(value);
      out.append(reinterpret_cast<const char*>(&word), 4);
    };
    number(2), number(12 + 8 + json.size() + 8 + data_.size());
    number(json.size()), out += "JSON", out += json;
    number(data_.size()), out.append("BIN\0", 4), out += data_;
    return out;
  }

 private:
  static void comma(std::string& list) {
    if (!list.empty()) list += ',';
  }
  static std::string material(const char* name) {
    return fmt::format(
        "{{\"name\":\"{}\",\"pbrMetallicRoughness\":{{\"metallicFactor\":0,\"roughnessFactor\":"
        "0.8}}}}",
        name);
  }

  std::string attributes_, primitives_, accessors_, views_, data_;
  int count_ = 0;
};

std::string upper(std::string name) {
  std::transform(name.begin(), name.end(), name.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return "_" + name;
}

/// Own attributes may not be unsigned integers, and viewers read floats best.
std::vector<float> as_floats(const NamedArray& array) {
  return std::visit([](const auto& v) { return std::vector<float>(v.begin(), v.end()); },
                    array.values);
}

std::vector<float> gather(const std::vector<float>& values, int components,
                          const std::vector<Index>& from) {
  std::vector<float> out;
  out.reserve(from.size() * static_cast<std::size_t>(components));
  for (Index v : from)
    for (int k = 0; k < components; ++k)
      out.push_back(values[static_cast<std::size_t>(components * v + k)]);
  return out;
}

}  // namespace

std::string surface_glb(const SurfaceMesh& mesh, Real time) {
  const FrameArrays arrays = surface_arrays(mesh);
  const SplitSurface split = split_surface(mesh);
  std::vector<std::uint32_t> corners[2];
  std::vector<std::uint8_t> crack(split.vertex.size(), 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = split.corner[3 * t + k];
      corners[mesh.interior[t]].push_back(v);
      crack[v] = mesh.interior[t];
    }
  std::vector<float> normal;
  for (const Vec3f& n : split.normal) normal.insert(normal.end(), n.data(), n.data() + 3);
  const std::vector<Index> pieces = vertex_pieces(mesh);

  Writer out;
  out.floats("POSITION", gather(arrays.position, 3, split.vertex), 3);
  out.floats("NORMAL", normal, 3);
  out.colors(gather(mesh.damage, 1, split.vertex), crack);
  for (const NamedArray& a : arrays.point)
    if (a.name != "normal")
      out.floats(upper(a.name), gather(as_floats(a), a.components, split.vertex), a.components);
  out.floats("_PIECE", gather({pieces.begin(), pieces.end()}, 1, split.vertex), 1);
  for (int kind = 0; kind < 2; ++kind)
    if (!corners[kind].empty()) out.primitive(corners[kind], kind, kTriangles);
  return out.finish(time);
}

std::string particles_glb(const Snapshot& snapshot, const Model& model) {
  const FrameArrays arrays = particle_arrays(snapshot, model);
  Writer out;
  out.floats("POSITION", arrays.position, 3);
  out.colors(snapshot.damage, {});
  for (const NamedArray& a : arrays.point) out.floats(upper(a.name), as_floats(a), a.components);
  out.primitive({}, 0, kPoints);
  return out.finish(snapshot.time);
}

}  // namespace rend
