// SPDX-License-Identifier: BSD-3-Clause
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <unistd.h>

#include <CLI/CLI.hpp>

#include "common/graph/finite_check.hpp"
#include "common/graph/options.hpp"
#include "common/io/procman/pmd_reader.hpp"
#include "common/process/live_runtime.hpp"
#include "processes/procman_sheriff/screen.hpp"
#include "processes/procman_sheriff/table.hpp"
#include "processes/procman_sheriff/verbs.hpp"

namespace clearway {
namespace {

constexpr const char* kDescription =
    "Starts, stops and watches the processes of all hosts.\n"
    "  clearway-sheriff [FILE.pmd] [VERB [TARGET...]]\n"
    "Verbs: status, start, stop, restart, run SCRIPT, follow, observe, check, screen.\n"
    "FILE alone on a terminal shows the full-screen view, and so does observe, without giving\n"
    "orders; else status is the default.\n"
    "A target is everything, a command's id or a group's path; cmd:NAME or group:NAME where a "
    "name\n"
    "is both. start, stop and restart need one. Without FILE what deputies report is what there "
    "is.";
constexpr const char* kExitStatuses =
    "Exit status: 0 done; 64 usage; 69 a deputy that is needed was not heard; 70 a command "
    "failed,\n"
    "was refused or gave up; 75 not done in time; 77 another sheriff is active; 78 wrong file.";

struct Arguments {
  graph::Options common;  // Only the log's level: a sheriff has no configuration.
  std::vector<std::string> words;
  double timeout_s = 30.0;
  bool no_wait = false;
  SheriffRequest request;
};

void AddArguments(CLI::App& app, Arguments& arguments) {
  app.set_version_flag("--version", CLEARWAY_VERSION);
  app.add_option("words", arguments.words, "[FILE.pmd] [VERB [TARGET...]]")->option_text(" ");
  app.add_option("-u,--lcm-url",
                 arguments.common.lcm_url,
                 "udpm://GROUP:PORT?ttl=N; else as LCM_DEFAULT_URL says, else LCM's default")
      ->type_name("URL");
  app.add_option("--timeout", arguments.timeout_s, "How long each wait may take")
      ->check(graph::Finite())
      ->check(CLI::Range(0.1, 86400.0))
      ->type_name("SECONDS");
  app.add_flag("--force",
               arguments.request.force,
               "Also when another sheriff is active, a deputy is not heard, or a silent deputy may "
               "still run what moves away from it");
  app.add_flag("--json", arguments.request.json, "Print JSON");
  app.add_flag("--no-wait", arguments.no_wait, "Do not wait until it is so");
  app.add_option(
         "--log-level", arguments.common.log_level, "trace, debug, info, warn, error or off")
      ->check(CLI::IsMember({"trace", "debug", "info", "warn", "error", "off"}));
  app.footer(kExitStatuses);
}

// Whether there is a terminal that the full-screen view can be drawn on.
bool HasScreen() {
  const char* term = std::getenv("TERM");
  return isatty(STDIN_FILENO) != 0 && isatty(STDOUT_FILENO) != 0 && term != nullptr &&
         *term != '\0' && std::string_view(term) != "dumb";
}

struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Splits the words into file, verb and targets; returns the file, empty when there is none.
std::string TakeWords(std::vector<std::string> words, SheriffRequest& request) {
  std::string file;
  if (!words.empty() && !VerbOf(words.front())) {
    file = words.front();
    // A path that is wrong is told by the reader of files.
    if (file.find_first_of("./") == std::string::npos && !std::filesystem::exists(file)) {
      throw UsageError("\"" + file + "\" is no file and no verb; verbs: " + KnownVerbs());
    }
    words.erase(words.begin());
  }
  if (!words.empty()) {
    const auto verb = VerbOf(words.front());
    if (!verb) throw UsageError("\"" + words.front() + "\" is no verb; verbs: " + KnownVerbs());
    request.verb = *verb;
    words.erase(words.begin());
  } else if (!file.empty() && !request.json && HasScreen()) {
    request.verb = SheriffVerb::kScreen;
  }
  request.targets = std::move(words);
  return file;
}

void Check(const SheriffRequest& request, const std::string& file) {
  const bool takes_targets = request.verb != SheriffVerb::kCheck &&
                             request.verb != SheriffVerb::kObserve &&
                             request.verb != SheriffVerb::kScreen;
  const bool needs_target = GivesOrders(request.verb) && request.verb != SheriffVerb::kRun;
  if (request.verb == SheriffVerb::kRun) {
    if (file.empty()) throw UsageError("run needs a FILE.pmd, which has the script");
    if (request.targets.size() != 1) throw UsageError("run needs the name of one script");
  }
  if (request.verb == SheriffVerb::kCheck && file.empty()) {
    throw UsageError("check needs a FILE.pmd");
  }
  if (!takes_targets && !request.targets.empty()) throw UsageError("this verb takes no target");
  if (needs_target && request.targets.empty()) {
    throw UsageError("start, stop and restart need a target: everything, a command or a group");
  }
  const bool starts = request.verb == SheriffVerb::kStart || request.verb == SheriffVerb::kRestart;
  if (starts && file.empty()) {
    for (const std::string& target : request.targets) {
      if (target == "everything") throw UsageError("to start everything a FILE.pmd is needed");
    }
  }
}

process::BusesConfig Buses(const std::string& url) {
  const char* environment = std::getenv("LCM_DEFAULT_URL");
  const std::string chosen = !url.empty() ? url : environment != nullptr ? environment : "";
  const process::BusConfig bus =
      chosen.empty() ? process::BusConfig{} : process::BusFromUrl(chosen);
  return {.local = bus, .shared = bus};
}

void Print(std::FILE* stream, const std::string& text) {
  std::fprintf(stream, "%s\n", text.c_str());
  std::fflush(stream);
}

SheriffPrinter Printer() {
  return {.out = [](const std::string& text) { Print(stdout, text); },
          .error = [](const std::string& text) { Print(stderr, "clearway-sheriff: " + text); },
          .shows_progress = isatty(STDERR_FILENO) != 0};
}

int Show(const Arguments& arguments) {
  process::LiveRuntime runtime(Buses(arguments.common.lcm_url), "");
  const bool observes = arguments.request.verb == SheriffVerb::kObserve;
  SheriffProcess process(runtime,
                         {.mode = core::procman::Sheriff::Mode::kObserve,
                          .discovers = !observes,
                          .takes_output = true});
  if (arguments.request.deployment) {
    process.sheriff().Load(*arguments.request.deployment, runtime.MonotonicUs());
  }
  const auto start = observes ? screen::ScreenStart::kObserve : screen::ScreenStart::kCommand;
  return screen::RunScreen(
      process,
      runtime,
      {.start = start,
       .script = {.timeout_us = arguments.request.timeout_us, .force = arguments.request.force}});
}

int Live(const Arguments& arguments) {
  process::LiveRuntime runtime(Buses(arguments.common.lcm_url), "");
  SheriffVerbRun verb(
      runtime,
      arguments.request,
      Printer(),
      {.done = [&runtime] { runtime.Stop(); },
       .is_gone = [host = runtime.HostName()](
                      const std::string& id) { return HasSheriffEnded(id, host); }});
  runtime.OnSignal([&verb](int signal) {
    if (signal != SIGCHLD && signal != SIGWINCH) verb.Interrupt();
  });
  runtime.Run();
  return verb.exit_status();
}

int Run(Arguments& arguments) {
  SheriffRequest& request = arguments.request;
  const std::string file = TakeWords(arguments.words, request);
  Check(request, file);
  request.timeout_us = static_cast<std::int64_t>(arguments.timeout_s * 1e6);
  request.waits = !arguments.no_wait;
  if (!file.empty()) request.deployment = io::ReadPmd(file);
  if (request.verb == SheriffVerb::kCheck) {
    Print(stdout, Summary(*request.deployment));
    return graph::kExitOk;
  }
  if (request.verb == SheriffVerb::kRun &&
      FindScript(*request.deployment, request.targets.front()) == nullptr) {
    std::string known;
    for (const auto& script : request.deployment->scripts) {
      known += (known.empty() ? "" : ", ") + script.name;
    }
    throw UsageError(file + " has no script \"" + request.targets.front() +
                     "\"; known: " + (known.empty() ? "none" : known));
  }
  const bool observes_on_screen =
      request.verb == SheriffVerb::kObserve && !request.json && HasScreen();
  if (request.verb == SheriffVerb::kScreen || observes_on_screen) return Show(arguments);
  return Live(arguments);
}

int Main(int argc, char** argv) {
  CLI::App app(kDescription, "clearway-sheriff");
  Arguments arguments;
  AddArguments(app, arguments);
  return graph::GuardedMain(app, arguments.common, argc, argv, [&] {
    try {
      return Run(arguments);
    } catch (const io::ReadError& error) {
      Print(stderr, error.what());
      return kSheriffFile;
    } catch (const UsageError& error) {
      Print(stderr, std::string("clearway-sheriff: ") + error.what());
      return kSheriffUsage;
    } catch (const std::invalid_argument& error) {
      Print(stderr, std::string("clearway-sheriff: ") + error.what());
      return kSheriffUsage;
    }
  });
}

}  // namespace
}  // namespace clearway

int main(int argc, char** argv) {
  return clearway::Main(argc, argv);
}
