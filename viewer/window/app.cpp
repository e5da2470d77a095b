// SPDX-License-Identifier: MIT
#include "app.h"

#include <algorithm>
#include <cmath>

#include <lodestone/formats.h>

#include "../render/detailed_side.h"
#include "../render/fly_path.h"

namespace lodestone::render {
namespace {

// A frame that took longer (a file was loading, the window was hidden) advances motion only by this much.
constexpr double longest_step_s = 0.25;

// Of a flight over the model.
constexpr double round_s = 60.0;

Sphere sphere_of(const Box& box) { return {.center = box.center(), .radius_m = box.diagonal_m() * 0.5}; }

}  // namespace

App::Shown::Shown(const Gl& gl, std::shared_ptr<const ProgressiveModel> m, double morph_seconds, Level level)
    : model(std::move(m)),
      cursor(model, {.motion = Motion::MorphFade, .morph_seconds = morph_seconds, .start_level = level}),
      geometry(gl, arrays_of(cursor)) {
  cursor.clear_dirty();
  if (cursor.beside() != nullptr) beside.emplace(gl, arrays_of(*cursor.beside()));
}

Result<std::unique_ptr<App>> App::create(const WindowOptions& options) {
  auto window =
      GlfwWindow::create("Lodestone", static_cast<int>(options.width_px), static_cast<int>(options.height_px));
  if (!window) return window.error();
  auto loaded = load_gl(GlfwWindow::address);
  if (!loaded) return loaded.error();
  auto gl = std::make_unique<Gl>(*loaded);
  auto renderer = Renderer::create(*gl);
  if (!renderer) return renderer.error();
  auto presenter = Presenter::create(*gl);
  if (!presenter) return presenter.error();
  return std::unique_ptr<App>{new App{options, std::move(window).value(), std::move(gl), std::move(renderer).value(),
                                      std::move(presenter).value()}};
}

App::App(const WindowOptions& options, std::unique_ptr<GlfwWindow> window, std::unique_ptr<Gl> gl, Renderer renderer,
         Presenter presenter)
    : options_(options),
      window_(std::move(window)),
      gl_(std::move(gl)),
      renderer_(std::move(renderer)),
      presenter_(std::move(presenter)),
      panel_(window_->handle()) {
  look_.wireframe = options.wireframe;
  if (options.lod_colors) look_.coloring = Coloring::Lod;
  if (options.cluster_colors) look_.coloring = Coloring::Clusters;
  flies_ = options.fly;
  if (options.street_houses > 0) {
    loader_.start_street(options.street_houses);
  } else if (options.file.empty()) {
    message_ = "Drop a model here: .lode, OBJ, PLY, glTF, 3DS, CityJSON, CityGML, ...";
  } else {
    loader_.keep_tiles_in(options.tile_cache);
    loader_.start(options.file);
  }
}

Status App::run() {
  using Clock = std::chrono::steady_clock;
  auto last = Clock::now();
  while (!window_->closing()) {
    // Without anything that moves the loop idles at a few frames a second until there is input.
    const bool moving = loader_.busy() || control_.mode == LevelMode::Sweep || flies_ || still_frames_ < 10;
    window_->gather_input(moving ? 0.0 : 0.2);
    const auto now = Clock::now();
    const double dt_s = std::min(std::chrono::duration<double>(now - last).count(), longest_step_s);
    last = now;
    if (auto status = take_loaded(); !status) return status;
    if (auto status = fit_frame_to_window(); !status) return status;
    // First, so that it knows whether the mouse is over it.
    const PanelResult asked = lay_out_panel(view());
    use_input(dt_s);
    draw_frame();
    obey(asked);
    if (!options_.screenshot.empty() && settled()) return write_screenshot();
    window_->swap();
  }
  return Done{};
}

// A file named on the command line that cannot be read ends the program; one dropped on the window is only reported.
Status App::take_loaded() {
  auto result = loader_.take();
  if (!result) return Done{};
  if (!result->ok()) {
    if (!shows_something() && loader_.file() == options_.file) return result->error();
    message_ = to_line(result->error());
    return Done{};
  }
  message_.clear();
  for (const Warning& warning : result->warnings()) {
    message_ = std::to_string(result->warnings().size()) + " warnings, the first: " + to_line(warning);
    break;
  }
  std::visit([&](const auto& opened) { show(opened); }, **result);
  if (Status level = take_level(); !level) return level;
  return take_plan();
}

// Of the file that was named beside it, as the plan.
Status App::take_level() {
  if (options_.level.empty() || loader_.file() != options_.file) return Done{};
  if (!shown_) return Error{ErrorCode::BadArgument, "only a progressive model has levels with names", options_.level};
  const auto level = shown_->model->level_of_name(options_.level);
  if (!level) return level.error();
  control_.go_to(*level, *shown_->model);
  return Done{};
}

// The plan belongs to the file that was named beside it.
Status App::take_plan() {
  control_.plan.reset();
  if (options_.plan.empty() || loader_.file() != options_.file) return Done{};
  if (!shown_) return Error{ErrorCode::BadArgument, "a plan is for a progressive model", options_.plan.string()};
  auto plan = read_level_plan(options_.plan);
  if (!plan) return plan.error();
  if (Status fits = check_level_plan(*plan, *shown_->model); !fits) return fits;
  control_.plan = std::move(*plan);
  return Done{};
}

void App::clear() {
  shown_.reset();
  tiles_.reset();
  clusters_.reset();
  street_.reset();
  look_.lighting = options_.lighting;
}

void App::show(const Loader::Model& model) {
  const bool first = !shows_something();
  clear();
  surfaces_ = std::make_unique<Surfaces>(*gl_, model->data());
  shown_ = std::make_unique<Shown>(*gl_, model, static_cast<double>(morph_seconds_), model->record_count());
  control_.attach(*model);
  frame(model->bounds(), detailed_yaw_rad(arrays_of(shown_->cursor)));
  if (first && options_.ratio) {
    const auto finest = static_cast<double>(model->info(model->record_count()).triangles);
    control_.slider = control_.slider_of(static_cast<std::uint32_t>(std::lround(*options_.ratio * finest)));
  }
  if (first && options_.play) control_.mode = LevelMode::Sweep;
  if (first && options_.perceptual) {
    control_.mode = LevelMode::Automatic;
    control_.max_error_px = 0.5F;
  }
}

void App::show(const Loader::Tiles& tiles) {
  clear();
  tiles_ = std::make_unique<TileScene>(*gl_, tiles);
  control_.mode = LevelMode::Automatic;
  control_.max_error_px = 1.0F;
  look_.lighting = tiles_->lighting(options_.lighting);
  for (const std::string& line : tiles_->status().failures) message_ = line;
  frame(tiles->bounds(), tiles_->yaw_rad());
}

void App::show(const Loader::Clusters& clusters) {
  clear();
  clusters_ = std::make_unique<ClusterScene>(*gl_, clusters);
  control_.mode = LevelMode::Automatic;
  control_.max_error_px = 1.0F;
  frame(clusters_->bounds(), Orbit{}.yaw_rad);
}

void App::show(const Loader::StreetOfHouses& street) {
  clear();
  street_ = std::make_unique<StreetScene>(*gl_, street, static_cast<double>(morph_seconds_));
  control_.mode = LevelMode::Automatic;
  control_.max_error_px = options_.perceptual ? 0.5F : 1.0F;
  frame(street->bounds, 0.0);
  stand_in_street();
}

void App::stand_in_street() {
  const Standpoint stand = near_end(street_->street());
  camera_.stand(stand.eye, stand.target, street_->street().bounds.diagonal_m());
}

Box App::bounds() const {
  if (shown_) return shown_->model->bounds();
  if (tiles_) return tiles_->bounds();
  if (street_) return street_->street().bounds;
  return clusters_ ? clusters_->bounds() : Box{};
}

// From the flight, or from where the mouse has put the camera.
View App::view() const {
  const View by_hand = camera_.view();
  if (!flies_ || !shows_something()) return by_hand;
  if (street_) return along_street(street_->street(), flown_s_ / round_s, by_hand.width_px, by_hand.height_px);
  return fly_view(bounds(), flown_s_ / round_s, by_hand.width_px, by_hand.height_px);
}

// What is new on the screen, from where all of it is seen.
void App::frame(const Box& bounds, double yaw_rad) {
  title_ = loader_.title();
  window_->set_title(title_ + " - Lodestone");
  int width = 0;
  int height = 0;
  window_->framebuffer_size(width, height);
  camera_.frame(bounds, static_cast<std::uint32_t>(std::max(1, width)), static_cast<std::uint32_t>(std::max(1, height)),
                yaw_rad);
}

void App::use_input(double dt_s) {
  const MouseDrag drag = window_->take_drag();
  const double wheel = window_->take_wheel_notches();
  if (!panel_.wants_mouse()) {
    if (drag.left) camera_.turn(drag.dx_px, drag.dy_px);
    if (drag.other) camera_.pan(drag.dx_px, drag.dy_px);
    camera_.zoom(wheel);
  }
  if (drag.left || drag.other || wheel != 0.0) {
    still_frames_ = 0;
    if (!panel_.wants_mouse()) flies_ = false;
  }
  if (const auto file = window_->take_dropped_file(); !file.empty()) loader_.start(file);
  use_keys();
  move_on(dt_s);
}

// The level, or the tiles, that the camera and the controls ask for.
void App::move_on(double dt_s) {
  if (flies_) flown_s_ += dt_s;
  if (clusters_) {
    cluster_frame_ = clusters_->update(view(), {.error_px = double(control_.max_error_px)}, dt_s);
    still_frames_ = cluster_frame_.settled ? still_frames_ + 1 : 0;
  }
  if (tiles_) {
    tiles_->set_error_px(double(control_.max_error_px));
    tiles_->update(view(), dt_s);
    still_frames_ = tiles_->still() ? still_frames_ + 1 : 0;
  }
  if (street_) {
    street_->update(view(), double(control_.max_error_px), dt_s);
    uploaded_kb_ = static_cast<double>(street_->uploaded_bytes()) / 1024.0;
    still_frames_ = street_->still() ? still_frames_ + 1 : 0;
  }
  if (!shown_) return;
  control_.drive(shown_->cursor, view(), dt_s);
  const StepResult step = shown_->cursor.step({}, dt_s);
  std::size_t uploaded_bytes = shown_->geometry.update(shown_->cursor);
  if (shown_->cursor.fade() > 0.0F) uploaded_bytes += shown_->beside->update(*shown_->cursor.beside());
  uploaded_kb_ = static_cast<double>(uploaded_bytes) / 1024.0;
  still_frames_ = step.changed || !step.arrived ? 0 : still_frames_ + 1;
}

void App::use_keys() {
  for (const char key : window_->take_typed()) {
    still_frames_ = 0;
    switch (key) {
      case ' ':
        control_.mode = control_.mode == LevelMode::Sweep ? LevelMode::Slider : LevelMode::Sweep;
        break;
      case '+':
      case '-':
        control_.mode = LevelMode::Slider;
        control_.slider = std::clamp(control_.slider + (key == '+' ? 0.05F : -0.05F), 0.0F, 1.0F);
        break;
      case 'w':
        look_.wireframe = !look_.wireframe;
        break;
      case 't':
        look_.coloring = look_.coloring == Coloring::Materials ? Coloring::Untextured : Coloring::Materials;
        break;
      case 'l':
        look_.coloring = look_.coloring == Coloring::Lod ? Coloring::Materials : Coloring::Lod;
        break;
      case 'u':
        look_.lighting = look_.lighting == Lighting::Photograph ? Lighting::Lamps : Lighting::Photograph;
        break;
      case 'f':
        obey({.frame_model = true});
        break;
      default:
        break;
    }
  }
}

Status App::fit_frame_to_window() {
  int width = 0;
  int height = 0;
  window_->framebuffer_size(width, height);
  const FrameSize wanted{static_cast<std::uint32_t>(std::max(1, width)),
                         static_cast<std::uint32_t>(std::max(1, height)), 1};
  if (frame_ && frame_->size() == wanted) return Done{};
  auto made = Frame::create(*gl_, wanted);
  if (!made) return made.error();
  frame_.emplace(std::move(made).value());
  second_.reset();
  camera_.resize(wanted.width_px, wanted.height_px);
  return Done{};
}

PanelResult App::lay_out_panel(const View& view) {
  PanelState state{.control = control_,
                   .look = look_,
                   .morph_seconds = morph_seconds_,
                   .frame_times = frame_times_,
                   .flies = flies_};
  state.title = title_;
  state.message = message_;
  if (loader_.busy()) {
    state.loading = loader_.title() + ": " + loader_.stage();
    state.loading_fraction = loader_.fraction();
  }
  state.tiles = tiles_.get();
  state.clusters = clusters_.get();
  state.street = street_.get();
  state.cluster_frame = cluster_frame_;
  if (shown_) {
    const Cursor& cursor = shown_->cursor;
    state.cursor = &cursor;
    state.screen_error_px = error_px(view, cursor.error_m(), sphere_of(cursor.model().bounds()));
    state.uploaded_kb = uploaded_kb_;
  }
  return panel_.layout(state);
}

// The level that fades in or out, into a frame of its own; false if there is none, or no room for the frame.
bool App::draw_second(Item item, const Box& box) {
  if (shown_->cursor.fade() <= 0.0F) return false;
  if (!second_) {
    auto made = Frame::create(*gl_, frame_->size());
    if (!made) return false;
    second_.emplace(std::move(made).value());
  }
  item.geometry = &*shown_->beside;
  renderer_.draw(*second_, view(), box, {&item, 1}, look_);
  return true;
}

void App::draw_frame() {
  const auto start = std::chrono::steady_clock::now();
  const Box box = bounds();
  std::optional<Item> item;
  if (shown_) item = Item{.geometry = &shown_->geometry, .surfaces = surfaces_.get(), .size_m = box.diagonal_m()};
  std::span<const Item> items = item ? std::span<const Item>{&*item, 1} : std::span<const Item>{};
  if (tiles_) items = tiles_->items();
  if (clusters_) items = clusters_->items(look_.coloring);
  if (street_) items = street_->items();
  renderer_.draw(*frame_, view(), box, items, look_);
  if (item && draw_second(*item, box)) {
    presenter_.present_blend(*frame_, *second_, static_cast<double>(shown_->cursor.fade()), 0);
  } else {
    presenter_.present(*frame_, 0);
  }
  panel_.draw();
  gl_->finish();
  frame_times_.add(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
}

void App::obey(const PanelResult& asked) {
  if (asked.changed) still_frames_ = 0;
  if (asked.frame_model) flies_ = false;
  if (asked.frame_model && tiles_) frame(tiles_->bounds(), tiles_->yaw_rad());
  if (asked.frame_model && clusters_) frame(clusters_->bounds(), Orbit{}.yaw_rad);
  if (asked.frame_model && street_) stand_in_street();
  if (!shown_) return;
  if (asked.frame_model) {
    const View view = camera_.view();
    camera_.frame(shown_->model->bounds(), view.width_px, view.height_px, detailed_yaw_rad(arrays_of(shown_->cursor)));
  }
  // The time of a morph is fixed at construction: a new cursor goes on where the old one is.
  if (asked.restart_cursor) {
    shown_ = std::make_unique<Shown>(*gl_, shown_->model, static_cast<double>(morph_seconds_), shown_->cursor.level());
  }
}

bool App::settled() const { return shows_something() && !loader_.busy() && still_frames_ >= 3; }

Status App::write_screenshot() {
  const FrameSize& size = frame_->size();
  gl_->bind_framebuffer(GL_FRAMEBUFFER, 0);
  return write_image(read_framebuffer(*gl_, size.width_px, size.height_px), options_.screenshot);
}

Status run_window(const WindowOptions& options) {
  auto app = App::create(options);
  if (!app) return app.error();
  return (*app)->run();
}

}  // namespace lodestone::render
