// The main() of benchmarks that need OpenGL.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <string>

#include "support/gl.h"

int main(int argc, char** argv) {
  std::string why;
  if (!loom::test::shared_context(why)) return std::fprintf(stderr, "%s\n", why.c_str()), 1;
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
