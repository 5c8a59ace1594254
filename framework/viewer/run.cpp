// The one symbol of the library.
#include "viewer/app.h"
#include "viewer/entry.h"

extern "C" LOOM_API void loom_viewer_run(const loom::viewer::Options& options);

void loom_viewer_run(const loom::viewer::Options& options) { loom::viewer::App(options).run(); }
