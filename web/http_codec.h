// The HTTP library at work on memory: reads a checked head, writes the bytes of a reply.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "web/http_guard.h"
#include "web/server.h"

namespace rend::web {

/// What goes out: head and body, or a head and the file whose bytes follow it.
struct Reply {
  std::string bytes;
  std::shared_ptr<const FileBody> file;
  std::uint64_t size() const { return bytes.size() + (file ? file->size() : 0); }
};

/// Parses `head.block` (request line, query), calls `handler` with method, path, query and headers
/// filled in, and returns the reply; never throws.
/// A handler's rend::Error becomes 422 with its pointer, anything else a 500 without text.
Reply answer_request(const GuardedHead& head, bool keep_alive, const Handler& handler);

/// A reply made without a handler; `head_only` leaves the body out.
Reply encode_response(const Response& response, bool keep_alive, bool head_only);

}  // namespace rend::web
