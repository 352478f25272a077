// SPDX-License-Identifier: BSD-3-Clause
#include "tools/run_graph/own_deputy.hpp"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <sys/wait.h>
#include <vector>

#include "common/host/log_file_name.hpp"
#include "common/host/process_table.hpp"
#include "tools/run_graph/graph_deployment.hpp"

namespace clearway::run_graph {
namespace {

namespace fs = std::filesystem;
using core::procman::CommandView;
using core::procman::Sheriff;
using core::procman::Target;

// For a deputy whose commands were not stopped before: one after the other.
constexpr int kEndTimeoutMs = 5000;

std::string IdOf(const process::Runtime& runtime) {
  return "run-" + runtime.HostName() + '-' + std::to_string(runtime.ProcessId());
}

// The host's own file is about the host's own deputy.
fs::path WriteConfig(const fs::path& folder) {
  const fs::path file = folder / "deputy.xml";
  std::ofstream stream(file);
  stream << "<clearway version=\"1\"/>\n";
  if (!stream.flush()) throw std::runtime_error(file.string() + ": cannot write");
  return file;
}

std::vector<std::string> CommandLineOf(const std::string& id, const RunSettings& settings) {
  const process::BusConfig& bus = settings.buses.shared;
  std::vector<std::string> line{
      settings.program_folder / "clearway-deputy",
      "--config",
      WriteConfig(settings.output_folder),
      "--id",
      id,
      "--lcm-url",
      bus.url + "?ttl=" + std::to_string(bus.ttl),
      "--allow-any",
      "--allow-root",
      "--set",
      "deputy.bus.max_message_bytes=" + std::to_string(bus.max_message_bytes),
      "--set",
      "deputy.logs.folder=" + settings.output_folder.string()};
  if (!settings.channel_prefix.empty()) {
    line.insert(line.end(), {"--channel-prefix", settings.channel_prefix});
  }
  // A service's folder, where this program is run by one, is not the place of a deputy that ends.
  unsetenv("STATE_DIRECTORY");
  return line;
}

}  // namespace

OwnDeputy::OwnDeputy(process::Runtime& runtime, const RunSettings& settings)
    : runtime_(runtime),
      log_folder_(settings.output_folder),
      id_(IdOf(runtime)),
      sheriff_(
          runtime,
          {.mode = Sheriff::Mode::kCommand, .scope = Sheriff::Scope::kFile, .discovers = false}),
      process_("deputy",
               CommandLineOf(id_, settings),
               settings.output_folder / "deputy.log",
               SIGTERM) {
  sheriff_.sheriff().Load(MakeDeployment(settings, id_), runtime_.MonotonicUs());
}

OwnDeputy::~OwnDeputy() {
  process_.Signal(SIGTERM);
  process_.WaitOrKill(kEndTimeoutMs);
}

void OwnDeputy::Start(const char* group) {
  sheriff_.sheriff().Start({Target::Kind::kGroup, group}, runtime_.MonotonicUs());
  sheriff_.Update();
}

void OwnDeputy::Stop(const char* group) {
  sheriff_.sheriff().Stop({Target::Kind::kGroup, group}, runtime_.MonotonicUs());
  sheriff_.Update();
}

CommandView OwnDeputy::ViewOf(const std::string& command) const {
  return sheriff_.sheriff().View(command, runtime_.MonotonicUs()).value_or(CommandView{});
}

bool OwnDeputy::IsReady(const std::string& command) const {
  const CommandView view = ViewOf(command);
  return view.is_ready && view.starts > 0;  // Else its health has not been told yet.
}

std::string OwnDeputy::StateOf(const std::string& command) const {
  const CommandView view = ViewOf(command);
  return view.text.empty() ? std::string(WordsFor(view.status)) : view.text;
}

std::int32_t OwnDeputy::PidOf(const std::string& command) const {
  return ViewOf(command).pid;
}

std::optional<int> OwnDeputy::ExitStatusOf(const std::string& command) const {
  const CommandView view = ViewOf(command);
  if (view.pid != 0 || view.run_id == 0 || view.run_id != view.desired_run_id) return std::nullopt;
  const int status = view.exit_code;
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

std::string OwnDeputy::LastWordsOf(const std::string& command) const {
  return host::LastLinesOf(log_folder_ / host::FileNameOf(command));
}

void OwnDeputy::CheckAlive() {
  const std::optional<int> status = process_.ExitStatus();
  if (!status) return;
  throw std::runtime_error("the deputy ended with status " + std::to_string(*status) + ":\n" +
                           process_.LastWords());
}

bool OwnDeputy::IsOwn(const status_t& status) const {
  if (status.host != runtime_.HostName()) return false;
  const auto& commands = sheriff_.sheriff().deployment().commands;
  const bool is_told = std::any_of(commands.begin(), commands.end(), [&](const auto& command) {
    return PidOf(command.spec.id) == status.pid;
  });
  if (is_told) return true;
  // The report that tells of it may be late or lost.
  const auto sender = host::ReadProcess(status.pid);
  return sender && sender->ppid == process_.pid();
}

}  // namespace clearway::run_graph
