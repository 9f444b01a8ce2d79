// The routes of exports: many frames as one archive.
#pragma once

#include "app/api.h"

#include <vector>

namespace rend {

/// GET and POST /api/exports, GET and DELETE /api/exports/{id}, GET /api/exports/{id}/file
/// (docs/api.md).
std::vector<web::Route> export_routes(ApiContext context);

}  // namespace rend
