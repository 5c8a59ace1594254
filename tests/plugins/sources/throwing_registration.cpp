#include "null_pass.h"

LOOM_PLUGIN("throwing_registration", registry) {
  registry.add<NullPass>("BeforeThrow", "Registered before the plugin fails");
  throw 42;  // NOLINT: that it is no std::exception is the point
}
