// SPDX-License-Identifier: MIT
#include <viewer/render/camera.h>
#include <viewer/render/fly_path.h>
#include <viewer/window/orbit_camera.h>

#include <catch2/catch.hpp>
#include <cmath>

using namespace lodestone;
using namespace lodestone::render;

namespace {

// Place in the picture, -1..1 on both axes; z is depth -1..1.
glm::dvec3 projected(const View& view, const Box& bounds, const glm::dvec3& p) {
  const glm::dvec4 clip = projection_matrix(view, bounds) * view_matrix(view) * glm::dvec4{p, 1.0};
  return glm::dvec3{clip} / clip.w;
}

glm::dvec3 corner_of(const Box& box, int i) {
  return {(i & 1) != 0 ? box.max.x : box.min.x, (i & 2) != 0 ? box.max.y : box.min.y,
          (i & 4) != 0 ? box.max.z : box.min.z};
}

// All corners inside, the tighter axis nearly filled, the outline centred on both.
void check_framing(const View& view, const Box& box) {
  glm::dvec2 low{1e9};
  glm::dvec2 high{-1e9};
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 place = projected(view, box, corner_of(box, i));
    low = glm::min(low, glm::dvec2{place});
    high = glm::max(high, glm::dvec2{place});
    CHECK(std::abs(place.z) <= 1.0);
  }
  const double reach = std::max({-low.x, -low.y, high.x, high.y});
  CHECK(reach < 0.96);
  CHECK(reach > 0.90);
  CHECK(low.x + high.x == Approx(0.0).margin(0.03));
  CHECK(low.y + high.y == Approx(0.0).margin(0.03));
}

}  // namespace

TEST_CASE("a framed view shows the whole box, centred and with little margin") {
  const Box street{{-100.0, -8.0, 0.0}, {100.0, 8.0, 15.0}};
  const Box tower{{10.0, 10.0, 0.0}, {20.0, 20.0, 80.0}};
  const Box slab{{-1.0, -1.0, 0.0}, {1.0, 1.0, 0.0}};
  for (const Box& box : {street, tower, slab}) {
    for (const double yaw : {-2.0, -0.6, 0.0, 1.0, 3.0}) {
      check_framing(framed_view(box, {.yaw_rad = yaw, .pitch_rad = 0.4}, 1280, 720), box);
      check_framing(framed_view(box, {.yaw_rad = yaw, .pitch_rad = -0.9}, 300, 700), box);
    }
    for (int direction = 0; direction < 6; ++direction) {
      if (box.size()[direction / 2] > 0.0 || direction >= 4) check_framing(axis_view(box, direction, 256, 256), box);
    }
  }
}

TEST_CASE("views of an empty box and of a point are finite") {
  Box point;
  point.add({5.0, 5.0, 5.0});
  for (const Box& box : {Box{}, point}) {
    const View view = framed_view(box, {}, 640, 480);
    CHECK(std::isfinite(glm::length(view.eye)));
    const glm::dvec3 place = projected(view, box, box.empty() ? glm::dvec3{0.0} : box.center());
    CHECK(std::abs(place.x) < 0.5);
    CHECK(std::abs(place.y) < 0.5);
  }
}

TEST_CASE("look_at puts the target in the middle, also straight down") {
  const Box box{glm::dvec3{-1.0}, glm::dvec3{1.0}};
  for (const glm::dvec3 eye : {glm::dvec3{5.0, 3.0, 2.0}, glm::dvec3{0.2, 0.1, 9.0}, glm::dvec3{0.2, 0.1, -9.0}}) {
    const View view = look_at(eye, {0.2, 0.1, 0.3}, 640, 480, 0.8);
    const glm::dvec3 place = projected(view, box, {0.2, 0.1, 0.3});
    CHECK(place.x == Approx(0.0).margin(1e-9));
    CHECK(place.y == Approx(0.0).margin(1e-9));
  }
}

TEST_CASE("a flight comes back to where it began, outside of the box, which it always sees") {
  const Box box{glm::dvec3{-30.0, -10.0, 0.0}, glm::dvec3{30.0, 10.0, 8.0}};
  for (int i = 0; i < 40; ++i) {
    const View view = fly_view(box, i / 40.0, 800, 600);
    const View later = fly_view(box, i / 40.0 + 1.0, 800, 600);
    CHECK(glm::length(view.eye - later.eye) < 1e-9);
    CHECK(view.eye.z > box.max.z);
    const glm::dvec3 at = view.eye + view.forward * ((box.center().z - view.eye.z) / view.forward.z);
    CHECK(std::abs(at.x) < box.max.x);
    CHECK(std::abs(at.y) < box.max.y);
    const View next = fly_view(box, i / 40.0 + 0.001, 800, 600);
    CHECK(glm::length(next.eye - view.eye) < 0.5);
  }
}

TEST_CASE("a panned point follows the mouse") {
  const Box box{glm::dvec3{-1.0}, glm::dvec3{1.0}};
  OrbitCamera camera;
  camera.frame(box, 800, 600);
  const View before = camera.view();
  const glm::dvec3 target = before.eye + before.forward * camera.distance_m();
  camera.pan(80.0, -30.0);
  const glm::dvec3 place = projected(camera.view(), box, target);
  CHECK(place.x * 400.0 == Approx(80.0).margin(0.01));
  CHECK(place.y * 300.0 == Approx(30.0).margin(0.01));
}

TEST_CASE("orbiting keeps the distance and stops short of vertical; zooming stays in range") {
  const Box box{glm::dvec3{-1.0}, glm::dvec3{1.0}};
  OrbitCamera camera;
  camera.frame(box, 800, 600);
  const double distance_m = camera.distance_m();
  camera.turn(123.0, 100'000.0);
  CHECK(camera.distance_m() == distance_m);
  CHECK(std::abs(camera.view().forward.z) < 0.9999);
  camera.zoom(1000.0);
  CHECK(camera.distance_m() > 0.0);
  camera.zoom(-5000.0);
  CHECK(camera.distance_m() <= 1000.0 * box.diagonal_m());
}
