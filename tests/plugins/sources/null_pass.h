#pragma once
// The least that is a pass.
#include "loom/plugin.h"

namespace {

class NullPass : public loom::Pass {
 public:
  void reflect(loom::Ports& /*ports*/, const loom::SceneFacts& /*facts*/) override {}
  void execute(loom::Frame& /*frame*/, const loom::Bindings& /*bindings*/) override {}
};

}  // namespace
