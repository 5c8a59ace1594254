#include <stdexcept>

#include "null_pass.h"

namespace {

class Thrower final : public NullPass {
 public:
  Thrower() { throw std::runtime_error("the constructor gave up"); }
};

}  // namespace

LOOM_PLUGIN("throwing_constructor", registry) { registry.add<Thrower>("Thrower", "Cannot be made"); }
