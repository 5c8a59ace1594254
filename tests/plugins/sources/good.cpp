#include "null_pass.h"

LOOM_PLUGIN("good", registry) {
  registry.add_bundle({.name = "GoodBundle", .version = 1, .members = {{"a", loom::MemberKind::texture, "m", ""}}});
  registry.add<NullPass>("Good", "Does nothing, as it should");
}
