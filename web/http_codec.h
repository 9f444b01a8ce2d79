// The HTTP library at work on memory: reads a checked head, writes the bytes of a reply.
#pragma once

#include <functional>
#include <string>

#include "web/http_guard.h"
#include "web/server.h"

namespace rend::web {

/// Parses `head.block` (request line, query), calls `handler` with method, path, query and headers
/// filled in, and returns the reply as bytes; never throws.
/// A handler's rend::Error becomes 422 with its pointer, anything else a 500 without text.
std::string answer_request(const GuardedHead& head, bool keep_alive, const Handler& handler);

/// The bytes of a reply made without a handler; `head_only` leaves the body out.
std::string encode_response(const Response& response, bool keep_alive, bool head_only);

}  // namespace rend::web
