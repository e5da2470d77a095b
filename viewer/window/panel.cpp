// SPDX-License-Identifier: MIT
#include "panel.h"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <algorithm>
#include <cstdio>

namespace lodestone::render {
namespace {

constexpr float panel_width_px = 330.0F;

// Ticks on the slider drawn last where the levels with names lie, and below it a button for each that goes there.
void level_marks(LevelControl& control, const ProgressiveModel& model) {
  const ImVec2 from = ImGui::GetItemRectMin();
  const ImVec2 to = ImGui::GetItemRectMax();
  // The middle of the slider's grab stays within half its width of the ends, and two pixels.
  const float margin_px = 2.0F + 0.5F * ImGui::GetStyle().GrabMinSize;
  for (const LevelControl::Mark& mark : control.marks()) {
    const float x = from.x + margin_px + mark.slider * (to.x - from.x - 2.0F * margin_px);
    ImGui::GetWindowDrawList()->AddLine(ImVec2(x, to.y - 5.0F), ImVec2(x, to.y + 2.0F),
                                        ImGui::GetColorU32(ImGuiCol_Text), 1.5F);
  }
  // Coarse on the left, as on the slider.
  for (auto mark = control.marks().rbegin(); mark != control.marks().rend(); ++mark) {
    if (mark != control.marks().rbegin()) ImGui::SameLine();
    if (ImGui::Button(mark->name.c_str())) control.go_to(mark->level, model);
  }
}

void level_controls(const PanelState& state) {
  LevelControl& control = state.control;
  const ProgressiveModel& model = state.cursor->model();
  const std::uint32_t finest = model.info(model.record_count()).triangles;

  ImGui::TextUnformatted("Level of detail");
  ImGui::SetNextItemWidth(-1.0F);
  const std::string name = control.name_of(state.cursor->level());
  char label[80];
  std::snprintf(label, sizeof label, "%s%s%u triangles", name.c_str(), name.empty() ? "" : ": ",
                control.triangles_of(control.slider));
  if (ImGui::SliderFloat("##level", &control.slider, 0.0F, 1.0F, label)) control.mode = LevelMode::Slider;
  level_marks(control, model);
  const bool playing = control.mode == LevelMode::Sweep;
  if (ImGui::Button(playing ? "Pause" : "Play", ImVec2(80.0F, 0.0F))) {
    control.mode = playing ? LevelMode::Slider : LevelMode::Sweep;
  }
  ImGui::SameLine();
  ImGui::SetNextItemWidth(-1.0F);
  ImGui::SliderFloat("##period", &control.sweep_s, 2.0F, 60.0F, "there and back in %.0f s");
  bool automatic = control.mode == LevelMode::Automatic;
  if (ImGui::Checkbox("From the camera's distance", &automatic)) {
    control.mode = automatic ? LevelMode::Automatic : LevelMode::Slider;
  }
  if (control.plan) {
    ImGui::TextUnformatted("what the plan found to be seen");
  } else {
    ImGui::SetNextItemWidth(-1.0F);
    ImGui::SliderFloat("##pixels", &control.max_error_px, 0.1F, 20.0F, "error at most %.2f pixels",
                       ImGuiSliderFlags_Logarithmic);
  }

  ImGui::Separator();
  const std::uint32_t triangles = state.cursor->triangle_count();
  ImGui::Text("%u of %u triangles (%.2f %%)", triangles, finest, 100.0 * triangles / std::max(1U, finest));
  ImGui::Text("error %.4g m, at most %.2f pixels", state.cursor->error_m(), state.screen_error_px);
  ImGui::Text("record %u of %u%s", state.cursor->level(), model.record_count(),
              state.cursor->morphing() ? ", morphing" : "");
}

void tile_controls(const PanelState& state) {
  const PagerStatus status = state.tiles->status();
  ImGui::SetNextItemWidth(-1.0F);
  ImGui::SliderFloat("##pixels", &state.control.max_error_px, 0.1F, 20.0F, "error at most %.2f pixels",
                     ImGuiSliderFlags_Logarithmic);
  ImGui::Text("%zu tiles, %u triangles", state.tiles->items().size(), state.tiles->triangle_count());
  ImGui::Text("%u tiles loaded, %.0f MB, %u on their way", status.resident_tiles,
              1e-6 * static_cast<double>(status.resident_bytes), status.wanted_tiles);
  if (!status.failures.empty()) ImGui::TextWrapped("%s", status.failures.back().c_str());
}

void cluster_controls(const PanelState& state) {
  const ClusterStreamer& streamer = state.clusters->streamer();
  const ClusterFrame& frame = state.cluster_frame;
  ImGui::SetNextItemWidth(-1.0F);
  ImGui::SliderFloat("##pixels", &state.control.max_error_px, 0.1F, 20.0F, "error at most %.2f pixels",
                     ImGuiSliderFlags_Logarithmic);
  ImGui::Text("%u clusters, %llu triangles", frame.clusters, static_cast<unsigned long long>(frame.cut.triangle_count));
  ImGui::Text("of %llu in %zu clusters",
              static_cast<unsigned long long>(state.clusters->outline().levels.front().triangles),
              state.clusters->outline().clusters.size());
  ImGui::Text("error at most %.2f pixels%s", frame.cut.max_error_px, frame.settled ? "" : ", morphing");
  ImGui::Text("%.1f MB of pages loaded, %u groups wait", 1e-6 * static_cast<double>(streamer.resident_bytes()),
              frame.missing_groups);
  if (streamer.broken_pages() > 0) ImGui::Text("%u pages are broken", streamer.broken_pages());
  bool clusters = state.look.coloring == Coloring::Clusters;
  if (ImGui::Checkbox("Colour clusters", &clusters)) {
    state.look.coloring = clusters ? Coloring::Clusters : Coloring::Materials;
  }
  ImGui::SameLine();
  ImGui::Checkbox("Fly", &state.flies);
}

void street_controls(const PanelState& state) {
  const std::uint32_t triangles = state.street->triangle_count();
  const std::uint32_t finest = state.street->finest_triangle_count();
  ImGui::SetNextItemWidth(-1.0F);
  ImGui::SliderFloat("##pixels", &state.control.max_error_px, 0.1F, 20.0F, "error at most %.2f pixels",
                     ImGuiSliderFlags_Logarithmic);
  ImGui::Text("%u of %u triangles (%.2f %%)", triangles, finest, 100.0 * triangles / std::max(1U, finest));
  const auto [fewest, most] = state.street->triangles_of_a_house();
  ImGui::Text("%zu houses of %u to %u triangles", state.street->street().houses.size(), fewest, most);
  ImGui::Checkbox("Fly along the street", &state.flies);
}

void look_controls(const PanelState& state, PanelResult& result) {
  bool textures = state.look.coloring == Coloring::Materials;
  bool lod_colors = state.look.coloring == Coloring::Lod;
  ImGui::Checkbox("Wireframe", &state.look.wireframe);
  ImGui::SameLine();
  if (ImGui::Checkbox("Textures", &textures)) {
    state.look.coloring = textures ? Coloring::Materials : Coloring::Untextured;
  }
  if (ImGui::Checkbox("LOD colours", &lod_colors)) {
    state.look.coloring = lod_colors ? Coloring::Lod : Coloring::Materials;
  }
  ImGui::SameLine();
  bool lamps = state.look.lighting != Lighting::Photograph;
  if (ImGui::Checkbox("Lamps", &lamps)) state.look.lighting = lamps ? Lighting::Lamps : Lighting::Photograph;
  if (state.cursor != nullptr) {
    ImGui::SetNextItemWidth(-1.0F);
    ImGui::SliderFloat("##morph", &state.morph_seconds, 0.0F, 3.0F, "morph in %.2f s");
    result.restart_cursor = ImGui::IsItemDeactivatedAfterEdit();
  }
  result.frame_model = ImGui::Button("Frame the model");
}

void frame_graph(const PanelState& state) {
  const auto& ms = state.frame_times.ms();
  char text[48];
  std::snprintf(text, sizeof text, "%.1f ms a frame", double(state.frame_times.latest_ms()));
  const float top = std::max(33.4F, *std::max_element(ms.begin(), ms.end()));
  ImGui::PlotLines("##frames", ms.data(), static_cast<int>(ms.size()), static_cast<int>(state.frame_times.oldest()),
                   text, 0.0F, top, ImVec2(panel_width_px - 16.0F, 60.0F));
  ImGui::Text("%.0f kB uploaded", state.uploaded_kb);
}

}  // namespace

Panel::Panel(GLFWwindow* window) {
  ImGui::CreateContext();
  ImGui::StyleColorsLight();
  ImGui::GetIO().IniFilename = nullptr;  // nothing is left in the folder it is started from
  ImGui::GetStyle().WindowRounding = 4.0F;
  ImGui::GetStyle().FrameRounding = 3.0F;
  ImGui_ImplGlfw_InitForOpenGL(window, true);
  ImGui_ImplOpenGL3_Init("#version 330 core");
}

Panel::~Panel() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
}

