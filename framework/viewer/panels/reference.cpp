#include "viewer/panels/reference.h"

#include <imgui.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <span>
#include <utility>

#include "measure/colormap.h"
#include "viewer/texture_view.h"
#include "viewer/theme.h"
#include "viewer/ui.h"

namespace loom::viewer {
namespace {

void upload(std::unique_ptr<Texture>& texture, glm::ivec2 size, const std::vector<std::uint32_t>& rgba) {
  if (!texture || texture->desc().width != size.x || texture->desc().height != size.y)
    texture = std::make_unique<Texture>(TextureDesc::image(size, Format::rgba8), "reference");
  texture->write(std::as_bytes(std::span(rgba)));
}

void picture(const Texture* texture, float height, const char* title) {
  if (texture == nullptr) return;
  const float width = height * static_cast<float>(texture->desc().width) / static_cast<float>(texture->desc().height);
  ImGui::BeginGroup();
  ImGui::TextDisabled("%s", title);
  ImGui::Image(image_of(*texture), {width, height});
  ImGui::EndGroup();
  ImGui::SameLine();
}

}  // namespace

bool ReferencePanel::follow(Ui& ui) {
  Model& model = ui.model;
  if (!on) {
    if (worker_.running()) worker_.stop();
    view_ = 0;
    return false;
  }
  if (model.frame_due()) return false;  // the picture comes first; what moves has no truth to converge to
  if (view_ != model.view_version() || !worker_.running()) {
    view_ = model.view_version();
    points_.clear();
    picture_ = 0;
    state_.metrics.reset();
    worker_.start(model.setup().scene, model.camera(), model.size());
  }
  if (picture_ != model.frames()) {
    picture_ = model.frames();
    pipeline_of_picture_ = std::filesystem::path(model.pipeline_path()).stem().string();
    worker_.measure(picture_, model.radiance());
  }
  std::optional<ReferenceState> newer = worker_.newer_than(state_.version);
  if (!newer) return false;
  state_ = std::move(*newer);
  show(state_);
  if (state_.metrics && state_.picture == picture_) {
    std::erase_if(points_, [&](const MeasuredPoint& p) { return p.pipeline == pipeline_of_picture_; });
    points_.push_back({pipeline_of_picture_, model.frame_times().gpu_median_ms, state_.metrics->relmse});
  }
  return true;
}

void ReferencePanel::show(const ReferenceState& state) {
  if (state.radiance.empty()) return;
  Texels texels{.desc = TextureDesc::image(state.size, Format::rgba32f),
                .mip = 0,
                .box = {.size = {state.size, 1}},
                .values = {}};
  // Texels have their bottom row first.
  for (int y = state.size.y - 1; y >= 0; --y)
    for (int x = 0; x < state.size.x; ++x)
      texels.values.emplace_back(state.radiance[static_cast<std::size_t>(y) * static_cast<std::size_t>(state.size.x) +
                                                static_cast<std::size_t>(x)],
                                 1);
  upload(truth_, state.size, make_view(texels, {.percentiles = glm::vec2(0, 99), .flag = Flag::none}).rgba);
  if (state.flip.size() != state.radiance.size()) return;
  std::vector<std::uint32_t> heat;
  heat.reserve(state.flip.size());
  for (const float error : state.flip) heat.push_back(colour_of(measure::magma(error), {.encode = false}, {0, 1}));
  upload(heat_, state.size, heat);
}

void ReferencePanel::draw(Ui& ui) {
  ImGui::Checkbox("trace in the background", &on);
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip("on all cores but one, up to %u samples a pixel", ReferenceWorker::enough);
  if (state_.samples > 0) {
    ImGui::SameLine();
    ImGui::TextDisabled("%u samples a pixel%s, relative noise %.2g", state_.samples, state_.done ? ", done" : "",
                        state_.noise);
  }
  if (state_.metrics) {
    ImGui::SameLine();
    ImGui::Text("relMSE %.4g   mean ratio %.3f   FLIP %.3f", state_.metrics->relmse, state_.metrics->mean_ratio,
                state_.metrics->flip.value_or(0));
  }
  plot.draw_controls(ui.model.scene_path(), ui.model.size());
  const ImVec2 room = ImGui::GetContentRegionAvail();
  if (room.y < 20) return;
  // The pictures leave the plot room for its labels.
  const float aspect = state_.size.y > 0 ? static_cast<float>(state_.size.x) / static_cast<float>(state_.size.y) : 1;
  const float height = std::min(room.y - ImGui::GetTextLineHeightWithSpacing(), .31F * room.x / aspect);
  picture(truth_.get(), height, "reference");
  picture(heat_.get(), height, "FLIP");
  plot.draw_plot(points_, std::filesystem::path(ui.model.pipeline_path()).stem().string());
}

}  // namespace loom::viewer
