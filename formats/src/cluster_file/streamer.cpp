// SPDX-License-Identifier: MIT
#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

#include <lodestone/cluster_file.h>

namespace lodestone {

struct ClusterStreamer::State {
  std::shared_ptr<const ClusterFile> file;
  StreamOptions options;

  // Of the caller's thread:
  std::vector<std::unique_ptr<const ClusterPage>> pages;
  std::vector<std::uint8_t> resident;
  std::vector<std::uint8_t> broken;
  std::vector<std::uint64_t> last_used;  // per page: update in which a refined group needed it
  std::uint64_t updates = 0;
  std::uint64_t bytes = 0;
  std::uint32_t broken_count = 0;

  // Shared with the loading thread:
  std::mutex door;
  std::condition_variable wake, idle;
  std::vector<PageId> wanted;  // the last one first
  PageId loading = none;
  std::vector<std::pair<PageId, std::unique_ptr<const ClusterPage>>> loaded;  // null: could not be read
  bool ends = false;
  std::thread thread;

  void load_pages() {
    std::unique_lock lock{door};
    while (true) {
      wake.wait(lock, [&] { return ends || !wanted.empty(); });
      if (ends) return;
      loading = wanted.back();
      wanted.pop_back();
      lock.unlock();
      auto page = file->load(loading);
      auto kept = page.ok() ? std::make_unique<const ClusterPage>(std::move(page).value()) : nullptr;
      lock.lock();
      loaded.emplace_back(loading, std::move(kept));
      loading = none;
      if (wanted.empty()) idle.notify_all();
    }
  }

  void take(PageId id, std::unique_ptr<const ClusterPage> page) {
    if (page == nullptr) {
      broken[id] = 1;
      ++broken_count;
      return;
    }
    if (pages[id] != nullptr) return;
    bytes += page->bytes;
    pages[id] = std::move(page);
    resident[id] = 1;
    last_used[id] = updates;
  }

  template <class Visit>
  void for_each_page(GroupId group, Visit visit) const {
    const Range parts = file->graph().groups[group].parts;
    for (std::uint32_t i = parts.begin; i != parts.end; ++i) visit(file->graph().parts[i].page);
  }

  // Pages that no refined group needs go first, the longest unused before others. One that a refined group needs stays.
  void keep_to_budget() {
    if (bytes <= options.budget_bytes) return;
    std::vector<PageId> idle_pages;
    for (PageId p = 1; p < pages.size(); ++p) {
      if (resident[p] != 0 && last_used[p] < updates) idle_pages.push_back(p);
    }
    std::sort(idle_pages.begin(), idle_pages.end(),
              [&](PageId a, PageId b) { return last_used[a] != last_used[b] ? last_used[a] < last_used[b] : a > b; });
    for (const PageId p : idle_pages) {
      if (bytes <= options.budget_bytes) return;
      bytes -= pages[p]->bytes;
      pages[p].reset();
      resident[p] = 0;
    }
  }

  // What the last cut missed, the largest error last; whole groups only, as long as the budget has room.
  [[nodiscard]] std::vector<PageId> choose(std::span<const MissingGroup> missing) const {
    std::vector<MissingGroup> order(missing.begin(), missing.end());
    std::sort(order.begin(), order.end(), [](const MissingGroup& a, const MissingGroup& b) {
      return a.error_px != b.error_px ? a.error_px > b.error_px : a.group < b.group;
    });
    std::vector<PageId> pages_wanted;
    for (const MissingGroup& m : order) {
      if (bytes > options.budget_bytes || pages_wanted.size() >= options.queue_pages) break;
      bool readable = true;
      for_each_page(m.group, [&](PageId p) { readable = readable && broken[p] == 0; });
      if (!readable) continue;
      for_each_page(m.group, [&](PageId p) {
        const bool known = std::find(pages_wanted.begin(), pages_wanted.end(), p) != pages_wanted.end();
        if (resident[p] == 0 && !known) pages_wanted.push_back(p);
      });
    }
    std::reverse(pages_wanted.begin(), pages_wanted.end());
    return pages_wanted;
  }
};

ClusterStreamer::ClusterStreamer(std::shared_ptr<const ClusterFile> file, const StreamOptions& options)
    : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.file = std::move(file);
  s.options = options;
  const std::size_t count = s.file->graph().page_count;
  s.pages.resize(count);
  s.resident.assign(count, 0);
  s.broken.assign(count, 0);
  s.last_used.assign(count, 0);
  // The roots, always: their first page, and where there are very many of them the pages that follow.
  if (count > 0) {
    s.for_each_page(0, [&](PageId p) {
      auto page = s.file->load(p);
      s.take(p, page.ok() ? std::make_unique<const ClusterPage>(std::move(page).value()) : nullptr);
    });
    s.bytes = 0;
  }
  s.thread = std::thread{[&s] { s.load_pages(); }};
}

ClusterStreamer::~ClusterStreamer() {
  {
    const std::lock_guard lock{state_->door};
    state_->ends = true;
  }
  state_->wake.notify_all();
  state_->thread.join();
}

void ClusterStreamer::update(const CutScratch& scratch, std::span<const GroupId> shown) {
  State& s = *state_;
  ++s.updates;
  for (const GroupId g : shown) s.for_each_page(g, [&](PageId p) { s.last_used[p] = s.updates; });
  for (const GroupId g : scratch.refined()) s.for_each_page(g, [&](PageId p) { s.last_used[p] = s.updates; });
  std::vector<std::pair<PageId, std::unique_ptr<const ClusterPage>>> loaded;
  {
    const std::lock_guard lock{s.door};
    loaded.swap(s.loaded);
  }
  for (auto& [id, page] : loaded) s.take(id, std::move(page));
  s.keep_to_budget();
  std::vector<PageId> wanted = s.choose(scratch.missing());
  {
    const std::lock_guard lock{s.door};
    std::erase_if(wanted, [&](PageId p) {
      return p == s.loading ||
             std::any_of(s.loaded.begin(), s.loaded.end(), [&](const auto& l) { return l.first == p; });
    });
    s.wanted = std::move(wanted);
  }
  s.wake.notify_one();
}

std::span<const std::uint8_t> ClusterStreamer::resident() const noexcept { return state_->resident; }
const ClusterPage* ClusterStreamer::page(PageId page) const noexcept { return state_->pages[page].get(); }
std::uint64_t ClusterStreamer::resident_bytes() const noexcept { return state_->bytes; }
std::uint32_t ClusterStreamer::broken_pages() const noexcept { return state_->broken_count; }

void ClusterStreamer::wait() {
  std::unique_lock lock{state_->door};
  state_->idle.wait(lock, [&] { return state_->wanted.empty() && state_->loading == none; });
}

}  // namespace lodestone
