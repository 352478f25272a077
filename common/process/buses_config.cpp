// SPDX-License-Identifier: BSD-3-Clause
#include "common/process/buses_config.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <charconv>
#include <stdexcept>
#include <string_view>
#include <utility>

namespace clearway::process {
namespace {

constexpr std::string_view kScheme = "udpm://";

// A whole number of [0, most]; -1 when the text is none.
int NumberOf(std::string_view text, int most) {
  int value = -1;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && stop == text.data() + text.size() && value <= most ? value : -1;
}

void SetOption(std::string_view option, BusConfig& bus, const std::string& url) {
  const std::size_t equals = std::min(option.find('='), option.size());
  const std::string_view name = option.substr(0, equals);
  const std::string_view value = option.substr(std::min(equals + 1, option.size()));
  const bool is_ttl = name == "ttl";
  if (!is_ttl && name != "recv_buf_size") {
    throw std::invalid_argument(url + ": unknown option \"" + std::string(name) +
                                "\"; known: ttl, recv_buf_size");
  }
  const int number = NumberOf(value, is_ttl ? 255 : 268435456);
  if (number < 0) {
    throw std::invalid_argument(url + ": " + std::string(name) + "=\"" + std::string(value) +
                                "\": expected a whole number" + (is_ttl ? " in [0, 255]" : ""));
  }
  (is_ttl ? bus.ttl : bus.receive_buffer_bytes) = number;
}

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

BusConfig BusFromUrl(const std::string& url, BusConfig defaults) {
  if (!url.starts_with(kScheme)) {
    throw std::invalid_argument(url + ": expected udpm://GROUP:PORT?ttl=N");
  }
  BusConfig bus = std::move(defaults);
  const std::size_t question = std::min(url.find('?'), url.size());
  std::string address = url.substr(0, question);
  if (address == kScheme) address = BusConfig{}.url;
  if (address.starts_with("udpm://:")) address.insert(kScheme.size(), "239.255.76.67");
  if (address.find(':', kScheme.size()) == std::string::npos) address += ":7667";
  bus.url = address;
  for (std::size_t begin = question + 1; begin < url.size();) {
    const std::size_t end = std::min(url.find('&', begin), url.size());
    SetOption(std::string_view(url).substr(begin, end - begin), bus, url);
    begin = end + 1;
  }
  const std::vector<std::string> problems = bus.Validate();
  if (!problems.empty()) throw std::invalid_argument(problems.front());
  if (bus.ttl > 0)
    bus.max_message_bytes = std::min(bus.max_message_bytes, kMessageBytesBetweenHosts);
  return bus;
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
