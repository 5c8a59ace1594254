#include "gpu/timer.h"

#include <epoxy/gl.h>

#include "gpu/current.h"

namespace loom::gpu {
namespace {

// Frames that may be under way before one is dropped unread; drivers queue up to three.
constexpr std::size_t ring = 6;

}  // namespace

SpanTimer::SpanTimer(std::size_t spans, bool settle) : frames_(ring), settle_(settle), context_(current_context()) {
  for (FrameMarks& frame : frames_) {
    frame.queries.resize(spans + 1);
    glCreateQueries(GL_TIMESTAMP, static_cast<GLsizei>(frame.queries.size()), frame.queries.data());
  }
}

SpanTimer::~SpanTimer() {
  if (current_context() != context_) return;
  for (FrameMarks& frame : frames_) glDeleteQueries(static_cast<GLsizei>(frame.queries.size()), frame.queries.data());
}

void SpanTimer::begin_frame() {
  current_ = (current_ + 1) % ring;
  frames_[current_].pending = false;  // where the GPU is that far behind, its figures are dropped
  next_mark_ = 0;
}

void SpanTimer::mark() {
  FrameMarks& frame = frames_[current_];
  if (settle_) glFinish();
  glQueryCounter(frame.queries[next_mark_++], GL_TIMESTAMP);
  if (settle_) glFinish();  // or the mark itself waits in the queue
  frame.pending = next_mark_ == frame.queries.size();
}

void SpanTimer::collect(bool wait, const Done& done) {
  std::vector<double> spans;
  for (std::size_t i = 1; i <= ring; ++i) {
    FrameMarks& frame = frames_[(current_ + i) % ring];
    if (!frame.pending) continue;
    GLuint available = GL_FALSE;
    if (!wait) glGetQueryObjectuiv(frame.queries.back(), GL_QUERY_RESULT_AVAILABLE, &available);
    if (!wait && available == GL_FALSE) return;
    std::vector<GLuint64> times(frame.queries.size());
    for (std::size_t q = 0; q < times.size(); ++q) glGetQueryObjectui64v(frame.queries[q], GL_QUERY_RESULT, &times[q]);
    spans.clear();
    for (std::size_t q = 1; q < times.size(); ++q)
      // Timestamps are nanoseconds; a driver may put a mark of an idle GPU slightly before its predecessor.
      spans.push_back(times[q] > times[q - 1] ? static_cast<double>(times[q] - times[q - 1]) * 1e-6 : 0.);
    frame.pending = false;
    done(spans);
  }
}

}  // namespace loom::gpu
