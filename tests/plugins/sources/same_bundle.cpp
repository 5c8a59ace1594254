// Declares the bundle type of good.cpp, in other words: the two merge.
#include "null_pass.h"

LOOM_PLUGIN("same_bundle", registry) {
  registry.add_bundle(
      {.name = "GoodBundle", .version = 1, .members = {{"a", loom::MemberKind::texture, "m", "prose"}}});
  registry.add<NullPass>("SameBundle", "Brings a bundle type that is there already");
}
