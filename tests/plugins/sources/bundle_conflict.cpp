// Declares the bundle type of good.cpp with another layout, after a pass that must be undone.
#include "null_pass.h"

LOOM_PLUGIN("bundle_conflict", registry) {
  registry.add<NullPass>("BeforeConflict", "Registered before the plugin fails");
  registry.add_bundle({.name = "GoodBundle", .version = 1, .members = {{"b", loom::MemberKind::texture, "m", ""}}});
}
