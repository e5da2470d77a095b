// SPDX-License-Identifier: MIT
// Levels of a model against full detail, as an eye before the display has them: the check of Zhu et al. 2010, section
// 5.2, where the levels switch.
#pragma once

#include <map>
#include <utility>

#include "detail_stage.h"
#include "switch_study.h"

namespace lodestone::render {

class LevelChecker {
 public:
  /// `noticeable_limit` as in StudyOptions. Keeps a reference to the stage and the context.
  LevelChecker(std::shared_ptr<const ProgressiveModel> model, const Display& display, double noticeable_limit,
               DetailStage& stage, const Context& context)
      : model_(std::move(model)), vision_(display), limit_(noticeable_limit), stage_(stage), context_(context) {}

  /// The sides whose pixels are counted together. Call first, once.
  void look_at(std::vector<LookedAt> sides) { sides_ = std::move(sides); }

  /// One level from one distance; what was asked before is not drawn again.
  [[nodiscard]] Result<LevelCheck> check(Level level, double distance_m);

  /// Of the levels from `from` to `finest`, by halving to a thousandth of the stack, one that passes the limit; `from`
  /// itself if it does, `finest` if none does.
  [[nodiscard]] Result<std::pair<Level, LevelCheck>> coarsest_unnoticed(Level from, Level finest, double distance_m);

  [[nodiscard]] const VisionModel& vision() const noexcept { return vision_; }

 private:
  /// The sides in full detail. Those of the nearest distance are kept, and of the one asked for last.
  [[nodiscard]] Result<const std::vector<ObjectPicture>*> full_detail(double distance_m);

  std::shared_ptr<const ProgressiveModel> model_;
  VisionModel vision_;
  double limit_;
  DetailStage& stage_;
  const Context& context_;
  std::vector<LookedAt> sides_;
  std::map<double, std::vector<ObjectPicture>> full_;
  std::map<std::pair<double, Level>, LevelCheck> checked_;
};

}  // namespace lodestone::render
