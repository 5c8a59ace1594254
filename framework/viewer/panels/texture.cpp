#include "viewer/panels/texture.h"

#include <fmt/core.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>

#include "gpu/format.h"
#include "gpu/read_region.h"
#include "viewer/theme.h"
#include "viewer/ui.h"

namespace loom::viewer {
namespace {

std::string number(float value) { return fmt::format("{:.5g}", value); }

double now_s() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

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
    if (selected) begin(item);
  }
}

void TexturePanel::begin(const Inspectable& item) {
  if (item_.name == item.name) return;
  item_ = item;
  settings.flag = item.never_negative ? Flag::negative : Flag::not_finite;
}

void TexturePanel::draw_controls(Ui& ui, const Texture& texture) {
  ImGui::TextColored(colour::accent, "%s", ui.model.inspected().c_str());
  ImGui::SameLine();
  ImGui::TextDisabled("%s", to_string(texture.desc()).c_str());
  ImGui::PushItemWidth(ImGui::GetFontSize() * 7);
  constexpr const char* channels[] = {"RGB", "R", "G", "B", "A"};
  int channel = static_cast<int>(settings.channels);
  ImGui::SetNextItemWidth(ImGui::GetFontSize() * 4);
  if (ImGui::Combo("channels", &channel, channels, 5)) settings.channels = static_cast<Channels>(channel);
  ImGui::SameLine();
  ImGui::SliderFloat("exposure", &settings.exposure, -12, 12, "%.2f stops", ImGuiSliderFlags_AlwaysClamp);
  ImGui::SameLine();
  ImGui::Checkbox("sRGB", &settings.encode);
  ImGui::SameLine();
  ImGui::Checkbox("false colour", &settings.false_colour);
  ImGui::SameLine();
  int flag = static_cast<int>(settings.flag);
  ImGui::SetNextItemWidth(ImGui::GetFontSize() * 6);
  if (ImGui::Combo("magenta", &flag, "nothing\0NaN, inf\0+ negative\0")) settings.flag = static_cast<Flag>(flag);
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip(
        "what stands out: nothing; NaN and infinity; these and negative values,\n"
        "which is chosen where the quantity cannot be negative");
  draw_range(texture.desc());
  if (ui.model.inspects_volume()) draw_volume(ui);
  ImGui::PopItemWidth();
}

void TexturePanel::draw_range(const TextureDesc& desc) {
  bool percentiles = settings.percentiles.has_value();
  ImGui::Checkbox("percentiles", &percentiles);
  ImGui::SameLine();
  ImGui::DragFloatRange2("##percent", &percent_.x, &percent_.y, .1F, 0, 100, "%.1f %%", "%.1f %%",
                         ImGuiSliderFlags_AlwaysClamp);
  settings.percentiles = percentiles ? std::optional(percent_) : std::nullopt;
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
}

void TexturePanel::draw_volume(Ui& ui) {
  ImGui::Checkbox("in the scene", &volume.on);
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip(
        "draw its cells at their place: values as cubes, harmonics as lobes, probes as spheres.\n"
        "Point at one in the picture to read it.");
  if (!volume.on) return;
  ImGui::SameLine();
  ImGui::Checkbox("this slice alone", &volume.one_slice);
  ImGui::SameLine();
  ImGui::SetNextItemWidth(ImGui::GetFontSize() * 5);
  ImGui::SliderFloat("size", &volume.size, .1F, 1, "%.2f", ImGuiSliderFlags_AlwaysClamp);
  const int parts = ui.overlay.parts();
  volume.part = std::clamp(volume.part, 0, parts - 1);
  if (parts > 1) {
    ImGui::SameLine();
    ImGui::SetNextItemWidth(ImGui::GetFontSize() * 5);
    ImGui::SliderInt("part", &volume.part, 0, parts - 1, "%d", ImGuiSliderFlags_AlwaysClamp);
    if (ImGui::IsItemHovered()) ImGui::SetTooltip("cascade, axis or side: slabs that lie one behind the other along z");
  }
  const CellMesh& mesh = ui.overlay.mesh();
  ImGui::SameLine();
  ImGui::TextDisabled("%zu of %zu filled cells", mesh.bodies.size(), mesh.cells);
}

bool TexturePanel::wants_redraw() const { return put_off_ && now_s() >= next_read_s_; }

void TexturePanel::refresh(Ui& ui, const Texture& texture) {
  const std::string key =
      fmt::format("{} {} {} {} {}", ui.model.inspected(), texture.name(), settings.mip, settings.axis, settings.slice);
  const bool other = key != shown_, newer = version_ != ui.model.inspected_version();
  const double start = now_s();
  put_off_ = newer && !other && start < next_read_s_;
  if ((newer || other) && !put_off_) {
    shown_ = key;
    version_ = ui.model.inspected_version();
    const TexelBox box = slice_box(texture.desc(), settings);
    texels_ = {.desc = texture.desc(),
               .mip = settings.mip,
               .box = box,
               .values = gpu::read_region(texture, settings.mip, box.lower, box.size)};
    ++reads_;
    stale_ = true;
  }
  if (stale_ || settings != viewed_) {
    stale_ = false;
    viewed_ = settings;
    view_ = make_view(texels_, settings);
    const glm::ivec2 size(view_.width, view_.height);
    if (!picture_ || picture_->desc().width != size.x || picture_->desc().height != size.y)
      picture_ = std::make_unique<Texture>(TextureDesc::image(size, Format::rgba8), "inspector");
    picture_->write(std::as_bytes(std::span(view_.rgba)));
  }
  const double end = now_s();
  if (version_ == ui.model.inspected_version() && !put_off_ && end - start > 0) next_read_s_ = end + 9 * (end - start);
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
  picture_at_ = {corner.x, corner.y};
  texel_size_ = fit;
  ImGui::Image(image_of(*picture_), size);
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
      const glm::ivec3 p = place_of(texels_.desc, settings, x, y);
      const std::string place = level_box(texels_.desc, settings.mip).size.z > 1
                                    ? fmt::format("({}, {}, {})", p.x, p.y, p.z)
                                    : fmt::format("({}, {})", p.x, p.y);
      text = fmt::format("{}  {}{}   ", place, numbers, item_.unit.empty() ? "" : " " + item_.unit) + text;
    }
  }
  ImGui::TextUnformatted(text.c_str());
  said_ = std::move(text);
}

void TexturePanel::draw(Ui& ui) {
  const float unit = ImGui::GetFontSize();
  if (ImGui::BeginChild("textures", {14 * unit, 0})) draw_list(ui);
  ImGui::EndChild();
  ImGui::SameLine();
  if (ImGui::BeginChild("texture")) {
    const Texture* texture = ui.model.inspected_texture();
    if (ui.model.inspected().empty()) {
      ImGui::TextDisabled("choose a texture or buffer on the left, or a wire of the graph");
    } else if (const Buffer* buffer = ui.model.inspected_buffer(); buffer != nullptr) {
      if (item_.name == ui.model.inspected()) table_.draw(ui, item_, *buffer);
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
