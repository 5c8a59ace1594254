// How long the compiler takes, from text to plan. Goal: a graph of 1,000 passes in 10 ms.
#include <benchmark/benchmark.h>

#include "graph/fakes.h"
#include "graph/random_graph.h"

namespace loom::test {
namespace {

void compile_random(benchmark::State& state) {
  const Registry registry = random_registry();
  const RandomGraph model = random_graph(37, static_cast<int>(state.range(0)));
  // Without pruning, so that every pass is planned and not only those that the outputs need.
  const graph::CompileOptions options{.prune = false};
  std::size_t passes = 0;
  for (auto _ : state) {
    const auto result = compile(model.text, registry, options);
    passes = result.graph ? result.graph->order.size() : 0;
    benchmark::DoNotOptimize(result);
  }
  if (passes != model.names.size()) state.SkipWithError("the graph does not compile");
}
BENCHMARK(compile_random)->Arg(10)->Arg(100)->Arg(1000)->Unit(benchmark::kMillisecond);

void compile_pruned(benchmark::State& state) {
  const Registry registry = random_registry();
  const RandomGraph model = random_graph(37, static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(compile(model.text, registry));
}
BENCHMARK(compile_pruned)->Arg(1000)->Unit(benchmark::kMillisecond);

void parse_only(benchmark::State& state) {
  const RandomGraph model = random_graph(37, static_cast<int>(state.range(0)));
  for (auto _ : state) {
    Diagnostics diagnostics;
    benchmark::DoNotOptimize(json::parse(model.text, "test.json", diagnostics));
  }
}
BENCHMARK(parse_only)->Arg(1000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace loom::test
