// Reads numbers and views out of the query of a request, with errors that name what is allowed.
#pragma once

#include "app/picture_service.h"
#include "app/view.h"

#include <map>
#include <string>

namespace rend {

using Query = std::map<std::string, std::string>;

/// A picture that a viewer asks for; unset camera numbers fall back to the scene's.
struct PictureQuery {
  std::string after;
  int wait_ms = 0;
  Index frame = -1;  ///< -1 is the newest
  int width = 1280, height = 720;
  bool quality_still = false;
  PictureFormat format = PictureFormat::jpeg;
  Query text;

  View view(const Stage& stage) const;
};

struct WaitQuery {
  std::uint64_t after = 0;
  double seconds = 0;
};

/// All throw Error with the name of the query key and what is allowed.
PictureQuery read_picture_query(const Query& query);
WaitQuery read_wait_query(const Query& query);
/// Place in the picture as shares x, y of its size from the top left, both needed.
struct PictureShare {
  Real x = 0, y = 0;
};
PictureShare read_picture_share(const Query& query);
Index read_frame_number(const std::string& text);

}  // namespace rend
