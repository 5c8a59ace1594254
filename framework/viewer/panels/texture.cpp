#include "viewer/panels/texture.h"

#include <fmt/core.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>

#include "gpu/format.h"
#include "viewer/theme.h"
#include "viewer/ui.h"

namespace loom::viewer {
namespace {

std::string number(float value) { return fmt::format("{:.5g}", value); }

}  // namespace

void TexturePanel::draw_list(Ui& ui) {
  ImGui::SetNextItemWidth(-1);
  ImGui::InputTextWithHint("##filter", "filter", &filter_);
  std::string pass;
  for (const Inspectable& item : ui.model.inspectables()) {
    if (!filter_.empty() && item.name.find(filter_) == std::string::npos) continue;
    if (item.pass != pass) {
      pass = item.pass;
      ImGui::TextDisabled("%s", pass.c_str());
    }
    const bool selected = item.name == ui.model.inspected();
    if (!item.made) ImGui::PushStyleColor(ImGuiCol_Text, colour::dim);
    const std::string label = "  " + item.name.substr(item.name.find('.') + 1) + "##" + item.name;
    if (ImGui::Selectable(label.c_str(), selected)) {
      ui.later([&ui, name = item.name] { ui.model.inspect(name); });
      ui.selected_pass = item.pass;
    }
    if (!item.made) ImGui::PopStyleColor();
    if (!item.made && ImGui::IsItemHovered())
      ImGui::SetTooltip("nobody reads it, so it is not made;\nlooking at it makes it");
    if (selected) unit_ = item.unit;
  }
}

void TexturePanel::draw_controls(Ui& ui, const Texture& texture) {
  const TextureDesc& desc = texture.desc();
  const TextureViewSettings before = settings;
  ImGui::PushItemWidth(ImGui::GetFontSize() * 7);
  ImGui::TextColored(colour::accent, "%s", ui.model.inspected().c_str());
  ImGui::SameLine();
  ImGui::TextDisabled("%s", to_string(desc).c_str());
  constexpr const char* channels[] = {"RGB", "R", "G", "B", "A"};
  int channel = static_cast<int>(settings.channels);
  if (ImGui::Combo("channels", &channel, channels, 5)) settings.channels = static_cast<Channels>(channel);
  ImGui::SameLine();
  ImGui::SliderFloat("exposure", &settings.exposure, -12, 12, "%.2f stops", ImGuiSliderFlags_AlwaysClamp);
  ImGui::SameLine();
  ImGui::Checkbox("sRGB", &settings.encode);
  ImGui::SameLine();
  ImGui::Checkbox("false colour", &settings.false_colour);
  ImGui::SameLine();
  ImGui::Checkbox("flag bad", &settings.flag);
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("NaN, infinity and negative values in magenta");
  ImGui::Checkbox("percentiles", &percentile_);
  ImGui::SameLine();
  ImGui::DragFloatRange2("##percent", &percent_.x, &percent_.y, .1F, 0, 100, "%.1f %%", "%.1f %%",
                         ImGuiSliderFlags_AlwaysClamp);
  settings.percentiles = percentile_ ? std::optional(percent_) : std::nullopt;
  if (desc.kind == TextureKind::d3) {
    ImGui::SameLine();
    ImGui::SetNextItemWidth(ImGui::GetFontSize() * 4);
    ImGui::Combo("axis", &settings.axis, "x\0y\0z\0");
  } else {
    settings.axis = 2;
  }
  settings.mip = std::clamp(settings.mip, 0, desc.mips - 1);
  if (desc.mips > 1) {
    ImGui::SameLine();
    ImGui::SliderInt("mip", &settings.mip, 0, desc.mips - 1, "%d", ImGuiSliderFlags_AlwaysClamp);
  }
  const SliceShape shape = slice_shape(desc, settings.mip, settings.axis);
  settings.slice = std::clamp(settings.slice, 0, shape.count - 1);
  if (shape.count > 1) {
    ImGui::SameLine();
    ImGui::SliderInt(desc.kind == TextureKind::d3 ? "slice" : "layer", &settings.slice, 0, shape.count - 1, "%d",
                     ImGuiSliderFlags_AlwaysClamp);
  }
  ImGui::PopItemWidth();
  const bool same = before.mip == settings.mip && before.slice == settings.slice && before.axis == settings.axis &&
                    before.channels == settings.channels && before.exposure == settings.exposure &&
                    before.percentiles == settings.percentiles && before.false_colour == settings.false_colour &&
                    before.encode == settings.encode && before.flag == settings.flag;
  stale_ = stale_ || !same;
}

void TexturePanel::refresh(Ui& ui, const Texture& texture) {
  const std::string key = fmt::format("{} {} {}", ui.model.inspected(), texture.name(), settings.mip);
  if (key != shown_ || frame_ != ui.model.frames()) {
    shown_ = key;
    frame_ = ui.model.frames();
    texels_ = {.desc = texture.desc(), .mip = settings.mip, .values = texture.read(settings.mip)};
    stale_ = true;
  }
  if (!stale_) return;
  stale_ = false;
  view_ = make_view(texels_, settings);
  const glm::ivec2 size(view_.width, view_.height);
  if (!picture_ || picture_->desc().width != size.x || picture_->desc().height != size.y)
    picture_ = std::make_unique<Texture>(TextureDesc::image(size, Format::rgba8), "inspector");
  picture_->write(std::as_bytes(std::span(view_.rgba)));
}

void TexturePanel::draw_image() {
  const float line = ImGui::GetTextLineHeightWithSpacing();
  ImVec2 room = ImGui::GetContentRegionAvail();
  room.y -= line;
  if (room.x < 4 || room.y < 4 || view_.width == 0) return;
  float fit = std::min(room.x / static_cast<float>(view_.width), room.y / static_cast<float>(view_.height));
  if (fit > 1) fit = std::floor(fit);
  const ImVec2 size(fit * static_cast<float>(view_.width), fit * static_cast<float>(view_.height));
  const ImVec2 corner = ImGui::GetCursorScreenPos();
  ImGui::Image(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(picture_->name())), size);
  std::string text = fmt::format("shown {} … {}", number(view_.range.x), number(view_.range.y));
  if (view_.not_finite > 0) text += fmt::format("   {} not finite", view_.not_finite);
  if (view_.negative > 0) text += fmt::format("   {} negative", view_.negative);
  if (ImGui::IsItemHovered()) {
    const ImVec2 mouse = ImGui::GetIO().MousePos;
    const int x = static_cast<int>((mouse.x - corner.x) / fit), y = static_cast<int>((mouse.y - corner.y) / fit);
    if (const auto value = texel_at(texels_, settings, x, y)) {
      std::string numbers;
      for (int c = 0; c < gpu::gl_format(texels_.desc.format).channels; ++c)
        numbers += (c == 0 ? "" : ", ") + number((*value)[c]);
      const std::string unit = unit_.empty() ? "" : " " + unit_;
      text = fmt::format("({}, {})  {}{}   ", x, view_.height - 1 - y, numbers, unit) + text;
    }
  }
  ImGui::TextUnformatted(text.c_str());
}

void TexturePanel::draw(Ui& ui) {
  const float unit = ImGui::GetFontSize();
  if (ImGui::BeginChild("textures", {14 * unit, 0})) draw_list(ui);
  ImGui::EndChild();
  ImGui::SameLine();
  if (ImGui::BeginChild("texture")) {
    const Texture* texture = ui.model.inspected_texture();
    if (ui.model.inspected().empty()) {
      ImGui::TextDisabled("choose a texture on the left, or a wire of the graph");
    } else if (texture == nullptr) {
      ImGui::TextDisabled("%s carries nothing here", ui.model.inspected().c_str());
    } else {
      draw_controls(ui, *texture);
      refresh(ui, *texture);
      draw_image();
    }
  }
  ImGui::EndChild();
}

}  // namespace loom::viewer
