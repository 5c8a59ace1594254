#pragma once
// What the panels share. A panel draws and says what shall happen; it happens after the frame is drawn, so that no
// texture or pass goes while somebody still points at it.
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <glm/vec2.hpp>

#include "viewer/model.h"
#include "viewer/panels/graph.h"
#include "viewer/panels/lights.h"
#include "viewer/panels/profile.h"
#include "viewer/panels/reference.h"
#include "viewer/panels/texture.h"
#include "viewer/user_state.h"
#include "viewer/volume_overlay.h"

namespace loom::viewer {

enum class Tab { graph, texture, profile, reference, messages };

struct Ui {
  Model& model;
  UserState& user;

  std::string selected_pass;
  bool scroll_to_selected = false;
  Tab tab = Tab::graph;
  bool switch_tab = false;  ///< `tab` was chosen by a key or a click, not on the tab bar
  bool show_help = false;
  bool save_dialog = false;
  std::string notice;  ///< one line about the last thing done
  int divisor = 1;     ///< the frame is the view's size divided by this
  bool fixed_size = false;
  float wipe = .5F;                          ///< where the compared pipeline begins, as a share of the picture's width
  glm::ivec2 view_size{0};                   ///< of the view panel, pixels
  glm::vec2 picture_at{0}, picture_size{0};  ///< upper left corner and size on the screen

  GraphPanel graph_panel;
  TexturePanel texture_panel;
  ProfilePanel profile_panel;
  ReferencePanel reference_panel;
  VolumeOverlay overlay;
  LightHandles light_handles;

  std::map<std::string, glm::vec2> places;  ///< middle of some widgets on the screen, for tests that click them

  std::vector<std::function<void()>> pending;
  void later(std::function<void()> work) { pending.push_back(std::move(work)); }

  /// The widget that was drawn last.
  void note_place(const std::string& name);
  void select(const std::string& pass) {
    selected_pass = pass;
    scroll_to_selected = true;
  }
  void open_tab(Tab which) {
    tab = which;
    switch_tab = true;
  }
};

// Contents of a window or child that is begun already, one file each.
void draw_toolbar(Ui& ui);
void draw_pipelines(Ui& ui);
void draw_scene(Ui& ui);
void draw_parameters(Ui& ui);
void draw_view(Ui& ui);
void draw_lower_tabs(Ui& ui);
void draw_messages(Ui& ui);
void draw_status(Ui& ui);
void draw_help(Ui& ui);
void draw_save_dialog(Ui& ui);
/// Keys that act wherever the pointer is, unless text is typed.
void handle_shortcuts(Ui& ui);

// Actions that a button and a key share.
void take_screenshot(Ui& ui, const char* extension);
void copy_command_line(Ui& ui);
void capture_frame(Ui& ui);

}  // namespace loom::viewer
