// libFuzzer target: the HTTP guard on any bytes; stops on the first property that breaks.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "tests/web/head_properties.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  rend::web::GuardPolicy policy;
  policy.hosts = {"127.0.0.1:8080", "localhost:8080"};
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  const std::string broken = rend::test::broken_property(bytes, policy);
  if (!broken.empty()) {
    std::fprintf(stderr, "broken: %s\n", broken.c_str());
    std::abort();
  }
  return 0;
}
