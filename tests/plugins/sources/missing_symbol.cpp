// Calls a function that no library has.
#include "null_pass.h"

extern "C" int a_function_that_nobody_defines();

LOOM_PLUGIN("missing_symbol", registry) {
  if (a_function_that_nobody_defines() != 0) registry.add<NullPass>("MissingSymbol", "");
}
