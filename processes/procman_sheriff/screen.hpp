// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "common/process/live_runtime.hpp"
#include "processes/procman_sheriff/sheriff_process.hpp"

namespace clearway::screen {

enum class ScreenStart {
  kObserve,  ///< Only looks on, until somebody takes command.
  /// Takes command as soon as it is known that no other sheriff has it: within 1.2 s, or at once
  /// where all deputies of the file say so. Where another has it, only looks on.
  kCommand,
};

struct ScreenSettings {
  ScreenStart start = ScreenStart::kCommand;
  core::procman::ScriptRunner::Options script;  ///< How scripts are run.
};

/// Shows the sheriff on the whole terminal of stdin and stdout and carries out what is typed, until
/// somebody quits, a signal asks to end or the terminal is gone. What runs goes on. Takes the
/// process's OnChange, OnOutput and OnUpdate and the runtime's OnSignal. Throws std::runtime_error
/// where there is no terminal. Returns the exit status.
/// @pre the process is an observer and takes output; the runtime is the process's.
[[nodiscard]] int RunScreen(SheriffProcess& process,
                            process::LiveRuntime& runtime,
                            const ScreenSettings& settings);

}  // namespace clearway::screen
