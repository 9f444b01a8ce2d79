// Entry point of the rend program.
#include "app/command_line.h"

#include <malloc.h>

int main(int argc, char** argv) {
  // Large arrays go back to the system when they are freed; glibc would keep ever larger ones.
  mallopt(M_MMAP_THRESHOLD, 4 << 20);
  return rend::run_command_line(argc, argv);
}
