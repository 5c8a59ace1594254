#pragma once
// Passes that only declare: enough for the compiler, which never runs one.
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "graph/compile/compile.h"
#include "loom/pass.h"
#include "loom/registry.h"

namespace loom::test {

/// A pass whose reflect() is a function.
class Declared : public Pass {
 public:
  using Reflect = std::function<void(Ports&, const SceneFacts&)>;
  explicit Declared(Reflect reflect) : reflect_(std::move(reflect)) {}
  void reflect(Ports& ports, const SceneFacts& facts) override { reflect_(ports, facts); }
  void execute(Frame& /*frame*/, const Bindings& /*bindings*/) override {}

 private:
  Reflect reflect_;
};

inline void add(Registry& registry, std::string name, Declared::Reflect reflect) {
  registry.add_pass({.name = std::move(name), .summary = "a fake", .create = [reflect = std::move(reflect)] {
                       return std::make_unique<Declared>(reflect);
                     }});
}

/// The types used in tests/graph: Geometry, Lights, Blur, Show, Accumulate and so on; see fakes.cpp.
Registry fake_registry();

/// A scene with one spot light.
SceneFacts one_light();

/// Compiles a pipeline text named "test.json".
graph::CompileResult compile(const std::string& text, const Registry& registry,
                             const graph::CompileOptions& options = {}, const SceneFacts& facts = one_light());

/// All diagnostics as text, for messages of failed tests.
std::string text_of(const Diagnostics& diagnostics);

/// The resource of that name; fails the test where there is none.
const graph::Resource& resource(const graph::CompiledGraph& graph, std::string_view name);
bool has_resource(const graph::CompiledGraph& graph, std::string_view name);
/// The names of the passes that run, in order, separated by blanks.
std::string order_of(const graph::CompiledGraph& graph);

}  // namespace loom::test
