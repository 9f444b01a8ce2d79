// The page's files, built into the program.
#pragma once

#include <span>
#include <string_view>

namespace rend::web {

struct Asset {
  std::string_view path;  ///< "/index.html"
  std::string_view type;  ///< media type
  std::string_view bytes;
  std::string_view etag;  ///< with its quotes
};

/// Every file of web/page, by path; generated at build time.
std::span<const Asset> page_assets();

}  // namespace rend::web
