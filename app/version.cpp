// Version and licence notice.
#include "app/version.h"

namespace rend {

std::string version_text() {
  return "rend " REND_VERSION
         "\nSources: MIT licence. This binary contains CGAL's Delaunay triangulation and is therefore distributed "
         "under the GNU GPL, version 3 or later.\n";
}

}  // namespace rend
