#include "viewer/theme.h"

#include <array>
#include <filesystem>
#include <system_error>

namespace loom::viewer {
namespace {

constexpr float font_points = 14;

/// Sans-serif fonts that systems have; with none of them ImGui's own bitmap font serves.
constexpr std::array fonts = {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf", "/usr/share/fonts/TTF/DejaVuSans.ttf",
                              "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
                              "/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf",
                              "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf"};

void load_font(float scale) {
  // Latin, Greek, punctuation, super- and subscripts, arrows, mathematics, blocks and shapes: what units are made of.
  static constexpr std::array<ImWchar, 17> ranges = {0x20,   0xff,   0x370,  0x3ff,  0x2010, 0x2027,
                                                     0x2070, 0x209f, 0x2190, 0x21ff, 0x2200, 0x22ff,
                                                     0x2580, 0x25ff, 0x2713, 0x2718, 0};
  ImGuiIO& io = ImGui::GetIO();
  io.Fonts->Clear();
  io.FontGlobalScale = 1;
  for (const char* font : fonts) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(font, error)) continue;
    if (io.Fonts->AddFontFromFileTTF(font, font_points * scale, nullptr, ranges.data()) != nullptr) return;
  }
  io.FontGlobalScale = scale;
}

}  // namespace

void apply_theme(float scale) {
  ImGui::GetStyle() = ImGuiStyle();  // sizes are scaled from their beginning
  ImGui::StyleColorsDark();
  load_font(scale);
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowRounding = 0;
  style.ChildRounding = 3;
  style.FrameRounding = 3;
  style.GrabRounding = 3;
  style.TabRounding = 3;
  style.PopupRounding = 4;
  style.WindowBorderSize = 0;
  style.WindowPadding = {8, 8};
  style.FramePadding = {6, 3};
  style.ItemSpacing = {7, 5};
  style.ScrollbarSize = 12;
  style.ScaleAllSizes(scale);

  const auto set = [&](ImGuiCol which, float r, float g, float b, float a = 1) { style.Colors[which] = {r, g, b, a}; };
  set(ImGuiCol_Text, .90F, .91F, .93F);
  set(ImGuiCol_TextDisabled, .55F, .57F, .61F);
  set(ImGuiCol_WindowBg, .115F, .12F, .135F);
  set(ImGuiCol_ChildBg, .115F, .12F, .135F);
  set(ImGuiCol_PopupBg, .14F, .145F, .165F, .98F);
  set(ImGuiCol_Border, .25F, .26F, .30F);
  set(ImGuiCol_FrameBg, .185F, .195F, .22F);
  set(ImGuiCol_FrameBgHovered, .235F, .25F, .285F);
  set(ImGuiCol_FrameBgActive, .26F, .29F, .34F);
  set(ImGuiCol_Header, .20F, .225F, .265F);
  set(ImGuiCol_HeaderHovered, .25F, .30F, .37F);
  set(ImGuiCol_HeaderActive, .27F, .35F, .45F);
  set(ImGuiCol_Button, .205F, .22F, .255F);
  set(ImGuiCol_ButtonHovered, .27F, .31F, .37F);
  set(ImGuiCol_ButtonActive, .30F, .40F, .52F);
  set(ImGuiCol_SliderGrab, .27F, .40F, .54F);
  set(ImGuiCol_SliderGrabActive, .30F, .50F, .70F);
  set(ImGuiCol_CheckMark, .46F, .74F, .98F);
  set(ImGuiCol_Tab, .15F, .16F, .185F);
  set(ImGuiCol_TabHovered, .27F, .34F, .43F);
  set(ImGuiCol_TabActive, .215F, .26F, .325F);
  set(ImGuiCol_PlotHistogram, .36F, .67F, .93F);
  set(ImGuiCol_Separator, .22F, .23F, .26F);
}

}  // namespace loom::viewer
