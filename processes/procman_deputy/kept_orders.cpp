// SPDX-License-Identifier: BSD-3-Clause
#include "processes/procman_deputy/kept_orders.hpp"

#include <fstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "common/host/atomic_file.hpp"
#include "common/messages/encoding.hpp"
#include "common/messages/procman.hpp"

namespace clearway {
namespace {

std::vector<std::byte> ContentOf(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::vector<std::byte> bytes;
  for (char c = 0; file.get(c);) bytes.push_back(static_cast<std::byte>(c));
  return bytes;
}

}  // namespace

KeptOrders::KeptOrders(std::filesystem::path file, std::string deputy_id)
    : file_(std::move(file)), deputy_id_(std::move(deputy_id)) {}

std::optional<std::vector<core::procman::DesiredCommand>> KeptOrders::Read() {
  if (file_.empty() || !std::filesystem::exists(file_)) return std::nullopt;
  bytes_ = ContentOf(file_);
  const auto message = messages::Decode<procman_lcm::orders_t>(bytes_);
  if (message && message->deputy_id == deputy_id_) return messages::FromLcm(*message).commands;
  std::error_code ignored;
  std::filesystem::rename(file_, file_.string() + ".unreadable", ignored);
  problem_ = file_.string() +
             (message ? ": orders of another deputy, \"" + message->deputy_id + '"'
                      : std::string(": not orders")) +
             "; put aside, nothing was started";
  return std::nullopt;
}

bool KeptOrders::Write(const std::vector<core::procman::DesiredCommand>& commands) {
  if (file_.empty()) return true;
  std::vector<std::byte> bytes = messages::Encode(messages::ToLcm(core::procman::Orders{
      .utime = 0, .deputy_id = deputy_id_, .sheriff_id = "kept", .commands = commands}));
  if (bytes == bytes_) return true;
  try {
    host::ReplaceFile(file_, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  } catch (const std::runtime_error& error) {
    problem_ = error.what();
    return false;
  }
  bytes_ = std::move(bytes);
  problem_.clear();
  return true;
}

}  // namespace clearway
