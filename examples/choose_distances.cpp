// SPDX-License-Identifier: MIT
// At which distances should discrete levels switch? The library measures pictures and does not draw: bring your own
// renderer. Here it is the simplest there is (each triangle flat shaded into a depth buffer), so that the example needs
// neither window nor graphics card.
//
//     choose_distances house.lode
#include <lodestone/formats.h>
#include <lodestone/perception.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace {

using namespace lodestone;

// A model looked at from the side that `sides` calls its front.
class Painter {
 public:
  Painter(const Mesh& mesh, const Sides& sides, const Display& display)
      : mesh_(mesh),
        middle_(sides.bounds.center),
        toward_eye_(std::sin(sides.front_rad), std::cos(sides.front_rad), 0.0),
        right_(-toward_eye_.y, toward_eye_.x, 0.0),
        width_(display.width_px),
        height_(display.height_px),
        focal_px_(focal_length_px(display)) {}

  [[nodiscard]] Result<ObjectPicture> operator()(double distance_m) {
    const std::size_t pixels = std::size_t{width_} * height_;
    ObjectPicture picture{Image{width_, height_, 1, std::vector<std::uint8_t>(pixels, 255)},  // white
                          std::vector<std::uint8_t>(pixels, 0)};
    depth_.assign(pixels, std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i + 2 < mesh_.indices.size(); i += 3) paint(picture, i, distance_m);
    return picture;
  }

 private:
  // x and y in pixels, z = metres from the eye.
  [[nodiscard]] glm::dvec3 on_screen(glm::dvec3 point, double distance_m) const {
    const glm::dvec3 p = point - middle_;
    const double depth_m = distance_m - glm::dot(p, toward_eye_);
    return {0.5 * width_ + focal_px_ * glm::dot(p, right_) / depth_m, 0.5 * height_ - focal_px_ * p.z / depth_m,
            depth_m};
  }

  void paint(ObjectPicture& picture, std::size_t corner, double distance_m) {
    glm::dvec3 world[3];
    glm::dvec3 c[3];
    for (std::size_t k = 0; k < 3; ++k) {
      world[k] = glm::dvec3{mesh_.vertices.positions[mesh_.indices[corner + k]]};
      c[k] = on_screen(world[k], distance_m);
    }
    const double area = (c[1].x - c[0].x) * (c[2].y - c[0].y) - (c[2].x - c[0].x) * (c[1].y - c[0].y);
    const glm::dvec3 normal = glm::cross(world[1] - world[0], world[2] - world[0]);
    if (area == 0.0 || glm::length(normal) == 0.0) return;
    const double facing = std::abs(glm::dot(normal, glm::normalize(toward_eye_ + glm::dvec3{0.3, 0.2, 0.6})));
    const auto grey = static_cast<std::uint8_t>(60.0 + 90.0 * std::min(1.0, facing / glm::length(normal)));
    const auto first = [](double a, double b, double d) { return std::max(0.0, std::ceil(std::min({a, b, d}) - 0.5)); };
    const auto last = [](double a, double b, double d, double end) { return std::min(end, std::max({a, b, d}) + 0.5); };
    for (double y = first(c[0].y, c[1].y, c[2].y); y < last(c[0].y, c[1].y, c[2].y, height_); ++y) {
      for (double x = first(c[0].x, c[1].x, c[2].x); x < last(c[0].x, c[1].x, c[2].x, width_); ++x) {
        const double u = ((x + 0.5 - c[0].x) * (c[2].y - c[0].y) - (c[2].x - c[0].x) * (y + 0.5 - c[0].y)) / area;
        const double v = ((c[1].x - c[0].x) * (y + 0.5 - c[0].y) - (x + 0.5 - c[0].x) * (c[1].y - c[0].y)) / area;
        if (u < 0.0 || v < 0.0 || u + v > 1.0) continue;
        const double depth_m = c[0].z + u * (c[1].z - c[0].z) + v * (c[2].z - c[0].z);
        const auto i = static_cast<std::size_t>(y) * width_ + static_cast<std::size_t>(x);
        if (depth_m >= depth_[i]) continue;
        depth_[i] = depth_m;
        picture.image.pixels[i] = grey;
        picture.mask[i] = 1;
      }
    }
  }

  const Mesh& mesh_;
  glm::dvec3 middle_, toward_eye_, right_;
  std::uint32_t width_;
  std::uint32_t height_;
  double focal_px_;
  std::vector<double> depth_;
};

int fail(const Error& error) {
  std::fprintf(stderr, "%s\n", to_line(error).c_str());
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: choose_distances MODEL.lode\n", stderr);
    return 1;
  }
  const auto model = read_model(argv[1]);
  if (!model) return fail(model.error());
  const Mesh mesh = (*model)->extract((*model)->record_count());
  const Sides sides = find_sides(mesh);
  const Display display{.width_px = 640, .height_px = 512, .dots_per_inch = 86.27, .viewing_distance_m = 0.5};
  const double focal_px = focal_length_px(display);
  const double first_m = first_distance_m(sides.bounds.radius_m, display.fov_y_rad);
  const double beyond_m = last_distance_m(sides.bounds.radius_m, focal_px) - first_m;

  const auto samples = sample_perceptual_metric({.first_m = first_m, .last_m = 15.6 * first_m, .count = 40},
                                                VisionModel{display}, Painter{mesh, sides, display});
  if (!samples) return fail(samples.error());
  const auto fit = fit_detail(*samples);
  if (!fit) return fail(fit.error());
  std::printf("visible detail, x metres beyond %.1f m: %.4f exp(%.5f x) + %.4f exp(%.5f x), R^2 %.4f\n", first_m,
              fit->a, fit->b, fit->c, fit->d, fit->r_square);

  auto plan = design_switches(*fit, choose_level_count(*fit, beyond_m), beyond_m);
  if (!plan) return fail(plan.error());
  add_cost(*plan, **model, first_m, beyond_m, focal_px);
  for (std::size_t i = 0; i < plan->switch_m.size(); ++i) {
    std::printf("from %8.1f m: level %u, %u triangles\n", first_m + plan->switch_m[i], plan->levels[i],
                plan->triangles[i]);
  }
  return 0;
}
