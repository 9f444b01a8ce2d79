// The HTTP interface of a session: JSON in SI units, pictures, downloads.
#pragma once

#include "app/api_upload.h"
#include "app/export_jobs.h"
#include "app/picture_service.h"
#include "app/session.h"
#include "web/server.h"

#include <filesystem>
#include <vector>

namespace rend {

/// What the routes act on; must outlive the server.
struct ApiContext {
  Session& session;
  PictureService& pictures;
  MeshUploads& uploads;
  ExportJobs& exports;
};

/// All /api routes (docs/api.md).
std::vector<web::Route> make_api(ApiContext context);

}  // namespace rend
