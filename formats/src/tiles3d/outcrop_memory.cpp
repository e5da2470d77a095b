// SPDX-License-Identifier: MIT
#include "tiles3d/outcrop_memory.h"

#include <algorithm>
#include <cmath>

#include "meshes/mesh_count.h"
#include "tiles3d/jobs.h"
#include "tiles3d/photographs.h"

namespace lodestone {
namespace {

constexpr double program_bytes = 47e6;    // its code, that of its libraries, and what they need to run
constexpr double per_tile_byte = 12.0;    // its texture plain and compressed
constexpr double compressed_pixel = 3.0;  // of a tile: its JPEG or WebP twice, and what the encoder holds
constexpr double worker_bytes = 1e6;      // what a thread keeps for itself
constexpr double check_triangle = 110.0;  // edges of the finest level, when the files are read back

// V_t as OutcropPyramid::build() will choose it, or more.
double expected_tile_bytes(const OutcropSize& size, std::span<const Photograph> photographs,
                           const OutcropOptions& options) {
  if (options.tile_bytes > 0) return static_cast<double>(options.tile_bytes);
  double whole = 25.0 * static_cast<double>(size.triangles);
  for (const Photograph& one : photographs) {
    const double pixels = static_cast<double>(one.info.width_px) * one.info.height_px;
    whole += one.info.file_bytes > 0 ? static_cast<double>(one.info.file_bytes) : 0.4 * pixels;
  }
  return std::clamp(whole / 64.0, 128e3, 1e6);
}

std::string megabytes(double bytes) { return std::to_string(static_cast<std::uint64_t>(std::ceil(bytes * 1e-6))); }

Error too_little(const Context& context, const std::string& of_what, const std::string& enough) {
  return {ErrorCode::TooLarge,
          "a limit of " + megabytes(static_cast<double>(context.max_memory_bytes)) +
              " MB on memory is too little for " + of_what + ": " + enough,
          {}};
}

Error too_little(const Context& context, const std::string& of_what, double needed) {
  return too_little(context, of_what, megabytes(needed) + "MB will do");
}

double color_bytes(const Photograph& photograph) {
  constexpr double channels = 3.0;  // most of what has four is no photograph; its decoder says so
  return std::max(channels, std::min(4.0, photograph.decode_bytes));
}

// From its file to its last level image: compressed, decoded, filled, shrunk.
double photograph_bytes(const Photograph& photograph, const OutcropOptions& options) {
  const double pixels = static_cast<double>(photograph.info.width_px) * photograph.info.height_px;
  const double colors = color_bytes(photograph);
  constexpr double fill_levels = 1.5;  // coarser ones with their weights, and which pixels are known
  // All levels down to one that is half as wide are made of the photograph, the largest of them in its memory.
  const double ratio = options.texture_ratio > 0.0 ? options.texture_ratio : options.ratio > 0.0 ? options.ratio : 0.5;
  double levels = 1.0;
  for (double width = ratio; width > 1.0 / 1.9; width *= ratio) levels += width * ratio * width * ratio;
  const double file = photograph.kept_bytes > 0 ? 0.0 : static_cast<double>(photograph.info.file_bytes);
  const double most =
      std::max(photograph.decode_bytes * pixels + file, std::max(colors + fill_levels, colors * levels + 0.2) * pixels);
  return most + worker_bytes;
}

// What is needed is not less than reading the mesh took.
Result<MemoryPlan> plan_memory(const OutcropSize& size, std::span<const Photograph> photographs,
                               const OutcropOptions& options, const Context& context, double reading_bytes = 0.0) {
  const unsigned workers = workers_of(context);
  if (context.max_memory_bytes == 0) {
    const auto images = static_cast<unsigned>(std::clamp<std::size_t>(photographs.size(), 1, workers));
    return MemoryPlan{.geometry_workers = workers, .photograph_workers = images, .tile_workers = workers / images};
  }
  const auto limit = static_cast<double>(context.max_memory_bytes);
  const double tile = per_tile_byte * expected_tile_bytes(size, photographs, options);
  MemoryPlan plan{.kept_bytes = program_bytes};
  double photograph = worker_bytes;
  for (const Photograph& one : photographs) {
    photograph = std::max(photograph, photograph_bytes(one, options));
    plan.kept_bytes += static_cast<double>(one.kept_bytes);
    plan.color_bytes = std::max(plan.color_bytes, color_bytes(one));
  }
  const double largest = photograph + tile;
  const double kept = plan.kept_bytes + static_cast<double>(outcrop_levels_bytes(size, options));
  const double building = plan.kept_bytes + static_cast<double>(outcrop_build_bytes(size, options, 1));
  const double checking = program_bytes + check_triangle * static_cast<double>(size.triangles);
  const double needed = std::max({building, checking, kept + largest, program_bytes + reading_bytes});
  if (needed > limit) {
    std::string of_what = std::to_string(size.triangles) + " triangles";
    if (kept + largest >= needed) of_what += " and one photograph of the largest";
    return too_little(context, of_what, needed);
  }
  const double side_by_side = plan.kept_bytes + worker_bytes * workers +
                              static_cast<double>(outcrop_build_bytes(size, options, std::max(2U, workers)));
  plan.geometry_workers = side_by_side <= limit ? workers : 1U;
  const double room = limit - kept;
  const auto count = static_cast<double>(std::max<std::size_t>(photographs.size(), 1));
  plan.photograph_workers = static_cast<unsigned>(std::min({room / largest, count, static_cast<double>(workers)}));
  const double room_of_each = room / plan.photograph_workers - photograph;
  plan.tile_workers = static_cast<unsigned>(
      std::clamp(room_of_each / tile, 1.0, static_cast<double>(std::max(1U, workers / plan.photograph_workers))));
  plan.fewer = plan.geometry_workers < workers || plan.tile_workers < workers / plan.photograph_workers ||
               plan.photograph_workers < std::min<std::size_t>(workers, photographs.size());
  return plan;
}

}  // namespace

Result<MemoryPlan> plan_memory_of(const Mesh& mesh, const OutcropOptions& options, const Context& context,
                                  std::vector<Warning>& warnings) {
  std::vector<Photograph> photographs;
  std::vector<TextureInfo> images;
  for (const Texture& texture : mesh.textures) {
    photographs.push_back(look_at(texture, warnings));
    images.push_back(photographs.back().info);
  }
  auto plan = plan_memory(outcrop_size(mesh), photographs, options, context);
  if (plan) plan->images = std::move(images);
  return plan;
}

Result<unsigned> joined_at_once(const OutcropPyramid& pyramid, std::span<const std::uint32_t> joined,
                                const MemoryPlan& plan, const Context& context) {
  const unsigned workers = workers_of(context);
  if (context.max_memory_bytes == 0) return workers;
  double each = worker_bytes;
  std::string largest;
  for (const std::uint32_t tile : joined) {
    double pixels = 0.0;
    std::size_t images = 0;
    for (const std::uint32_t s : pyramid.tiles()[tile].segments) {
      if (pyramid.segments()[s].texture == none) continue;
      const glm::uvec2 size = pyramid.image_size(s, pyramid.tiles()[tile].level);
      pixels += static_cast<double>(size.x) * size.y;
      ++images;
    }
    // Composed and compressed; and a bound on it, as few tiles are looked into.
    const double composed = plan.color_bytes + compressed_pixel;
    constexpr double most_growth = 2.0;
    if (pixels * (plan.color_bytes + most_growth * composed) <= each) continue;
    const TileTexture texture = pyramid.content(tile).texture;
    const double needed =
        worker_bytes + pixels * plan.color_bytes + composed * static_cast<double>(texture.width) * texture.height;
    if (needed <= each) continue;
    each = needed;
    largest = "a tile of " + std::to_string(texture.width) + " x " + std::to_string(texture.height) +
              " pixels that shows " + std::to_string(images) + " images";
  }
  constexpr double pages_half_full = 1.1;
  const double kept = plan.kept_bytes + pages_half_full * static_cast<double>(pyramid.memory_bytes());
  const auto limit = static_cast<double>(context.max_memory_bytes);
  if (!largest.empty() && kept + each > limit) return too_little(context, largest, kept + each);
  return static_cast<unsigned>(std::clamp((limit - kept) / each, 1.0, static_cast<double>(workers)));
}

namespace {

// Its photographs where the mesh's file tells of them.
std::vector<Photograph> photographs_of(const MeshCount& count, const Input& input) {
  std::vector<Photograph> photographs;
  std::vector<Warning> told_when_used;
  for (const std::filesystem::path& file : count.textures) {
    photographs.push_back(look_at({.name = file.string(), .path = file.string()}, told_when_used));
  }
  for (const InnerImage& image : count.images) {
    const auto other =
        image.file.empty() ? Result<Input>{input} : Input::open(image.file, ReadOptions{}.max_file_bytes);
    if (other) photographs.push_back(look_inside(*other, image.offset, image.size_bytes));
  }
  if (count.other_image_bytes > 0) photographs.push_back({.kept_bytes = count.other_image_bytes});
  return photographs;
}

// Of kinds whose triangles are not counted before they are read: what that takes for a byte of the file, at least, and
// what is enough for most.
struct Growth {
  double least = 1.0;
  double most = 12.0;
};

Growth growth_of(ReadFunction reader) {
  if (reader == read_gltf) return {3.0, 12.0};  // of the JSON, which is looked at
  if (reader == read_cityjson) return {10.0, 25.0};
  if (reader == read_citygml) return {4.0, 12.0};
  return {};
}

Status file_fits(const Input& input, ReadFunction reader, const Context& context) {
  const Growth growth = growth_of(reader);
  const auto read = static_cast<double>(reader == read_gltf ? gltf_json_bytes(input) : input.size());
  if (program_bytes + growth.least * read <= static_cast<double>(context.max_memory_bytes)) return Done{};
  const auto size = static_cast<double>(input.size());
  return too_little(context, "a file of " + megabytes(size) + " MB",
                    "about " + megabytes(program_bytes + growth.most * size) + "MB may do");
}

Status fits(const Input& input, const TilesetOptions& options, const Context& context) {
  const ReadFunction reader = find_reader(input);
  const bool counted = reader == read_gltf || reader == read_ply || reader == read_obj;
  if (reader != read_ply && reader != read_obj) {
    if (Status status = file_fits(input, reader, context); !status || !counted) return status;
  }
  const auto count = reader == read_gltf  ? count_gltf(input)
                     : reader == read_ply ? count_ply(input, context)
                                          : count_obj(input, context);
  if (!count) return count.error();
  const OutcropSize size{count->triangles, count->vertices, count->vertex_bytes};
  const auto plan = plan_memory(size, photographs_of(*count, input), options.pyramid, context, count->reading_bytes);
  if (!plan) return plan.error();
  return Done{};
}

}  // namespace

Status outcrop_fits(const std::filesystem::path& mesh_file, const TilesetOptions& options, const Context& context) {
  if (context.max_memory_bytes == 0) return Done{};
  const ReadOptions reading;
  const auto input = Input::open(mesh_file, reading.max_file_bytes);
  if (!input) return input.error();
  Status status = fits(*input, options, context);
  if (status) return status;
  Error error = status.error();
  if (error.where.empty()) error.where = mesh_file.string();
  return error;
}

}  // namespace lodestone
