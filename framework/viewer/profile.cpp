#include "viewer/profile.h"

#include <numeric>
#include <utility>

#include <nlohmann/json.hpp>

namespace loom::viewer {

double ProfiledFrame::gpu_ms() const {
  return std::accumulate(passes.begin(), passes.end(), 0.,
                         [](double sum, const graph::PassCost& p) { return sum + p.gpu_ms; });
}

void Profile::add(ProfiledFrame frame) {
  frames_.push_back(std::move(frame));
  if (frames_.size() > capacity) frames_.pop_front();
}

std::string Profile::chrome_trace() const {
  nlohmann::ordered_json events = nlohmann::ordered_json::array();
  constexpr double us_per_ms = 1e3, us_per_s = 1e6;
  const char* const tracks[] = {"GPU", "CPU"};
  for (int track = 0; track < 2; ++track)
    events.push_back(
        {{"name", "thread_name"}, {"ph", "M"}, {"pid", 1}, {"tid", track}, {"args", {{"name", tracks[track]}}}});
  for (const ProfiledFrame& frame : frames_) {
    for (int track = 0; track < 2; ++track) {
      double at = (frame.start_s - frames_.front().start_s) * us_per_s;
      for (const graph::PassCost& pass : frame.passes) {
        const double duration = (track == 0 ? pass.gpu_ms : pass.cpu_ms) * us_per_ms;
        events.push_back({{"name", pass.name},
                          {"ph", "X"},
                          {"pid", 1},
                          {"tid", track},
                          {"ts", at},
                          {"dur", duration},
                          {"args", {{"frame", frame.index}}}});
        at += duration;
      }
    }
  }
  return nlohmann::ordered_json{{"traceEvents", events}, {"displayTimeUnit", "ms"}}.dump(1) + "\n";
}

}  // namespace loom::viewer
