// Entry point of the rend program.
#include "app/command_line.h"

#include <fcntl.h>
#include <malloc.h>
#include <unistd.h>

int main(int argc, char** argv) {
  // Where a standard stream is closed, the first file that is opened would take its place.
  int fd = -1;
  do fd = ::open("/dev/null", O_RDWR);
  while (fd >= 0 && fd <= 2);
  if (fd >= 0) ::close(fd);
  // Large arrays go back to the system when they are freed; glibc would keep ever larger ones.
  mallopt(M_MMAP_THRESHOLD, 4 << 20);
  return rend::run_command_line(argc, argv);
}
