// posix_spawn, because fork in a program with threads is fragile; input in a memory file, because
// writing to a dead child's pipe would raise SIGPIPE here.
#include "engine/mesh/loader_process.h"

#include "engine/core/error.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <thread>

namespace rend {

namespace {

using Clock = std::chrono::steady_clock;

[[noreturn]] void fail(const std::string& why) { throw Error("file", why); }

class Descriptor {
 public:
  explicit Descriptor(int fd = -1) : fd_(fd) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() { reset(); }
  int get() const { return fd_; }
  void reset(int fd = -1) {
    if (fd_ >= 0) close(fd_);
    fd_ = fd;
  }

 private:
  int fd_;
};

// Never leaves a process behind: whatever happens, it is killed and waited for.
class Child {
 public:
  Child(const std::string& program, const std::vector<std::string>& arguments, int in, int out) {
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, in, STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, out, STDOUT_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawn_file_actions_addclosefrom_np(&actions, 3);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    // The program may ignore or block signals; the loader must die of its own.
    sigset_t all, none;
    sigfillset(&all);
    sigemptyset(&none);
    posix_spawnattr_setsigdefault(&attributes, &all);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
    std::vector<char*> argv = {const_cast<char*>(program.c_str())};
    for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
    argv.push_back(nullptr);
    char locale[] = "LC_ALL=C";
    char* environment[] = {locale, nullptr};
    const int error =
        posix_spawn(&pid_, program.c_str(), &actions, &attributes, argv.data(), environment);
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    if (error != 0) {
      pid_ = -1;
      fail(fmt::format("cannot start the mesh loader {}: {}", program, std::strerror(error)));
    }
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    if (pid_ <= 0) return;
    kill(pid_, SIGKILL);
    while (waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }

  // False when it still runs at the deadline.
  bool wait_until(Clock::time_point deadline, int& status) {
    for (;;) {
      const pid_t done = waitpid(pid_, &status, WNOHANG);
      if (done == pid_ || (done < 0 && errno != EINTR)) {
        pid_ = -1;
        return true;
      }
      if (Clock::now() >= deadline) return false;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }

 private:
  pid_t pid_ = -1;
};

std::string find_loader(const MeshLoading& loading) {
  if (!loading.loader.empty()) return loading.loader.string();
  std::error_code ignored;
  const auto folder = std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path();
  for (const auto& candidate : {folder / "rend-meshload", folder.parent_path() / "rend-meshload"})
    if (access(candidate.c_str(), X_OK) == 0) return candidate.string();
  fail("cannot be read: the program rend-meshload is missing beside " + folder.string());
}

void fill_memory_file(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = write(fd, bytes.data(), bytes.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) fail("cannot be read: no memory to hand it to the mesh loader");
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  lseek(fd, 0, SEEK_SET);
}

// False when the deadline passes before the other end is closed.
bool read_until(int fd, Clock::time_point deadline, std::size_t limit, std::string& out) {
  std::vector<char> chunk(1 << 16);
  for (;;) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0) return false;
    pollfd wait{fd, POLLIN, 0};
    const int ready = poll(&wait, 1, static_cast<int>(left) + 1);
    if (ready < 0 && errno == EINTR) continue;
    if (ready <= 0) return false;
    const ssize_t n = read(fd, chunk.data(), chunk.size());
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return true;
    out.append(chunk.data(), static_cast<std::size_t>(n));
    if (out.size() > limit) fail("gives more triangles than fit into memory");
  }
}

}  // namespace

std::string run_mesh_loader(std::string_view bytes, const std::string& ending,
                            const MeshLoading& loading) {
  const auto deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(
                                           std::chrono::duration<Real>(loading.wall_seconds));
  Descriptor in(memfd_create("mesh", MFD_CLOEXEC));
  if (in.get() < 0) fail("cannot be read: no memory to hand it to the mesh loader");
  fill_memory_file(in.get(), bytes);
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) fail("cannot be read: too many open files");
  Descriptor out(ends[0]), out_of_child(ends[1]);
  Child child(find_loader(loading),
              {ending, std::to_string(loading.cpu_seconds), std::to_string(loading.memory_bytes)},
              in.get(), out_of_child.get());
  out_of_child.reset();
  std::string output;
  int status = 0;
  if (!read_until(out.get(), deadline, loading.memory_bytes, output) ||
      !child.wait_until(deadline, status))
    fail(fmt::format("is damaged or too large: the mesh loader did not finish in {} s",
                     loading.wall_seconds));
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    // Its own limits end in SIGXCPU or a failed allocation; nothing of ours sends SIGKILL before the wall limit.
    if (signal == SIGKILL)
      fail("was not read: the mesh loader was killed from outside, perhaps because the machine is out of memory");
    if (signal == SIGXCPU)
      fail(fmt::format(
          "is damaged or too large: the mesh loader took more than {} s of processor time",
          loading.cpu_seconds));
    fail(fmt::format("is damaged: the mesh loader crashed on it (signal {})", signal));
  }
  return output;
}

}  // namespace rend
