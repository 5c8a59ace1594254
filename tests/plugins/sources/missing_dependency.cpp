#include "null_pass.h"

extern "C" int absent_answer();

LOOM_PLUGIN("missing_dependency", registry) {
  if (absent_answer() != 0) registry.add<NullPass>("MissingDependency", "");
}
