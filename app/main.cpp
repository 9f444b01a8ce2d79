// Entry point of the rend program.
#include "app/version.h"

#include <cstdio>

int main() {
  std::fputs(rend::version_text().c_str(), stdout);
  return 0;
}
