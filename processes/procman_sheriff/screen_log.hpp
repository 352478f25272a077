// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include "common/process/live_runtime.hpp"

namespace clearway::screen {

/// While it lives, what this program writes to a stderr that is a terminal becomes lines for a
/// handler: it would deface the screen. A stderr that leads elsewhere is left alone. What nobody
/// has handled at the end is written to stderr then.
class ScreenLog {
 public:
  ScreenLog(process::LiveRuntime& runtime, std::function<void(const std::string& line)> handler);
  ScreenLog(const ScreenLog&) = delete;
  ScreenLog& operator=(const ScreenLog&) = delete;
  ~ScreenLog();

 private:
  void Read();

  process::LiveRuntime& runtime_;
  std::function<void(const std::string& line)> handler_;
  int stderr_ = -1;  // The true one; -1: left alone.
  int pipe_ = -1;
  std::string partial_;
};

}  // namespace clearway::screen
