// Version and licence notice.
#include "app/version.h"

#include "engine/mpm/tile_kernel.h"

namespace rend {

std::string version_text() {
  const TileKernels* kernels = tile_kernels();
  return std::string("rend " REND_VERSION "\nSolver: ") +
         (kernels ? std::string("tile, ") + kernels->name : std::string("reference only")) +
         "\nSources: MIT licence. This binary contains CGAL's Delaunay triangulation and is therefore distributed "
         "under the GNU GPL, version 3 or later.\n";
}

}  // namespace rend
