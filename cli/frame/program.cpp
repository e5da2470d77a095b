// SPDX-License-Identifier: MIT
#include <CLI/CLI.hpp>
#include <algorithm>
#include <new>
#include <span>
#include <string_view>

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
  arguments.bytes("--max-memory", common.max_memory_bytes, "End with an error rather than take more memory than this");
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
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& request) {  // --help, --version
    return app.exit(request);
  } catch (const CLI::ParseError& fault) {
    common.json = asks_for_json(argc, argv);
    Session session{common};
    return session.finish(Error{ErrorCode::BadArgument, std::string{fault.what()} + "; see lodestone --help", ""});
  }
  Session session{common};
  return session.finish(run_guarded(*chosen, session));
}

}  // namespace lodestone::cli
