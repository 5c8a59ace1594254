#include "viewer/panels/reference.h"

#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>
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

std::uint32_t packed(const glm::vec3& c) {
  return 0xff000000u | static_cast<std::uint32_t>(c.r * 255 + .5F) | static_cast<std::uint32_t>(c.g * 255 + .5F) << 8 |
         static_cast<std::uint32_t>(c.b * 255 + .5F) << 16;
}

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
  ImGui::Image(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(texture->name())), {width, height});
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
  Texels texels{.desc = TextureDesc::image(state.size, Format::rgba32f), .values = {}};
  // Texels have their bottom row first.
  for (int y = state.size.y - 1; y >= 0; --y)
    for (int x = 0; x < state.size.x; ++x)
      texels.values.emplace_back(state.radiance[static_cast<std::size_t>(y) * static_cast<std::size_t>(state.size.x) +
                                                static_cast<std::size_t>(x)],
                                 1);
  upload(truth_, state.size, make_view(texels, {.percentiles = glm::vec2(0, 99), .flag = false}).rgba);
  if (state.flip.size() != state.radiance.size()) return;
  std::vector<std::uint32_t> heat;
  heat.reserve(state.flip.size());
  for (const float error : state.flip) heat.push_back(packed(measure::magma(error)));
  upload(heat_, state.size, heat);
}

void ReferencePanel::draw_plot(const std::string& open) const {
  const ImVec2 room(std::max(ImGui::GetContentRegionAvail().x, 40.F), std::max(ImGui::GetContentRegionAvail().y, 40.F));
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  ImDrawList* list = ImGui::GetWindowDrawList();
  list->AddRectFilled(corner, {corner.x + room.x, corner.y + room.y}, IM_COL32(22, 23, 27, 255));
  const ImU32 dim = ImGui::GetColorU32(ImGuiCol_TextDisabled);
  list->AddText({corner.x + 4, corner.y + 2}, dim, "relMSE over GPU ms, both by ratio: lower left is better");
  if (points_.empty()) return;
  double left = 1e9, right = 0, low = 1e9, high = 0;
  for (const MeasuredPoint& p : points_) {
    left = std::min(left, p.gpu_ms), right = std::max(right, p.gpu_ms);
    low = std::min(low, p.relmse), high = std::max(high, p.relmse);
  }
  // A factor of two around all points, so that a single one stands in the middle.
  const auto place = [](double v, double from, double to) {
    return std::log(std::max(v, 1e-9) / (.5 * std::max(from, 1e-9))) /
           std::log(4 * std::max(to, 1e-9) / std::max(from, 1e-9));
  };
  for (const MeasuredPoint& p : points_) {
    const ImVec2 at(corner.x + room.x * static_cast<float>(place(p.gpu_ms, left, right)),
                    corner.y + room.y * static_cast<float>(1 - place(p.relmse, low, high)));
    const bool is_open = p.pipeline == open;
    list->AddCircleFilled(at, is_open ? 5.F : 3.5F,
                          ImGui::ColorConvertFloat4ToU32(is_open ? colour::changed : colour::accent));
    list->AddText({at.x + 8, at.y - 7}, ImGui::GetColorU32(ImGuiCol_Text),
                  fmt::format("{}  {:.3g} ms  {:.3g}", p.pipeline, p.gpu_ms, p.relmse).c_str());
  }
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
  const float height = ImGui::GetContentRegionAvail().y - 2 * ImGui::GetTextLineHeightWithSpacing();
  if (height < 20 || state_.radiance.empty()) return;
  picture(truth_.get(), height, "reference");
  picture(heat_.get(), height, "FLIP");
  draw_plot(std::filesystem::path(ui.model.pipeline_path()).stem().string());
}

}  // namespace loom::viewer
