// SPDX-License-Identifier: MIT
#include <lodestone/cursor.h>
#include <lodestone/formats.h>

#include <algorithm>
#include <chrono>
#include <random>

#include "count_allocations.h"
#include "verbs.h"

namespace lodestone::cli {
namespace {

class Play final : public Verb {
 public:
  [[nodiscard]] std::string name() const override { return "play"; }
  [[nodiscard]] std::string summary() const override { return "Time a cursor: full sweeps and random seeks"; }
  [[nodiscard]] std::string example() const override { return "lodestone play house.lode --json"; }
  void declare(Arguments& arguments) override {
    arguments.file("MODEL", model_, "Progressive model (.lode)", Need::Required);
    arguments.count("--sweeps", sweeps_, 1, 1000, "Full sweeps each way; the median is reported");
    arguments.count("--seeks", seeks_, 1, 1'000'000, "Random seeks of 1 % of the stack");
    arguments.seed("--seed", seed_, "Another seed seeks elsewhere");
  }
  [[nodiscard]] Status run(Session& session) override;

 private:
  std::filesystem::path model_;
  std::uint32_t sweeps_ = 5;
  std::uint32_t seeks_ = 1000;
  std::uint64_t seed_ = 1;
};

double percentile(std::vector<double>& values, double share) {
  const auto nth = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

// Seconds that a cursor takes to a level, by the call that a frame loop makes.
double seconds_to(Cursor& cursor, Level level) {
  const auto start = std::chrono::steady_clock::now();
  cursor.set_target(Target::level(level));
  cursor.step({}, 0.0);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct Timings {
  std::vector<double> refine_s, coarsen_s, seek_s;
};

Status measure(Cursor& cursor, std::mt19937_64& random, const Context& context, const std::filesystem::path& file,
               Timings& timings) {
  const Level last = cursor.model().record_count();
  const auto cancelled = [&] { return Error{ErrorCode::Cancelled, "cancelled", file.string()}; };
  for (std::size_t i = 0; i < timings.refine_s.size(); ++i) {
    if (context.cancelled()) return cancelled();
    timings.refine_s[i] = seconds_to(cursor, last);
    timings.coarsen_s[i] = seconds_to(cursor, 0);
  }
  const Level distance = std::max<Level>(1, last / 100);
  for (double& seek_s : timings.seek_s) {
    if (context.cancelled()) return cancelled();
    const Level from = static_cast<Level>(random() % (last + 1ULL));
    const bool down = from >= distance && (from + distance > last || (random() & 1U) != 0);
    cursor.jump(from);
    seek_s = seconds_to(cursor, down ? from - distance : std::min(last, from + distance));
  }
  return Done{};
}

Status Play::run(Session& session) {
  auto read = read_model(model_, {}, session.context());
  session.keep(read);
  if (!read) return read.error();
  const ProgressiveModel& model = **read;
  const Level last = model.record_count();
  Cursor cursor{*read, {.motion = Motion::Hard}};
  std::mt19937_64 random{seed_};
  Timings timings{std::vector<double>(sweeps_), std::vector<double>(sweeps_), std::vector<double>(seeks_)};

  const std::uint64_t allocations_before = allocation_count();
  Status measured = measure(cursor, random, session.context(), model_, timings);
  const std::uint64_t allocations = allocation_count() - allocations_before;
  if (!measured) return measured;

  const double records = last;
  const auto held_bytes = static_cast<double>(model.memory_bytes() + cursor.memory_bytes());
  Report& report = session.report();
  report.set("records", last);
  report.set("refine_records_per_second", records / percentile(timings.refine_s, 0.5));
  report.set("coarsen_records_per_second", records / percentile(timings.coarsen_s, 0.5));
  report.set("seek_seconds_p50", percentile(timings.seek_s, 0.5));
  report.set("seek_seconds_p99", percentile(timings.seek_s, 0.99));
  report.set("bytes_per_triangle", held_bytes / std::max(1U, model.face_slot_count()));
  report.set("bytes_per_vertex", held_bytes / std::max(1U, model.vertex_slot_count()));
  report.set("allocations", allocations);
  return Done{};
}

}  // namespace

std::unique_ptr<Verb> make_play() { return std::make_unique<Play>(); }

}  // namespace lodestone::cli
