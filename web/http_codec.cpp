// The HTTP library at work on memory: reads a checked head, writes the bytes of a reply.
#include "web/http_codec.h"

#include <httplib.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <new>
#include <string_view>
#include <utility>

#include "engine/core/error.h"

namespace rend::web {
namespace {

// The guard and the use of `process_request` rest on how this very version reads and writes.
static_assert(std::string_view(CPPHTTPLIB_VERSION) == "0.11.4",
              "read web/http_codec.cpp and run tests/web before changing the cpp-httplib version");

class MemoryStream final : public httplib::Stream {
 public:
  explicit MemoryStream(std::string_view input) : input_(input) {}

  bool is_readable() const override { return !input_.empty(); }
  bool is_writable() const override { return true; }
  ssize_t read(char* to, std::size_t size) override {
    const std::size_t count = std::min(size, input_.size());
    std::memcpy(to, input_.data(), count);
    input_.remove_prefix(count);
    return static_cast<ssize_t>(count);
  }
  ssize_t write(const char* from, std::size_t size) override {
    output.append(from, size);
    return static_cast<ssize_t>(size);
  }
  void get_remote_ip_and_port(std::string&, int&) const override {}
  void get_local_ip_and_port(std::string&, int&) const override {}
  socket_t socket() const override { return -1; }

  std::string output;

 private:
  std::string_view input_;
};

bool safe_header(const std::string& name, const std::string& value) {
  const auto printable = [](unsigned char c) { return c >= 32 && c != 127; };
  return !name.empty() && std::all_of(value.begin(), value.end(), printable) &&
         std::all_of(name.begin(), name.end(),
                     [](unsigned char c) { return std::isalnum(c) || c == '-'; });
}

// A reply of our own may not split either: a header with a line break is a bug in a handler.
Response checked(Response response) {
  bool fine = response.status >= 200 && response.status <= 599 &&
              (response.type.empty() || safe_header("Content-Type", response.type));
  for (const auto& [name, value] : response.headers) fine = fine && safe_header(name, value);
  return fine ? std::move(response) : problem(500, "internal", "The request failed inside.");
}

std::string json_pointer_of(const Error& error) {
  const std::string& where = error.where();
  const auto hash = where.find("#/");
  if (hash != std::string::npos) return where.substr(hash + 1);
  // "file:line" and plain file names must not leave the machine.
  const bool pointer = !where.empty() && where[0] == '/' && where.find(':') == std::string::npos;
  return pointer ? where : "";
}

Response guarded_call(const Handler& handler, const Request& request) {
  try {
    return handler(request);
  } catch (const Error& error) {
    return problem(422, "invalid", error.why(), json_pointer_of(error));
  } catch (const std::bad_alloc&) {
    return problem(507, "out_of_memory", "The request needs more memory than there is.");
  } catch (...) {
    return problem(500, "internal", "The request failed inside.");
  }
}

// One exchange: the library reads the head and writes the reply, nothing of it touches a socket.
class Exchange final : private httplib::Server {
 public:
  Reply run(const GuardedHead& head, bool keep_alive, const web::Handler& handler) {
    set_pre_routing_handler([&](const httplib::Request& in, httplib::Response& out) {
      fill(out, checked(respond(head, in, handler)), head.method == "HEAD");
      return HandlerResponse::Handled;
    });
    set_post_routing_handler([](const httplib::Request&, httplib::Response& out) {
      out.headers.erase("Keep-Alive");
      out.headers.erase("Accept-Ranges");
      if (out.status == 204 || out.status == 304) out.headers.erase("Content-Length");
    });
    MemoryStream stream(head.block);
    bool closed = false;
    process_request(stream, !keep_alive, closed, nullptr);
    return {std::move(stream.output), std::move(file_)};
  }

 private:
  static Response respond(const GuardedHead& head, const httplib::Request& in,
                          const web::Handler& handler) {
    // Two readers of one request line must agree, else one of them has been led astray.
    if (in.method != head.method || in.path != head.path) {
      return problem(400, "bad_target", "The request target is ambiguous.");
    }
    Request request;
    request.method = in.method;
    request.path = in.path;
    for (const auto& [name, value] : in.params) request.query.emplace(name, value);
    request.headers = head.headers;
    return guarded_call(handler, request);
  }

  void fill(httplib::Response& out, Response&& response, bool head_only) {
    static const std::pair<const char*, const char*> security[] = {
        {"Content-Security-Policy",
         "default-src 'self'; img-src 'self' blob: data:; base-uri 'none'; form-action 'none'; "
         "frame-ancestors 'none'"},
        {"X-Content-Type-Options", "nosniff"},
        {"Cross-Origin-Resource-Policy", "same-origin"},
        {"Cross-Origin-Opener-Policy", "same-origin"},
        {"Referrer-Policy", "no-referrer"}};
    out.status = response.status;
    for (const auto& [name, value] : response.headers) out.set_header(name, value);
    for (const auto& [name, value] : security) {
      out.headers.erase(name);
      out.set_header(name, value);
    }
    if (!out.has_header("Cache-Control")) out.set_header("Cache-Control", "no-store");
    if ((!response.body.empty() || response.file) && !response.type.empty()) {
      out.set_header("Content-Type", response.type);
    }
    // The library knows no length of a body that it never sees written.
    if (head_only || response.file) {
      const std::uint64_t size = response.file ? response.file->size() : response.body.size();
      out.set_header("Content-Length", std::to_string(size));
    } else {
      out.body = std::move(response.body);
    }
    if (!head_only) file_ = std::move(response.file);
  }

  std::shared_ptr<const FileBody> file_;
};

}  // namespace

Reply answer_request(const GuardedHead& head, bool keep_alive, const Handler& handler) {
  return Exchange().run(head, keep_alive, handler);
}

Reply encode_response(const Response& response, bool keep_alive, bool head_only) {
  GuardedHead head;
  head.method = std::string(head_only ? "HEAD" : "GET");
  head.path = std::string("/");
  head.block = head.method + " / HTTP/1.1\r\n\r\n";
  return answer_request(head, keep_alive, [&](const Request&) { return response; });
}

}  // namespace rend::web
