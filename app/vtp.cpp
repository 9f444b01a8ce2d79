// VTK XML: a header that names arrays and where they begin, then the arrays as they lie in memory.
#include "app/vtp.h"

#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <numeric>

namespace rend {

static_assert(std::endian::native == std::endian::little, "arrays are written as they lie");

namespace {

constexpr const char* kRoot =
    "<?xml version=\"1.0\"?>\n<VTKFile type=\"{}\" version=\"1.0\" byte_order=\"LittleEndian\" "
    "header_type=\"UInt64\">\n";

const char* type_name(float) { return "Float32"; }
const char* type_name(Real) { return "Float64"; }
const char* type_name(Index) { return "Int32"; }
const char* type_name(std::uint8_t) { return "UInt8"; }

/// Header and appended data grow side by side.
struct Writer {
  std::string header, data;

  template <class T>
  void array(const std::string& name, int components, const T* values, std::size_t count,
             const char* more = "") {
    header += fmt::format(
        "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\"{} format=\"appended\" "
        "offset=\"{}\"/>\n",
        type_name(T{}), name, components, more, data.size());
    const std::uint64_t bytes = count * sizeof(T);
    data.append(reinterpret_cast<const char*>(&bytes), sizeof(bytes));
    data.append(reinterpret_cast<const char*>(values), bytes);
  }

  void arrays(const char* place, const char* attributes, const std::vector<NamedArray>& all) {
    header += fmt::format("<{}{}>\n", place, attributes);
    for (const NamedArray& a : all)
      std::visit([&](const auto& v) { array(a.name, a.components, v.data(), v.size()); }, a.values);
    header += fmt::format("</{}>\n", place);
  }

  void cells(const char* place, const std::vector<Index>& corners, Index each) {
    std::vector<Index> offsets(corners.size() / static_cast<std::size_t>(each));
    for (std::size_t i = 0; i < offsets.size(); ++i)
      offsets[i] = each * (static_cast<Index>(i) + 1);
    header += fmt::format("<{}>\n", place);
    array("connectivity", 1, corners.data(), corners.size());
    array("offsets", 1, offsets.data(), offsets.size());
    header += fmt::format("</{}>\n", place);
  }
};

}  // namespace

std::string vtp(const FrameArrays& frame, Real time) {
  const bool cloud = frame.triangles.empty();
  const std::size_t points = frame.point_count();
  Writer out;
  out.header = fmt::format(fmt::runtime(kRoot), "PolyData") + "<PolyData>\n<FieldData>\n";
  out.array("TimeValue", 1, &time, 1, " NumberOfTuples=\"1\"");
  out.header += fmt::format(
      "</FieldData>\n<Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"0\" "
      "NumberOfStrips=\"0\" NumberOfPolys=\"{}\">\n",
      points, cloud ? points : 0, frame.triangles.size());
  out.arrays("PointData", cloud ? " Scalars=\"damage\"" : " Scalars=\"damage\" Normals=\"normal\"",
             frame.point);
  out.arrays("CellData", "", frame.triangle);
  out.header += "<Points>\n";
  out.array("position", 3, frame.position.data(), frame.position.size());
  out.header += "</Points>\n";
  std::vector<Index> corners;
  if (cloud) {
    corners.resize(points);
    std::iota(corners.begin(), corners.end(), 0);
    out.cells("Verts", corners, 1);
  } else {
    for (const Triangle& t : frame.triangles) corners.insert(corners.end(), t.begin(), t.end());
    out.cells("Polys", corners, 3);
  }
  return out.header + "</Piece>\n</PolyData>\n<AppendedData encoding=\"raw\">\n_" + out.data +
         "\n</AppendedData>\n</VTKFile>\n";
}

std::string pvd(const std::vector<SeriesEntry>& entries) {
  std::string out = fmt::format(fmt::runtime(kRoot), "Collection") + "<Collection>\n";
  for (const SeriesEntry& e : entries)
    out += fmt::format("<DataSet timestep=\"{}\" group=\"\" part=\"0\" file=\"{}\"/>\n", e.time,
                       e.file);
  return out + "</Collection>\n</VTKFile>\n";
}

}  // namespace rend
