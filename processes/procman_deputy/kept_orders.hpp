// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/core/procman/orders.hpp"

namespace clearway {

/// The last orders of a deputy on disk, for its next life. Trouble is told by problem() and keeps
/// nothing else from working.
class KeptOrders {
 public:
  /// No file: nothing is kept.
  KeptOrders(std::filesystem::path file, std::string deputy_id);

  /// What an earlier life was told; nothing when there is none, or none that can be read: such a
  /// file is put aside.
  [[nodiscard]] std::optional<std::vector<core::procman::DesiredCommand>> Read();

  /// Replaces them, where they differ. False: the disk refused, see problem().
  bool Write(const std::vector<core::procman::DesiredCommand>& commands);

  /// In words; empty: none.
  [[nodiscard]] const std::string& problem() const { return problem_; }

 private:
  std::filesystem::path file_;
  std::string deputy_id_;
  std::vector<std::byte> bytes_;  // What stands in the file.
  std::string problem_;
};

}  // namespace clearway
