#pragma once
// Which context is current. Asked before any GL call that may come late (destructors), since the loader aborts the
// process where there is none.

namespace loom::gpu {

/// The current context's handle (EGLContext or GLXContext), or null. Makes no GL call.
void* current_context();

}  // namespace loom::gpu
