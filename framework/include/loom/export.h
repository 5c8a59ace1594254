#pragma once
// Everything is built with hidden visibility; what a plugin or an embedding program may link is marked LOOM_API.
#define LOOM_API __attribute__((visibility("default")))
