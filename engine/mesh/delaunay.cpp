// The only file that knows CGAL: 3D Delaunay with exact predicates.
#include "engine/mesh/delaunay.h"

#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Delaunay_triangulation_cell_base_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_cell_base_with_info_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

#include <utility>

namespace rend {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using VertexBase = CGAL::Triangulation_vertex_base_with_info_3<Index, Kernel>;
using CellBase =
    CGAL::Triangulation_cell_base_with_info_3<Index, Kernel,
                                              CGAL::Delaunay_triangulation_cell_base_3<Kernel>>;
using Triangulation =
    CGAL::Delaunay_triangulation_3<Kernel,
                                   CGAL::Triangulation_data_structure_3<VertexBase, CellBase>>;

}  // namespace

DelaunayCells delaunay(const std::vector<Vec3>& points) {
  std::vector<std::pair<Kernel::Point_3, Index>> input;
  input.reserve(points.size());
  for (const Vec3& x : points)
    input.emplace_back(Kernel::Point_3(x.x(), x.y(), x.z()), static_cast<Index>(input.size()));
  const Triangulation triangulation(input.begin(), input.end());
  DelaunayCells cells;
  if (triangulation.dimension() < 3) return cells;
  for (const auto cell : triangulation.all_cell_handles()) cell->info() = -1;
  for (const auto cell : triangulation.finite_cell_handles()) {
    cell->info() = static_cast<Index>(cells.tets.size());
    cells.tets.push_back({cell->vertex(0)->info(), cell->vertex(1)->info(), cell->vertex(2)->info(),
                          cell->vertex(3)->info()});
  }
  cells.neighbours.reserve(cells.tets.size());
  for (const auto cell : triangulation.finite_cell_handles())
    cells.neighbours.push_back({cell->neighbor(0)->info(), cell->neighbor(1)->info(),
                                cell->neighbor(2)->info(), cell->neighbor(3)->info()});
  return cells;
}

}  // namespace rend
