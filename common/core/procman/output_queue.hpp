// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace clearway::core::procman {

/// What the bus takes of the output of commands. XML element: <deputy><output>.
struct OutputConfig {
  int bytes_per_s = 200'000;
  std::int64_t batch_us = 10'000;

  template <typename Self, typename Visitor>
  static void Visit(Self& self, Visitor& visitor) {
    visitor.Integer("bytes_per_s",
                    self.bytes_per_s,
                    1000,
                    100000000,
                    "Output of all commands together that goes to PM_OUTPUT [byte/s]. What is more "
                    "is dropped there, counted and said; the log on disk has all of it.");
    visitor.Milliseconds("batch_ms",
                         self.batch_us,
                         0.0,
                         1000.0,
                         "Output is collected for so long before it is sent [ms].");
  }
};

/// Output on its way to PM_OUTPUT: in batches that fit into a message, within a rate, in turn
/// between the commands so that a loud one does not silence the others. Time is an argument [us].
class OutputQueue {
 public:
  using Batch = std::vector<std::pair<std::string, std::string>>;  ///< Command id and text.

  /// `max_text_bytes`: what a message takes besides its own header, ids and text together.
  OutputQueue(const OutputConfig& config, std::size_t max_text_bytes);

  /// NUL bytes become ^@: a string of LCM ends at a NUL. O(length).
  void Add(const std::string& command_id, std::string_view text, std::int64_t now_us);

  /// What may be sent now.
  [[nodiscard]] std::vector<Batch> Take(std::int64_t now_us);

  /// When there will be something to send; nothing: all is sent.
  [[nodiscard]] std::optional<std::int64_t> NextDue() const;

  /// Bytes of a command that were dropped so far.
  [[nodiscard]] std::int64_t DroppedBytes(const std::string& command_id) const;

  /// A command is no more: its count goes, what waits is still sent.
  void Forget(const std::string& command_id) { dropped_.erase(command_id); }

 private:
  struct Waiting {
    std::string text;
    std::int64_t unsaid_bytes = 0;  // Dropped since that was last said.
  };

  void Refill(std::int64_t now_us);
  [[nodiscard]] Batch NextBatch();
  static void SayWhatWasDropped(Waiting& waiting);

  OutputConfig config_;
  std::size_t max_text_bytes_;
  std::map<std::string, Waiting> waiting_;
  std::map<std::string, std::int64_t> dropped_;
  std::string last_served_;
  double credit_bytes_;
  std::int64_t refilled_us_ = 0;
  std::int64_t since_us_ = 0;  // When the first of what waits came.
};

}  // namespace clearway::core::procman
