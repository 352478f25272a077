// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "common/core/procman/script_runner.hpp"
#include "common/core/procman/sheriff.hpp"
#include "common/process/runtime.hpp"
#include "processes/procman_deputy/deputy_file.hpp"
#include "processes/procman_deputy/deputy_process.hpp"

namespace clearway {

/// A deputy that starts its commands by itself: when no sheriff has spoken for a while and nothing
/// is left from an earlier life, it runs a script of a deployment file, for its own commands only.
/// The first orders of a real sheriff end that.
class SelfStart {
 public:
  /// Does nothing when no deployment is configured. Problems of the file are told by problem() and
  /// keep nothing else from working. @pre `runtime` and `deputy` outlive it.
  SelfStart(process::Runtime& runtime, DeputyProcess& deputy, const ByItselfConfig& config);
  ~SelfStart();
  SelfStart(const SelfStart&) = delete;
  SelfStart& operator=(const SelfStart&) = delete;

 private:
  void Begin(const ByItselfConfig& config);
  void Step();
  void Finish();

  process::Runtime& runtime_;
  DeputyProcess& deputy_;
  core::procman::Sheriff sheriff_;
  core::procman::ScriptRunner runner_;
  process::Runtime::TimerId begin_timer_ = 0;
  process::Runtime::TimerId step_timer_ = 0;
};

}  // namespace clearway
