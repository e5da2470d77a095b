// SPDX-License-Identifier: MIT
// Based on: Li et al. 2019 (facet shift, one stack of reversible records).
// Differs: planes, parts and points compete by the squared distance they cost per face gone, level by level of that
// price; between two shifts points slide within their planes, which costs nothing. Few faces ever tilt: the price for
// leaving a plane's direction is high, and asked only when nothing cheaper is left.
#include <lodestone/facet_shift.h>

#include <algorithm>
#include <array>
#include <optional>
#include <queue>
#include <set>
#include <span>

#include <lodestone/repair.h>

#include "facets/appendages.h"
#include "facets/block.h"
#include "facets/build_log.h"
#include "facets/crossing.h"
#include "facets/facet_mesh.h"
#include "facets/hidden.h"
#include "facets/joiner.h"
#include "facets/judge.h"
#include "facets/kinds.h"
#include "facets/last_stretch.h"
#include "facets/openings.h"
#include "facets/outline.h"
#include "facets/parts.h"
#include "facets/plan.h"
#include "facets/scraps.h"
#include "facets/visibility.h"
#include "progressive/values.h"

namespace lodestone {
namespace facets {
namespace {

constexpr double first_price = 1e-10;  // m^4 a face
constexpr double price_step = 4.0;
constexpr double look_ahead = 16.0;  // times the price: shifts that cost more when they were looked at wait
constexpr double least_share = 0.1;  // of what the whole plane would cost, a shift costs at least
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double last_share = 1e-2;  // of (area * diagonal^2): beyond it the block itself would go
constexpr std::uint32_t rounds_per_price = 4;
constexpr std::size_t most_neighbours = 256;  // faces of a point that is looked at
constexpr std::size_t few_neighbours = 24;    // with more it is looked at again only when the others are done
constexpr double free_cost = 1e-9;            // m^4; what slides within its plane cuts through nothing
constexpr double most_gone = 4.0;             // faces that a slide takes; a few take more

class Builder {
 public:
  Builder(const Mesh& source, const FacetShiftOptions& options, const Context& context)
      : options_(options),
        context_(context),
        log_(progressive::value_words(source.vertices)),
        mesh_(make_facet_mesh(source, options, degenerate_)),
        moved_(mesh_),
        pieces_(mesh_),
        slides_(mesh_, pieces_),
        planner_(mesh_),
        around_(mesh_),
        parts_(mesh_, pieces_, around_),
        scraps_(mesh_, around_),
        hidden_(mesh_),
        block_(mesh_),
        stepped_(mesh_, block_),
        crossings_(mesh_, parts_),
        kinds_(mesh_),
        offered_(mesh_.point_count(), 0) {}

  progressive::EditLog run(FacetShiftReport& report);

 private:
  struct Entry {
    double key = 0.0;
    std::uint32_t point = none, onto = none, version = 0;
    // Cheapest first, then by id.
    bool operator<(const Entry& b) const { return key != b.key ? key > b.key : point > b.point; }
  };

  // What a shift would have cost when it was looked at last.
  struct Known {
    std::uint64_t version = 0;
    double key = 0.0;
  };

  void drop_degenerate();
  void drop_interior();
  void offer(std::uint32_t point);
  void slide_points(double price);
  bool shift_planes(double price);
  [[nodiscard]] std::uint64_t version_of(std::uint32_t surface) const;
  [[nodiscard]] double key_of_shift(Direction direction, double price);
  [[nodiscard]] bool is_due(std::uint32_t surface, double price) const;
  [[nodiscard]] bool is_stale(std::uint32_t surface, std::uint64_t version, double price) const;
  void vanish_parts(double price);
  void vanish_scraps(const std::vector<Scrap>& scraps, Going going, std::uint32_t& count);
  bool close_openings(double price);
  [[nodiscard]] std::uint32_t& count_of(OpeningJob::Kind kind) noexcept {
    return kind == OpeningJob::Kind::Recess    ? report_.openings_recessed
           : kind == OpeningJob::Kind::Flatten ? report_.openings_flattened
                                               : report_.openings_filled;
  }
  void lead_kinds();
  std::uint32_t follow(double error_m);
  void offer_around(std::span<const std::uint32_t> points);
  bool offer_later();
  [[nodiscard]] bool cuts_through();
  [[nodiscard]] bool takes_of_the_block(const Move& move) const;
  [[nodiscard]] const Block& next_block() const { return stepped_.exists() ? stepped_ : block_; }
  bool become(const Block& block);
  [[nodiscard]] std::string why_no_block() const;
  [[nodiscard]] bool done() const {
    return mesh_.live_faces <= options_.target_triangles || block_due_ || next_block().must_come(mesh_) ||
           context_.cancelled() || hands_over();
  }
  // A closed model would come to cross itself: there the loop goes on to the end.
  [[nodiscard]] bool hands_over() const {
    return !closed_ && block_.exists() &&
           mesh_.live_faces <= last_stretch_share * static_cast<double>(mesh_.faces.size());
  }
  void collapse_rest(double price);

