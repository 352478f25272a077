// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cstdint>
#include <cstdio>
#include <string>
#include <unistd.h>

#include <CLI/CLI.hpp>

#include "common/graph/options.hpp"
#include "common/messages/channels.hpp"
#include "common/process/live_runtime.hpp"
#include "common/process/plain_channels.hpp"
#include "tools/teleop/keys.hpp"
#include "tools/teleop/operator_wish.hpp"
#include "tools/teleop/status_line.hpp"
#include "tools/teleop/terminal_mode.hpp"

namespace clearway::teleop {
namespace {

constexpr const char* kDescription =
    "Drives the robot by keys: publishes DRIVE_REQUEST and shows DRIVE_PERMIT.\n"
    "w s or up down: a step faster forward, backward; a d or left right: a step of turning;\n"
    "space: stop; q: quit. Hold a key to keep going: after 0.6 s without one it asks for "
    "standstill.";

constexpr std::int64_t kRequestPeriod_us = 50'000;
constexpr std::int64_t kLinePeriod_us = 100'000;

/// Keys in, DRIVE_REQUEST out.
class Teleop {
 public:
  Teleop(const graph::GraphConfig& config, process::LiveRuntime& runtime)
      : runtime_(runtime),
        wish_({config.vehicle.max_forward_mps,
               config.vehicle.max_backward_mps,
               config.vehicle.max_turn_radps}),
        session_(runtime.NewSession()) {
    process::Subscribe<drive_permit_t>(
        runtime_, messages::channels::kDrivePermit, [this](const auto& m) { OnPermit(m); }, [] {});
    runtime_.WatchDescriptor(STDIN_FILENO, [this] { ReadKeys(); });
    runtime_.Every(kRequestPeriod_us, [this] { Request(wish_.At(runtime_.MonotonicUs())); });
    runtime_.Every(kLinePeriod_us, [this] { ShowLine(); });
    ShowLine();
  }

  /// The last word: standstill.
  void End() {
    Request({});
    std::fputs("\n", stdout);
    std::fflush(stdout);
  }

 private:
  void ReadKeys() {
    std::array<char, 256> bytes{};
    const ssize_t size = read(STDIN_FILENO, bytes.data(), bytes.size());
    if (size <= 0) {  // The terminal is gone.
      runtime_.Stop();
      return;
    }
    const std::int64_t now_us = runtime_.MonotonicUs();
    for (const Key key : decoder_.Decode({bytes.data(), static_cast<std::size_t>(size)})) {
      wish_.OnKey(key, now_us);
      if (key == Key::kStop) Request({});
      if (key == Key::kQuit) runtime_.Stop();
    }
  }

  void OnPermit(const drive_permit_t& m) {
    const bool is_taken = gate_.OnPermit({m.session,
                                          m.sequence,
                                          m.utime,
                                          m.valid_us,
                                          m.forward_mps,
                                          m.backward_mps,
                                          m.turn_left_radps,
                                          m.turn_right_radps},
                                         runtime_.MonotonicUs());
    if (is_taken) permit_ = m;
  }

  void Request(const core::BaseMotion& motion) {
    drive_request_t message{};
    message.utime = runtime_.UtimeNow();
    message.session = session_;
    message.sequence = sequence_++;
    message.v_mps = motion.v_mps;
    message.w_radps = motion.w_radps;
    process::Publish(runtime_, messages::channels::kDriveRequest, message);
  }

  void ShowLine() {
    const std::int64_t now_us = runtime_.MonotonicUs();
    const auto width = static_cast<std::size_t>(TerminalWidth(STDOUT_FILENO) - 1);
    const std::string line =
        StatusLine(wish_.At(now_us), gate_.PermitState(now_us), permit_, width);
    if (line == shown_) return;
    shown_ = line;
    std::printf("\r\x1b[K%s", line.c_str());
    std::fflush(stdout);
  }

  process::LiveRuntime& runtime_;
  KeyDecoder decoder_;
  OperatorWish wish_;
  core::BaseGate gate_;
  drive_permit_t permit_{};
  std::int64_t session_;
  std::int64_t sequence_ = 0;
  std::string shown_;
};

int Run(int argc, char** argv) {
  CLI::App app(kDescription, "clearway-teleop");
  graph::Options options;
  graph::AddOptions(app, options);
  return graph::GuardedMain(app, options, argc, argv, [&] {
    const config::LoadResult<graph::GraphConfig> config = graph::LoadConfig(options);
    if (graph::AnsweredByConfig(options, config)) return graph::kExitOk;

    // Signals are blocked from here on and end Run(): the terminal is restored in any case.
    process::LiveRuntime runtime(config.root.buses, options.channel_prefix);
    const TerminalMode mode(STDIN_FILENO);
    std::puts(
        "w/s forward/backward, a/d left/right (or arrows), space stop, q quit; hold to drive");
    Teleop teleop(config.root, runtime);
    runtime.Run();
    teleop.End();
    return graph::kExitOk;
  });
}

}  // namespace
}  // namespace clearway::teleop

int main(int argc, char** argv) {
  return clearway::teleop::Run(argc, argv);
}
