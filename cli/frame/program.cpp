// SPDX-License-Identifier: MIT
#include <CLI/CLI.hpp>
#include <algorithm>
#include <new>
#include <numeric>
#include <optional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include "verb.h"
#include "version.h"

namespace lodestone::cli {
namespace {

void declare_common(CLI::App& app, Common& common) {
  Arguments arguments{app};
  arguments.flag("--json", common.json, "Print one JSON object on stdout");
  arguments.flag("--quiet", common.quiet, "No progress, remarks or warnings on stderr");
  arguments.flag("--strict", common.strict, "End with 3 if there were warnings");
  arguments.count("--threads", common.threads, 0, 1024, "Worker threads, 0 = one per core; does not change the result");
  arguments.bytes("--max-memory", common.max_memory_bytes,
                  "Most memory to take; where that is too little, end with an error that says so");
}

// Memory that ran out is the one exception that leaves the library.
Status run_guarded(Verb& verb, Session& session) {
  try {
    return verb.run(session);
  } catch (const std::bad_alloc&) {
    return Error{ErrorCode::TooLarge, "out of memory, use a smaller input or a larger --max-memory", verb.name()};
  }
}

// The parser may stop before it reaches --json, so the words themselves are asked.
bool asks_for_json(int argc, char** argv) {
  const std::span<char*> words{argv, static_cast<std::size_t>(argc)};
  return std::any_of(words.begin(), words.end(), [](const char* word) { return std::string_view{word} == "--json"; });
}

// Letters to add, drop or change to make one word the other (Levenshtein 1966).
std::size_t edits_between(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t changed = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({changed, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

// A first word that is no verb: the parser would only complain that one is missing.
std::optional<Error> unknown_verb(const Verbs& verbs, std::string_view word) {
  if (word.empty() || word.front() == '-') return std::nullopt;
  const auto distance = [word](const auto& verb) { return edits_between(word, verb->name()); };
  if (std::any_of(verbs.begin(), verbs.end(), [&](const auto& verb) { return verb->name() == word; })) return {};
  const auto nearest = std::min_element(verbs.begin(), verbs.end(),
                                        [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
  std::string message = "there is no verb '" + std::string{word} + "'";
  constexpr std::size_t most_slips = 3;
  if (distance(*nearest) <= most_slips) message += ", did you mean '" + (*nearest)->name() + "'?";
  return Error{ErrorCode::BadArgument, message + "; see lodestone --help", ""};
}

}  // namespace

int run_program(const Verbs& verbs, int argc, char** argv) {
  catch_signals();
  CLI::App app{"Continuous level of detail of buildings and rock outcrops", "lodestone"};
  app.set_version_flag("--version", version);
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 done, 1 wrong arguments, 2 unreadable or bad data, 3 warnings under --strict, 4 cancelled.");
  Common common;
  Verb* chosen = nullptr;
  for (const auto& verb : verbs) {
    CLI::App* sub = app.add_subcommand(verb->name(), verb->summary());
    Arguments arguments{*sub};
    verb->declare(arguments);
    declare_common(*sub, common);
    sub->footer("Example:\n  " + verb->example());
    sub->callback([&chosen, &verb] { chosen = verb.get(); });
  }
  if (const auto error = unknown_verb(verbs, argc > 1 ? argv[1] : "")) {
    common.json = asks_for_json(argc, argv);
    Session session{common};
    return session.finish(*error);
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& request) {  // --help, --version
    return app.exit(request);
  } catch (const CLI::ParseError& fault) {
    common.json = asks_for_json(argc, argv);
    Session session{common};
    return session.finish(Error{ErrorCode::BadArgument, std::string{fault.what()} + "; see lodestone --help", ""});
  }
  constexpr std::uint64_t least_memory_bytes = 40'000'000;  // what the program is before it does anything
  if (common.max_memory_bytes != 0 && common.max_memory_bytes < least_memory_bytes) {
    common.max_memory_bytes = 0;  // not even this answer could be kept to it
    Session session{common};
    return session.finish(Error{ErrorCode::BadArgument, "--max-memory: less than 40MB cannot be kept to", ""});
  }
  Session session{common};
  return session.finish(run_guarded(*chosen, session));
}

}  // namespace lodestone::cli