PanelResult Panel::layout(const PanelState& state) {
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  ImGui::NewFrame();
  PanelResult result;
  ImGui::SetNextWindowPos(ImVec2(12.0F, 12.0F));
  ImGui::SetNextWindowSize(ImVec2(panel_width_px, 0.0F));
  ImGui::Begin("Lodestone", nullptr, ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize);
  if (!state.title.empty()) ImGui::TextUnformatted(state.title.c_str());
  if (!state.loading.empty()) {
    ImGui::ProgressBar(state.loading_fraction, ImVec2(-1.0F, 0.0F), state.loading.c_str());
  }
  if (!state.message.empty()) ImGui::TextWrapped("%s", state.message.c_str());
  if (state.cursor != nullptr) {
    level_controls(state);
  }
  if (state.tiles != nullptr) tile_controls(state);
  if (state.clusters != nullptr) cluster_controls(state);
  if (state.street != nullptr) street_controls(state);
  if (state.cursor != nullptr || state.tiles != nullptr || state.clusters != nullptr || state.street != nullptr) {
    ImGui::Separator();
    look_controls(state, result);
    frame_graph(state);
  }
  ImGui::TextDisabled("drag: orbit  shift-drag: pan  wheel: zoom");
  ImGui::TextDisabled("space: play  + -: level  w t l u f: look");
  result.changed = ImGui::IsAnyItemActive() || ImGui::IsAnyItemHovered();
  ImGui::End();
  ImGui::Render();
  return result;
}

bool Panel::wants_mouse() const { return ImGui::GetIO().WantCaptureMouse; }

void Panel::draw() { ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData()); }

}  // namespace lodestone::render
