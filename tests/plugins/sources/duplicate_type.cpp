// The pass type of good.cpp again, after a pass and a bundle that must be undone.
#include "null_pass.h"

LOOM_PLUGIN("duplicate_type", registry) {
  registry.add_bundle({.name = "BeforeDuplicateBundle"});
  registry.add<NullPass>("BeforeDuplicate", "Registered before the plugin fails");
  registry.add<NullPass>("Good", "The same name again");
}
