// SPDX-License-Identifier: MIT
// A mesh named on the command line, with what its file may leave unsaid.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <lodestone/formats.h>

#include "frame/verb.h"

namespace lodestone::cli {

class MeshInput {
 public:
  // `name` is the positional name or the option that takes the file.
  void declare(Arguments& arguments, const std::string& name, const std::string& help, Need need = Need::Required);

  [[nodiscard]] bool given() const noexcept { return !file_.empty(); }
  [[nodiscard]] const std::filesystem::path& file() const noexcept { return file_; }
  // Warnings go to the session.
  [[nodiscard]] Result<LoadedMesh> read(Session& session, LoadTextures textures = LoadTextures::Encoded) const;

 private:
  std::filesystem::path file_;
  std::string up_ = "from-file";
  std::optional<double> unit_m_;
  std::optional<std::string> crs_;
};

}  // namespace lodestone::cli
