// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "common/graph/options.hpp"
#include "tools/relay/relay.hpp"

namespace clearway::relay {
namespace {

struct Arguments {
  std::vector<std::string> ports;
  std::vector<std::string> faults;
  std::vector<std::string> cut;
  RelaySettings settings;
};

// An option that is the command of the same name, for all directions.
void AddFault(CLI::App& app, Arguments& arguments, const std::string& name, const char* help) {
  app.add_option_function<std::string>(
         "--" + name,
         [&arguments, name](const std::string& value) {
           arguments.settings.commands.push_back(name + ' ' + value);
         },
         help)
      ->type_name(name.ends_with("-ms") ? "MS" : "P");
}

void AddArguments(CLI::App& app, Arguments& arguments) {
  app.set_version_flag("--version", CLEARWAY_VERSION);
  app.add_option("--port", arguments.ports, "An interface, and its name if it is to have another")
      ->required()
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->type_name("[NAME=]INTERFACE");
  AddFault(app, arguments, "delay-ms", "Hold every frame this long");
  AddFault(app, arguments, "jitter-ms", "And up to this much longer; the order stays");
  AddFault(app, arguments, "loss", "Probability that a frame is lost");
  AddFault(app, arguments, "duplicate", "Probability that a frame comes twice");
  app.add_option("--cut", arguments.cut, "This port neither receives nor sends; may be repeated")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->type_name("PORT");
  app.add_option("--fault",
                 arguments.faults,
                 "A line as on standard input, as \"loss 0.1 robot:laptop\"; may be repeated")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
      ->type_name("LINE");
  app.add_option("--seed", arguments.settings.seed, "Of the random numbers")->capture_default_str();
  app.add_option("--max-delayed-bytes",
                 arguments.settings.max_delayed_bytes,
                 "Frames beyond this are dropped and counted")
      ->capture_default_str();
  app.add_flag("--until-eof", arguments.settings.until_eof, "End with the standard input");
  app.footer(
      "Lines on standard input: loss P, duplicate P, delay-ms T, jitter-ms T, each with FROM:TO "
      "behind it for\none direction (* is any port); cut PORT, mend PORT, stats, quit. Each is "
      "answered by \"ok\" or \"refused\".");
}

RelaySettings SettingsOf(Arguments& arguments) {
  RelaySettings settings = std::move(arguments.settings);
  for (const std::string& port : arguments.ports) {
    const std::size_t equals = port.find('=');
    settings.ports.push_back(
        {port.substr(0, equals), equals == std::string::npos ? port : port.substr(equals + 1)});
  }
  for (const std::string& port : arguments.cut) settings.commands.push_back("cut " + port);
  settings.commands.insert(
      settings.commands.end(), arguments.faults.begin(), arguments.faults.end());
  return settings;
}

int Main(int argc, char** argv) {
  CLI::App app("Passes frames between network interfaces, with delay, loss and cuts on demand",
               "clearway-relay");
  Arguments arguments;
  AddArguments(app, arguments);
  return graph::GuardedMain(app, {}, argc, argv, [&] {
    std::optional<Relay> relay;
    try {
      relay.emplace(SettingsOf(arguments));
    } catch (const CommandError& error) {
      std::fprintf(stderr, "clearway-relay: %s\n", error.what());
      return graph::kExitUsage;
    } catch (const std::invalid_argument& error) {
      std::fprintf(stderr, "clearway-relay: --port: %s\n", error.what());
      return graph::kExitUsage;
    }
    relay->Run();
    return graph::kExitOk;
  });
}

}  // namespace
}  // namespace clearway::relay

int main(int argc, char** argv) {
  return clearway::relay::Main(argc, argv);
}
