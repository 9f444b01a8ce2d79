// `rend serve`.
#include "app/serve_command.h"

#include "app/api.h"
#include "app/picture_service.h"
#include "app/session.h"

#include <fmt/format.h>

#include <csignal>
#include <thread>

namespace rend {

namespace {

/// Blocks SIGINT and SIGTERM in every thread that is started later, so that one thread can wait for them.
class StopSignals {
 public:
  StopSignals() {
    sigemptyset(&set_);
    sigaddset(&set_, SIGINT);
    sigaddset(&set_, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &set_, nullptr);
  }

  void wait() const {
    int signal = 0;
    sigwait(&set_, &signal);
  }

 private:
  sigset_t set_;
};

}  // namespace

int serve(SceneLibrary library, const ServeOptions& options) {
  const StopSignals signals;
  library.read(options.scene);
  PictureService pictures(options.gl);
  Session session(std::move(library), options.scene);
  MeshUploads uploads(session.library());
  ExportJobs exports;
  web::Server server(options.server, make_api({session, pictures, uploads, exports}));
  fmt::print("rend is at {}  (Ctrl+C ends it)\n", server.url());
  std::fflush(stdout);
  std::thread stopper([&] {
    signals.wait();
    server.stop();
  });
  server.run();
  stopper.join();
  return 0;
}

}  // namespace rend
