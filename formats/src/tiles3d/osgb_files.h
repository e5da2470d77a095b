// SPDX-License-Identifier: MIT
// Trees of OpenSceneGraph files, read by lodestone-osgb in processes of their own.
#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include <lodestone/formats.h>

#include "tiles3d/osgb_answer.h"

namespace lodestone {

// Any thread: each call has a process for itself, which is kept for the next. One that breaks down on a file, or says
// nothing for a minute, is ended and fails that call only.
class OsgbFiles {
 public:
  explicit OsgbFiles(std::filesystem::path root) : root_(std::move(root)) {}

  // A tileset.json whose contents are names for tile(). Walks through all files of the tree.
  [[nodiscard]] Result<std::string> index();
  [[nodiscard]] Result<Mesh> tile(const std::string& name, LoadTextures textures);

 private:
  class Process;
  struct Ender {
    void operator()(Process* process) const;
  };
  [[nodiscard]] Result<OsgbAnswer> ask(const std::string& line);

  std::filesystem::path root_;
  std::mutex mutex_;  // guards what follows
  std::vector<std::unique_ptr<Process, Ender>> idle_;
};

}  // namespace lodestone
