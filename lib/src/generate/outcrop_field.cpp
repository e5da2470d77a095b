// SPDX-License-Identifier: MIT
#include "generate/outcrop_field.h"

#include <algorithm>
#include <cmath>

#include "base/rng.h"
#include "generate/noise.h"

namespace lodestone::generate {

namespace {

// The undisturbed profile: arc length to (depth into the hill, height). Talus, cliff, plateau, with rounded knees.
struct ProfilePoint {
  double t_m, y_m, z_m;
};
constexpr ProfilePoint profile[] = {{0.0, 0.0, 0.0},    {9.0, 8.2, 3.6},    {11.0, 9.6, 5.0},   {13.0, 10.2, 6.9},
                                    {35.0, 12.4, 28.8}, {37.0, 13.3, 30.5}, {40.0, 16.1, 31.4}, {52.0, 28.0, 32.8}};

struct Place {
  double y_m = 0, z_m = 0;
  double out_y = 0, out_z = 0;  // outward direction, unit length
};

Place on_profile(double t_m) noexcept {
  const ProfilePoint* end = std::end(profile) - 1;
  const ProfilePoint* p = std::begin(profile);
  while (p + 1 != end && t_m > p[1].t_m) ++p;
  const double share = (t_m - p->t_m) / (p[1].t_m - p->t_m);
  Place place;
  place.y_m = mix(p->y_m, p[1].y_m, share);
  place.z_m = mix(p->z_m, p[1].z_m, share);
  // Outward turns smoothly from up the slope of the talus to level on the cliff and up again on the plateau.
  const double level = smooth_step(7.0, 14.0, t_m) - smooth_step(34.0, 41.0, t_m);
  const double out_y = -0.15 - 0.85 * level;
  const double out_z = 1.0 - 0.98 * level;
  const double length = std::sqrt(out_y * out_y + out_z * out_z);
  place.out_y = out_y / length;
  place.out_z = out_z / length;
  return place;
}

// Octaves of noise of first wavelength `wave_m` that a grid of `cell_m` can show.
int visible_octaves(double wave_m, double cell_m, int most) noexcept {
  int octaves = 1;
  for (double w = wave_m * 0.5; octaves < most && w > 2.0 * cell_m; w *= 0.5) ++octaves;
  return octaves;
}

glm::vec3 bed_color(Rng& rng, double hardness) {
  // Sandstones of ochre, cream and rust; soft beds are grey-green or maroon shales.
  static constexpr float hard[][3] = {
      {0.62F, 0.47F, 0.30F}, {0.70F, 0.58F, 0.42F}, {0.58F, 0.44F, 0.32F}, {0.66F, 0.53F, 0.39F}};
  static constexpr float soft[][3] = {
      {0.40F, 0.36F, 0.30F}, {0.43F, 0.31F, 0.26F}, {0.36F, 0.34F, 0.31F}, {0.50F, 0.38F, 0.27F}};
  const auto& c = hardness > 0.0 ? hard[rng.below(4)] : soft[rng.below(4)];
  const auto tint = static_cast<float>(rng.uniform(0.88, 1.1));
  return glm::vec3{c[0], c[1], c[2]} * tint;
}

}  // namespace

OutcropField::OutcropField(std::uint64_t seed) : seed_(static_cast<std::uint32_t>(hash_combine(seed, 11))) {
  Rng rng{seed, 12};
  dip_ = rng.uniform(-0.09, 0.09);
  fault_s_m_ = rng.uniform(0.3, 0.7) * width_m;
  throw_m_ = rng.uniform(0.9, 2.2);
  double base = -20.0;
  bool hard = true;
  while (base < 60.0) {
    Bed bed;
    bed.base_m = base;
    bed.thickness_m = hard ? rng.uniform(0.7, 3.4) : rng.uniform(0.15, 0.9);
    bed.hardness = hard ? rng.uniform(0.15, 1.0) : rng.uniform(-1.0, -0.3);
    bed.color = bed_color(rng, bed.hardness);
    beds_.push_back(bed);
    base += bed.thickness_m;
    hard = !hard || rng.unit() < 0.3;
  }
}

std::uint32_t OutcropField::bed_at(double strata_m) const noexcept {
  const auto above =
      std::upper_bound(beds_.begin(), beds_.end(), strata_m, [](double s, const Bed& bed) { return s < bed.base_m; });
  return above == beds_.begin() ? 0 : static_cast<std::uint32_t>(above - beds_.begin() - 1);
}

OutcropField::Joints OutcropField::joints(std::uint32_t bed, double along_m, double up_m,
                                          double spacing_m) const noexcept {
  // Joints lean a little and stand at uneven distances; each block between two of them has come forward differently.
  const double place =
      (along_m + 0.12 * up_m) / spacing_m + 37.0 * lattice_unit(seed_ + 5, static_cast<std::int32_t>(bed));
  const auto cell = static_cast<std::int32_t>(std::floor(place));
  const auto row = static_cast<std::int32_t>(bed);
  const auto edge = [&](std::int32_t i) { return i + 0.6 * (lattice_unit(seed_ + 6, i, row) - 0.5); };
  std::int32_t block = cell;
  if (place < edge(cell)) --block;
  if (place >= edge(cell + 1)) ++block;
  const double left_m = (place - edge(block)) * spacing_m;
  const double right_m = (edge(block + 1) - place) * spacing_m;
  const double gap_m = std::min(left_m, right_m);
  const double width_m_here = 0.03 + 0.05 * lattice_unit(seed_ + 7, left_m < right_m ? block : block + 1, row);
  const double lean = (lattice_unit(seed_ + 8, block, row) - 0.5) * 0.16 * (left_m - right_m);
  Joints result;
  const double luck = lattice_unit(seed_ + 9, block, row);
  result.offset_m = 0.7 * (luck - 0.55) + lean - (luck < 0.12 ? 0.6 : 0.0);  // some blocks have fallen out
  result.crack = 1.0 - smooth_step(0.4 * width_m_here, 1.6 * width_m_here, gap_m);
  return result;
}

RockSample OutcropField::carve(double s_m, double z_m, double cell_m) const noexcept {
  RockSample rock;
  // Beds dip, bend gently and step down at one fault that leans.
  const double past_fault = s_m - fault_s_m_ - 0.35 * (z_m - 15.0);
  rock.strata_m = z_m + dip_ * (s_m - 0.5 * width_m) + 1.1 * noise(seed_ + 20, s_m / 34.0, 0.2) +
                  0.12 * fractal(seed_ + 21, s_m / 5.0, z_m / 3.0, 2) + (past_fault > 0.0 ? throw_m_ : 0.0);
  const std::uint32_t index = bed_at(rock.strata_m);
  const Bed& bed = beds_[index];
  const double above_m = rock.strata_m - bed.base_m;
  const double below_m = bed.thickness_m - above_m;
  const double to_edge_m = std::min(above_m, below_m);

  const double spacing_m = std::clamp(1.5 * bed.thickness_m, 0.5, 3.2);
  const Joints block = joints(index, s_m + 0.25 * noise(seed_ + 22, s_m * 0.5, z_m * 0.5), above_m, spacing_m);
  const double cleft = 1.0 - smooth_step(0.02, 0.10, to_edge_m);
  const double wear = 0.5 + 0.5 * noise(seed_ + 23, s_m / 7.0, z_m / 5.0);
  // Edges of hard beds are rounded off; hard beds stand out, soft ones hollow out between them.
  const double round_m = 0.22 * (1.0 - smooth_step(0.0, 0.35, to_edge_m));
  rock.relief_m =
      0.75 * bed.hardness * (0.6 + 0.4 * wear) + block.offset_m * (bed.hardness > 0.0 ? 1.0 : 0.35) - round_m;
  // Great fractures cut through everything, the fault among them.
  const double warp = 1.6 * noise(seed_ + 24, s_m / 9.0, z_m / 9.0);
  const double line = std::abs(noise(seed_ + 25, (s_m + 0.3 * z_m + warp) / 11.0, z_m / 60.0));
  const double fracture = 1.0 - smooth_step(0.0, 0.04, line);
  const double fault = 1.0 - smooth_step(0.05, 0.45, std::abs(past_fault + 0.4 * noise(seed_ + 26, 0.3, z_m / 2.0)));
  rock.relief_m -= 1.3 * fracture * fracture + 0.7 * fault;
  rock.relief_m -= 0.30 * block.crack + 0.16 * cleft;
  rock.relief_m += 0.10 * fractal(seed_ + 30, s_m / 1.3, z_m / 0.9, visible_octaves(1.0, cell_m, 8), 0.55);
  rock.relief_m -= 0.08 * ridged(seed_ + 40, s_m / 0.8, z_m / 0.5, visible_octaves(0.6, cell_m, 4));
  rock.crack = static_cast<float>(
      std::clamp(std::max({block.crack, 0.8 * cleft, 0.7 * fracture * fracture, 0.8 * fault}), 0.0, 1.0));
  return rock;
}

RockSample OutcropField::sample(double s_m, double t_m, double cell_m) const noexcept {
  const Place place = on_profile(t_m);
  const double edge = 0.8 * noise(seed_ + 50, s_m / 4.0, 7.0) + 0.4 * noise(seed_ + 51, s_m / 1.1, 3.0);
  const double foot = smooth_step(8.5, 13.0, t_m + 2.5 * noise(seed_ + 52, s_m / 8.0, 1.0) + edge);
  const double brow = 1.0 - smooth_step(35.2, 37.6, t_m + edge);
  RockSample rock;
  if (foot * brow > 0.0) rock = carve(s_m, place.z_m, cell_m);
  rock.face = static_cast<float>(foot * brow);
  rock.turf = static_cast<float>(1.0 - brow);
  double scree = 0.0;
  if (foot < 1.0) {
    scree =
        1.5 * boulders(seed_ + 60, s_m / 2.6, t_m / 2.6) *
            smooth_step(0.35, 0.6, lattice_unit(seed_, 1) * 0.3 + 0.5 + 0.5 * noise(seed_ + 61, s_m / 9.0, t_m / 6.0)) +
        0.5 * boulders(seed_ + 62, s_m / 0.9, t_m / 0.9) + 0.16 * boulders(seed_ + 63, s_m / 0.33, t_m / 0.33) +
        0.05 * fractal(seed_ + 64, s_m / 0.7, t_m / 0.7, visible_octaves(0.7, cell_m, 5));
  }
  const double turf =
      brow < 1.0 ? 0.35 * fractal(seed_ + 70, s_m / 5.0, t_m / 5.0, visible_octaves(5.0, cell_m, 7), 0.45) : 0.0;
  rock.relief_m = mix(scree, rock.relief_m, foot);
  rock.relief_m = mix(turf, rock.relief_m, brow);
  rock.crack *= rock.face;
  return rock;
}

glm::dvec3 OutcropField::position(double s_m, double t_m, double cell_m) const noexcept {
  const Place place = on_profile(t_m);
  const RockSample rock = sample(s_m, t_m, cell_m);
  // The cliff swings in and out in bays and buttresses.
  const double plan =
      4.5 * fractal(seed_ + 80, s_m / 38.0, 0.4, 3) + 1.2 * noise(seed_ + 81, s_m / 11.0, place.z_m / 30.0);
  return {s_m - 0.5 * width_m, place.y_m + plan + rock.relief_m * place.out_y, place.z_m + rock.relief_m * place.out_z};
}

}  // namespace lodestone::generate
