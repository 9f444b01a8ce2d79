// A traced child, stepped by its parent.
#include "bench/instruction_count.h"

#include <sys/ptrace.h>
#include <sys/wait.h>
#include <unistd.h>
#include <csignal>

namespace rend {

namespace {

// Stopped by the mark itself, not by the end of the child or another signal.
bool stops_at_mark(pid_t child) {
  int status = 0;
  return waitpid(child, &status, 0) == child && WIFSTOPPED(status) && WSTOPSIG(status) == SIGSTOP;
}

double step_to_mark(pid_t child) {
  for (double count = 0;; ++count) {
    int status = 0;
    if (ptrace(PTRACE_SINGLESTEP, child, nullptr, nullptr) != 0) return -1;
    if (waitpid(child, &status, 0) != child || !WIFSTOPPED(status)) return -1;
    if (WSTOPSIG(status) == SIGSTOP) return count;
    if (WSTOPSIG(status) != SIGTRAP) return -1;
  }
}

}  // namespace

double count_instructions(const std::function<void(const std::function<void()>& mark)>& body) {
  const pid_t child = fork();
  if (child < 0) return -1;
  if (child == 0) {
    if (ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) != 0) _exit(1);
    body([] { std::raise(SIGSTOP); });
    _exit(0);
  }
  double count = -1;
  if (stops_at_mark(child)) count = step_to_mark(child);
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  return count;
}

}  // namespace rend
