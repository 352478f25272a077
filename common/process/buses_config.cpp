// SPDX-License-Identifier: BSD-3-Clause
#include "common/process/buses_config.hpp"

#include <arpa/inet.h>
#include <charconv>

namespace clearway::process {
namespace {

constexpr std::string_view kScheme = "udpm://";

}  // namespace

int PortOf(const std::string& url) {
  const std::size_t colon = url.rfind(':');
  if (!url.starts_with(kScheme) || colon < kScheme.size()) return -1;
  const std::string group = url.substr(kScheme.size(), colon - kScheme.size());
  in_addr address{};
  if (inet_pton(AF_INET, group.c_str(), &address) != 1) return -1;
  if (!IN_MULTICAST(ntohl(address.s_addr))) return -1;
  int port = -1;
  const char* end = url.data() + url.size();
  const auto [stop, error] = std::from_chars(url.data() + colon + 1, end, port);
  return error == std::errc() && stop == end && port > 0 && port < 65536 ? port : -1;
}

std::vector<std::string> BusConfig::Validate() const {
  if (PortOf(url) >= 0) return {};
  return {"url=\"" + url +
          "\": expected udpm://GROUP:PORT with an IPv4 multicast group and a port in [1, 65535]"};
}

std::vector<std::string> BusesConfig::Validate() const {
  std::vector<std::string> problems;
  if (local.ttl != 0) {
    problems.emplace_back(
        "the local bus must have ttl=\"0\": nothing that moves the robot leaves its host");
  }
  if (PortOf(local.url) == PortOf(shared.url) && (local.url != shared.url || shared.ttl != 0)) {
    problems.emplace_back(
        "two buses on one port must have the same url and ttl=\"0\": LCM does not separate groups, "
        "so give the shared bus a port of its own");
  }
  return problems;
}

}  // namespace clearway::process
