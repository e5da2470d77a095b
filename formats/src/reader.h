// SPDX-License-Identifier: MIT
// What every mesh reader has in common: the bytes it is given, the list of warnings it keeps, the table it stands in.
//
// A reader is a free function of the type ReadFunction. It reads through an Input, which is a file or a span of bytes
// (fuzzing), so that no reader opens files on its own except those that a file names (textures, MTL, buffers), and
// those only through `open_beside`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <lodestone/formats.h>

namespace lodestone {

// A file, or bytes that stand for one. Copies share the open file.
class Input {
 public:
  // NotFound, Unreadable, or TooLarge beyond `max_bytes`.
  [[nodiscard]] static Result<Input> open(const std::filesystem::path& file, std::uint64_t max_bytes);
  // `bytes` must outlive the Input. `name` is used in messages and to tell formats by extension; files that the bytes
  // refer to are looked for in `folder`.
  [[nodiscard]] static Input from_bytes(std::span<const std::uint8_t> bytes, std::string name,
                                        std::filesystem::path folder = {});

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  [[nodiscard]] const std::filesystem::path& folder() const noexcept { return folder_; }
  [[nodiscard]] std::uint64_t size() const noexcept { return size_; }
  // In lower case, with the dot: ".obj".
  [[nodiscard]] std::string extension() const;
  // The file on disk; empty for bytes.
  [[nodiscard]] const std::filesystem::path& file() const noexcept { return file_; }

  // Copies bytes from `offset` on; returns how many, fewer than asked only at the end or when the disk fails.
  [[nodiscard]] std::size_t read(std::uint64_t offset, std::span<std::uint8_t> out) const;
  [[nodiscard]] Result<std::vector<std::uint8_t>> read_all() const;

 private:
  Input() = default;
  std::string name_;
  std::filesystem::path folder_;
  std::filesystem::path file_;
  std::uint64_t size_ = 0;
  std::shared_ptr<const int> descriptor_;
  std::span<const std::uint8_t> bytes_;
};

// Finds a file that another one names: backslashes, wrong case, file:// and absolute paths of another machine are
// forgiven; tried are the name under `folder`, then its last two parts, then its last part there and in
// `folder`/textures. Empty if there is none.
[[nodiscard]] std::optional<std::filesystem::path> find_beside(const std::filesystem::path& folder,
                                                               std::string_view name);

// Collapses repeats, in the order of first occurrence; keeps at most 200 different messages.
class Warnings {
 public:
  void add(std::string message, std::string where = {});
  void add_all(std::vector<Warning> warnings);
  [[nodiscard]] std::vector<Warning> take() { return std::move(list_); }

 private:
  std::vector<Warning> list_;
  std::unordered_map<std::string, std::size_t> index_;
};

// Adds the texture that `name` refers to, loaded as `options.textures` asks, or finds it among those already there.
// A missing or broken file is a warning and gives `none`; a missing one is said to be named at `place`, else in the
// model.
[[nodiscard]] std::uint32_t add_texture_file(Mesh& mesh, const std::string& name, const Input& model,
                                             const ReadOptions& options, Warnings& warnings,
                                             const std::string& place = {});
// The same for bytes that came inside the model file.
[[nodiscard]] std::uint32_t add_texture_bytes(Mesh& mesh, const std::string& name, std::vector<std::uint8_t> bytes,
                                              const ReadOptions& options, Warnings& warnings);
// "image/jpeg", "image/png", ...; empty if the bytes are no image we know.
[[nodiscard]] std::string image_mime_type(std::span<const std::uint8_t> bytes);

// The error of a file that exceeds a cap of ReadOptions.
[[nodiscard]] Error too_large(const Input& input, std::string_view what, std::uint64_t count, std::uint64_t cap);

// Readers. Each returns warnings with its value and leaves axes and units to its own call of `to_lodestone_axes`
// (axes.h).
using ReadFunction = Result<LoadedMesh> (*)(const Input&, const ReadOptions&, const Context&);
[[nodiscard]] Result<LoadedMesh> read_obj(const Input& input, const ReadOptions& options, const Context& context);
[[nodiscard]] Result<LoadedMesh> read_ply(const Input& input, const ReadOptions& options, const Context& context);
[[nodiscard]] Result<LoadedMesh> read_gltf(const Input& input, const ReadOptions& options, const Context& context);
[[nodiscard]] Result<LoadedMesh> read_assimp(const Input& input, const ReadOptions& options, const Context& context);
// The same without the process around it, for fuzzing; a broken file may crash it.
[[nodiscard]] Result<LoadedMesh> read_assimp_in_process(const Input& input, const ReadOptions& options,
                                                        const Context& context);
// Whether assimp has an importer for files of this extension (".dae").
[[nodiscard]] bool assimp_reads(const std::string& extension);
[[nodiscard]] Result<LoadedMesh> read_cityjson(const Input& input, const ReadOptions& options, const Context& context);
[[nodiscard]] Result<LoadedMesh> read_citygml(const Input& input, const ReadOptions& options, const Context& context);

// The reader for these bytes, told by the first 4096 of them, else by the name's extension; null if none fits.
[[nodiscard]] ReadFunction find_reader(const Input& input);

// Runs a reader, holds its caps, tidies and validates what it returns. In a file of its own: who reads only tiles does
// not link the other readers and their libraries.
[[nodiscard]] Result<LoadedMesh> read_with(ReadFunction reader, const Input& input, const ReadOptions& options,
                                           const Context& context);

// read_mesh behind the door: finds the reader and runs it.
[[nodiscard]] Result<LoadedMesh> read_input(const Input& input, const ReadOptions& options, const Context& context);

}  // namespace lodestone
