// SPDX-License-Identifier: BSD-3-Clause
#include "tools/doctor/examination.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <sstream>
#include <unistd.h>

#include "common/core/procman/deployment.hpp"
#include "common/graph/graph_config.hpp"
#include "common/graph/options.hpp"
#include "common/host/program_path.hpp"
#include "common/io/procman/pmd_reader.hpp"
#include "processes/procman_deputy/child_set.hpp"
#include "processes/procman_deputy/deputy_options.hpp"
#include "tools/doctor/bus_facts.hpp"
#include "tools/doctor/deployment_checks.hpp"
#include "tools/doctor/graph_checks.hpp"
#include "tools/doctor/network_checks.hpp"
#include "tools/doctor/network_facts.hpp"
#include "tools/doctor/user_checks.hpp"

namespace clearway::doctor {
namespace {

namespace fs = std::filesystem;

constexpr char kConfigVariable[] = "CLEARWAY_CONFIG";

std::string HostName() {
  std::array<char, 256> name{};
  gethostname(name.data(), name.size() - 1);
  return name.data();
}

std::vector<std::string> LinesOf(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

struct GraphFile {
  ConfigFacts facts;
  process::BusesConfig buses;
};

GraphFile ReadGraphFile(const fs::path& file) {
  GraphFile read;
  read.facts.path = file.string();
  try {
    const auto config = config::Load<graph::GraphConfig>(file, {});
    read.facts.digest = config::Digest(config.root);
    read.buses = config.root.buses;
  } catch (const config::ConfigError& error) {
    read.facts.problems = error.problems();
  } catch (const std::exception& error) {
    read.facts.problems = {error.what()};
  }
  return read;
}

// One examination: what was read so far, and what was found.
class Examination {
 public:
  explicit Examination(const Arguments& arguments) : arguments_(arguments) {}

  Result Run() {
    ReadConfig();
    ReadHostFile();
    ReadDeployment();
    CheckNetwork();
    CheckSensor();
    CheckCommandsHere();
    CheckBus();
    CheckUserHere();
    return {{here_.version, here_.host, here_.deputy}, std::move(findings_)};
  }

 private:
  void Add(Finding finding) { findings_.push_back(std::move(finding)); }

  void ReadConfig() {
    here_ = {.host = HostName(), .deputy = {}, .version = CLEARWAY_VERSION, .deputy_config = {}};
    if (!arguments_.config.empty()) graph_ = ReadGraphFile(arguments_.config);
    graph_.facts.effective_digest = graph_.facts.digest;
    if (!arguments_.lcm_url.empty()) {
      graph_.buses.local = process::BusFromUrl(arguments_.lcm_url, graph_.buses.local);
      graph_.buses.shared = process::BusFromUrl(arguments_.lcm_url, graph_.buses.shared);
      graph_.facts.effective_digest = DigestWithUrl();
    }
    Append(findings_, CheckConfig(graph_.facts));
  }

  // Processes that were started with the same --lcm-url have this one.
  [[nodiscard]] std::string DigestWithUrl() const {
    if (graph_.facts.digest.empty()) return {};
    try {
      graph::Options options;
      options.config_path = arguments_.config;
      options.lcm_url = graph_.buses.shared.url;
      return config::Digest(graph::LoadConfig(options).root);
    } catch (const std::exception&) {
      return graph_.facts.digest;  // Not a legal override: no process was started with it.
    }
  }

  void ReadHostFile() {
    constexpr char kCheck[] = "host_file";
    const bool is_named = !arguments_.host_file.empty();
    host_file_name_ = is_named ? arguments_.host_file.string() : kHostFile;
    if (is_named || fs::exists(kHostFile)) {
      DeputyOptions options;
      options.config_path = arguments_.host_file;
      try {
        host_file_ = LoadDeputyFile(options).root;
        Add({kCheck,
             State::kOk,
             host_file_name_ + " is good; it allows " + std::to_string(host_file_->allow.size()) +
                 " kinds of commands",
             {}});
      } catch (const std::exception& error) {
        for (const std::string& line : LinesOf(error.what())) {
          Add({kCheck, State::kProblem, line, {}});
        }
      }
    } else {
      Add({kCheck, State::kNotChecked, std::string("there is no ") + kHostFile, {}});
      if (!arguments_.deployment.empty()) {
        constexpr const char* kExample = CLEARWAY_PROCMAN_FOLDER "/deputy.xml";
        auto& mend = findings_.back().mend;
        if (!std::filesystem::exists(kExample))
          mend.push_back("sudo cmake --install build/release");
        mend.push_back(std::string("sudo install -D -m 644 ") + kExample + " " + host_file_name_);
      }
    }
    const bool is_bus_open = arguments_.config.empty() && arguments_.lcm_url.empty();
    if (host_file_ && is_bus_open) graph_.buses.shared = host_file_->deputy.bus;
    if (host_file_) here_.deputy_config = host_file_->deputy.graph_config;
    here_.deputy = host_file_ ? host_file_->deputy.id : "";
    if (!arguments_.deputy.empty()) here_.deputy = arguments_.deputy;
    if (here_.deputy.empty()) here_.deputy = here_.host;
    CheckDeputyBus();
  }

  // A deputy hears the statuses of its commands on its own bus only.
  void CheckDeputyBus() {
    if (!host_file_ || graph_.facts.digest.empty()) return;
    process::BusConfig& deputy = host_file_->deputy.bus;
    const process::BusConfig& shared = graph_.buses.shared;
    if (!arguments_.lcm_url.empty() || (deputy.url == shared.url && deputy.ttl == shared.ttl))
      return;
    Add({"host_file",
         State::kProblem,
         host_file_name_ + ": the deputy is on " + deputy.url + " with ttl=\"" +
             std::to_string(deputy.ttl) + "\", the graph's shared bus on " + shared.url +
             " with ttl=\"" + std::to_string(shared.ttl) + "\"",
         {"# in " + host_file_name_ + ", below <deputy>: <bus url=\"" + shared.url + "\" ttl=\"" +
          std::to_string(shared.ttl) + "\" max_message_bytes=\"" +
          std::to_string(shared.max_message_bytes) + "\"/>"}});
  }

  void ReadDeployment() {
    if (arguments_.deployment.empty()) {
      Add({"deployment", State::kNotChecked, "no --deployment is given", {}});
      return;
    }
    try {
      deployment_ = io::ReadPmd(arguments_.deployment);
    } catch (const std::exception& error) {
      for (const std::string& line : LinesOf(error.what())) {
        Add({"deployment", State::kProblem, line, {}});
      }
    }
  }

  void CheckNetwork() {
    buses_ = BusesOf(graph_.buses);
    interfaces_ = ReadInterfaces();
    std::vector<BusRoute> routes;
    for (const Bus& bus : buses_) routes.push_back({bus, RouteTo(bus.group)});
    Append(findings_, CheckRoutes(routes, interfaces_));
    Add(CheckBuffers(buses_, {ReadCoreLimit("rmem_max"), ReadCoreLimit("rmem_default")}));
    for (const Bus& bus : buses_) Add(CheckPort(bus, TryPort(bus.port)));
  }

  void CheckSensor() {
    const bool has_sensor = deployment_ && HasLiveSensor(*deployment_, here_.deputy);
    const std::optional<Subnet> subnet = ParseSubnet(arguments_.sensor_subnet);
    if (subnet && (has_sensor || arguments_.wants_sensor)) {
      Add(CheckSensorSubnet(*subnet, interfaces_));
    } else {
      Add({"sensor_subnet",
           State::kNotChecked,
           "no command of this host drives a sensor, and no --sensor-subnet is given",
           {}});
    }
  }

  // As the deputy would have it: what the host's file names goes before its environment, which is
  // this program's only as far as both are started alike.
  [[nodiscard]] std::optional<std::string> VariableOf(const std::string& name) const {
    const bool is_config = name == kConfigVariable;
    if (is_config && !here_.deputy_config.empty()) {
      return fs::absolute(here_.deputy_config).string();
    }
    if (const char* const value = std::getenv(name.c_str())) return value;
    if (!is_config || arguments_.config.empty()) return std::nullopt;
    return fs::absolute(arguments_.config).string();
  }

  void CheckCommandsHere() {
    if (!deployment_) return;
    HostView host;
    host.variable = [this](const std::string& name) { return VariableOf(name); };
    host.search_path = SearchPath();
    host.find_program = [&host](const std::string& name) {
      return host::FindProgram(name, host.search_path);
    };
    host.read_config = [](const std::string& file, bool is_of_graph) {
      NamedConfig config;
      config.is_readable = fs::is_regular_file(file) && access(file.c_str(), R_OK) == 0;
      if (!config.is_readable || !is_of_graph) return config;
      GraphFile read = ReadGraphFile(file);
      config.problems = std::move(read.facts.problems);
      return config;
    };
    host.host_file = host_file_name_;
    if (!graph_.facts.digest.empty()) host.graph_config = graph_.facts.path;
    if (host_file_) host.allowed.emplace(host_file_->allow);
    Append(findings_, CheckCommands(*deployment_, here_.deputy, host));
  }

  // LCM is opened only where it will not wait for itself in vain.
  void CheckBus() {
    const bool has_way = std::none_of(findings_.begin(), findings_.end(), [](const Finding& each) {
      return (each.check == "multicast_route" || each.check == "port") &&
             each.state == State::kProblem;
    });
    if (!has_way) {
      for (const char* check : {"loop_back", "traffic", "deputies", "digests", "versions"}) {
        Add({check, State::kNotChecked, "the way to the bus has a problem, see above", {}});
      }
      return;
    }
    const BusFacts facts = ListenTo(buses_, arguments_.listen_ms * 1000);
    for (std::size_t i = 0; i < buses_.size(); ++i) {
      Add(CheckLoopBack(buses_[i], facts.loop_backs[i]));
    }
    Append(findings_, CheckTraffic(facts.heard, here_));
    Append(findings_,
           CheckDeputies(facts.heard,
                         deployment_ ? DeputiesOf(*deployment_) : std::vector<std::string>{},
                         here_));
    Append(findings_, CheckDigests(facts.heard, graph_.facts, here_));
    Append(findings_, CheckVersions(facts.heard, here_));
  }

  void CheckUserHere() {
    UserFacts facts{.is_root = geteuid() == 0,
                    .deputy_user = arguments_.user,
                    .user = ReadUser(arguments_.user),
                    .files = {}};
    for (const fs::path& file : {arguments_.config, fs::path(here_.deputy_config)}) {
      if (!file.empty()) facts.files.push_back(ReadFileFacts(file));
    }
    if (host_file_) facts.files.push_back(ReadFileFacts(host_file_name_));
    Append(findings_, CheckUser(facts));
  }

  const Arguments& arguments_;
  Here here_;
  GraphFile graph_;
  std::optional<DeputyFile> host_file_;  // Nothing: not there, or not good.
  std::string host_file_name_;
  std::optional<core::procman::Deployment> deployment_;
  std::vector<Bus> buses_;
  std::vector<Interface> interfaces_;
  Findings findings_;
};

}  // namespace

Result Examine(const Arguments& arguments) {
  return Examination(arguments).Run();
}

}  // namespace clearway::doctor
