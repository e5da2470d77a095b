// SPDX-License-Identifier: MIT
// Pictures of cluster graphs without a window: one cut, or a camera that flies.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include <lodestone/cluster_file.h>

#include "headless.h"

namespace lodestone::render {

/// The cut that this camera needs at `error_px`, its pages streamed in and its groups where their morph stands.
[[nodiscard]] Result<Picture> render_clusters(const std::shared_ptr<const ClusterFile>& file,
                                              const RenderOptions& options = {}, double error_px = 1.0);

struct FlightOptions {
  std::uint32_t frames = 300;  ///< 1/60 s apart
  double error_px = 4.0;
  /// As in ClusterSceneOptions; 0: groups are exchanged at once.
  double morph_seconds = 0.3;
  /// The camera that cuts are made for, in the frame of the graph, at a share 0..1 of the way through this box.
  std::function<View(const Box& bounds, double share)> path;
  /// If given, pictures are taken from here instead, so that what changes from one to the next is the model alone.
  std::function<View(const Box& bounds)> watch;
  /// Wait in every frame until what it needs is loaded: the same pictures whatever the disk does.
  bool waits_for_pages = true;
  StreamOptions stream;
  RenderOptions render{.width_px = 640, .height_px = 360};
  /// Called with every picture, in order; an error ends the flight.
  std::function<Status(const Image& image, std::uint32_t frame)> on_frame;
};

struct ClusterFlight {
  std::vector<double> pops;           ///< block_pop() of successive pictures
  std::vector<double> frame_seconds;  ///< cut, upload and drawing; without waiting, reading back and comparing
  double mean_triangles = 0.0;
  std::uint64_t most_resident_bytes = 0;
};
[[nodiscard]] Result<ClusterFlight> fly_clusters(const std::shared_ptr<const ClusterFile>& file,
                                                 const FlightOptions& options);

}  // namespace lodestone::render
