// SPDX-License-Identifier: MIT
// Models to write, files to spoil.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include <lodestone/edge_collapse.h>
#include <lodestone/formats.h>

namespace lodestone::test {

using Bytes = std::vector<std::uint8_t>;
using Model = std::shared_ptr<const ProgressiveModel>;

[[nodiscard]] Model build(const Mesh& mesh, Placement placement);
// A model of two materials, a seam, features and every attribute.
[[nodiscard]] Model rich_model();

[[nodiscard]] Bytes slurp(const std::filesystem::path& file);
void spill(const std::filesystem::path& file, const Bytes& bytes);
// Writes a model and gives the bytes of its file.
[[nodiscard]] Bytes written(const ProgressiveModel& model, const std::filesystem::path& file,
                            const ModelWriteOptions& options = {});

// Whether every array of two models is equal to the bit.
[[nodiscard]] bool same_data(const ModelData& a, const ModelData& b);
// Whether two meshes have equal vertices and faces.
[[nodiscard]] bool same_mesh(const Mesh& a, const Mesh& b);

}  // namespace lodestone::test
