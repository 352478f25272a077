// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <exception>
#include <unistd.h>

#include <CLI/CLI.hpp>

#include "common/graph/options.hpp"
#include "common/graph/output_files.hpp"
#include "common/process/buses_config.hpp"
#include "tools/doctor/examination.hpp"
#include "tools/doctor/network_checks.hpp"
#include "tools/doctor/report.hpp"

namespace clearway::doctor {
namespace {

std::string ProblemOfUrl(const std::string& url) {
  try {
    (void)process::BusFromUrl(url);
    return {};
  } catch (const std::exception& error) {
    return error.what();
  }
}

std::string ProblemOfSubnet(const std::string& subnet) {
  return ParseSubnet(subnet) ? "" : subnet + ": expected A.B.C.D/BITS with BITS in [0, 30]";
}

void AddArguments(CLI::App& app, Arguments& arguments) {
  app.add_option("--config", arguments.config, "XML file of the whole graph")->type_name("FILE");
  app.add_option("--deployment", arguments.deployment, "What is to run where")
      ->type_name("FILE.pmd");
  app.add_option("--host-file", arguments.host_file, "This host's own file")
      ->type_name("FILE")
      ->default_str("/etc/clearway/deputy.xml");
  app.add_option("--host", arguments.deputy, "Id of this host's deputy; without it the host file's")
      ->type_name("ID");
  app.add_option("--lcm-url", arguments.lcm_url, "Both buses are on udpm://GROUP:PORT?ttl=N")
      ->type_name("URL")
      ->check(ProblemOfUrl);
  app.add_option("--listen-ms", arguments.listen_ms, "How long it listens on the buses")
      ->type_name("MS")
      ->check(CLI::Range(100, 60000));
  app.add_option("--sensor-subnet", arguments.sensor_subnet, "Where the sensors are")
      ->type_name("A.B.C.D/BITS")
      ->check(ProblemOfSubnet)
      ->each([&arguments](const std::string&) { arguments.wants_sensor = true; });
  app.add_option("--user", arguments.user, "Whom the deputy runs as")->type_name("NAME");
}

int Main(int argc, char** argv) {
  CLI::App app("Checks whether this host can run its part of a graph, and says what mends it",
               "clearway-doctor");
  app.set_version_flag("--version", CLEARWAY_VERSION);
  Arguments arguments;
  AddArguments(app, arguments);
  std::string json;
  app.add_option("--json", json, "Write the findings to this file")->type_name("FILE");
  return graph::GuardedMain(app, {}, argc, argv, [&] {
    Result result = Examine(arguments);
    if (geteuid() == 0) {
      for (Finding& finding : result.findings) finding = ForRoot(std::move(finding));
    }
    std::fputs(FormatText(result.findings).c_str(), stdout);
    if (!json.empty()) graph::WriteFile(json, FormatJson(result.patient, result.findings));
    return ExitStatusOf(result.findings);
  });
}

}  // namespace
}  // namespace clearway::doctor

int main(int argc, char** argv) {
  return clearway::doctor::Main(argc, argv);
}