  const FacetShiftOptions& options_;
  const Context& context_;
  progressive::EditLog log_;
  std::vector<FaceId> degenerate_;
  FacetMesh mesh_;
  Moved moved_;
  Pieces pieces_;
  SlideJudge slides_;
  Planner planner_;
  Surroundings around_;
  PartFinder parts_;
  ScrapFinder scraps_;
  HiddenFinder hidden_;
  Block block_;
  Block stepped_;  // comes before it, if it exists
  bool closed_ = true;
  bool block_due_ = false;  // the next slide would take a face that it needs
  CrossingFinder crossings_;
  Kinds kinds_;
  Kinds::Errand errand_;
  std::optional<std::uint64_t> led_at_;                        // edits there had been when kinds were told apart
  std::vector<std::uint8_t> offered_;                          // per point
  std::set<std::pair<std::uint32_t, std::uint32_t>> refused_;  // slides, at this price
  std::priority_queue<Entry> queue_;
  std::vector<std::uint32_t> later_;         // points to be looked at again
  std::vector<std::uint32_t> surfaces_;      // with faces left, but for those of parts that follow
  std::array<std::vector<Known>, 2> known_;  // per direction and surface
  FacetShiftReport report_;
  std::optional<Openings> openings_;
};

void Builder::drop_degenerate() {
  for (const FaceId f : degenerate_) {
    log_.begin(static_cast<float>(options_.weld_tolerance_m));
    log_.remove_face(f);
    log_.end();
  }
}

void Builder::drop_interior() {
  const std::vector<std::uint8_t> seen = seen_surfaces(*mesh_.source, mesh_.surfaces);
  if (std::find(seen.begin(), seen.end(), 1) == seen.end()) return;
  for (std::uint32_t s = 0; s < seen.size() && !done(); ++s) {
    if (seen[s] != 0) continue;
    const std::vector<FaceId> faces = mesh_.surface_faces[s];
    report_.interior_faces += static_cast<std::uint32_t>(faces.size());
    vanish(mesh_, faces, Going::Still, 0.0, log_);
  }
}

// The cheapest way for the point to slide onto a neighbour.
void Builder::offer(std::uint32_t point) {
  const auto& faces = mesh_.faces_of[point];
  if (faces.empty() || faces.size() > most_neighbours || kinds_.follows(point)) return;
  Entry best{std::numeric_limits<double>::infinity(), point, none, mesh_.version[point]};
  double best_length = 0.0;
  slides_.look_at(point);
  for (const SlideJudge::Spoke& spoke : slides_.spokes()) {
    const std::uint32_t q = spoke.to;
    if (!refused_.empty() && refused_.contains({point, q})) continue;
    const Verdict v = slides_.judge(q, most_gone * best.key);
    if (!v.allowed || v.error_m > options_.max_error_m || v.key() > best.key) continue;
    const double length = glm::length(mesh_.at(q) - mesh_.at(point));
    if (v.key() == best.key && length >= best_length) continue;
    best.key = v.key();
    best.onto = q;
    best_length = length;
  }
  if (best.onto != none) queue_.push(best);
}

void Builder::offer_around(std::span<const std::uint32_t> points) {
  std::vector<std::uint32_t> around{points.begin(), points.end()};
  for (const std::uint32_t point : points) {
    for (const FaceId f : mesh_.faces_of[point])
      around.insert(around.end(), mesh_.faces[f].point.begin(), mesh_.faces[f].point.end());
  }
  std::sort(around.begin(), around.end());
  around.erase(std::unique(around.begin(), around.end()), around.end());
  for (const std::uint32_t p : around) {
    if (mesh_.faces_of[p].size() <= few_neighbours) {
      offer(p);
    } else {
      later_.push_back(p);
    }
  }
}

// Of the moves that were judged last.
bool Builder::cuts_through() {
  crossings_.update(mesh_.touched);
  mesh_.touched.clear();
  return crossings_.makes_crossing(moved_);
}

bool Builder::offer_later() {
  if (later_.empty()) return false;
  std::sort(later_.begin(), later_.end());
  later_.erase(std::unique(later_.begin(), later_.end()), later_.end());
  for (const std::uint32_t p : later_) offer(p);
  later_.clear();
  return true;
}

// The parts of the same kind do as the one for which errand_ was prepared; returns how many did.
std::uint32_t Builder::follow(double error_m) {
  for (std::uint32_t i = 0; i < errand_.size(); ++i) {
    if (done()) return i;
    const std::span<const Move> moves = errand_.moves(i);
    moved_.set(moves);
    if (moves.size() == 1 && takes_of_the_block(moves.front())) {
      block_due_ = true;
      return i;
    }
    apply(mesh_, moved_, error_m + errand_.apart_m(i), log_);
  }
  return errand_.size();
}

// Tells anew which parts are alike. What led or was alone and follows now waits; what is on its own again is looked at.
void Builder::lead_kinds() {
  if (led_at_ == mesh_.edits) return;
  led_at_ = mesh_.edits;
  if (options_.order == ShiftOrder::OneByOne) {
    parts_.split();
    crossings_.update(mesh_.touched);
    crossings_.start();
    mesh_.touched.clear();
    kinds_.update(parts_.parts());
  }
  for (std::uint32_t p = 0; p < mesh_.point_count() && !context_.cancelled(); ++p) {
    if (kinds_.follows(p)) {
      offered_[p] = 0;
    } else if (offered_[p] == 0) {
      offered_[p] = 1;
      offer(p);
    }
  }
  surfaces_.clear();
  for (std::uint32_t s = 0; s < mesh_.surface_faces.size(); ++s) {
    const auto& faces = mesh_.surface_faces[s];
    if (!faces.empty() && !kinds_.follows(mesh_.faces[faces.front()])) surfaces_.push_back(s);
  }
}

void Builder::slide_points(double price) {
  while (!done()) {
    if (queue_.empty() || queue_.top().key > price) {
      if (!offer_later()) break;
      continue;
    }
    const Entry e = queue_.top();
    queue_.pop();
    if (e.version != mesh_.version[e.point] || kinds_.follows(e.point)) continue;
    const Move move{e.point, e.onto, mesh_.place[e.onto]};
    slides_.look_at(e.point);
    const Verdict v = slides_.judge(e.onto, std::numeric_limits<double>::infinity());
    if (!v.allowed || v.key() > price) {
      offer(e.point);
      continue;
    }
    moved_.set({&move, 1});
    if (v.cost > free_cost && cuts_through()) {
      refused_.insert({e.point, e.onto});
      later_.push_back(e.point);
      continue;
    }
    if (takes_of_the_block(move)) {
      block_due_ = true;
      return;
    }
    kinds_.prepare({&move, 1}, errand_);
    apply(mesh_, moved_, v.error_m, log_);
    (v.tilts ? report_.tilting_collapses : report_.points_merged) += 1 + follow(v.error_m);
    offer_around({&e.onto, 1});
  }
}

// Changes whenever something around the surface does.
std::uint64_t Builder::version_of(std::uint32_t surface) const {
  std::uint64_t sum = 1;
  for (const FaceId f : mesh_.surface_faces[surface]) {
    for (const std::uint32_t p : mesh_.faces[f].point) sum += mesh_.version[p];
  }
  return sum;
}

double Builder::key_of_shift(Direction direction, double price) {
  const double way_m = planner_.way_m(direction);
  if (way_m == 0.0) return infinity;
  const double least = least_share * planner_.area_m2() * way_m * way_m / static_cast<double>(planner_.face_count());
  if (least > price) return least;
  const Plan plan = planner_.plan(way_m);
  if (plan.moves.empty()) return infinity;
  const Verdict v = judge_shift(mesh_, moved_, plan.moves);
  return v.allowed && v.error_m <= options_.max_error_m ? v.key() : infinity;
}

// Whether what the shifts of the surface cost may have to be found anew.
bool Builder::is_due(std::uint32_t surface, double price) const {
  return std::any_of(known_.begin(), known_.end(), [&](const std::vector<Known>& known) {
    return std::isinf(known[surface].key) || known[surface].key <= look_ahead * price;
  });
}

// Of one that is due, whether they have.
bool Builder::is_stale(std::uint32_t surface, std::uint64_t version, double price) const {
  return std::any_of(known_.begin(), known_.end(), [&](const std::vector<Known>& known) {
    const Known& k = known[surface];
    if (k.version == version) return k.key <= price;
    return std::isinf(k.key) || k.key <= look_ahead * price;
  });
}

bool Builder::shift_planes(double price) {
  struct Offer {
    double key;
    std::uint32_t surface;
    Direction direction;
  };
  std::vector<Offer> offers;
  planner_.begin_round();
  std::erase_if(surfaces_, [&](std::uint32_t s) {
    if (mesh_.faces[mesh_.surface_faces[s].front()].live) return false;
    std::erase_if(mesh_.surface_faces[s], [&](FaceId f) { return !mesh_.faces[f].live; });
    return mesh_.surface_faces[s].empty();
  });
  for (const std::uint32_t s : surfaces_) {
    if (context_.cancelled()) break;
    if (!is_due(s, price)) continue;
    std::erase_if(mesh_.surface_faces[s], [&](FaceId f) { return !mesh_.faces[f].live; });
    const std::uint64_t version = version_of(s);
    if (!is_stale(s, version, price)) continue;
    const bool moves = planner_.look_at(s) && !kinds_.follows(planner_.first_point());
    for (const Direction direction : {Direction::Inwards, Direction::Outwards}) {
      Known& known = known_[static_cast<std::size_t>(direction)][s];
      known = {version, moves ? key_of_shift(direction, price) : infinity};
      if (known.key <= price) offers.push_back({known.key, s, direction});
    }
  }
  std::stable_sort(offers.begin(), offers.end(), [](const Offer& a, const Offer& b) { return a.key < b.key; });
  Joiner joiner{log_, options_.order};
  const auto way = [&](const Offer& offer) {
    const glm::dvec3 n = 20.0 * mesh_.surfaces.surfaces[offer.surface].normal;
    return Joiner::Key{std::lround(n.x), std::lround(n.y), std::lround(n.z),
                       static_cast<std::int64_t>(offer.direction)};
  };
  if (joiner.joins()) {
    std::stable_sort(offers.begin(), offers.end(), [&](const Offer& a, const Offer& b) { return way(a) < way(b); });
  }
  bool any = false;
  for (const Offer& offer : offers) {
    if (done()) break;
    joiner.begin(way(offer));
    planner_.begin_round();  // others may have moved meanwhile: plan anew
    if (!planner_.look_at(offer.surface)) continue;
    const Plan plan = planner_.plan(planner_.way_m(offer.direction));
    if (plan.moves.empty()) continue;
    const Verdict v = judge_shift(mesh_, moved_, plan.moves);
    if (!v.allowed || v.key() > price || v.error_m > options_.max_error_m) continue;
    if (cuts_through()) {
      // Not asked again at this price unless something around it changes.
      known_[static_cast<std::size_t>(offer.direction)][offer.surface].key = std::nextafter(price, infinity);
      continue;
    }
    kinds_.prepare(plan.moves, errand_);
    apply(mesh_, moved_, v.error_m, log_);
    report_.shifts += 1 + follow(v.error_m);
    any = true;
    std::vector<std::uint32_t> ends;
    for (const Move& m : plan.moves) ends.push_back(m.onto == none ? m.point : m.onto);
    offer_around(ends);
  }
  return any;
}

void Builder::vanish_parts(double price) {
  // Farther than this no part of a face or more can be within the price.
  const double limit = std::min(options_.max_error_m, std::sqrt(price / 1e-3));
  std::vector<std::uint8_t> leant_upon(mesh_.point_count(), 0);
  for (const Part& part : parts_.find(limit, price)) {
    if (done()) break;
    if (part.error_m > options_.max_error_m) continue;
    if (mesh_.live_faces - part.faces.size() <= next_block().face_count()) continue;
    const bool holds = std::any_of(part.faces.begin(), part.faces.end(), [&](FaceId f) {
      const auto& p = mesh_.faces[f].point;
      return leant_upon[p[0]] != 0 || leant_upon[p[1]] != 0 || leant_upon[p[2]] != 0;
    });
    const bool held = std::all_of(part.support.begin(), part.support.end(),
                                  [&](std::uint32_t p) { return !mesh_.faces_of[p].empty(); });
    if (holds || !held) continue;
    for (const std::uint32_t p : part.support) {
      leant_upon[p] = 1;
      mesh_.deviation_m[p] = std::max(mesh_.deviation_m[p], static_cast<float>(part.error_m));
    }
    pieces_.hand_on(part.faces, part.support);
    report_.parts_sunk += sink(mesh_, part, log_) ? 1 : 0;
    ++report_.parts_vanished;
  }
}

void Builder::vanish_scraps(const std::vector<Scrap>& scraps, Going going, std::uint32_t& count) {
  std::vector<std::uint8_t> leant_upon(mesh_.faces.size(), 0);
  for (const Scrap& scrap : scraps) {
    if (done()) break;
    if (scrap.error_m > options_.max_error_m || mesh_.live_faces - scrap.faces.size() <= next_block().face_count())
      continue;
    if (std::any_of(scrap.faces.begin(), scrap.faces.end(), [&](FaceId f) { return leant_upon[f] != 0; }) ||
        !std::all_of(scrap.support.begin(), scrap.support.end(), [&](FaceId f) { return mesh_.faces[f].live; })) {
      continue;
    }
    if (next_block().needs(mesh_, scrap.faces)) continue;
    for (const FaceId f : scrap.support) leant_upon[f] = 1;
    std::vector<std::uint32_t> support;
    for (const FaceId f : scrap.support)
      support.insert(support.end(), mesh_.faces[f].point.begin(), mesh_.faces[f].point.end());
    pieces_.hand_on(scrap.faces, support);
    vanish(mesh_, scrap.faces, going, scrap.error_m, log_);
    for (const FaceId f : scrap.faces)
      later_.insert(later_.end(), mesh_.faces[f].point.begin(), mesh_.faces[f].point.end());
    ++count;
  }
}

bool Builder::close_openings(double price) {
  bool any = false;
  openings_->update();
  std::vector<Opening> openings = openings_->all();
  Joiner joiner{log_, options_.order};
  const auto facade = [&](const Opening& o) { return Joiner::Key{mesh_.faces[o.wall].surface}; };
  if (joiner.joins()) {
    std::stable_sort(openings.begin(), openings.end(),
                     [&](const Opening& a, const Opening& b) { return facade(a) < facade(b); });
  }
  for (const Opening& opening : openings) {
    if (done()) break;
    joiner.begin(facade(opening));
    const auto job = openings_->job(opening, price, options_.max_error_m);
    if (!job) continue;
    apply(mesh_, job->patch, job->error_m, log_);
    for (const Redrawn& r : job->patch.redrawn) {
      for (const std::uint32_t p : r.point) later_.push_back(p);
    }
    ++count_of(job->kind);
    any = true;
  }
  return any;
}

// When little is left, or nothing else can be done.
bool Builder::takes_of_the_block(const Move& move) const {
  std::vector<FaceId> gone;
  std::copy_if(moved_.faces().begin(), moved_.faces().end(), std::back_inserter(gone), [&](FaceId f) {
    const auto& p = mesh_.faces[f].point;
    return std::find(p.begin(), p.end(), move.onto) != p.end();
  });
  return next_block().needs(mesh_, gone);
}

bool Builder::become(const Block& block) {
  if (!block.exists() || mesh_.live_faces <= std::max(block.face_count(), options_.target_triangles)) return false;
  if (block.error_m() > options_.max_error_m || context_.cancelled()) return false;
  return block.apply(mesh_, log_);
}

std::string Builder::why_no_block() const {
  if (!block_.exists()) return block_.why_not();
  if (block_.error_m() > options_.max_error_m) return "the block would exceed the largest error allowed";
  if (mesh_.live_faces <= options_.target_triangles) return "the target was reached before";
  if (mesh_.live_faces <= block_.face_count()) return "it has no more triangles than its block would have";
  return "too few vertices are left for the corners of the block";
}

void Builder::collapse_rest(double price) {
  float error_m = 0.0F;
  for (std::uint32_t p = 0; p < mesh_.point_count(); ++p) {
    if (!mesh_.faces_of[p].empty()) error_m = std::max(error_m, mesh_.deviation_m[p]);
  }
  report_.last_collapses = collapse_the_rest(mesh_, options_, next_block(), {error_m, price}, context_, log_);
}

progressive::EditLog Builder::run(FacetShiftReport& report) {
  for (const CharacteristicSurface& s : mesh_.surfaces.surfaces) {
    ++report_.surfaces;
    report_.walls += s.kind == SurfaceClass::Wall ? 1 : 0;
    report_.roofs += s.kind == SurfaceClass::Roof ? 1 : 0;
    report_.openings += s.kind == SurfaceClass::Opening ? 1 : 0;
  }
  drop_degenerate();
  if (options_.interior == Interior::DropFirst) drop_interior();
  closed_ = is_closed(mesh_);
  openings_.emplace(mesh_, closed_);
  for (auto& known : known_) known.resize(mesh_.surface_faces.size());
  lead_kinds();
  double area = 0.0;
  for (const CharacteristicSurface& s : mesh_.surfaces.surfaces) area += s.area_m2;
  const double diagonal = bounds(*mesh_.source).diagonal_m();
  const double last_price = last_share * area * diagonal * diagonal;
  double price = first_price;
  for (; price <= last_price && !done(); price *= price_step) {
    bool any = true;
    pieces_.weigh();
    for (const auto& [point, onto] : refused_) later_.push_back(point);
    refused_.clear();
    // Before points slide: a window goes whole, or its outline frays.
    while (!done() && close_openings(price)) continue;
    lead_kinds();
    for (std::uint32_t round = 0; round < rounds_per_price && any && !done(); ++round) {
      slide_points(price);
      any = shift_planes(price);
    }
    if (!done()) vanish_parts(price);
    if (!done() && !closed_) vanish_scraps(scraps_.find(price), Going::Shrinking, report_.scraps_vanished);
    if (!done() && !closed_) vanish_scraps(hidden_.find(price), Going::Still, report_.hidden_vanished);
    crossings_.update(mesh_.touched);
    crossings_.start();
    mesh_.touched.clear();
    context_.report("facet shift",
                    1.0 - static_cast<double>(mesh_.live_faces) / static_cast<double>(mesh_.faces.size()));
  }
  if (hands_over()) collapse_rest(price / price_step);
  become(stepped_);
  report_.reached_block = become(block_) || is_block(mesh_);
  if (!report_.reached_block) report_.block_sentence = why_no_block();
  if (mesh_.live_faces > options_.target_triangles && options_.target_triangles != 0) {
    report_.sentence = "nothing more can go without tearing the block";
  }
  report_.closed_t_junctions = report.closed_t_junctions;
  report = report_;
  return std::move(log_);
}

}  // namespace

// The coarsest levels within the positional accuracy that CityGML 2.0 asks of its LoD3, LoD2 and LoD1; but a block is
// what it calls LoD1.
void name_levels(ModelData& data, bool reached_block) {
  const auto coarsest = [&](float error_m) {
    for (const ErrorStep& step : data.errors) {
      if (step.error_m <= error_m) return step.level;
    }
    return static_cast<Level>(data.shapes.size());
  };
  data.named_levels = {
      {"lod3", coarsest(0.5F)}, {"lod2", coarsest(2.0F)}, {"lod1", reached_block ? 0 : coarsest(5.0F)}};
  if (reached_block) data.named_levels.push_back({"block", 0});
}

progressive::EditLog shift_log(Mesh& source, const FacetShiftOptions& options, const Context& context,
                               FacetShiftReport& report) {
  report.closed_t_junctions = repair(source, {.remove_degenerate = false,
                                              .remove_duplicates = false,
                                              .t_junction_tolerance_m = options.t_junction_tolerance_m})
                                  .closed_t_junctions;
  return Builder{source, options, context}.run(report);
}

}  // namespace facets

Result<FacetShiftResult> build_by_facet_shift(const Mesh& mesh, const FacetShiftOptions& options,
                                              const Context& context) {
  if (Status status = validate(mesh); !status.ok()) return status.error();
  FacetShiftResult result;
  Mesh source = mesh;
  progressive::EditLog log = facets::shift_log(source, options, context, result.report);
  if (context.cancelled()) return Error{ErrorCode::Cancelled, "building was cancelled", ""};
  ModelData data = progressive::record(source, std::move(log), "facet-shift");
  facets::name_levels(data, result.report.reached_block);
  auto model = ProgressiveModel::from_data(std::move(data));
  if (!model.ok()) return model.error();
  result.model = std::move(model).value();
  return result;
}

}  // namespace lodestone
