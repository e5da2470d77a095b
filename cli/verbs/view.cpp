// SPDX-License-Identifier: MIT
// The window is a program of its own, because the headless renderer in this one brings another OpenGL along.
#include <lodestone/tile_loader.h>

#include "run_program.h"
#include "verbs.h"

namespace lodestone::cli {
namespace {

class View final : public Verb {
 public:
  [[nodiscard]] std::string name() const override { return "view"; }
  [[nodiscard]] std::string summary() const override {
    return "Open the window: slider, orbit, wireframe, frame graph";
  }
  [[nodiscard]] std::string example() const override { return "lodestone view house.lode"; }
  void declare(Arguments& arguments) override {
    arguments.file("FILE", file_, "Mesh, .lode or .lodg file, tileset.json or root of an .osgb tree", Need::Required);
    arguments.flag("--perceptual", perceptual_, "Level by the camera's distance: at most half a pixel off");
    arguments.file("--plan", plan_, "Level by the camera's distance: what 'distances' measured to be seen",
                   Need::Optional);
    arguments.file("--tile-cache", cache_, "Folder for copies of tiles, of a tileset on the web or a slow disk",
                   Need::Optional);
    arguments.flag("--unlit", unlit_, "Colours as they are, without lamps: what tilesets with photographs start with");
    arguments.flag("--lit", lit_, "Under lamps, always");
  }
  [[nodiscard]] Status run(Session& session) override;

 private:
  std::filesystem::path file_;
  bool perceptual_ = false;
  std::filesystem::path plan_;
  std::filesystem::path cache_;
  bool unlit_ = false;
  bool lit_ = false;
};

// lodestone-view beside this program, as installed; else in the build tree; else on the PATH.
std::filesystem::path find_viewer() { return find_program("lodestone-view", "../viewer/window"); }

Status View::run(Session& session) {
  std::error_code fault;
  if (!is_tileset_file(file_) && !std::filesystem::exists(file_, fault)) {  // a tileset may lie on the web
    return Error{ErrorCode::NotFound, "there is no such file", file_.string()};
  }
  const std::string program = find_viewer().string();
  std::vector<std::string> command{program, file_.string()};
  if (perceptual_) command.emplace_back("--perceptual");
  if (!plan_.empty()) command.insert(command.end(), {"--plan", plan_.string()});
  if (!cache_.empty()) command.insert(command.end(), {"--tile-cache", cache_.string()});
  if (unlit_) command.emplace_back("--unlit");
  if (lit_) command.emplace_back("--lit");
  const auto ended = run_to_end(std::move(command));
  if (!ended) {
    return Error{ErrorCode::NotFound, "cannot be started, install lodestone-view beside lodestone", program};
  }
  if (session.context().cancelled()) return Error{ErrorCode::Cancelled, "cancelled", file_.string()};
  if (ended->status == 0) return Done{};
  std::string message = ended->last_words.substr(0, ended->last_words.find('\n'));
  if (message.empty()) message = "the window ended without a word, status " + std::to_string(ended->status);
  return Error{ErrorCode::BadData, message, ""};
}

}  // namespace

std::unique_ptr<Verb> make_view() { return std::make_unique<View>(); }

}  // namespace lodestone::cli
