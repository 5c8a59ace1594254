#pragma once
// What earlier runs of the user's left in the cache (measurements of scenes change plans) is none of a test's business.

namespace loom::test {

/// From now on this process and those that it starts have an empty cache folder of their own. Compiled shaders, which
/// change nothing but time, stay where Mesa keeps them.
void isolate_user_cache();

}  // namespace loom::test
