// SPDX-License-Identifier: BSD-3-Clause
#include "common/host/port_holders.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>

namespace clearway::host {
namespace {

namespace fs = std::filesystem;

// Inodes of the sockets that are bound to the port, from a table such as /proc/net/udp:
//   sl  local_address rem_address st tx_queue:rx_queue tr:tm->when retrnsmt uid timeout inode ...
std::vector<std::string> InodesIn(const fs::path& table, int port) {
  std::vector<std::string> inodes;
  std::ifstream file(table);
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream words(line);
    std::array<std::string, 10> fields;
    for (std::string& field : fields) words >> field;
    const std::size_t colon = fields[1].rfind(':');
    if (!words || colon == std::string::npos) continue;
    if (std::strtol(fields[1].c_str() + colon + 1, nullptr, 16) == port)
      inodes.push_back(fields[9]);
  }
  return inodes;
}

bool HoldsOneOf(const fs::path& process, const std::vector<std::string>& inodes) {
  std::error_code error;
  for (fs::directory_iterator fd(process / "fd", error); !error && fd != fs::directory_iterator();
       fd.increment(error)) {
    std::error_code gone;
    const std::string target = fs::read_symlink(fd->path(), gone).string();
    const bool is_one = std::any_of(inodes.begin(), inodes.end(), [&](const std::string& inode) {
      return target == "socket:[" + inode + "]";
    });
    if (is_one) return true;
  }
  return false;
}

}  // namespace

std::vector<PortHolder> UdpPortHolders(int port) {
  std::vector<std::string> inodes = InodesIn("/proc/net/udp", port);
  for (std::string& inode : InodesIn("/proc/net/udp6", port)) inodes.push_back(std::move(inode));
  std::vector<PortHolder> holders;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator("/proc", error)) {
    const int pid = std::atoi(entry.path().filename().c_str());
    if (pid <= 0 || !HoldsOneOf(entry.path(), inodes)) continue;
    std::string program;
    std::ifstream name(entry.path() / "comm");
    std::getline(name, program);
    holders.push_back({pid, program});
  }
  std::sort(holders.begin(), holders.end(), [](const PortHolder& a, const PortHolder& b) {
    return a.pid < b.pid;
  });
  return holders;
}

}  // namespace clearway::host
