#pragma once
// RenderDoc, where it is attached to this process.
#include <functional>
#include <string>

namespace loom::viewer {

/// Does not load RenderDoc: asks whether it is there.
bool renderdoc_attached();
/// Captures what `work` draws. Returns the path of the capture, empty where RenderDoc gave none. Throws Error where it
/// is not attached.
std::string renderdoc_capture(const std::function<void()>& work);

}  // namespace loom::viewer
